"""Channels of a recording in a file of any format: which are of use, and what they are of."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from chatter.description.arrays import Array
from chatter.description.errors import InputError
from chatter.description.units import dimension_of, measured_unit
from chatter.detection.spectral.recording import Recording
from chatter.io.stated_columns import read_signal_table
from chatter.io.table import Column, Table
from chatter.io.trace_headings import unit_of_trace, with_units
from dynamics.frf.container import MeasurementError

#: quantity -> SI unit by whose dimension a column is recognised
_UNITS = {
    "acceleration": "m/s**2",
    "velocity": "m/s",
    "displacement": "m",
    "force": "N",
    "torque": "N*m",
    "sound": "Pa",
    "power": "W",
    "current": "A",
}
#: names of channels -> quantity, where the unit does not tell it
_NAMES = {
    "sound": r"(sound|mic|audio|spl|left|right)",
    "acceleration": r"(a[xyz]?\d*$|acc|vib)",
    "force": r"(f[xyzn]?\d*$|force)",
    "displacement": r"([xyz]$|disp)",
    "velocity": r"(v[xyz]$|vel)",
    "torque": r"(m[xyz]$|torque)",
    "current": r"(i\d*$|cur)",
    "power": r"(p\d*$|pow)",
}
_TIME = re.compile(
    r"\s*(.*\.)?(t|time|zeit|elapsed.*|x[_ ]?value|(time|zeit)\s+\d.*)\s*", re.IGNORECASE
)
#: names of a tacho of one pulse a revolution, and of any
_ONCE = re.compile(r"\s*(once[ _-]?per[ _-]?rev.*|keyphasor|index pulse)\s*", re.IGNORECASE)
_TACHO = re.compile(rf"\s*(tacho.*|trigger)\s*|{_ONCE.pattern}", re.IGNORECASE)
#: names of a measured speed of the spindle, whose unit is one of turning
_SPEED = re.compile(r"tacho|spindle|spindel|speed|drehzahl|rpm|n\b", re.IGNORECASE)
#: channels that follow the tool: motor currents and power are read only where there are none
_SLOW = ("current", "power")
_FEWEST_SAMPLES = 2
#: relative scatter of the steps of time that counts as uniform
_UNIFORM = 0.01
#: last digit of a rounded time in its largest step, at the most
_MOST_ROUNDED = 2.5
#: samples of an even clock for each that was recorded: where there are more the recording has gaps
_MOST_FILLED = 4.0


class _Channel(NamedTuple):
    name: str
    quantity: str
    values: Array


def read_recording(
    path: str | Path,
    channels: Sequence[str] = (),
    sampling_rate: float | None = None,
    columns: str | None = None,
) -> Recording:
    """Channels of a file.

    Parameters
    ----------
    path : path
        File of any format that holds signals.
    channels : sequence of str
        Names of those to use; by default all that vibrate: sound, acceleration, velocity,
        displacement, force, torque; current and power where there are none of these.
    sampling_rate : float, optional
        Hz, where the file has no time.
    columns : str, optional
        Names and units of all columns in their order, where the file has none.

    Raises
    ------
    InputError
        If the file cannot be read, has no time, or no channel of use.
    """
    path = Path(path)
    try:
        table = read_signal_table(path, columns)
        return _recording(path, table, channels, sampling_rate)
    except MeasurementError as error:
        raise InputError(str(error)) from error


def _recording(
    path: Path, table: Table, wanted: Sequence[str], sampling_rate: float | None
) -> Recording:
    table = replace(table, columns=_of_own_names(with_units(table.columns)))
    numbers = {one.name: table.numbers(k) for k, one in enumerate(table.columns)}
    time = _time(path, table, numbers, sampling_rate)
    pulses = next((one.name for one in table.columns if _is_tacho(one)), None)
    tacho = None if pulses is None else numbers[pulses]
    _require_signal(path, table, numbers)
    chosen = _chosen(path, _usable(table, numbers), wanted)
    values = np.stack([one.values for one in chosen], axis=1)
    steps = np.diff(time)
    step = float(np.median(steps)) if steps.size else math.nan
    if _is_rounded(time):
        step = float((time[-1] - time[0]) / (time.size - 1))
    elif steps.size and not np.all(steps > 0.0):
        raise InputError(
            f"{path}: the time does not increase at {table.where(int(np.argmin(steps)) + 1)}"
        )
    elif steps.size and steps.max() - steps.min() > _UNIFORM * step:
        _refuse_gaps(path, table, steps, step)
        even = time[0] + step * np.arange(int((time[-1] - time[0]) / step) + 1)
        values = np.stack([np.interp(even, time, one) for one in values.T], axis=1)
        tacho = None if tacho is None else np.interp(even, time, tacho)
    else:
        step = float((time[-1] - time[0]) / max(time.size - 1, 1))
    names, quantities = zip(*((one.name, one.quantity) for one in chosen), strict=True)
    speed = _speed(table, numbers)
    once = pulses is not None and bool(_ONCE.fullmatch(pulses))
    return Recording(str(path), step, names, quantities, values, float(time[0]), tacho, speed, once)


def _of_own_names(columns: Sequence[Column]) -> tuple[Column, ...]:
    """Columns of which those of a name that stands before have their number behind it."""
    found: list[Column] = []
    for number, column in enumerate(columns, start=1):
        if column.name in {one.name for one in found}:
            unit = f" [{column.unit}]" if column.unit else ""
            column = replace(column, heading=f"{column.name} {number}{unit}")
        found.append(column)
    return tuple(found)


def _is_tacho(column: Column) -> bool:
    """Whether a column has the pulses of a tacho, and not the speed by it."""
    return is_tacho_name(column.name) and not _is_of_turning(column)


def is_tacho_name(name: str) -> bool:
    """Whether a name is that of the pulses of a tacho, or of the speed by it."""
    return bool(_TACHO.fullmatch(name))


def _is_of_turning(column: Column) -> bool:
    """Whether the unit of a column is one of a speed of turning."""
    unit = unit_of_trace(column.unit)
    return unit is not None and unit.has_angle and unit.dimension == dimension_of("rad/s")


def _speed(table: Table, numbers: dict[str, Array]) -> float | None:
    """Median of a measured speed of the spindle while it turns, Hz; None where there is none."""
    for column in table.columns:
        if _SPEED.match(column.name) and _is_of_turning(column):
            values = np.abs(numbers[column.name]) * unit_of_trace(column.unit).factor
            turning = values[values > 0.5 * values.max()]
            return float(np.median(turning)) / math.tau if turning.size else None
    return None


def _is_rounded(time: Array) -> bool:
    """Whether a time rises evenly but for the rounding of what was written."""
    steps = np.diff(time)
    quantum = float(steps[steps > 0.0].min()) if np.any(steps > 0.0) else 0.0
    if time.size < _FEWEST_SAMPLES or not steps.min() >= 0.0:
        return False
    even = np.linspace(time[0], time[-1], time.size)
    return float(np.abs(time - even).max()) <= quantum and steps.max() < _MOST_ROUNDED * quantum


def _refuse_gaps(path: Path, table: Table, steps: Array, step: float) -> None:
    """Refuse a recording that is mostly gaps: an even clock would fill them with lines."""
    if steps.sum() > _MOST_FILLED * steps.size * step:
        row = int(np.argmax(steps))
        raise InputError(
            f"{path}: the time jumps by {steps[row]:.3g} s at {table.where(row + 1)}, where the "
            f"others are {step:.3g} s apart; a recording without such gaps is required"
        )


def _time(
    path: Path, table: Table, numbers: dict[str, Array], sampling_rate: float | None
) -> Array:
    """Time of the samples, s: of the sampling rate where it is given."""
    if sampling_rate is not None:
        return np.arange(table.size) / sampling_rate
    for column in table.columns:
        if _TIME.fullmatch(column.name) or column.content == "time":
            unit = measured_unit(column.unit) if column.unit and not column.content else None
            return numbers[column.name] * (1.0 if unit is None else unit.factor)
    raise InputError(
        f"{path}: no column is a time; there are {', '.join(numbers)}; state --sampling-rate"
    )


def _require_signal(path: Path, table: Table, numbers: dict[str, Array]) -> None:
    """Refuse a recording of one sample, or in which nothing ever changes."""
    if table.size < _FEWEST_SAMPLES:
        raise InputError(f"{path}: {table.size} sample is no recording")
    signals = [name for name in numbers if not _TIME.fullmatch(name) and not _TACHO.fullmatch(name)]
    if signals and not any(np.ptp(numbers[name]) > 0.0 for name in signals):
        raise InputError(
            f"{path}: {', '.join(signals)} never changes: nothing was recorded, or the sensor was "
            "not connected"
        )


def _usable(table: Table, numbers: dict[str, Array]) -> list[_Channel]:
    """Columns that are a signal, with what they are of."""
    found = []
    for column in table.columns:
        is_other = _TIME.fullmatch(column.name) or _TACHO.fullmatch(column.name)
        values = numbers[column.name]
        if is_other or column.content == "time" or not np.ptp(values) > 0.0:
            continue
        quantity = quantity_of(column)
        if quantity is not None:
            found.append(_Channel(column.name, quantity, values))
    return found


def quantity_of(column: Column) -> str | None:
    """What a column is of: by its unit, else by its name; None where it is no vibration."""
    if column.content is not None:
        return column.content if column.content in _UNITS else None
    unit = measured_unit(column.unit) if column.unit else None
    if unit is not None and unit.dimension:
        for quantity, si_unit in _UNITS.items():
            if unit.dimension == dimension_of(si_unit):
                return quantity
        if unit.dimension != dimension_of("V"):
            return None
    name = column.name.strip().lower()
    by_name = (quantity for quantity, form in _NAMES.items() if re.match(form, name))
    return next(by_name, None if unit is not None and unit.has_angle else "unknown")


def _chosen(path: Path, usable: list[_Channel], wanted: Sequence[str]) -> list[_Channel]:
    """Channels that are named, else all that vibrate."""
    named = {one.name: one for one in usable}
    for name in wanted:
        if name not in named:
            raise InputError(
                f'{path}: --channel "{name}" is no signal of the file; there are '
                f"{', '.join(named) or 'none'}"
            )
    if wanted:
        return [named[name] for name in wanted]
    known = [one for one in usable if one.quantity != "unknown"] or usable
    chosen = [one for one in known if one.quantity not in _SLOW] or known
    if not chosen:
        raise InputError(f"{path}: no column is a sound, vibration, force, current or power")
    return chosen
