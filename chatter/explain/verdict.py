"""Verdict on what a search found."""

from chatter.explain.selection.search import Search

EXPLAINED, NOTHING_MISSING, UNEXPLAINED = "explained", "nothing-missing", "unexplained"
EXPLAINED_IN_PART = "explained-in-part"
#: that leave nothing to be explained
COMPLETE = (EXPLAINED, NOTHING_MISSING)


def verdict_of(found: Search) -> str:
    """Verdict on what was found.

    A residual at the noise explains nothing where declared values left their tolerances for it.
    """
    if not found.is_at_noise or found.out_of_tolerance:
        return EXPLAINED_IN_PART if found.accepted and found.is_certain else UNEXPLAINED
    return EXPLAINED if found.accepted else NOTHING_MISSING
