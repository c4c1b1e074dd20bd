"""FRFs of the columns of a table: real and imaginary part, or magnitude and phase."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TypeVar

import numpy as np

from chatter.description.arrays import Array, ComplexArray
from chatter.io.formats.units import channel_unit, frf_unit
from chatter.io.table import Column, Table
from chatter.io.trace_headings import with_units
from dynamics.frf.container import Frf, MeasurementError, Point, Quantity

T = TypeVar("T")

#: words in a heading -> what the column holds
_PARTS = {
    "frequency": ("frequency", "freq", "f"),
    "real": ("real", "re"),
    "imaginary": ("imag", "imaginary", "im"),
    "magnitude": ("magnitude", "mag", "amplitude", "amp", "abs", "modulus"),
    "phase": ("phase", "angle", "arg"),
    "coherence": ("coherence", "coh"),
}
_PART_OF_WORD = {word: part for part, words in _PARTS.items() for word in words}
_DEGREES = {"deg", "°", "degree", "degrees"}
_RADIANS = {"rad", "radian", "radians"}
_EXAMPLE = "frequency [Hz],real [m/N],imag [m/N]"


@dataclass
class _Parts:
    """Columns that make one FRF, by what they hold, with index into the table."""

    label: str
    columns: dict[str, tuple[int, Column]] = field(default_factory=dict)


def frfs_of_tables(tables: Mapping[str, Table]) -> list[Frf]:
    """FRFs of the records of a file, one after the other; see below."""
    return [frf for table in tables.values() for frf in frfs_of_table(table)]


def frfs_of_table(table: Table) -> list[Frf]:
    """FRFs in SI units of a table whose headings name each column and its unit.

    Headings are such as ``frequency [Hz]``, ``real [m/N]``, ``imag [m/N]``. The first column is the
    frequency; each FRF is a pair real and imaginary or magnitude and phase (deg or rad), with an
    optional coherence. A label in the name (``"real xy [m/N]"``, response first, then reference)
    tells several FRFs apart and gives their directions. FRFs are in the order of the columns.

    MeasurementError if the columns are not such; the message names file, line or column, and the
    reason.
    """
    path, table = table.path, replace(table, columns=with_units(table.columns))
    if not any(column.unit for column in table.columns):
        raise MeasurementError(
            f"{path}: names no units; FRFs need columns like: {_EXAMPLE}; of time records state "
            'the columns: --columns "time [s], force [N], acceleration [m/s^2]"'
        )
    if table.size < 2:
        raise MeasurementError(f"{path}: {table.size} row of numbers; at least 2 needed")
    frequency = _frequency_axis(path, table)
    groups, coherences = _grouped(path, table.columns)
    frfs = [_frf(path, table, frequency, group) for group in groups.values()]
    return [
        _with_coherence(path, table, frf, group.label, coherences)
        for frf, group in zip(frfs, groups.values(), strict=True)
    ]


def _frequency_axis(path: Path, table: Table) -> Array:
    column = table.columns[0]
    if not column.unit:
        raise MeasurementError(f"{path}: column {column.name!r} has no unit; write {_EXAMPLE}")
    channel, factor = _named(path, column.name, column.unit, channel_unit)
    if channel == "time":
        raise MeasurementError(
            f"{path}: holds a time record ({column.name} [{column.unit}]), not an FRF; "
            "of a hammer record one column is a force and one a displacement, velocity or "
            "acceleration; of volts state the sensitivities: "
            '--columns "time [s], force [2.25 mV/N], acceleration [10.2 mV/g]"'
        )
    if channel != "frequency":
        raise MeasurementError(
            f"{path}: the first column must be a frequency in Hz, not {column.name} [{column.unit}]"
        )
    frequency = table.numbers(0) * factor
    falling = np.flatnonzero(np.diff(frequency) <= 0.0)
    if falling.size:
        row = int(falling[0])
        raise MeasurementError(
            f"{path}: {table.where(row + 1)}: frequency {frequency[row + 1]:g} Hz "
            f"after {frequency[row]:g} Hz; frequencies must rise"
        )
    return frequency


def _named(
    path: Path, name: str, unit: str, convert: Callable[[str], tuple[T, float]]
) -> tuple[T, float]:
    """Convert the unit of a column, naming file and column where it fails."""
    try:
        return convert(unit)
    except MeasurementError as error:
        raise MeasurementError(f"{path}: column {name!r}: {error}") from None


def _part_and_label(path: Path, column: Column) -> tuple[str, str]:
    words = re.findall(r"[A-Za-z0-9]+", column.name)
    parts = [_PART_OF_WORD[word.lower()] for word in words if word.lower() in _PART_OF_WORD]
    if len(parts) != 1 or parts[0] == "frequency":
        raise MeasurementError(
            f"{path}: column {column.name!r} is neither real, imag, magnitude, phase nor "
            f"coherence; the heading must be like: {_EXAMPLE}"
        )
    label = " ".join(word.lower() for word in words if word.lower() not in _PART_OF_WORD)
    return parts[0], label


def _grouped(path: Path, columns: Sequence[Column]) -> tuple[dict[str, _Parts], dict[str, int]]:
    groups: dict[str, _Parts] = {}
    coherences: dict[str, int] = {}
    for index, column in enumerate(columns[1:], start=1):
        part, label = _part_and_label(path, column)
        if part == "coherence":
            coherences[label] = index
            continue
        group = groups.setdefault(label, _Parts(label))
        if part in group.columns:
            raise MeasurementError(
                f"{path}: two columns {column.name!r}; tell FRFs apart by a label, "
                "such as 'real xx [m/N]' and 'real yy [m/N]'"
            )
        group.columns[part] = (index, column)
    if not groups:
        raise MeasurementError(f"{path}: no response column; the heading must be like: {_EXAMPLE}")
    return groups, coherences


def _frf(path: Path, table: Table, frequency: Array, group: _Parts) -> Frf:
    if set(group.columns) == {"real", "imaginary"}:
        values, quantity = _cartesian(path, table, group)
    elif set(group.columns) == {"magnitude", "phase"}:
        values, quantity = _polar(path, table, group)
    else:
        names = ", ".join(repr(column.name) for _, column in group.columns.values())
        raise MeasurementError(
            f"{path}: {names} make no FRF; real and imag, or magnitude and phase, are needed"
        )
    response, reference = _points(group.label)
    source = f"{path}: {group.label}" if group.label else str(path)
    return Frf(frequency, values, quantity, response, reference, source=source)


def _scaled(path: Path, name: str, unit: str) -> tuple[Quantity, float]:
    if unit.lower().startswith("db"):
        raise MeasurementError(
            f"{path}: column {name!r} is in {unit}; decibels are not read, "
            "write the linear magnitude, such as [m/N]"
        )
    return _named(path, name, unit, frf_unit)


def _cartesian(path: Path, table: Table, group: _Parts) -> tuple[ComplexArray, Quantity]:
    (real_index, real), (imaginary_index, imaginary) = (
        group.columns["real"],
        group.columns["imaginary"],
    )
    real_unit, imaginary_unit = real.unit or imaginary.unit, imaginary.unit or real.unit
    quantity, real_factor = _scaled(path, real.name, real_unit)
    other, imaginary_factor = _scaled(path, imaginary.name, imaginary_unit)
    if other != quantity:
        raise MeasurementError(
            f"{path}: {real.name!r} in {real_unit} and {imaginary.name!r} in {imaginary_unit} "
            "are different quantities"
        )
    values = (
        table.numbers(real_index) * real_factor
        + 1j * table.numbers(imaginary_index) * imaginary_factor
    )
    return values, quantity


def _polar(path: Path, table: Table, group: _Parts) -> tuple[ComplexArray, Quantity]:
    (magnitude_index, magnitude), (phase_index, phase) = (
        group.columns["magnitude"],
        group.columns["phase"],
    )
    quantity, factor = _scaled(path, magnitude.name, magnitude.unit)
    unit = phase.unit.lower()
    if unit not in _DEGREES | _RADIANS:
        raise MeasurementError(
            f"{path}: column {phase.name!r} has unit {phase.unit!r}; allowed are deg and rad"
        )
    angle = table.numbers(phase_index)
    angle = np.deg2rad(angle) if unit in _DEGREES else angle
    return table.numbers(magnitude_index) * factor * np.exp(1j * angle), quantity


def _points(label: str) -> tuple[Point, Point]:
    """Directions from a label: ``xy`` or ``hxy`` is response x, reference y; ``x`` is both."""
    for word in label.split():
        found = re.fullmatch(r"(?:h|g|frf)?([xyz])([xyz])?", word)
        if found:
            response = found.group(1)
            return Point(direction=response), Point(direction=found.group(2) or response)
    return Point(), Point()


def _with_coherence(
    path: Path, table: Table, frf: Frf, label: str, coherences: dict[str, int]
) -> Frf:
    if label not in coherences:
        return frf
    index = coherences[label]
    coherence = table.numbers(index) * (0.01 if table.columns[index].unit == "%" else 1.0)
    if np.any((coherence < 0.0) | (coherence > 1.0 + 1e-6)):
        row = int(np.argmax((coherence < 0.0) | (coherence > 1.0 + 1e-6)))
        raise MeasurementError(
            f"{path}: {table.where(row)}: coherence {coherence[row]:g} is outside 0..1"
        )
    return replace(frf, coherence=coherence)
