"""Collocation."""
