"""Cuts that differ by the feed alone: what is measured at one feed from those beside it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from chatter.description.case import Case


def differ_by_feed_alone(cases: Sequence[Case]) -> bool:
    """Whether the cuts of cases have the same speed, depth and arc."""
    first = cases[0].cut
    return all(
        one.cut.model_copy(
            update={"feed_per_tooth": first.feed_per_tooth, "feed_rate": first.feed_rate}
        )
        == first
        for one in cases
    )


def position_among(feed: float, feeds: Sequence[float]) -> str:
    """Where a feed lies among feeds, its own with them: at, between or beyond the others."""
    least, most = min(feeds), max(feeds)
    if least == most:
        return "at"
    return "between" if least < feed < most else "beyond"


def at_feed(feed: float, feeds: Sequence[float], values: ArrayLike) -> np.ndarray:
    """Values (n, ...) of n cuts at another feed: lines between the feeds, the last ones beyond.

    Cuts of one feed count by their mean; of a single feed that mean is the answer.
    """
    given = np.asarray(values)
    known = np.unique(feeds)
    means = np.stack([given[np.asarray(feeds) == one].mean(axis=0) for one in known])
    if known.size == 1:
        return means[0]
    low = int(np.clip(np.searchsorted(known, feed) - 1, 0, known.size - 2))
    share = (feed - known[low]) / (known[low + 1] - known[low])
    return (1.0 - share) * means[low] + share * means[low + 1]
