"""A dominant multiplier and what kind of instability it makes."""

from __future__ import annotations

from typing import NamedTuple

#: |Im| below this share of |mu| is a real multiplier
_REAL_SHARE = 1e-6


class Multiplier(NamedTuple):
    """Dominant Floquet multiplier over one period."""

    value: complex
    steps: int  # steps or points a period of the finest resolution
    error: float  # estimated error of |value|


def bifurcation_kind(multiplier: complex) -> str:
    """``"flip"`` where the multiplier is real and negative, else ``"hopf"``."""
    is_real = abs(multiplier.imag) <= _REAL_SHARE * abs(multiplier)
    return "flip" if is_real and multiplier.real < 0.0 else "hopf"
