"""Signals of a measurement from files of any format: columns in SI by their standard names."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from chatter.description.arrays import Array
from chatter.description.errors import InputError
from chatter.description.formatting import formatted
from chatter.io.formats.format_list import format_of
from chatter.io.headings import DIMENSIONS, named
from chatter.io.stated_columns import read_signal_table, signals_of
from chatter.io.table import Column, Table, is_copy, is_number
from dynamics.frf.container import Frf, MeasurementError

Signals = dict[str, Array]

#: words of a verdict -> stable or not; marginal and unknown ones are no verdict
_VERDICTS = {
    **dict.fromkeys(("1", "1.0", "true", "yes", "stable", "ok"), 1.0),
    **dict.fromkeys(("0", "0.0", "false", "no", "chatter", "unstable"), 0.0),
    **dict.fromkeys(("", "nan", "marginal", "unknown", "?", "-"), np.nan),
}


#: kind of measurement -> names of what a format itself says a column holds; {axis} is x, y or z
_NAMES_OF_CONTENT = {
    "milling": {"force": "F{axis}", "displacement": "{axis}"},
    "axis": {"force": "force", "displacement": "position", "velocity": "velocity"},
}


def read_signals(
    path: Path, kind: str = "", direction: str = "", columns: str | None = None
) -> Signals:
    """Columns of a file in SI, by name; `columns` states the headings of a file without.

    The kind of measurement tells what a displacement or a force of a universal file is called
    there; the direction is that of the FRF wanted of a file of several, response first. InputError
    if it is missing, of a format that is not read, or holds what is not a number.
    """
    try:
        if kind == "frf":
            return _frf(path, direction)
        return _in_si(read_signal_table(path, columns), kind)
    except MeasurementError as error:
        raise InputError(str(error)) from error


def _in_si(table: Table, kind: str) -> Signals:
    signals: Signals = {}
    first: dict[str, int] = {}
    for index, name, factor in _named_columns(table, kind):
        column = table.columns[index]
        if name in ("stable", "chatter"):
            stable = np.array([_verdict(table, column, k) for k in range(table.size)])
            name, values = "stable", stable if name == "stable" else 1.0 - stable
        elif name not in DIMENSIONS and _are_remarks(column):
            continue
        else:
            values = _numbers(table, column) * factor
        if name not in signals:
            signals[name], first[name] = values, index
        elif not is_copy(signals[name], values):
            raise InputError(_which_of(table, name, first[name], index))
    return signals


def _named_columns(table: Table, kind: str) -> list[tuple[int, str, float]]:
    """Index, name and factor to SI of each column that has a name.

    A column without one is that of the numbers of rows, as tables of pandas have it. One whose unit
    is of another quantity than its name is left out where another column of the name has the right
    one, as raw volts have beside the force.
    """
    found: list[tuple[int, str, float]] = []
    wrong: list[tuple[str, InputError]] = []
    for index, column in enumerate(table.columns):
        if not column.heading.strip() and column.content is None:
            continue
        try:
            found.append((index, *_name_and_factor(table.path, column, kind)))
        except InputError as error:
            wrong.append((column.name, error))
    right = {table.columns[index].name for index, _, _ in found}
    for name, problem in wrong:
        if name not in right:
            raise problem
    return found


def _which_of(table: Table, name: str, one: int, other: int) -> str:
    """Say which columns have one name, and how to state which of them is meant."""
    given = [column.heading.strip() or f"column {k}" for k, column in enumerate(table.columns, 1)]
    unit = table.columns[other].unit
    stated = list(given)
    stated[other] = f"{table.columns[other].name} {other + 1}" + (f" [{unit}]" if unit else "")
    return (
        f'{table.path}: columns {one + 1} and {other + 1} are both "{name}" '
        f"({given[one]}, {given[other]}), and differ; give one of them another name: in the "
        f"heading, or all columns by --columns, or by columns of the run in measurement.toml, "
        f'"{", ".join(stated)}"'
    )


def _name_and_factor(path: Path, column: Column, kind: str) -> tuple[str, float]:
    """Name of a column by what the format says it holds, else by its heading; factor to SI."""
    pattern = _NAMES_OF_CONTENT.get(kind, {}).get(column.content or "")
    if pattern is None:
        name, factor = named(path, column.heading)
        return name, 1.0 if column.content else factor
    if "{axis}" not in pattern:
        return pattern, 1.0
    if not column.point.direction:
        raise InputError(f"{path}: {column.heading}: a {column.content} without a direction")
    return pattern.format(axis=column.point.direction), float(column.point.sign)


def _are_remarks(column: Column) -> bool:
    """Whether a column has words or blanks alone: an operator's remarks, names of tools."""
    cells = column.cells
    if column.unit or column.content or (isinstance(cells, np.ndarray) and cells.dtype.kind != "O"):
        return False
    return not any(is_number(str(cell)) for cell in cells if str(cell).strip())


def _numbers(table: Table, column: Column) -> Array:
    """Numbers of a column; NaN where a cell is blank."""
    try:
        return np.array(column.cells, dtype=np.float64)
    except (TypeError, ValueError):
        return np.array([_number(table, column, row) for row in range(table.size)])


def _number(table: Table, column: Column, row: int) -> float:
    text = str(column.cells[row]).strip()
    try:
        return float(text) if text else np.nan
    except ValueError:
        where = f"{table.path}: {table.where(row)}: {column.heading}"
        raise InputError(f"{where}: {formatted(text)} is not a number") from None


def _verdict(table: Table, column: Column, row: int) -> float:
    text = str(column.cells[row]).strip()
    if text.lower() not in _VERDICTS:
        raise InputError(
            f"{table.path}: {table.where(row)}: {column.heading}: {formatted(text)} is no verdict; "
            "1, true or stable, 0, false or chatter, or marginal"
        )
    return _VERDICTS[text.lower()]


def _frf(path: Path, direction: str) -> Signals:
    """Receptance in columns frequency, real and imag; else of the FRF of a direction."""
    one = format_of(path, "FRFs")
    if one.read_signals is not None:
        try:
            signals = _with_parts(path, _in_si(signals_of(one, path), "frf"))
        except (InputError, MeasurementError):
            signals = {}  # a table of another quantity, of several FRFs, or no table
        if {"frequency", "real", "imag"} <= signals.keys():
            return signals
    return _frf_of_direction(path, one.read_frfs(path), direction)


def _with_parts(path: Path, signals: Signals) -> Signals:
    """Real and imaginary part instead of magnitude and phase."""
    if "magnitude" not in signals or "real" in signals:
        return signals
    if "phase" not in signals:
        raise InputError(f"{path}: there is a magnitude without a phase")
    rest = {k: v for k, v in signals.items() if k not in ("magnitude", "phase")}
    values = signals["magnitude"] * np.exp(1j * signals["phase"])
    return {**rest, "real": values.real, "imag": values.imag}


def _frf_of_direction(path: Path, measured: Sequence[Frf], direction: str) -> Signals:
    frfs = [frf.along_axes() for frf in measured]
    wanted = (direction[:1], direction[-1:])
    chosen = [frf for frf in frfs if wanted == (frf.response.direction, frf.reference.direction)]
    if len(frfs) == 1 and not (frfs[0].response.direction and frfs[0].reference.direction):
        chosen = frfs
    if len(chosen) != 1:
        held = ", ".join(f"{f.response.direction}{f.reference.direction}" or "?" for f in frfs)
        raise InputError(
            f'{path}: holds {len(chosen)} FRFs of direction "{direction}" (response, then force); '
            f"there are {held}"
        )
    frf = chosen[0].receptance()
    return {"frequency": frf.frequency, "real": frf.values.real, "imag": frf.values.imag}
