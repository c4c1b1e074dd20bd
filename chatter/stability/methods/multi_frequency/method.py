"""The multi-frequency solution."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from chatter.stability.method import StabilityMethod

if TYPE_CHECKING:
    from chatter.description.progress import Progress
    from chatter.stability.limit_curve import LimitCurve
    from chatter.stability.model import MillingModel

Array = NDArray[np.float64]


class MultiFrequency(StabilityMethod):
    """Harmonics of the directional coefficients, by the argument principle."""

    name = "multi-frequency"
    label = "multi-frequency"
    help = "Any tool straight from FRFs (Budak and Altintas 1998), low radial immersion too."
    takes_frfs = True

    def limits_of_structure(
        self,
        model: MillingModel,
        speeds: Array,
        depths: Array,
        steps: int | None,  # noqa: ARG002
        progress: Progress,
    ) -> LimitCurve:
        """Limits from the FRFs themselves."""
        from chatter.stability.methods.multi_frequency.determinant import FrequencyResponse
        from chatter.stability.methods.multi_frequency.limits import limit_curve

        lines, receptance = model.receptance
        response = FrequencyResponse(2.0 * np.pi * lines, np.ascontiguousarray(receptance))
        return limit_curve(model.cut(float(depths[-1])), response, speeds, depths, progress)


MULTI_FREQUENCY = MultiFrequency()
