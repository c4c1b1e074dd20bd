"""A number of cuts in words."""

from __future__ import annotations


def number_of_cuts(count: int) -> str:
    """Return ``"1 cut"``, ``"3 cuts"``."""
    return f"{count} cut" if count == 1 else f"{count} cuts"
