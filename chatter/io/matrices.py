"""Matrices and nodes that a finite element program wrote, read and checked."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import scipy

from chatter.description.arrays import BooleanArray
from chatter.io.formats.format_list import format_of
from chatter.io.formats.matrix_market import require_square
from dynamics.frf.container import MeasurementError
from dynamics.structure.imported import refuse_indefinite, symmetrised, tied_structure
from dynamics.structure.linear_structure import LinearStructure, Matrix, StructureError
from dynamics.structure.surface_constraint import InterpolatedPoint, Nodes, RigidSurface

#: unequal halves of a matrix, relative to the diagonal, that digits cut by a file explain
UNSYMMETRIC = 1e-8
NODE_COLUMNS = ("node", "x", "y", "z")
ROW_COLUMNS = ("ux", "uy", "uz", "rx", "ry", "rz")


def imported_structure(
    mass: str | Path,
    stiffness: str | Path,
    damping: str | Path | None = None,
    nodes: str | Path | Nodes | None = None,
    rigid: Sequence[RigidSurface] = (),
    interpolated: Sequence[InterpolatedPoint] = (),
) -> LinearStructure:
    """Read matrices and tie points to them.

    Files as for `read_matrix`; without damping the structure has none. Nodes, or their table as for
    `read_nodes`, are needed for points. StructureError if a file cannot be used, a matrix is not
    symmetric, sizes differ, the mass matrix is not positive definite, or a point cannot be tied.
    """
    mass_matrix, stiffness_matrix = read_matrix(mass), read_matrix(stiffness)
    size = mass_matrix.shape[0]
    damping_matrix = _zeros(mass_matrix) if damping is None else read_matrix(damping)
    for path, matrix in ((stiffness, stiffness_matrix), (damping, damping_matrix)):
        if matrix.shape[0] != size:
            raise StructureError(
                f"{path}: {matrix.shape[0]} rows; {mass} has {size}, and both must be the same"
            )
    refuse_indefinite(mass_matrix, str(mass))
    if nodes is not None and not isinstance(nodes, Nodes):
        nodes = read_nodes(nodes, size)
    bare = LinearStructure(mass_matrix, damping_matrix, stiffness_matrix, {})
    return tied_structure(bare, nodes, rigid, interpolated)


def read_matrix(path: str | Path) -> Matrix:
    """Read one symmetric matrix (n, n) of finite real numbers, full or sparse.

    From a format that holds matrices: Matrix Market, or NPZ of `scipy.sparse.save_npz` or with one
    plain array. StructureError names the file and the entry (rows and columns from 1).
    """
    path = Path(path)
    try:
        matrix = format_of(path, "matrices").read_matrix(path)
        require_square(path, matrix.shape)
    except MeasurementError as error:
        raise StructureError(str(error)) from error
    except Exception as error:  # the libraries raise nearly anything on a broken file
        raise StructureError(f"{path}: cannot be read as a matrix: {error}") from error
    return _checked(matrix, path)


def read_nodes(path: str | Path, size: int) -> Nodes:
    """Read a table of nodes of a structure whose matrices have `size` rows.

    CSV with a header and the columns node, x, y, z (m). If freedoms are not three or six a node one
    after another, also ux, uy, uz, and rx, ry, rz: the row of the matrices, from 1, of that
    freedom, or nothing where it is held or there is none. StructureError names the file, line and
    column.
    """
    path = Path(path)
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            reader = csv.DictReader(file, skipinitialspace=True)
            lines = [(reader.line_num, line) for line in reader]
            header = tuple(reader.fieldnames or ())
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise StructureError(f"{path}: cannot be read as a table: {error}") from error
    for column in NODE_COLUMNS:
        if column not in header:
            raise StructureError(f'{path}: no column "{column}" in the header, {header}')
    if not lines:
        raise StructureError(f"{path}: has no nodes")
    names = [_number(path, line, row, "node", int) for line, row in lines]
    coordinates = [
        [_number(path, line, row, axis, float) for axis in NODE_COLUMNS[1:]] for line, row in lines
    ]
    try:
        if not any(column in header for column in ROW_COLUMNS):
            return Nodes.in_order(names, np.reshape(coordinates, (-1, 3)), size)
        rows = [[_matrix_row(path, line, row, part, size) for part in ROW_COLUMNS]
                for line, row in lines]  # fmt: skip
        return Nodes(np.array(names), np.array(coordinates), np.array(rows))
    except StructureError as error:
        raise StructureError(str(error).replace("nodes:", f"{path}:", 1)) from error


def _number(path: Path, line: int, row: dict, column: str, kind: type) -> float | int:
    try:
        value = kind(row[column])
        if np.isfinite(value) and abs(value) < 2**62:
            return value
    except (TypeError, ValueError, OverflowError):
        pass
    wanted = "whole number" if kind is int else "finite number"
    raise StructureError(f'{path}, line {line}: {column} is "{row[column]}", not a {wanted}')


def _matrix_row(path: Path, line: int, row: dict, column: str, size: int) -> int:
    if not (row.get(column) or "").strip():
        return -1
    value = _number(path, line, row, column, int)
    if not 1 <= value <= size:
        raise StructureError(f"{path}, line {line}: {column} is {value}; rows are 1 to {size}")
    return int(value) - 1


def _checked(matrix: Matrix, path: Path) -> Matrix:
    if not np.issubdtype(matrix.dtype, np.integer) and not np.issubdtype(matrix.dtype, np.floating):
        raise StructureError(f"{path}: has entries of type {matrix.dtype}; they must be real")
    sparse = scipy.sparse.csr_array(matrix, dtype=np.float64)
    entries = scipy.sparse.coo_array(sparse)
    for row, column, value in _where(entries, ~np.isfinite(entries.data)):
        raise StructureError(f"{path}: row {row + 1}, column {column + 1} is {value}")
    unequal = scipy.sparse.coo_array(sparse - sparse.T)
    scale = np.sqrt(np.abs(sparse.diagonal()))
    limit = UNSYMMETRIC * scale[unequal.row] * scale[unequal.col] + 1e-14 * np.max(scale) ** 2
    for row, column, _ in _where(unequal, np.abs(unequal.data) > limit):
        raise StructureError(
            f"{path}: not symmetric: row {row + 1}, column {column + 1} is "
            f"{sparse[row, column]:g}, row {column + 1}, column {row + 1} is "
            f"{sparse[column, row]:g}"
        )
    return symmetrised(sparse if scipy.sparse.issparse(matrix) else np.asarray(matrix, np.float64))


def _where(entries: scipy.sparse.coo_array, wrong: BooleanArray) -> list[tuple]:
    """Row, column and value of the wrong entry that is wrong by most, or nothing."""
    if not np.any(wrong):
        return []
    sizes = np.where(wrong, np.nan_to_num(np.abs(entries.data), nan=np.inf), -1.0)
    worst = int(np.argmax(sizes))
    return [(int(entries.row[worst]), int(entries.col[worst]), entries.data[worst])]


def _zeros(matrix: Matrix) -> Matrix:
    return (
        scipy.sparse.csr_array(matrix.shape, dtype=np.float64)
        if scipy.sparse.issparse(matrix)
        else np.zeros(matrix.shape)
    )
