"""What of a record is in the cut, and the offsets that the air before and after it shows."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from chatter.cutting_coefficients.mean_forces import FEWEST_REVOLUTIONS, force_channels
from chatter.description.arrays import Array
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.explain.measurement import Measurement, Run
from chatter.explain.records.description import AIR
from chatter.explain.records.stages import stages_of

#: revolutions of air that show an offset, at the least, and those beside the cut that do not count
_LEAST_AIR, _MARGIN = 2, 2
#: samples of a revolution by which a force can be followed around it
_LEAST_SAMPLES = 4


class RunInCut(NamedTuple):
    """Run in its settled cut, and whether its offsets were taken off."""

    run: Run
    is_zeroed: bool


def in_the_cut(measurement: Measurement, run: Run) -> RunInCut:
    """Return the settled cut of a run that begins or ends in the air; else the run as it is.

    The offset is the mean force in the air; where there is air on both sides it drifts on a line.
    InputError where a force is blank somewhere, or none varies, or the time does not rise.
    """
    names = list(force_channels(measurement, run))
    time = run.signals.get("time")
    if time is None or not names or time.size < 2:
        return RunInCut(run, is_zeroed=False)
    where = measurement.folder / run.name
    _require_clock(str(where), time)
    case = run.of(measurement.case)
    _require_revolutions(str(where), time, case)
    forces = np.array([run.signals[name] for name in names])
    _require_forces(str(where), names, forces)
    turn = 2.0 * math.pi / case.cut.spindle_speed / run.step
    if time.size < FEWEST_REVOLUTIONS * turn:  # too short for a mean, where that is told
        return RunInCut(run, is_zeroed=False)
    stages = stages_of(case, time, forces, AIR)
    if stages.entry == 0 and stages.leave == time.size:
        return RunInCut(run, is_zeroed=False)
    air = [
        part
        for part in (slice(0, stages.entry - round(_MARGIN * turn)),
                     slice(stages.leave + round(_MARGIN * turn), time.size))
        if part.stop - part.start >= _LEAST_AIR * turn
    ]  # fmt: skip
    signals = {name: values[stages.settled] for name, values in run.signals.items()}
    for name in names:
        signals[name] = signals[name] - _offset(run.signals[name], air, turn, time, signals["time"])
    return RunInCut(replace(run, signals=signals), is_zeroed=bool(air))


def _require_clock(where: str, time: Array) -> None:
    """Raise InputError where a time is no number or does not rise."""
    wrong = np.flatnonzero(~(np.diff(time) > 0.0))
    if wrong.size:
        first = int(wrong[0])
        raise InputError(
            f"{where}: time: {time[first]:.6g} s in row {first + 1} is followed by "
            f"{time[first + 1]:.6g} s; times must rise"
        )


def _require_revolutions(where: str, time: Array, case: Case) -> None:
    """Raise InputError where the samples of a record are further apart than a cut is told by."""
    step = float(time[-1] - time[0]) / (time.size - 1)
    turn = 2.0 * math.pi / case.cut.spindle_speed
    if _LEAST_SAMPLES * step > turn:
        raise InputError(
            f"{where}: time: the samples are {step:.3g} s apart, and a revolution takes "
            f"{turn:.3g} s; is the time in another unit?"
        )


def _require_forces(where: str, names: list[str], forces: Array) -> None:
    """Raise InputError where a force is blank somewhere, or none varies."""
    for name, values in zip(names, forces, strict=True):
        blank = int(np.sum(~np.isfinite(values)))
        if blank:
            raise InputError(f"{where}: {name}: {blank} samples are blank or no numbers")
    if not np.any(np.ptp(forces, axis=1) > 0.0):
        raise InputError(f"{where}: no force varies over the record: {', '.join(names)}")


def _offset(values: Array, air: list[slice], turn: float, time: Array, wanted: Array) -> Array:
    """Offset at the times wanted, by whole revolutions of air."""
    if not air:
        return np.zeros(wanted.size)
    at, level = [], []
    for part in air:
        size = round(math.floor((part.stop - part.start) / turn) * turn)
        chosen = slice(part.start, part.start + size)
        at.append(float(time[chosen].mean()))
        level.append(float(values[chosen].mean()))
    return np.interp(wanted, at, level)
