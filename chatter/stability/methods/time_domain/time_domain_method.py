"""Limits from cuts simulated in the time domain."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from chatter.description.arrays import Array
from chatter.stability.stability_method import StabilityMethod, Sweep

if TYPE_CHECKING:
    from chatter.stability.limit_curve import LimitCurve


class TimeDomain(StabilityMethod):
    """Growth rate of small vibration measured in simulated cuts."""

    name = "time-domain"
    label = "time domain"
    help = "All that can be simulated: loss of contact, friction, ploughing in full."
    takes_contact = True
    is_linear = False
    is_fast = False
    gives_radius = True

    def limits_of(self, sweep: Sweep) -> LimitCurve:
        """Limits on a grid of at most 32 depths, refined."""
        from chatter.stability.methods.time_domain.critical_depths import time_limit_curve

        model, speeds, depths, _, progress = sweep
        return time_limit_curve(model.case, model.structure.modes, speeds, depths, progress)

    def radius_of(self, sweep: Sweep) -> Array:
        """Spectral radius at points."""
        from chatter.stability.methods.time_domain.critical_depths import growths

        model, speeds, depths, _, progress = sweep
        found = growths(model.case, model.structure.modes, speeds, depths, progress)
        return np.array([growth.radius for growth in found])


TIME_DOMAIN = TimeDomain()
