"""Records of stable cuts beside a table of tests, and the multipliers that they show."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from chatter.compile.cutter import cutter_of
from chatter.description.arrays import Array
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.explain.measurement import Run
from chatter.io.signals import read_signals
from chatter.learning.stable_cuts import Multiplier, multiplier_of
from cutting.edge_segments.segments import period_angle

#: column of the number of a record; columns of what is identified, and the scatter of the first
RECORD, MAGNITUDE, ANGLE, DEVIATION = (
    "record", "multiplier", "multiplier_angle", "multiplier_deviation",
)  # fmt: skip
_TIME = "time"


def with_multipliers(run: Run, folder: Path, case: Case) -> Run:
    """Tests with the multipliers that the records of stable ones show.

    InputError if a record is missing, holds no vibration over time, or is too short.
    """
    if RECORD not in run.signals:
        return run
    numbers = run.signals[RECORD]
    stable = run.signals.get("stable", np.ones(numbers.size))
    found = {name: np.full(numbers.size, np.nan) for name in (MAGNITUDE, ANGLE, DEVIATION)}
    # of a cut that chatters the motion is no longer small
    for row in np.flatnonzero(np.isfinite(numbers) & (stable > 0.5)):
        path = folder / f"record-{numbers[row]:.0f}.csv"
        one = _identified(path, case, float(run.signals["spindle_speed"][row]))
        found[MAGNITUDE][row], found[ANGLE][row] = one.magnitude, one.angle
        found[DEVIATION][row] = one.deviation
    return replace(run, signals={**run.signals, **found})


def _identified(path: Path, case: Case, speed: float) -> Multiplier:
    angle = period_angle(cutter_of(case))
    time, vibration = _vibration(path)
    sampling = (time.size - 1) / float(time[-1] - time[0])
    teeth = max(1, round(2.0 * math.pi / angle))
    one = multiplier_of(vibration, sampling, angle / speed, teeth)
    if one is None:
        raise InputError(
            f"{path}: {time[-1] - time[0]:.3g} s are too short; a record of a stable cut holds 60 "
            "periods of the cut at the least"
        )
    return one


def _vibration(path: Path) -> tuple[Array, Array]:
    """Time (n,), s, and the first other column (n,) of a record."""
    signals = read_signals(path)
    names = [name for name in signals if name != _TIME]
    if _TIME not in signals or not names or signals[_TIME].size < 2:
        raise InputError(f"{path}: a record has time [s] and a vibration, such as ay [m/s^2]")
    return signals[_TIME], signals[names[0]]
