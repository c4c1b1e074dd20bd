"""Cubic spline through points, as `scipy.interpolate.CubicSpline` has it.

That module loads the optimisation, the rotations and the special functions of scipy, and a solver
of its own the linear algebra: a good part of the time that a short run takes. The equations are the
same, and so are the results.
"""

import numpy as np
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
    before, after = width[:-1], width[1:]
    right = 3.0 * (after * slope[:-1] + before * slope[1:])
    lower, upper = after[:, 0].copy(), before[:, 0].copy()
    middle = 2.0 * (lower + upper)
    # the ends have equations of two slopes each, which take the outer ones out of the inner system
    first, last = x[2] - x[0], x[-1] - x[-3]
    at_first = (
        (width[0] + 2.0 * first) * width[1] * slope[0] + width[0] ** 2 * slope[1]
    ) / first  # fmt: skip
    at_last = (
        width[-1] ** 2 * slope[-2] + (2.0 * last + width[-1]) * width[-2] * slope[-1]
    ) / last  # fmt: skip
    middle[0] -= first
    right[0] -= at_first
    middle[-1] -= last
    right[-1] -= at_last
    lower[0] = upper[-1] = 0.0
    inner = _solved(lower, middle, upper, right)
    return np.concatenate(
        [
            (at_first - first * inner[:1]) / width[1],
            inner,
            (at_last - last * inner[-1:]) / width[-2],
        ]
    )


def _solved(lower: Array, middle: Array, upper: Array, right: Array) -> Array:
    """Solution (n, k) of a tridiagonal system whose diagonal outweighs what is beside it.

    Cyclic reduction (Hockney 1965, J. ACM 12, 95-113): every other unknown is taken out at once, so
    that a long system is solved by a few operations on arrays. `lower` begins with zero, `upper`
    ends with it, both (n,).
    """
    count = len(middle)
    if count == 1:
        return right / middle
    if count % 2 == 0:
        # an unknown of its own, zero, which makes the even ones one more than the odd ones
        more = np.append(right, np.zeros((1, right.shape[1])), axis=0)
        padded = np.append(lower, 0.0), np.append(middle, 1.0), np.append(upper, 0.0)
        return _solved(*padded, more)[:count]
    low, mid, high, even = lower[::2], middle[::2], upper[::2], right[::2]
    below, above = lower[1::2] / mid[:-1], upper[1::2] / mid[1:]
    odd = _solved(
        -below * low[:-1],
        middle[1::2] - below * high[:-1] - above * low[1:],
        -above * high[1:],
        right[1::2] - below[:, None] * even[:-1] - above[:, None] * even[1:],
    )
    solution = np.empty_like(right)
    solution[1::2] = odd
    taken_out = even.copy()
    taken_out[1:] -= low[1:, None] * odd
    taken_out[:-1] -= high[:-1, None] * odd
    solution[::2] = taken_out / mid[:, None]
    return solution
