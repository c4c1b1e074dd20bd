"""Limits from cuts simulated in the time domain."""

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


class TimeDomain(StabilityMethod):
    """Growth rate of small vibration measured in simulated cuts."""

    name = "time-domain"
    label = "time domain"
    help = "All that can be simulated: loss of contact, friction, ploughing in full."
    takes_contact = True
    is_linear = False
    is_fast = False
    gives_radius = True

    def limits_of_structure(
        self,
        model: MillingModel,
        speeds: Array,
        depths: Array,
        steps: int | None,  # noqa: ARG002
        progress: Progress,
    ) -> LimitCurve:
        """Limits on a grid of at most 32 depths, refined."""
        from chatter.stability.methods.time_domain.critical_depths import time_limit_curve

        return time_limit_curve(model.case, model.structure.modes, speeds, depths, progress)

    def radius_of_structure(
        self,
        model: MillingModel,
        speeds: Array,
        depths: Array,
        steps: int | None,  # noqa: ARG002
        progress: Progress,
    ) -> Array:
        """Spectral radius at n points."""
        from chatter.stability.methods.time_domain.critical_depths import growths

        found = growths(model.case, model.structure.modes, speeds, depths, progress)
        return np.array([growth.radius for growth in found])


TIME_DOMAIN = TimeDomain()
