"""Collocation on elements."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from chatter.description.arrays import Array
from chatter.stability.stability_method import Multiplier, StabilityMethod, Sweep

if TYPE_CHECKING:
    from chatter.stability.limit_curve import LimitCurve
    from chatter.stability.model import MillingModel


class Collocation(StabilityMethod):
    """Collocation on elements of any tool, at any course of the spindle speed."""

    name = "collocation"
    label = "collocation"
    help = "Any tool, runout and course of the spindle speed; converges spectrally."
    takes_varying_speed = True
    gives_radius = gives_multiplier = gives_chatter_frequency = True

    def limits_of(self, sweep: Sweep) -> LimitCurve:
        """Limits, with finer elements until they are good to the tolerance of the case."""
        from chatter.stability.methods.collocation.converged_limits import converged_limit_curve
        from chatter.stability.methods.collocation.element_cut import element_cuts

        model, speeds, depths, _, progress = sweep
        cut_at = element_cuts(model, sweep.max_depth)
        return converged_limit_curve(cut_at, speeds, depths, progress, model.tolerance)

    def radius_of(self, sweep: Sweep) -> Array:
        """Spectral radius at points."""
        from chatter.stability.methods.collocation.element_cut import element_cut
        from chatter.stability.methods.collocation.multipliers import multipliers

        cut = element_cut(sweep.model, sweep.max_depth)
        return np.abs(multipliers(cut, sweep.speeds, sweep.depths, sweep.progress))

    def multiplier(self, model: MillingModel, steps: int | None) -> Multiplier:  # noqa: ARG002
        """Dominant multiplier of the cut of a case, refined until two resolutions agree."""
        from chatter.stability.methods.collocation.element_cut import element_cuts
        from chatter.stability.methods.collocation.multipliers import converged_multiplier

        speed, depth = model.operating_point
        return converged_multiplier(element_cuts(model, depth), speed, depth)

    def chatter_frequency(self, model: MillingModel) -> float:
        """Chatter frequency of the cut of a case, Hz."""
        from chatter.stability.methods.collocation.element_cut import element_cut
        from chatter.stability.methods.collocation.multipliers import chatter_frequency

        speed, depth = model.operating_point
        return chatter_frequency(element_cut(model, depth), speed, depth)

    def chatter_frequencies_of(self, sweep: Sweep) -> Array:
        """Chatter frequencies at points, Hz."""
        from chatter.stability.methods.collocation.element_cut import element_cut
        from chatter.stability.methods.collocation.multipliers import chatter_frequencies

        cut = element_cut(sweep.model, sweep.max_depth)
        return chatter_frequencies(cut, sweep.speeds, sweep.depths)


COLLOCATION = Collocation()
