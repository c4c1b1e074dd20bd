"""Semi-discretization of several orders, and full discretization."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from chatter.description.arrays import Array
from chatter.stability.stability_method import Multiplier, StabilityMethod, Sweep

if TYPE_CHECKING:
    from chatter.stability.limit_curve import LimitCurve
    from chatter.stability.methods.semi_discretization.step_schemes import Scheme
    from chatter.stability.model import MillingModel


class DiscretizedDelay(StabilityMethod):
    """Limits by a scheme that discretizes the steps of a tooth period.

    The scheme is a name in `step_schemes`; the rest as of `StabilityMethod`.
    """

    takes_any_tool = False

    def __init__(self, name: str, label: str, help: str, scheme: str) -> None:  # noqa: A002
        self.name, self.label, self.help = name, label, help
        self._scheme_name = scheme

    @property
    def scheme(self) -> Scheme:
        """The scheme, as compiled code takes it."""
        from chatter.stability.methods.semi_discretization import step_schemes

        return getattr(step_schemes, self._scheme_name)

    def limits_of(self, sweep: Sweep) -> LimitCurve:
        """Limits, extrapolated from two resolutions where the case fixes no steps."""
        from chatter.stability.methods.semi_discretization.arrays import milling_arrays
        from chatter.stability.methods.semi_discretization.multipliers import limit_curve

        return limit_curve(milling_arrays(sweep.model), *sweep[1:], self.scheme)


class SemiDiscretization(DiscretizedDelay):
    """First-order semi-discretization, which also gives multipliers."""

    gives_radius = gives_multiplier = True

    def radius_of(self, sweep: Sweep) -> Array:
        """Spectral radius at points."""
        from chatter.stability.methods.semi_discretization.arrays import milling_arrays
        from chatter.stability.methods.semi_discretization.multipliers import multipliers

        return np.abs(multipliers(milling_arrays(sweep.model), *sweep[1:]))

    def multiplier(self, model: MillingModel, steps: int | None) -> Multiplier:
        """Dominant multiplier of the cut of a case, by the steps that it fixes or converged."""
        from chatter.stability.methods.semi_discretization.arrays import milling_arrays
        from chatter.stability.methods.semi_discretization.multipliers import (
            converged_multiplier,
            multipliers,
        )

        speed, depth = model.operating_point
        arrays = milling_arrays(model)
        if steps is None:
            return converged_multiplier(arrays, speed, depth)
        point = np.array([speed]), np.array([depth])
        coarse, fine = (multipliers(arrays, *point, n)[0] for n in (steps, 2 * steps))
        # of second order: a third of the change is left
        return Multiplier(complex(coarse), steps, float(abs(abs(coarse) - abs(fine)) * 4.0 / 3.0))


FIRST_ORDER = SemiDiscretization(
    "semi-discretization",
    "semi-discretization",
    "First order (Insperger and Stepan 2004); to compare with published work, with steps.",
    "FIRST_ORDER",
)
ZEROTH_ORDER = DiscretizedDelay(
    "semi-discretization-0",
    "semi-discretization of order 0",
    "Delayed motion constant over a step; to see how a published scheme errs.",
    "ZEROTH_ORDER",
)
SECOND_ORDER = DiscretizedDelay(
    "semi-discretization-2",
    "semi-discretization of order 2",
    "Delayed motion a parabola over a step; to see how a published scheme errs.",
    "SECOND_ORDER",
)
FULL_DISCRETIZATION = DiscretizedDelay(
    "full-discretization",
    "full discretization",
    "Ding, Zhu, Zhang and Ding 2010; to see how a published scheme errs.",
    "FULL_DISCRETIZATION",
)
