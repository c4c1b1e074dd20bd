"""The matrix-free method."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from chatter.description.arrays import Array
from chatter.stability.stability_method import Multiplier, StabilityMethod, Sweep

if TYPE_CHECKING:
    from chatter.stability.limit_curve import LimitCurve
    from chatter.stability.model import MillingModel


class MatrixFree(StabilityMethod):
    """Initial functions propagated in time, and the space that they span."""

    name = "matrix-free"
    label = "matrix-free"
    help = "Any tool, with the contact of tool and work; a check of collocation by other means."
    takes_varying_speed = True
    takes_contact = True
    gives_radius = gives_multiplier = gives_chatter_frequency = True

    def limits_of(self, sweep: Sweep) -> LimitCurve:
        """Limits with extrapolated multipliers."""
        from chatter.stability.methods.matrix_free.multipliers import limit_curve
        from chatter.stability.methods.matrix_free.stepped_cut import stepped_cuts

        model, speeds, depths, _, progress = sweep
        return limit_curve(stepped_cuts(model, sweep.max_depth), speeds, depths, progress)

    def radius_of(self, sweep: Sweep) -> Array:
        """Spectral radius at points."""
        from chatter.stability.methods.matrix_free.multipliers import multipliers
        from chatter.stability.methods.matrix_free.stepped_cut import stepped_cut

        cut = stepped_cut(sweep.model, sweep.max_depth)
        return np.abs(multipliers(cut, sweep.speeds, sweep.depths, sweep.progress))

    def multiplier(self, model: MillingModel, steps: int | None) -> Multiplier:  # noqa: ARG002
        """Dominant multiplier of the cut of a case, its steps halved until it has converged."""
        from chatter.stability.methods.matrix_free.multipliers import converged_multiplier
        from chatter.stability.methods.matrix_free.stepped_cut import stepped_cuts

        speed, depth = model.operating_point
        return converged_multiplier(stepped_cuts(model, depth), speed, depth)

    def chatter_frequency(self, model: MillingModel) -> float:
        """Chatter frequency of the cut of a case, Hz."""
        from chatter.stability.methods.matrix_free.multipliers import chatter_frequency
        from chatter.stability.methods.matrix_free.stepped_cut import stepped_cut

        speed, depth = model.operating_point
        return chatter_frequency(stepped_cut(model, depth), speed, depth)


MATRIX_FREE = MatrixFree()
