"""Limits of stability over spindle speed: what every method returns."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class LimitCurve(NamedTuple):
    """Limits of stability along depth at every spindle speed."""

    spindle_speed: NDArray[np.float64]  # rad/s (n,)
    critical_depth: NDArray[np.float64]  # m (n,), the first limit; inf where none was found
    chatter_frequency: NDArray[np.float64]  # Hz (n,), nan where none was found
    bifurcation: tuple[str, ...]  # "hopf", "flip" or "none" (n,)
    crossings: tuple[NDArray[np.float64], ...]  # m, all: lost at even places, regained at odd
    steps: NDArray[np.int64]  # steps a tooth period (n,), 0 where the method has none
    error: float = np.nan  # estimated, of the limit depths, relative; nan where it was not

    def up_to(self, count: int) -> LimitCurve:
        """Return the curve of the first `count` speeds."""
        return LimitCurve(*(column[:count] for column in self[:-1]), self.error)
