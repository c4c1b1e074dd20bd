"""Depth axis of a diagram under sliders: it ends a little above the lobes."""

from collections.abc import Mapping
from typing import Any

#: highest depth shown over the highest limit, and the same where some speeds have none
_ABOVE_LIMITS, _ABOVE_GAPS = 1.15, 1.25
#: depth over that of the cut, and from how many times the height of the lobes the cut is left out
_ABOVE_CUT, _FAR_ABOVE = 1.1, 2.5
#: the axis stays while the depth wanted is within these shares of it: it would jump at every move
_STAYS = 0.6, 1.08


def end_of_depth_axis(diagram: Mapping[str, Any], before: float) -> float:
    """Depth at which the axis ends, mm: a little above the lowest limits of all speeds.

    Parameters
    ----------
    diagram : mapping
        As of `LiveCase.diagram`.
    before : float
        What was shown before, mm; 0 where nothing was.
    """
    deepest, cut = diagram["max_axial_depth_mm"], diagram["operating"]["axial_depth_mm"]
    highest = [found[0] for found in diagram["crossings_mm"] if found]
    if not highest:
        return deepest
    everywhere = len(highest) == len(diagram["crossings_mm"])
    wanted = (_ABOVE_LIMITS if everywhere else _ABOVE_GAPS) * max(highest)
    if cut <= _FAR_ABOVE * wanted:
        wanted = max(wanted, _ABOVE_CUT * cut)
    wanted = min(wanted, deepest)
    low, high = _STAYS
    return before if low * before <= wanted <= high * before and before <= deepest else wanted
