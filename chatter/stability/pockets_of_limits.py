"""Pockets of the limits of a model, with a margin for what the linear methods neglect."""

import math
from typing import NamedTuple

from chatter.stability.forced_vibration import neglected_in_steady_cut
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.methods.zeroth_order.limits import zero_order_of
from chatter.stability.methods.zeroth_order.uniform_pitch import ZeroOrderLimit
from chatter.stability.misfit_of_modes import neglected_misfit_of_modes
from chatter.stability.model import MillingModel
from chatter.stability.neglected_effects import EDGE_FORCES, NeglectedEffect
from chatter.stability.pockets import Pocket, depth_margin, find_pockets
from chatter.stability.resting_friction import (
    limits_with_resting_friction,
    neglected_resting_friction,
)
from chatter.stability.search_range import known_to
from chatter.stability.stability_method import StabilityMethod


class PocketsOfLimits(NamedTuple):
    """Pockets, and what they keep a margin for."""

    pockets: tuple[Pocket, ...]
    neglected: tuple[NeglectedEffect, ...]
    resting_friction: float  # share of the lowest limit that resting frictions leave


def pockets_of_limits(
    model: MillingModel,
    method: StabilityMethod,
    limits: LimitCurve,
    max_depth: float,
    zero_order: ZeroOrderLimit | None = None,
) -> PocketsOfLimits:
    """Neglected effects of limits over speeds, and the pockets that are left with them.

    The limits are by the method, the depth, m, as far as they were searched; `zero_order` at the
    same speeds where it is known.
    """
    case, speeds = model.case, limits.spindle_speed
    neglected = (
        *neglected_resting_friction(model),
        *neglected_misfit_of_modes(model, method),
        *neglected_in_steady_cut(model, method, limits.critical_depth),
    )
    margin = depth_margin([one for one in neglected if one.name == EDGE_FORCES])
    here = zero_order_of(model, speeds) if zero_order is None else zero_order
    at_rest = limits_with_resting_friction(model, here)
    area = case.width_of_cut * case.cut.feed_per_tooth * case.tool.teeth / (2.0 * math.pi)
    bounded = at_rest.bounded(limits.critical_depth)
    pockets = find_pockets(
        speeds, bounded, max_depth, area, depth_margin=margin, known_to=known_to(max_depth, here)
    )
    return PocketsOfLimits(pockets, neglected, at_rest.of_lowest)
