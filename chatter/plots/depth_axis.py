"""Depth at which the axis of a stability diagram ends, in a picture and on a page."""

from collections.abc import Sequence

#: depth shown over the highest limit, the same where some speeds have none, and over the cut
_ABOVE_LIMITS, _ABOVE_GAPS, ABOVE_CUT = 1.15, 1.25, 1.1
#: a cut so many times as deep as the limits that are shown is marked at the upper edge
_FAR_ABOVE = 2.5


def end_of_depth_axis(limits: Sequence[Sequence[float]], searched: float, cut: float) -> float:
    """Depth at which the axis ends: a little above the limits and the cut, as far as was searched.

    Where speeds have no limit, the search is shown that far above the others. A cut far above the
    limits is left out.

    Parameters
    ----------
    limits : sequence of sequences
        All changes of stability at every speed.
    searched, cut : float
        Deepest depth searched, and that of the cut; all in one unit.
    """
    found = [depth for crossings in limits for depth in crossings]
    wanted = ABOVE_CUT * cut
    if not found:
        return max(searched, wanted)
    everywhere = all(len(crossings) for crossings in limits)
    shown = min((_ABOVE_LIMITS if everywhere else _ABOVE_GAPS) * max(found), searched)
    # lobes that a deep cut presses to the ground cannot be read
    return shown if wanted > _FAR_ABOVE * shown else max(shown, wanted)
