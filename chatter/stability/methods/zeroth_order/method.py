"""Zeroth-order approximation (ZOA) in the frequency domain."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from chatter.stability.limit_curve import LimitCurve
from chatter.stability.method import StabilityMethod

if TYPE_CHECKING:
    from chatter.description.progress import Progress
    from chatter.stability.model import MillingModel

Array = NDArray[np.float64]


class ZerothOrder(StabilityMethod):
    """Limits from averaged directional coefficients; no steps, no flip bifurcations."""

    name = "zero-order"
    label = "zeroth-order"
    help = "Averaged directional coefficients (Altintas and Budak 1995), straight from FRFs."
    takes_varying_speed = True
    takes_process_damping = False
    takes_frfs = True

    def limits(
        self,
        model: MillingModel,
        speeds: Array,
        depths: Array,
        steps: int | None,  # noqa: ARG002
        progress: Progress,
    ) -> LimitCurve:
        """Limits within the depths; see `zero_order_of`."""
        from chatter.stability.methods.zeroth_order.limits import zero_order_of

        limit = zero_order_of(model, speeds)
        within = limit.critical_depth <= depths[-1]
        progress(len(speeds), len(speeds))
        return LimitCurve(
            spindle_speed=speeds,
            critical_depth=np.where(within, limit.critical_depth, np.inf),
            chatter_frequency=np.where(within, limit.chatter_frequency, np.nan),
            bifurcation=tuple("hopf" if found else "none" for found in within),
            crossings=tuple(
                np.array([depth]) if found else np.empty(0)
                for depth, found in zip(limit.critical_depth, within, strict=True)
            ),
            steps=np.zeros(len(speeds), dtype=np.int64),
        )


ZEROTH_ORDER = ZerothOrder()
