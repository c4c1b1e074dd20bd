"""Branches of a hysteresis and the reversals it remembers.

Branch n starts at reversal n, of value r_n, and runs r = r_n + 2 tanh(u) along its direction,
u = a x; branch 0, the curve from rest, runs r = tanh(u), u = 2 a x. Reversal n came at u_n on
branch n - 1; as branches are alike, branch n meets that reversal's forerunner at u_n too, and
branch n - 2 goes on from where it was left, at u_(n-1). Nothing but r_n and u_n is needed.
"""

import math

import numpy as np
from numpy.typing import NDArray

from dynamics.leaves import leaf

#: reversals remembered; beyond it, the two between which least happened are forgotten
_DEPTH = 64
#: tanh is 1 to the last bit
_SATURATED = 20.0
#: below it, three-point Gauss quadrature of tanh is exact to rounding
_SHORT = 0.02
#: below it, so is the middle with its second derivative
_TINY = 3e-4
_GAUSS = 0.5 * math.sqrt(0.6)


def reversal_columns(count: int) -> tuple[NDArray[np.int64], NDArray, NDArray, NDArray, NDArray]:
    """Return count, value, length, side and travel of hystereses that have not moved."""
    return (
        np.zeros(count, dtype=np.int64),
        np.zeros((count, _DEPTH)),
        np.zeros((count, _DEPTH)),
        np.ones(count),
        np.zeros(count),
    )


@leaf
def branch_value(law, i):
    """Value of r now."""
    n = law.count[i]
    if n == 0:
        return law.side[i] * math.tanh(law.travel[i])
    return law.value[i, n - 1] + law.side[i] * 2.0 * math.tanh(law.travel[i])


@leaf
def _tanh_over(start, width):
    """Integral of tanh over a width from start >= 0."""
    if start > _SATURATED:
        return width
    if width < _TINY:
        middle = math.tanh(start + 0.5 * width)
        return width * middle * (1.0 - width * width * (1.0 - middle * middle) / 12.0)
    if width < _SHORT:
        middle, off = start + 0.5 * width, _GAUSS * width
        ends = math.tanh(middle - off) + math.tanh(middle + off)
        return width * (5.0 * ends + 8.0 * math.tanh(middle)) / 18.0
    last = math.log1p(math.exp(-2.0 * (start + width)))
    return width + last - math.log1p(math.exp(-2.0 * start))


@leaf
def _rise_over(start, width, height):
    """Integral of height tanh(u), the rise of a branch, over a width from start >= 0."""
    return height * _tanh_over(start, width)


@leaf
def _lost_over(start, width, height):  # noqa: ARG001
    """Integral of tanh(u) - u / cosh(u)^2 over a width from start >= 0.

    It is what sliders behind springs dissipate, on every branch (Iwan 1966).
    """
    end = start + width
    lost = 2.0 * _tanh_over(start, width)
    return lost - (end * math.tanh(end) - start * math.tanh(start))


@leaf
def _nothing(start, width, height):  # noqa: ARG001
    return 0.0


@leaf
def _along(over, share, law, i, sign, distance):
    """Integral along a distance >= 0 (m) in a direction, and where it ends.

    `over` is the integral over a piece of a branch, of start and width in u and the branch's
    height; `share` the part of r where the branch begins that is added. Total, m, and branch and
    travel at the end.
    """
    a = law.hysteresis_slope[i]
    n, u = law.count[i], law.travel[i]
    origin = sign * law.value[i, n - 1] if n > 0 else 0.0
    close = law.length[i, n - 1] if n > 0 else math.inf
    if sign != law.side[i] and (n > 0 or u > 0.0):
        origin, close, u, n = sign * branch_value(law, i), u, 0.0, n + 1
    total, rest = 0.0, distance
    while True:
        scale = a if n > 0 else 2.0 * a
        closes = rest * scale > close - u
        # its own number: the end forgets the digits of a short distance
        width = close - u if closes else rest * scale
        run = width / scale if closes else rest
        total += share * origin * run + over(u, width, 2.0 if n > 0 else 1.0) / scale
        u = close if closes else u + width
        if not closes:
            break
        rest -= run
        if n == 1:
            n, origin, close = 0, 0.0, math.inf
        else:
            n -= 2
            u = law.length[i, n]
            origin = sign * law.value[i, n - 1] if n > 0 else 0.0
            close = law.length[i, n - 1] if n > 0 else math.inf
    return total, n, u


@leaf
def branch_mean(law, i, sign, distance):
    """Mean of r along a distance >= 0 (m) in a direction, counted along it."""
    if distance <= 0.0:
        return sign * branch_value(law, i)
    total, _, _ = _along(_rise_over, 1.0, law, i, sign, distance)
    return total / distance


@leaf
def branch_lost(law, i, sign, distance):
    """Dissipated energy per sliding force, m, along a distance > 0 (m) in a direction."""
    lost, _, _ = _along(_lost_over, 0.0, law, i, sign, distance)
    return lost


@leaf
def move_along(law, i, motion):
    """Move by a motion, m: note a reversal, forget loops that close."""
    if motion == 0.0:
        return
    sign = 1.0 if motion > 0.0 else -1.0
    if sign != law.side[i] and (law.count[i] > 0 or law.travel[i] > 0.0):
        if law.count[i] == law.value.shape[1]:
            _forget_least(law, i)
        n = law.count[i]
        law.value[i, n] = branch_value(law, i)
        law.length[i, n] = law.travel[i]
        law.count[i] = n + 1
        law.travel[i] = 0.0
    law.side[i] = sign
    _, n, u = _along(_nothing, 0.0, law, i, sign, abs(motion))
    law.count[i] = n
    law.travel[i] = u


@leaf
def _forget_least(law, i):
    """Forget the two neighbouring reversals whose branches differ least in length."""
    n = law.count[i]
    now = branch_value(law, i)
    least, gap = 1, math.inf
    for k in range(1, n - 1):
        if law.length[i, k] - law.length[i, k + 1] < gap:
            least, gap = k, law.length[i, k] - law.length[i, k + 1]
    for k in range(least, n - 2):
        law.value[i, k] = law.value[i, k + 2]
        law.length[i, k] = law.length[i, k + 2]
    law.count[i] = n - 2
    after = law.value[i, least] if least < n - 2 else now
    reach = min(0.5 * abs(after - law.value[i, least - 1]), 1.0 - 1e-16)
    if least < n - 2:
        law.length[i, least] = math.atanh(reach)
    else:
        law.travel[i] = math.atanh(reach)
