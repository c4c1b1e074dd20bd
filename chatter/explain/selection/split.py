"""Runs to fit, and runs held out to judge by."""

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

from chatter.explain.measurement import Run


class Split(NamedTuple):
    """Runs to fit, and runs held out to judge by."""

    fitted: tuple[Run, ...]
    holdout: tuple[Run, ...]


def split_runs(runs: Sequence[Run]) -> Split:
    """Hold out every third run, so that both parts cover the conditions."""
    places = _places(runs)
    holdout = tuple(run for run, place in zip(runs, places, strict=True) if place % 3 == 2)
    fitted = tuple(run for run, place in zip(runs, places, strict=True) if place % 3 != 2)
    return Split(fitted, holdout) if holdout else Split(tuple(runs), tuple(runs))


def _places(runs: Sequence[Run]) -> list[int]:
    """Number of every run among those of its kind."""
    counts: Counter[str] = Counter()
    found = []
    for run in runs:
        found.append(counts[run.kind])
        counts[run.kind] += 1
    return found
