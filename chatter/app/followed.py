"""Limits for a moving slider: the boundary is followed instead of searched for on a whole net."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from chatter.description.progress import Progress
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.methods.collocation import multipliers as collocation
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.methods.collocation.varying_speed import LOOSE_FIT
from chatter.stability.model import MillingModel

#: points per element and wavelengths of the highest mode in one, enough for a picture
_POINTS, _WAVELENGTHS = 6, 1.0
_TOLERANCE = 5e-3
_STRIDE = 8


def followed_limits(
    model: MillingModel,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    steps: int | None,  # noqa: ARG001  (the signature of a method)
    progress: Progress,
) -> LimitCurve:
    """Limits to 0.5 % by following the boundary.

    Parameters
    ----------
    model : MillingModel
    speeds, depths : array of float
        rad/s, m.
    progress : callable
        May raise to give up.
    """
    cut = element_cut(model, float(depths[-1]), _POINTS, _WAVELENGTHS).with_fit(LOOSE_FIT)
    return collocation.limit_curve(cut, speeds, depths, progress, _TOLERANCE, _STRIDE)
