"""Tests that contradict each other, or the case that was learnt from all of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from chatter.description.unit_system import units_of
from chatter.description.units import rpm
from chatter.description.usual_units import UsualUnit
from chatter.explain.measurement import Measurement, Run
from chatter.learning.cuts import TEST
from chatter.learning.records_of_cuts import MAGNITUDE

Array = NDArray[np.float64]

#: relative difference of speed, depth, feed and width up to which two tests are of one cut
_SAME_CUT = 0.01
#: what a test may state beside speed and depth, which two of one cut have in common
_OTHER_CONDITIONS = ("feed_per_tooth", "radial_depth", "cut_time")
#: relative depth from which a stable cut is clearly deeper than one that chatters
_CLEARLY_DEEPER = 0.1
#: probability of its verdict below which a test is no scatter of the limits
_UNBELIEVABLE = 0.05
#: verdicts from which it is worth saying that all are alike
_LEAST_ALIKE = 4
#: notes of a kind at the most; the first say what to look for
_MOST_NOTES = 3


def contradictions(measurement: Measurement) -> list[str]:
    """Say which verdicts cannot all be right: one cut judged both ways, or stable below chatter.

    Tests are named by their rows, from 1. A deeper cut may be stable where a shallower one
    chatters only between lobes that overlap, which is rare: it is told as a question.
    """
    judged = _judged(measurement)
    if judged is None:
        return []
    length = units_of(measurement.case).length
    return [*_of_one_cut(judged, length), *_deeper(judged, length)]


def one_sided(measurement: Measurement) -> list[str]:
    """Say that tests judged all alike bound the limits from one side only.

    Not where the vibration of stable cuts was recorded, which says how far they are from chatter.
    """
    judged = _judged(measurement)
    if judged is None or any(run.record == MAGNITUDE for run in measurement.runs):
        return []
    stable = judged.signals["stable"] > 0.5
    if stable.size < _LEAST_ALIKE or np.ptp(stable.astype(float)) > 0.0:
        return []
    word, side, other = (
        ("are stable", "lower", "higher") if stable[0] else ("chatter", "higher", "lower")
    )
    return [
        f"all {stable.size} tests {word}: they say that limits are not {side}, not how much "
        f"{other} they are, which is known by what is declared alone; a test that "
        f"{'chatters' if stable[0] else 'is stable'} would tell"
    ]


def surprises(measurement: Measurement, probability: Array) -> list[str]:
    """Say which verdicts the learnt case does not believe, by the probability (n,) of stability."""
    judged = _judged(measurement)
    if judged is None:
        return []
    stable, length = judged.signals["stable"] > 0.5, units_of(measurement.case).length
    believed = np.where(stable, probability, 1.0 - probability)
    worst = [int(k) for k in np.argsort(believed) if believed[k] < _UNBELIEVABLE]
    notes = [
        f"test {_number(judged, k)}, {_verdict(judged, k)} at {_cut(judged, k, length)}: the "
        f"learnt case gives that {believed[k]:.1%}; check its verdict and its units, or what the "
        "case lacks"
        for k in worst[:_MOST_NOTES]
    ]
    if len(worst) > _MOST_NOTES:
        notes.append(f"{len(worst) - _MOST_NOTES} more verdicts are as unlikely")
    return notes


def _judged(measurement: Measurement) -> Run | None:
    """Tests that have a verdict; None where none has."""
    return next((run for run in measurement.runs if run.record == "stable"), None)


def _of_one_cut(run: Run, length: UsualUnit) -> list[str]:
    stable = run.signals["stable"] > 0.5
    notes, told = [], np.zeros(stable.size, dtype=bool)
    for k in range(stable.size):
        same = _same(run, k, ("spindle_speed", "axial_depth", *_OTHER_CONDITIONS)) & ~told
        if same[k] and stable[same].any() and not stable[same].all():
            told |= same
            notes.append(
                f"tests {_numbers(run, same & stable)} (stable) and "
                f"{_numbers(run, same & ~stable)} (chatter) are one cut, {_cut(run, k, length)}: "
                "one verdict is wrong, or the cut is at its limit"
            )
    return _first(notes, "cuts are judged both ways")


def _deeper(run: Run, length: UsualUnit) -> list[str]:
    stable, depth = run.signals["stable"] > 0.5, run.signals["axial_depth"]
    notes = []
    for k in np.flatnonzero(stable):
        same = _same(run, int(k), ("spindle_speed", *_OTHER_CONDITIONS)) & ~stable
        shallower = np.flatnonzero(same & (depth * (1.0 + _CLEARLY_DEEPER) < depth[k]))
        if shallower.size:
            least = int(shallower[np.argmin(depth[shallower])])
            notes.append(
                f"test {_number(run, int(k))} is stable at {_cut(run, int(k), length)}, deeper "
                f"than test {_number(run, least)}, which chatters at {length.text(depth[least])}: "
                "is one verdict wrong?"
            )
    return _first(notes, "stable tests are deeper than one that chatters")


def _first(notes: list[str], rest: str) -> list[str]:
    if len(notes) <= _MOST_NOTES:
        return notes
    return [*notes[:_MOST_NOTES], f"{len(notes) - _MOST_NOTES} more {rest}"]


def _same(run: Run, index: int, names: Sequence[str]) -> NDArray[np.bool_]:
    """Tests (n,) that have the values of one of them, as far as they are stated."""
    found = np.ones(run.signals["stable"].size, dtype=bool)
    for name in names:
        if name in run.signals:
            values = run.signals[name]
            close = np.abs(values - values[index]) <= _SAME_CUT * np.abs(values[index])
            found &= close | (np.isnan(values) & np.isnan(values[index]))
    return found


def _number(run: Run, index: int) -> int:
    return int(run.signals[TEST][index]) + 1


def _numbers(run: Run, chosen: NDArray[np.bool_]) -> str:
    numbers = [str(_number(run, int(k))) for k in np.flatnonzero(chosen)]
    more = f" and {len(numbers) - 4} more" if len(numbers) > 4 else ""
    return ", ".join(numbers[:4]) + more


def _verdict(run: Run, index: int) -> str:
    return "stable" if run.signals["stable"][index] > 0.5 else "chatter"


def _cut(run: Run, index: int, length: UsualUnit) -> str:
    depth, speed = run.signals["axial_depth"][index], run.signals["spindle_speed"][index]
    return f"{length.text(depth)} and {rpm(float(speed)):.0f} rpm"
