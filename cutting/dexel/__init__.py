"""Dexel."""
