"""Cubic spline through points, as `scipy.interpolate.CubicSpline` has it.

That module loads the optimisation, the rotations and the special functions of scipy, a good part of
the time that a short run takes. The equations are the same, and so are the results.
"""

import numpy as np
import scipy
from numpy.typing import NDArray

Array = NDArray[np.float64]


class CubicSpline:
    """Piecewise cubic with continuous curvature, its third derivative too at the first inner knots.

    Not-a-knot ends: de Boor 1978, A Practical Guide to Splines, ch. IV.

    Parameters
    ----------
    x : (n,) array of float
        Increasing, n >= 4.
    y : (n, k) array of float
    """

    def __init__(self, x: Array, y: Array) -> None:
        self.x = np.asarray(x, dtype=np.float64)
        y = np.asarray(y, dtype=np.float64)
        if len(self.x) < 4:
            raise ValueError(f"a cubic spline of {len(self.x)} points; four are needed")
        width = np.diff(self.x)[:, None]
        if not np.all(width > 0.0):
            raise ValueError("the places of a cubic spline must increase")
        slope = np.diff(y, axis=0) / width
        tangent = _tangents(self.x, width, slope)
        bend = (tangent[:-1] + tangent[1:] - 2.0 * slope) / width
        #: of the powers 0 to 3 of the distance from the left end of each interval (4, n - 1, k)
        self.coefficients = np.stack(
            [y[:-1], tangent[:-1], (slope - tangent[:-1]) / width - bend, bend / width]
        )

    def __call__(self, places: Array) -> Array:
        """Values at places (...), along a further axis (..., k); cubic beyond the ends too."""
        places = np.asarray(places, dtype=np.float64)
        last = len(self.x) - 2
        interval = np.clip(np.searchsorted(self.x, places, side="right") - 1, 0, last)
        distance = (places - self.x[interval])[..., None]
        value, power = np.zeros((*places.shape, self.coefficients.shape[2])), 1.0
        for coefficient in self.coefficients:
            value += coefficient[interval] * power
            power = power * distance
        return value


def _tangents(x: Array, width: Array, slope: Array) -> Array:
    """Slopes at the points (n, k) for which the curvature is continuous."""
    bands = np.zeros((3, len(x)))
    right = np.empty((len(x), slope.shape[1]))
    bands[1, 1:-1] = 2.0 * (width[:-1, 0] + width[1:, 0])
    bands[0, 2:] = width[:-1, 0]
    bands[2, :-2] = width[1:, 0]
    right[1:-1] = 3.0 * (width[1:] * slope[:-1] + width[:-1] * slope[1:])
    bands[1, 0], bands[0, 1] = width[1, 0], x[2] - x[0]
    over = x[2] - x[0]
    right[0] = ((width[0] + 2.0 * over) * width[1] * slope[0] + width[0] ** 2 * slope[1]) / over
    bands[1, -1], bands[2, -2] = width[-2, 0], x[-1] - x[-3]
    over = x[-1] - x[-3]
    right[-1] = (
        width[-1] ** 2 * slope[-2] + (2.0 * over + width[-1]) * width[-2] * slope[-1]
    ) / over
    return scipy.linalg.solve_banded((1, 1), bands, right, check_finite=False)
