"""Stability of milling: one module a method, one sweep."""
