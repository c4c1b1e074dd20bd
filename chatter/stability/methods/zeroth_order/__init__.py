"""Zeroth order."""
