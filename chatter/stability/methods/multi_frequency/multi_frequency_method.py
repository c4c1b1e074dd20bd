"""The multi-frequency solution."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from chatter.stability.stability_method import StabilityMethod, Sweep

if TYPE_CHECKING:
    from chatter.stability.limit_curve import LimitCurve


class MultiFrequency(StabilityMethod):
    """Harmonics of the directional coefficients, by the argument principle."""

    name = "multi-frequency"
    label = "multi-frequency"
    help = "Any tool straight from FRFs (Budak and Altintas 1998), low radial immersion too."
    takes_frfs = True

    def limits_of(self, sweep: Sweep) -> LimitCurve:
        """Limits from the FRFs themselves."""
        from chatter.stability.limits_by_depth import few_depths
        from chatter.stability.methods.multi_frequency.determinant import FrequencyResponse
        from chatter.stability.methods.multi_frequency.limits import limit_curve

        model, speeds, depths, _, progress = sweep
        lines, receptance = model.receptance
        response = FrequencyResponse(2.0 * np.pi * lines, np.ascontiguousarray(receptance))
        if model.is_inclined:
            few = few_depths(depths)
            return limit_curve(model.cut, response, speeds, few, progress)
        cut = model.cut(sweep.max_depth)
        return limit_curve(lambda _: cut, response, speeds, depths, progress)


MULTI_FREQUENCY = MultiFrequency()
