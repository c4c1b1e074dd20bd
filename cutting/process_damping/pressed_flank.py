"""What a flank presses against, over the slope at which its edge moves into the work.

The land is short against the waves that it meets: at a distance s behind an edge that moves into
the work at the slope q (its velocity over the cutting speed) the new surface lies s q away. The
flank of depth d(s) below the line of the new surface then displaces, a width,

    A(q) = sum over s of max(0, s q + d(s)) - max(0, d(s))

and a small motion beside that slope meets the dashpot K dA/dq over the cutting speed. A motion that
is not small beside it meets the describing value of A (Gelb and Vander Velde 1968, Multiple-Input
Describing Functions, section 6.2): the mean of dA/dq over the slopes passed, with semicircular
weight.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

#: slopes of a table, an odd number, and distances along the flank
_SLOPES, _DISTANCES = 601, 4001
#: steepest slope of a table, of that at which the whole flank is pressed
_STEEPEST = 0.95
#: nodes of the mean over the slopes that a vibration passes
_PHASES = 64


class PressingOverSlope(NamedTuple):
    """Area that a flank presses over the slope, and its derivative, beside a still tool."""

    steepest: float  # the slopes go from minus this to this
    area: NDArray[np.float64]  # A, m^2 (S,)
    coefficient: NDArray[np.float64]  # dA/dq, m^2 (S,)

    @property
    def slope(self) -> NDArray[np.float64]:
        """Slopes of the table (S,)."""
        return np.linspace(-self.steepest, self.steepest, self.area.size)

    def describing_coefficient(self, slope: float, swing: float) -> float:
        """Describing value of dA/dq, m^2, for a vibration about a slope.

        `swing` is the largest slope of the vibration itself, > 0.
        """
        return float(np.interp(slope, self.slope, self.described(swing)))

    def described(self, swing: float) -> NDArray[np.float64]:
        """Describing value of dA/dq (S,), m^2, about every slope for a vibration of this swing."""
        phase = (np.arange(_PHASES) + 0.5) * math.pi / _PHASES
        weight = 2.0 / _PHASES * np.sin(phase) ** 2
        passed = self.slope[:, None] + swing * np.cos(phase)
        return np.interp(passed, self.slope, self.coefficient) @ weight


def pressing_over_slope(
    profile: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    contact_length: float,
    clearance_angle: float,
) -> PressingOverSlope:
    """Table of the area that a flank presses.

    Parameters
    ----------
    profile : callable
        Depth of the flank, m, below the line of the new surface at distances (n,), m, behind the
        edge.
    contact_length : float
        Of a still tool, m.
    clearance_angle : float
        rad.
    """
    steepest = _STEEPEST * math.tan(clearance_angle)
    slope = np.linspace(-steepest, steepest, _SLOPES)
    reach = contact_length / (1.0 - _STEEPEST)
    # crowded towards the edge, where all slopes press
    border = reach * np.linspace(0.0, 1.0, _DISTANCES) ** 2
    distance, width = 0.5 * (border[1:] + border[:-1]), np.diff(border)
    depth = profile(distance)
    still = width @ np.maximum(depth, 0.0)
    level = slope[:, None] * distance + depth
    area = np.maximum(level, 0.0) @ width - still
    return PressingOverSlope(steepest, area, np.gradient(area, slope))
