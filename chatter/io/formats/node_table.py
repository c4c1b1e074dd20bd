"""Tables of nodes: number, coordinates and, where freedoms are in no order, rows of matrices."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from chatter.io.files import read_lines
from chatter.io.formats.model_parts import StoredNodes
from dynamics.frf.container import MeasurementError

NODE_COLUMNS = ("node", "x", "y", "z")
ROW_COLUMNS = ("ux", "uy", "uz", "rx", "ry", "rz")


def read_nodes(path: Path) -> StoredNodes:
    """Read a table with a header and the columns node, x, y, z.

    If freedoms are not three or six a node one after another, also ux, uy, uz, and rx, ry, rz: the
    row of the matrices, from 1, of that freedom, or nothing where it is held or there is none.
    MeasurementError names the file, line and column.
    """
    text = read_lines(path)
    try:
        reader = csv.DictReader(text, skipinitialspace=True)
        lines = [(reader.line_num, line) for line in reader]
        header = tuple(reader.fieldnames or ())
    except csv.Error as error:
        raise MeasurementError(f"{path}: cannot be read as a table: {error}") from error
    for column in NODE_COLUMNS:
        if column not in header:
            raise MeasurementError(f'{path}: no column "{column}" in the header, {header}')
    if not lines:
        raise MeasurementError(f"{path}: has no nodes")
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


def _number(path: Path, line: int, row: dict, column: str, kind: type) -> float | int:
    try:
        value = kind(row[column])
        if np.isfinite(value) and abs(value) < 2**62:
            return value
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
