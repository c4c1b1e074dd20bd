"""How coarse the elements of collocation may be for the limits that a search needs."""

from collections.abc import Sequence

import numpy as np

from chatter.description.arrays import Array
from chatter.stability.methods.collocation.element_cut import RESOLUTION, element_cut
from chatter.stability.methods.collocation.multipliers import growth_rate_at
from chatter.stability.model import MillingModel
from dynamics.modal.modes import inside_band

#: chatter wavelengths in an element that are tried, the most first
_TRIED = (6.0, 4.0, 3.0, 2.0, 1.4)
#: permitted error of the growth rate (logarithm of the spectral radius): limits move by less than
#: 1e-3
_ERROR = 2e-5
#: speeds and depths at which it is compared
_SPEEDS, _DEPTHS = 6, 5


def max_wavelengths(model: MillingModel, speeds: Array, depths: Array) -> float:
    """Largest number of wavelengths in an element at which stability is the same as for every day.

    The elements for every day resolve the fastest mode. Where slower ones decide, as on a machine
    whose highest modes hardly take part, far longer elements give the same; that is evaluated, at
    points spread over all speeds (rad/s) and depths (m), ascending.
    """
    speed, depth = (
        part.ravel()
        for part in np.meshgrid(
            np.geomspace(speeds[0], speeds[-1], _SPEEDS),
            np.geomspace(max(depths[0], 0.05 * depths[-1]), depths[-1], _DEPTHS),
        )
    )

    def growth_rate(wavelengths: float) -> Array:
        cut = element_cut(model, float(depths[-1]), wavelengths=wavelengths)
        return growth_rate_at(cut, speed, depth)

    known = growth_rate(RESOLUTION[1])
    for wavelengths in _TRIED:
        if np.all(np.abs(growth_rate(wavelengths) - known) <= _ERROR):
            return wavelengths
    return RESOLUTION[1]


def extreme_models(models: Sequence[MillingModel]) -> list[MillingModel]:
    """Of models of one case with other values, those whose fast modes differ most.

    The one with the fastest mode, and those whose fastest mode takes part most and least: by the
    share of its response at resonance in that of the liveliest mode.
    """

    def highest(model: MillingModel) -> float:
        return max((mode.frequency for mode in inside_band(model.structure.modes)), default=0.0)

    def share(model: MillingModel) -> float:
        modes = model.structure.modes
        if not modes:
            return 0.0
        lively = [1.0 / (mode.stiffness * mode.damping) for mode in modes]
        fastest = max(range(len(modes)), key=lambda index: modes[index].frequency)
        return lively[fastest] / max(lively)

    if not models:
        return []
    shares = [share(model) for model in models]
    fastest = int(np.argmax([highest(model) for model in models]))
    chosen = {fastest, int(np.argmax(shares)), int(np.argmin(shares))}
    return [models[index] for index in sorted(chosen)]
