"""How far cutting tests are from the stability limit of a case."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from chatter.compile.structure import depends_on_speed
from chatter.description.case import Case
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.methods.collocation.multipliers import multipliers
from chatter.stability.model import MillingModel, milling_model
from chatter.stability.steady_flank import about_steady_motion, follows_steady_motion

#: share of the depth over which the growth rate is evaluated
_STEP = 0.04
#: margins beyond this count as this
_FAR = 3.0


def stability_margins(
    case: Case, speeds: NDArray[np.float64], depths: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Share of its depth by which a cut is away from the limit; above 0: stable.

    From the logarithm of the spectral radius at the depth and a little above, as if it were linear
    in the logarithm of the depth.
    """
    rate, slope = np.empty(speeds.size), np.empty(speeds.size)
    for chosen, model in _models(case, speeds, depths):
        cut = element_cut(model, (1.0 + _STEP) * float(depths[chosen].max()))
        at = multipliers(cut, speeds[chosen], depths[chosen])
        above = multipliers(cut, speeds[chosen], depths[chosen] * (1.0 + _STEP))
        rate[chosen] = np.log(np.maximum(np.abs(at), 1e-12))
        slope[chosen] = (np.log(np.maximum(np.abs(above), 1e-12)) - rate[chosen]) / np.log1p(_STEP)
    # where rate does not rise with depth, its size tells no more than the side
    rising = np.maximum(slope, 0.3 * np.abs(rate) + 1e-3)
    return np.clip(-rate / rising, -_FAR, _FAR)


def _models(
    case: Case, speeds: NDArray[np.float64], depths: NDArray[np.float64]
) -> Iterator[tuple[NDArray[np.bool_], MillingModel]]:
    """Tests that share a model, and the model."""
    model = milling_model(case)
    if not depends_on_speed(case) and not follows_steady_motion(model):
        yield np.ones(speeds.size, dtype=bool), model
        return
    for speed in np.unique(speeds):
        own = model.at_speed(float(speed)) if depends_on_speed(case) else model
        at_speed = speeds == speed
        if not follows_steady_motion(model):
            yield at_speed, own
            continue
        for depth in np.unique(depths[at_speed]):
            yield at_speed & (depths == depth), about_steady_motion(own, float(speed), float(depth))
