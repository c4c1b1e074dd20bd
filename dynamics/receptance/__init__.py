"""Receptance."""
