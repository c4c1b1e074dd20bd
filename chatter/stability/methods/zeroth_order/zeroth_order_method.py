"""Zeroth-order approximation (ZOA) in the frequency domain."""

import numpy as np

from chatter.description.arrays import Array, IntegerArray
from chatter.stability.limit_curve import LimitCurve, limits_at
from chatter.stability.stability_method import StabilityMethod, Sweep


class ZerothOrder(StabilityMethod):
    """Limits from averaged directional coefficients; no steps, no flip bifurcations."""

    name = "zero-order"
    label = "zeroth-order"
    help = "Averaged directional coefficients (Altintas and Budak 1995), straight from FRFs."
    takes_varying_speed = True
    takes_process_damping = False
    takes_frfs = True

    def limits_of(self, sweep: Sweep) -> LimitCurve:
        """Limits within the depths; see `zero_order_of`."""
        from chatter.stability.methods.zeroth_order.limits import zero_order_of

        limit = zero_order_of(sweep.model, sweep.speeds)
        crossings = [depth[depth <= sweep.depths[-1]] for depth in limit.critical_depth[:, None]]

        def at_limits(
            index: IntegerArray,
            depth: Array,  # noqa: ARG001
        ) -> tuple[list[str], Array]:
            return ["hopf"] * index.size, limit.chatter_frequency[index]

        count = len(sweep.speeds)
        sweep.progress(count, count)
        return limits_at(at_limits, sweep.speeds, crossings, np.zeros(count, dtype=np.int64))


ZEROTH_ORDER = ZerothOrder()
