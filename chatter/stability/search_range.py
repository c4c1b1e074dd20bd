"""Speeds and depths of a diagram: what the case asks for, completed from the model."""

import math

import numpy as np

from chatter.description.arrays import Array
from chatter.description.case import Case
from chatter.description.questioned import LONGEST_FLUTES
from chatter.stability.methods.zeroth_order.uniform_pitch import ZeroOrderLimit

_SPEED_COUNT = 400
#: depth searched over that of the cut, at the least
_BEYOND = 1.02
#: depths evaluated for the limit at one speed, and the share of the lowest zeroth-order limit
#: between them
_DEPTHS_AT_ONE_SPEED = 200
_SHARE_OF_LOWEST_LIMIT = 0.25
_MOST_DEPTHS = 1000
_DEPTH_COUNT = 100
#: depths evaluated, in units of the lowest zeroth-order limit
_MAX_DEPTH_IN_LOWEST_LIMITS = 6.0
#: without a limit to scale by, depths are evaluated up to this multiple of the operating depth
_MAX_DEPTH_IN_OPERATING_DEPTHS = 4.0


def spindle_speeds(case: Case) -> Array:
    """Speeds of the diagram, rad/s: from the case, else around the operating speed."""
    wanted = case.lobes.speeds if case.lobes else None
    if wanted is not None:
        return np.linspace(wanted.from_, wanted.to, wanted.count)
    operating = case.cut.spindle_speed
    return np.linspace(0.5 * operating, 1.5 * operating, _SPEED_COUNT)


def maximum_depth(case: Case, zero_order: ZeroOrderLimit) -> float:
    """Depth to which limits are searched, m: no deeper than the tool can cut, or its like."""
    wanted = case.lobes.depths if case.lobes else None
    if wanted is not None:
        return min(wanted.to, case.tool.depth_that_tool_allows)
    candidates = [_MAX_DEPTH_IN_OPERATING_DEPTHS * case.cut.axial_depth]
    if math.isfinite(zero_order.lowest_depth):
        candidates.append(_MAX_DEPTH_IN_LOWEST_LIMITS * zero_order.lowest_depth)
        finite = zero_order.critical_depth[np.isfinite(zero_order.critical_depth)]
        if finite.size:
            candidates.append(min(float(finite.max()), 4.0 * candidates[-1]))
    deepest = max(LONGEST_FLUTES * case.tool.diameter, _BEYOND * case.cut.axial_depth)
    return min(max(candidates), deepest, case.tool.depth_that_tool_allows)


def beyond_the_cut(case: Case, max_depth: float) -> float:
    """Depth to search that reaches a little beyond the cut, m, as far as the tool can cut."""
    return min(max(max_depth, _BEYOND * case.cut.axial_depth), case.tool.depth_that_tool_allows)


def known_to(searched: float, zero_order: ZeroOrderLimit | None) -> float:
    """Depth, m, above which a limit lies that was not found up to the depth searched.

    No deeper than the tool can cut was searched; the lowest zeroth-order limit lies where it lies.
    """
    return searched if zero_order is None else max(searched, zero_order.lowest_depth)


def axial_depths(case: Case, max_depth: float) -> Array:
    """Depths of the grid and the grid, m, ascending, > 0."""
    wanted = case.lobes.depths if case.lobes else None
    count = wanted.count if wanted is not None else _DEPTH_COUNT
    return np.linspace(0.0, max_depth, count + 1)[1:]


def depths_at_one_speed(case: Case, zero_order: ZeroOrderLimit) -> Array:
    """Depths of the grid for the limit at the operating speed, m, beyond the operating depth."""
    max_depth = beyond_the_cut(case, maximum_depth(case, zero_order))
    # limits lie close together near the lowest one, however deep the cut is
    near = min(max_depth, maximum_depth(case, zero_order))
    if math.isfinite(zero_order.lowest_depth):
        near = min(near, _MAX_DEPTH_IN_LOWEST_LIMITS * zero_order.lowest_depth)
    depths = _evenly(near, zero_order.lowest_depth)
    if near < max_depth:
        beyond = _evenly(max_depth, zero_order.lowest_depth)
        depths = np.concatenate([depths, beyond[beyond > depths[-1] * (1.0 + 1e-9)]])
    return depths


def _evenly(depth: float, lowest_limit: float) -> Array:
    """Evenly spaced depths down to one, m."""
    spacing = min(depth / _DEPTHS_AT_ONE_SPEED, _SHARE_OF_LOWEST_LIMIT * lowest_limit)
    count = min(_MOST_DEPTHS, math.ceil(depth / spacing))
    return np.linspace(0.0, depth, count + 1)[1:]
