"""Tables of nodes: number, coordinates and, where freedoms are in no order, rows of matrices."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import numpy as np

from chatter.io.files import read_lines
from chatter.io.formats.model_parts import StoredNodes
from dynamics.frf.container import MeasurementError

NODE_COLUMNS = ("node", "x", "y", "z")
ROW_COLUMNS = ("ux", "uy", "uz", "rx", "ry", "rz")
#: what programs call them, in lower case
_SPELLINGS = {
    **dict.fromkeys(("id", "nid", "no", "number", "label", "grid", "n", "knoten", "nodes"), "node"),
    **dict.fromkeys(("node id", "node no", "node number", "node label", "grid id"), "node"),
    **{f"{word} {axis}": axis for word in ("coord", "coordinate", "pos") for axis in "xyz"},
    **{f"{axis} {word}": axis for word in ("coord", "coordinate", "location") for axis in "xyz"},
    **{f"x{number}": axis for number, axis in enumerate("xyz", start=1)},
    **{f"rot{axis}": f"r{axis}" for axis in "xyz"},
}
#: a unit in a heading, such as "x [mm]"
_UNIT = re.compile(r"[\[(/].*[a-z]")


def read_nodes(path: Path) -> StoredNodes:
    """Read a table with a header and the columns node, x, y, z.

    If freedoms are not three or six a node one after another, also ux, uy, uz, and rx, ry, rz: the
    row of the matrices, from 1, of that freedom, or nothing where it is held or there is none.
    Columns are separated by commas, semicolons (numbers may have decimal commas then), tabs or
    blanks. MeasurementError names the file, line and column.
    """
    text = read_lines(path)
    separator = _separator(text)
    try:
        reader = csv.DictReader(
            _single_blanks(text) if separator == " " else text,
            delimiter=separator,
            skipinitialspace=True,
        )
        reader.fieldnames = [_column(path, name) for name in reader.fieldnames or ()]
        lines = [(reader.line_num, line) for line in reader]
        header = tuple(reader.fieldnames)
    except csv.Error as error:
        raise MeasurementError(f"{path}: cannot be read as a table: {error}") from error
    for column in NODE_COLUMNS:
        if column not in header:
            raise MeasurementError(f'{path}: no column "{column}" in the header, {header}')
    if not lines:
        raise MeasurementError(f"{path}: has no nodes")
    if separator != ",":
        for _, row in lines:
            row.update({name: row[name].replace(",", ".") for name in NODE_COLUMNS if row[name]})
    names = [_number(path, line, row, "node", int) for line, row in lines]
    coordinates = [
        [_number(path, line, row, axis, float) for axis in NODE_COLUMNS[1:]] for line, row in lines
    ]
    rows = None
    if any(column in header for column in ROW_COLUMNS):
        rows = np.array(
            [[_matrix_row(path, line, row, part) for part in ROW_COLUMNS] for line, row in lines]
        )
    return StoredNodes(np.array(names, dtype=np.int64), np.array(coordinates), rows)


def _separator(text: list[str]) -> str:
    """What separates the columns of the header."""
    header = next(line for line in text if line.strip())
    return next((one for one in ";,\t" if one in header), " ")


def _single_blanks(text: list[str]) -> list[str]:
    return [" ".join(line.split()) for line in text]


def _column(path: Path, name: str) -> str:
    """Column by its heading, in the words of the program that wrote it."""
    plain = " ".join((name or "").strip().strip('"#').lower().replace("_", " ").split())
    if _UNIT.search(plain):
        raise MeasurementError(
            f'{path}: the column "{name.strip()}" has a unit; leave it out, and say it by units = '
            '{ length = "mm" } of the part, for its matrices too'
        )
    return _SPELLINGS.get(plain, plain)


def _number(path: Path, line: int, row: dict, column: str, kind: type) -> float | int:
    try:
        value = float(row[column])
        # some programs write 7.0 for 7
        if np.isfinite(value) and abs(value) < 2**53 and (kind is float or value.is_integer()):
            return kind(value)
    except (TypeError, ValueError, OverflowError):
        pass
    wanted = "whole number" if kind is int else "finite number"
    raise MeasurementError(f'{path}, line {line}: {column} is "{row[column]}", not a {wanted}')


def _matrix_row(path: Path, line: int, row: dict, column: str) -> int:
    if not (row.get(column) or "").strip():
        return -1
    value = _number(path, line, row, column, int)
    if value < 1:
        raise MeasurementError(f"{path}, line {line}: {column} is {value}; rows begin at 1")
    return int(value) - 1
