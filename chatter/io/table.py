"""Columns of numbers or words that a file holds, whatever its format."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from chatter.description.arrays import Array
from dynamics.frf.container import LARGEST, MeasurementError, Point

if TYPE_CHECKING:
    from chatter.io.formats.units import Channel

#: ends of names without brackets, as in "force_N" -> unit
_UNITS_OF_NAMES = {
    **{unit: unit for unit in ("s", "ms", "us", "Hz", "N", "kN", "lbf", "g", "m", "mm", "um")},
    **{unit: unit for unit in ("Pa", "A", "W", "kW", "V", "rpm", "deg", "rad")},
    "Nm": "N*m",
    **dict.fromkeys(("ms2", "mps2", "m_s2"), "m/s^2"),
}
#: of the largest value, by which columns differ that hold the same
_ROUNDING = 1e-4


@dataclass(frozen=True, eq=False)
class Column:
    """One column as stored."""

    heading: str  # name and unit as written: "Fx [N]"
    cells: Sequence[str] | NDArray  # (n,)
    #: "force", "displacement", ... where the format says so itself; the cells are then in SI.
    content: Channel | None = None
    #: where and in which direction it was measured, where the format says so
    point: Point = field(default_factory=Point)

    @property
    def name(self) -> str:
        """Heading without its unit."""
        return split_heading(self.heading)[0]

    @property
    def unit(self) -> str:
        """Unit in the heading; empty where there is none."""
        return split_heading(self.heading)[1]


@dataclass(frozen=True, eq=False)
class Table:
    """Columns of equal length."""

    path: Path
    columns: tuple[Column, ...]
    lines: Sequence[int] | None = None  # line of the text file each row stood on, from 1

    @property
    def size(self) -> int:
        """Number of rows."""
        return len(self.columns[0].cells)

    def where(self, row: int) -> str:
        """Name a row, from 0, as in messages."""
        return f"row {row + 1}" if self.lines is None else f"line {self.lines[row]}"

    def _named(self, index: int) -> str:
        """Column as in messages: its name, or its number where it has none."""
        return self.columns[index].name or f"column {index + 1}"

    def numbers(self, index: int) -> Array:
        """Cells of a column as finite numbers.

        MeasurementError if a cell is not a finite number, or one that no instrument records; the
        message names file and line.
        """
        cells = self.columns[index].cells
        try:
            values = np.asarray(cells, dtype=np.float64)
            wrong = np.flatnonzero(~np.isfinite(values))
        except (TypeError, ValueError):
            wrong = [next(row for row, cell in enumerate(cells) if not is_number(str(cell)))]
        if len(wrong):
            cell = str(cells[wrong[0]]).strip()
            finite = "finite " if is_number(cell) else ""
            raise MeasurementError(
                f"{self.path}: {self.where(int(wrong[0]))}, {self._named(index)}: {cell[:40]!r} is "
                f"not a {finite}number"
            )
        far = np.abs(values) > LARGEST
        if np.any(far):
            row = int(np.argmax(far))
            raise MeasurementError(
                f"{self.path}: {self.where(row)}: {values[row]:g} is no measured number (at most "
                f"{LARGEST:g})"
            )
        return values


def table_of(path: Path, columns: Sequence[Column], what: str) -> Table:
    """Table of columns; MeasurementError where they, named as in messages, differ in length."""
    lengths = {column.heading: len(column.cells) for column in columns}
    if len(set(lengths.values())) != 1:
        raise MeasurementError(f"{path}: the {what} differ in length or there are none: {lengths}")
    return Table(path, tuple(columns))


def is_copy(one: Array, other: Array) -> bool:
    """Whether two columns hold the same, but for the rounding of what was written."""
    largest = float(np.nanmax(np.abs(one), initial=0.0))
    return np.allclose(one, other, rtol=0.0, atol=_ROUNDING * largest, equal_nan=True)


def is_number(cell: str) -> bool:
    """Tell whether a cell is a number, NaN and infinity included."""
    try:
        float(cell)
    except ValueError:
        return False
    return "_" not in cell


def split_heading(heading: str) -> tuple[str, str]:
    """Split ``"real xx [m/N]"`` or ``"Real ((m/s^2)/N)"`` into name and unit."""
    text = heading.strip().strip('"').strip()
    found = re.fullmatch(r"(.*?)\[(.*)\]", text)
    if found:
        return found.group(1).strip(), found.group(2).strip()
    if text.endswith(")"):
        depth = 0
        for index in range(len(text) - 1, -1, -1):
            depth += {")": 1, "(": -1}.get(text[index], 0)
            if depth == 0:
                return text[:index].strip(), text[index + 1 : -1].strip()
    return text, ""


def heading_of_name(name: str) -> str:
    """Name and unit: "force_N" is "force [N]", as brackets are not allowed in every program."""
    if "[" in name or "(" in name:
        return name
    for end, unit in _UNITS_OF_NAMES.items():
        stem = name.removesuffix(f"_{end}")
        if stem and stem != name:
            return f"{stem} [{unit}]"
    return name
