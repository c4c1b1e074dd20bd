"""Kind of instability of a dominant Floquet multiplier."""

from __future__ import annotations

#: |Im| below this share of |mu| is a real multiplier
_REAL_SHARE = 1e-6


def bifurcation_kind(multiplier: complex) -> str:
    """``"flip"`` where the multiplier is real and negative, else ``"hopf"``."""
    is_real = abs(multiplier.imag) <= _REAL_SHARE * abs(multiplier)
    return "flip" if is_real and multiplier.real < 0.0 else "hopf"
