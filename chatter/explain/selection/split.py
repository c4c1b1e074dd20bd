"""Runs to fit, and runs held out to judge by."""

from collections import Counter
from collections.abc import Sequence
from typing import Any, NamedTuple

from chatter.explain.measurement import Measurement, Run
from chatter.explain.records.steady_record import SteadyRecord

#: part of a condition by which runs may differ that were meant to be made alike
_SAME = 0.01


class Split(NamedTuple):
    """Runs to fit, and runs held out to judge by."""

    fitted: tuple[Run, ...]
    holdout: tuple[Run, ...]


def split_runs(measurement: Measurement) -> Split:
    """Hold out every third run, so that both parts cover the conditions.

    Of a series in which one condition alone varies, runs between others are held out: what was
    fitted to some feeds is asked for another one between them, not beyond. Of others, the run
    nearest to its stability limit is fitted: the rest cannot tell whether it chatters.
    """
    runs = measurement.runs
    places = _places_in_series(measurement) or _with_nearest_to_limit_fitted(runs)
    holdout = tuple(run for run, place in zip(runs, places, strict=True) if place % 3 == 2)
    fitted = tuple(run for run, place in zip(runs, places, strict=True) if place % 3 != 2)
    return Split(fitted, holdout) if holdout else Split(tuple(runs), tuple(runs))


def _with_nearest_to_limit_fitted(runs: Sequence[Run]) -> list[int]:
    """Places in which the run that settles slowest has changed with the one before it, if held."""
    places = _places(runs)
    settling = [
        one.record.revolutions if isinstance(one.record, SteadyRecord) else 0 for one in runs
    ]
    slowest = settling.index(max(settling))
    fitted = [n for n, place in zip(settling, places, strict=True) if place % 3 != 2]
    if places[slowest] % 3 == 2 and settling[slowest] > max(fitted):
        alike = [index for index, run in enumerate(runs) if run.kind == runs[slowest].kind]
        before = next(index for index in alike if places[index] == places[slowest] - 1)
        places[slowest], places[before] = places[before], places[slowest]
    return places


def _places_in_series(measurement: Measurement) -> list[int]:
    """Number of every run, from 1, by the one condition that varies; 0 for the last.

    None where no condition varies, or more than one, or some runs are alike.
    """
    runs = measurement.runs
    if len({run.kind for run in runs}) != 1:
        return []
    paths = set().union(*(run.overrides for run in runs))
    cases = [run.of(measurement.case) for run in runs]
    varied = [found for path in paths if _varies(found := [case.get(path) for case in cases])]
    if len(varied) != 1 or not all(isinstance(value, int | float) for value in varied[0]):
        return []
    ordered = sorted(set(varied[0]))
    if len(ordered) < len(runs):
        return []
    return [0 if value == ordered[-1] else 1 + ordered.index(value) for value in varied[0]]


def _varies(values: Sequence[Any]) -> bool:
    """Whether values are set apart: speeds by what repeats in a record differ a little."""
    if all(isinstance(value, int | float) for value in values):
        return max(values) - min(values) > _SAME * max(abs(value) for value in values)
    return any(value != values[0] for value in values)


def _places(runs: Sequence[Run]) -> list[int]:
    """Number of every run among those of its kind."""
    counts: Counter[str] = Counter()
    found = []
    for run in runs:
        found.append(counts[run.kind])
        counts[run.kind] += 1
    return found
