"""Zeroth-order limits less a fifth, as a cautious shop would take them."""

from __future__ import annotations

from chatter.stability.limit_curve import LimitCurve
from chatter.stability.methods.zeroth_order.zeroth_order_method import ZerothOrder
from chatter.stability.stability_method import Sweep


class CautiousZerothOrder(ZerothOrder):
    name = "cautious-zero-order"
    label = "zeroth-order, a fifth less"
    help = "Zeroth-order limits less a fifth."

    def limits_of(self, sweep: Sweep) -> LimitCurve:
        found = super().limits_of(sweep)
        return found._replace(
            critical_depth=0.8 * found.critical_depth,
            crossings=tuple(0.8 * each for each in found.crossings),
        )


METHOD = CautiousZerothOrder()
