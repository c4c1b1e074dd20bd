"""Depth limits at a speed by scan and bisection on the multipliers of the collocation."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from . import milling

#: a multiplier whose imaginary part is less than this share of it is real
_REAL = 1e-5


class Crossing(NamedTuple):
    """A depth in m where the largest multiplier has magnitude one, and that multiplier."""

    depth: float
    multiplier: complex
    entering: bool

    @property
    def kind(self):
        """ "hopf", "flip" or "fold"."""
        if abs(self.multiplier.imag) > _REAL:
            return "hopf"
        return "flip" if self.multiplier.real < 0.0 else "fold"


def crossings(case, depths, only_first=False, **resolution):
    """Return the crossings between the given depths, ascending; `case.depth` does not matter.

    The space below the first depth belongs to the scan, as zero depth is always stable.
    """

    def growth(depth):
        dominant = milling.multipliers(replace(case, depth=float(depth)), **resolution)[0]
        return math.log(abs(dominant))

    found = []
    low, growth_low = 1e-6 * depths[0], -1.0
    for high in depths:
        growth_high = growth(high)
        if (growth_high > 0.0) != (growth_low > 0.0):
            depth = brentq(growth, low, high, xtol=1e-12, rtol=1e-13)
            multiplier = milling.multipliers(replace(case, depth=depth), **resolution)[0]
            found.append(Crossing(depth, complex(multiplier), growth_high > 0.0))
            if only_first:
                break
        low, growth_low = high, growth_high
    return found


def first_limit(case, start=0.05e-3, step=0.17e-3, deepest=10e-3, **resolution):
    """Return the first Crossing above zero depth, or None up to the deepest."""
    depths = np.arange(start, deepest + step, step)
    found = crossings(case, depths, only_first=True, **resolution)
    return found[0] if found else None
