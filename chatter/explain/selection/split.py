"""Runs to fit, and runs held out to judge by."""

from collections.abc import Sequence
from typing import NamedTuple

from chatter.explain.measurement import Run


class Split(NamedTuple):
    """Runs to fit, and runs held out to judge by."""

    fitted: tuple[Run, ...]
    holdout: tuple[Run, ...]


def split_runs(runs: Sequence[Run]) -> Split:
    """Hold out every third run, so that both parts cover the conditions."""
    holdout = tuple(run for index, run in enumerate(runs) if index % 3 == 2)
    fitted = tuple(run for index, run in enumerate(runs) if index % 3 != 2)
    return Split(fitted, holdout) if holdout else Split(tuple(runs), tuple(runs))
