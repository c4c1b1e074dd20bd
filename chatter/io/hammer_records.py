"""Hammer records from files: a file of one or several, a folder of files."""

import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from chatter.description.arrays import Array
from chatter.io.formats.format_list import formats_of
from chatter.io.formats.units import Channel, channel_unit
from chatter.io.stated_columns import read_signal_table, read_signal_tables
from chatter.io.table import Column, Table, is_copy
from chatter.io.trace_headings import with_units
from dynamics.frf.container import QUANTITY_OF_MOTION, MeasurementError, Point
from dynamics.frf.hammer.record import FEWEST_SAMPLES, HammerRecord

#: Hz, below which a time without a unit is not taken for seconds
_SLOW_RATE = 200.0
#: names of a time without a unit, which is in s
_TIMES = ("time", "t")
_EXAMPLE = "time [s],force [N],acceleration [m/s^2]"
#: time between samples below which the unit of the time is wrong, s
_SHORTEST_STEP = 1e-12
#: share of a sampling interval by which a time stamp may lie off the even grid, beyond rounding
_TIME_JITTER = 0.1


@dataclass(frozen=True)
class StatedRecord:
    """What is stated of a record whose file does not say it."""

    columns: str | None = None  # names and units of all columns, in their order
    sampling_rate: float | None = None  # Hz, of a file without a time


@dataclass(frozen=True)
class HammerFolder:
    """What a folder of hammer records holds."""

    records: tuple[HammerRecord, ...]  # in natural order of their names (tap2 before tap10)
    #: name and reason for each file that could not be read as a record
    unreadable: tuple[tuple[str, str], ...] = ()
    passed_over: tuple[str, ...] = ()  # names of the files of other extensions


def read_hammer_record(
    path: str | Path,
    response: str | None = None,
    columns: str | None = None,
    sampling_rate: float | None = None,
) -> HammerRecord:
    """Read one hammer record from a file of any format of signals.

    The columns, such as ``time [s],force [N],acceleration [m/s^2]``, are told by their units: a
    time (or a column ``time`` or ``t`` without a unit, which is in s), a force, and a displacement,
    velocity or acceleration, by its name where there are several; `columns` states them where the
    file has no heading, `sampling_rate`, Hz, stands for the time where it has none.
    MeasurementError if the file is no such table, its samples are not evenly spaced, or the
    response column cannot be told.
    """
    return _record_of(read_signal_table(Path(path), columns), response, sampling_rate)


def read_hammer_records(
    path: str | Path, columns: str | None = None, sampling_rate: float | None = None
) -> HammerFolder:
    """Read every hammer record of a file, which may hold several.

    Each as `read_hammer_record` reads it. MeasurementError if the file holds no record.
    """
    records: list[HammerRecord] = []
    unreadable: list[tuple[str, str]] = []
    for table in read_signal_tables(Path(path), columns):
        try:
            records.append(_record_of(table, None, sampling_rate))
        except MeasurementError as error:
            reason = str(error).removeprefix(f"{table.path}: ")
            unreadable.append((table.path.name, reason))
    if not records:
        raise MeasurementError(f"{path}: {unreadable[0][1]}")
    return HammerFolder(tuple(records), tuple(unreadable))


def _record_of(table: Table, response: str | None, sampling_rate: float | None) -> HammerRecord:
    """Hammer record of a table."""
    path = table.path
    table = replace(table, columns=with_units(table.columns))
    if not any(column.unit or column.content for column in table.columns):
        raise MeasurementError(
            f"{path}: no heading with names and units above the numbers; "
            f'the first line must be like: {_EXAMPLE}; or state them: --columns "{_EXAMPLE}"'
        )
    channels = [_channel(path, column) for column in table.columns]
    has_time = any(channel == "time" for channel, _ in channels)
    if sampling_rate is None and not has_time:
        held = ", ".join(column.heading for column in table.columns)
        raise MeasurementError(
            f"{path}: no column is a time; there are {held}; "
            'state --sampling-rate, such as "25.6 kHz"'
        )
    force = _only(path, table, channels, ("force",), None)
    motion = _only(path, table, channels, tuple(QUANTITY_OF_MOTION), response)
    force_values = table.numbers(force) * channels[force][1]
    response_values = table.numbers(motion) * channels[motion][1]
    if sampling_rate is None:
        time = _only(path, table, channels, ("time",), None)
        start, rate = _even_sampling(path, table, time, channels[time][1])
        _require_plausible(path, table.columns[time], rate)
    else:
        start, rate = 0.0, _given_rate(path, table, sampling_rate)
    return HammerRecord(
        name=path.name,
        sampling_rate=rate,
        force=force_values,
        response=response_values,
        quantity=QUANTITY_OF_MOTION[channels[motion][0]],
        start_time=start,
        response_point=_point(table.columns[motion]),
        reference_point=_point(table.columns[force]),
        source=str(path),
    )


def is_hammer_record(path: Path, columns: str | None = None) -> bool:
    """Tell whether a file is a time record: it has a time, or a force and a motion, by units."""
    try:
        tables = read_signal_tables(path, columns)
        columns = [one for table in tables for one in with_units(table.columns)]
        held = {_channel(path, column)[0] for column in columns}
    except MeasurementError:
        return False
    return "time" in held or ("force" in held and bool(held & set(QUANTITY_OF_MOTION)))


def _require_plausible(path: Path, time: Column, rate: float) -> None:
    """Ask for the unit of a time that names none and would be that of a very slow record."""
    if not time.unit and not time.content and rate < _SLOW_RATE:
        raise MeasurementError(
            f"{path}: {time.name} has no unit, and in s it would be sampled at {rate:.4g} Hz; "
            'write its unit, such as "time [ms]", or state --sampling-rate'
        )


def _given_rate(path: Path, table: Table, rate: float) -> float:
    if table.size < FEWEST_SAMPLES:
        raise MeasurementError(
            f"{path}: {table.size} samples; a hammer record needs {FEWEST_SAMPLES}"
        )
    return rate


def read_hammer_folder(
    path: str | Path, columns: str | None = None, sampling_rate: float | None = None
) -> HammerFolder:
    """Read every hammer record of a folder.

    Files as `read_hammer_record` reads them. Files of other extensions, hidden files and folders
    are passed over; a file that is no record is named with the reason. MeasurementError if the path
    is not a folder or holds no record.
    """
    path = Path(path)
    if not path.is_dir():
        problem = "is a file, not a folder" if path.exists() else "no such folder"
        raise MeasurementError(f"{path}: {problem}")
    extensions = [extension for one in formats_of("signals") for extension in one.extensions]
    records: list[HammerRecord] = []
    unreadable: list[tuple[str, str]] = []
    passed_over: list[str] = []
    for file in sorted(path.iterdir(), key=_natural_order):
        if file.name.startswith(".") or file.is_dir():
            continue
        if file.suffix.lower() not in extensions:
            passed_over.append(file.name)
            continue
        try:
            found = read_hammer_records(file, columns, sampling_rate)
            records += found.records
            unreadable += found.unreadable
        except MeasurementError as error:
            unreadable.append((file.name, str(error).removeprefix(f"{file}: ")))
    if not records:
        listed = "; ".join(f"{name}: {reason}" for name, reason in unreadable[:3])
        listed = listed or f"no file ends in {', '.join(extensions)}"
        raise MeasurementError(f"{path}: holds no hammer record ({listed})")
    return HammerFolder(tuple(records), tuple(unreadable), tuple(passed_over))


def _natural_order(file: Path) -> list[tuple[int, str]]:
    pieces = re.split(r"(\d+)", file.name.lower())
    return [(int(piece), "") if piece.isdigit() else (-1, piece) for piece in pieces]


def _channel(path: Path, column: Column) -> tuple[Channel | None, float]:
    if column.content is not None:
        return column.content, 1.0
    if not column.unit:
        return ("time" if column.name.lower().rpartition(".")[2] in _TIMES else None), 1.0
    try:
        return channel_unit(column.unit)
    except MeasurementError as error:
        raise MeasurementError(f"{path}: column {column.name!r}: {error}") from None


def _only(
    path: Path,
    table: Table,
    channels: list[tuple[Channel | None, float]],
    kinds: tuple[Channel, ...],
    name: str | None,
) -> int:
    """Index of the one column of these kinds (and of that name, where given)."""
    found = [index for index, (channel, _) in enumerate(channels) if channel in kinds]
    names = ", ".join(repr(table.columns[index].name) for index in found)
    if name is not None:
        found = [index for index in found if table.columns[index].name == name]
        if not found:
            raise MeasurementError(f"{path}: no response column {name!r}; there are {names}")
    wanted = "displacement, velocity or acceleration" if len(kinds) > 1 else kinds[0]
    if not found:
        raise MeasurementError(
            f"{path}: no column is a {wanted}; the heading must be like: {_EXAMPLE}; or state "
            f'the columns, here {len(table.columns)}: --columns "{_EXAMPLE}"'
        )
    if len(found) > 1 and not _hold_the_same(table, found, channels):
        raise MeasurementError(
            f"{path}: several columns are a {wanted}: {names}; leave the unit of all but one "
            f'away: --columns "{_with_one(table, found)}"'
        )
    return found[0]


def _hold_the_same(
    table: Table, found: list[int], channels: list[tuple[Channel | None, float]]
) -> bool:
    """Whether columns are copies of one, in one unit or in several."""
    if len({channels[index][0] for index in found}) > 1:
        return False
    first, *others = (table.numbers(index) * channels[index][1] for index in found)
    return all(is_copy(first, one) for one in others)


def _with_one(table: Table, found: list[int]) -> str:
    """Headings of all columns, those but the first of some without their unit."""
    stated = []
    for number, column in enumerate(table.columns, start=1):
        left_out = number - 1 in found[1:]
        name = column.name.replace(",", " ") or f"column {number}"
        if left_out:
            stated.append(f"{name} {number}")
        else:
            stated.append(f"{name} [{column.unit}]" if column.unit else name)
    return ", ".join(stated)


def _point(column: Column) -> Point:
    if column.content is not None:
        return column.point
    axes = [word for word in re.findall(r"[A-Za-z]+", column.name.lower()) if word in "xyz"]
    return Point(direction=axes[0]) if len(axes) == 1 else Point()


def _even_sampling(path: Path, table: Table, index: int, factor: float) -> tuple[float, float]:
    """Start time and sampling rate of a time column that may have been rounded.

    Printed times are rounded, some so coarsely that neighbours repeat; the rate comes from the
    span. A round rate within what the rounding leaves open is taken as meant.
    """
    time = table.numbers(index)
    if time.size < FEWEST_SAMPLES:
        raise MeasurementError(
            f"{path}: {time.size} samples; a hammer record needs {FEWEST_SAMPLES}"
        )
    span = time[-1] - time[0]
    if span <= 0.0 or np.any(np.diff(time) < 0.0):
        row = int(np.argmax(np.diff(time) < 0.0)) if span > 0.0 else 0
        raise MeasurementError(
            f"{path}: {table.where(row + 1)}: time {time[row + 1]:g} after "
            f"{time[row]:g}; times must rise"
        )
    steps = np.diff(time)
    rounding = _rounding(time)
    interval = span / (time.size - 1)
    if interval > 1.5 * np.median(steps) + rounding:  # a gap stretches the mean step
        interval = float(np.median(steps))
    allowed = 1.01 * rounding + _TIME_JITTER * interval
    wrong = np.abs(steps - interval) > allowed
    drift = np.abs(time - (time[0] + interval * np.arange(time.size)))
    if np.any(wrong) or np.any(drift > allowed):
        row = int(np.argmax(np.abs(steps - interval)))
        raise MeasurementError(
            f"{path}: {table.where(row + 1)}: time steps by {steps[row]:.6g} where the "
            f"others step by {interval:.6g}; samples must be evenly spaced without gaps"
        )
    if interval * factor < _SHORTEST_STEP:
        raise MeasurementError(
            f"{path}: times step by {interval * factor:.3g} s, and no recorder samples so fast: is "
            "the unit of the time right?"
        )
    return float(time[0]) * factor, _rate(time, rounding) / factor


def _rate(time: Array, rounding: float) -> float:
    """Samples per unit of time by least squares; a round number where the rounding allows it."""
    count = time.size
    index = np.arange(count) - 0.5 * (count - 1)
    rate = float(np.sum(index**2) / np.sum(index * (time - time.mean())))
    # standard error of the slope where each time is off by up to half its last digit
    uncertainty = 5.0 * rate**2 * rounding / count**1.5
    for digits in range(-3, 4):
        rounded = round(rate, digits)
        if rounded > 0.0 and abs(rounded - rate) <= uncertainty:
            return rounded
    return rate


def _rounding(time: Array) -> float:
    """Unit of the last digit the times were printed with."""
    scale = float(np.max(np.abs(time)))
    for digits in range(-3, 13):
        if np.allclose(np.round(time, digits), time, rtol=0.0, atol=1e-9 * scale * 10.0**-6):
            return 10.0**-digits
    return 1e-12 * scale
