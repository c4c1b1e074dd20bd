"""Limits for a moving slider: the boundary is followed instead of searched for on a whole net."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from chatter.model import MillingModel
from chatter.stability import collocation
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.multiplier import bifurcation_kind
from chatter.stability.sweep import Progress

#: points an element and waves of the highest mode in one, enough for a picture
_POINTS, _WAVES = 6, 1.0
#: the chatter frequency is asked for at every so many speeds
_STRIDE = 3


def followed_limits(
    model: MillingModel,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    steps: int | None,  # noqa: ARG001  (the signature of a method)
    progress: Progress,
) -> LimitCurve:
    """Limits to 0.5 % by following the boundary; chatter frequencies at every third speed.

    Parameters
    ----------
    model : MillingModel
    speeds, depths : array of float
        rad/s, m.
    progress : callable
        May raise to give up.
    """
    cut = model.cut(float(depths[-1]), _POINTS, _WAVES)
    crossings = collocation.followed_limits(cut, speeds, depths)
    progress(1, 2)
    found = np.array([i for i, limits in enumerate(crossings) if limits.size], dtype=np.int64)
    first = np.full(len(speeds), np.inf)
    first[found] = [crossings[i][0] for i in found]
    frequency = np.full(len(speeds), np.nan)
    for i in found[::_STRIDE]:
        frequency[i] = collocation.chatter_frequency(cut, float(speeds[i]), float(first[i]))
    kind = ["none"] * len(speeds)
    at_limit = collocation.multipliers(cut, speeds[found], first[found])
    for i, value in zip(found.tolist(), at_limit, strict=True):
        kind[i] = bifurcation_kind(complex(value))
    none_asked = np.zeros(len(speeds), dtype=np.int64)
    return LimitCurve(speeds, first, frequency, tuple(kind), tuple(crossings), none_asked)
