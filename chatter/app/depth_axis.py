"""Depth axis of a diagram under sliders: it ends a little above the lobes."""

from collections.abc import Mapping
from typing import Any

from chatter.plots.depth_axis import end_of_depth_axis

#: the axis stays while the depth wanted is within these shares of it: it would jump at every move
_STAYS = 0.6, 1.08


def steady_end_of_depth_axis(diagram: Mapping[str, Any], before: float) -> float:
    """Depth at which the axis ends, mm: a little above the limits of all speeds.

    Parameters
    ----------
    diagram : mapping
        As of `LiveCase.diagram`.
    before : float
        What was shown before, mm; 0 where nothing was.
    """
    deepest, cut = diagram["max_axial_depth_mm"], diagram["operating"]["axial_depth_mm"]
    # the page is as deep as its slider says, at the most
    wanted = min(end_of_depth_axis(diagram["crossings_mm"], deepest, cut), deepest)
    low, high = _STAYS
    return before if low * before <= wanted <= high * before and before <= deepest else wanted
