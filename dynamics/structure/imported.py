"""Structures from matrices that a finite element program wrote.

Mass, stiffness and damping come as Matrix Market or NPZ files, nodes as a table. Sparse matrices
stay sparse.
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import scipy.sparse

from dynamics.structure.linear_structure import LinearStructure, Matrix, StructureError
from dynamics.structure.matrix_file import read_matrix, refuse_indefinite, symmetrised
from dynamics.structure.surface_constraint import (
    InterpolatedPoint,
    Nodes,
    RigidSurface,
    interpolation,
    rigid_transformation,
)

__all__ = [
    "InterpolatedPoint",
    "Nodes",
    "RigidSurface",
    "imported_structure",
    "read_matrix",
    "read_nodes",
    "tied_structure",
]

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

    Parameters
    ----------
    mass, stiffness, damping : path
        Files as for `read_matrix`; without damping the structure has none.
    nodes : path or Nodes, optional
        Table as for `read_nodes`, or the nodes; needed for points.
    rigid : sequence of RigidSurface
    interpolated : sequence of InterpolatedPoint

    Returns
    -------
    LinearStructure

    Raises
    ------
    StructureError
        If a file cannot be used, a matrix is not symmetric, sizes differ, the mass matrix is not
        positive definite, or a point cannot be tied.
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


def tied_structure(
    bare: LinearStructure,
    nodes: Nodes | None,
    rigid: Sequence[RigidSurface] = (),
    interpolated: Sequence[InterpolatedPoint] = (),
) -> LinearStructure:
    """Tie points to the surfaces of a structure given by its nodes' freedoms.

    Rigid surfaces take freedoms away: with x = T q the matrices become T' M T and so on.

    Parameters
    ----------
    bare : LinearStructure
        Its own points are kept.
    nodes : Nodes
    rigid : sequence of RigidSurface
    interpolated : sequence of InterpolatedPoint

    Raises
    ------
    StructureError
        If a point cannot be tied, or two have one name.
    """
    names = [*bare.points, *(tie.name for tie in (*rigid, *interpolated))]
    for name in names:
        if names.count(name) > 1:
            raise StructureError(f'point "{name}" is there twice; names must differ')
    if not (rigid or interpolated):
        return bare
    if nodes is None:
        raise StructureError(f'point "{names[-1]}" is tied to nodes, and no nodes are given')
    if nodes.rows.size and nodes.rows.max() >= bare.size:
        raise StructureError(
            f"nodes: row {nodes.rows.max() + 1} is named, the matrices have {bare.size}"
        )
    rows = {tie.name: interpolation(tie, nodes, bare.size) for tie in interpolated}
    transformation, first = rigid_transformation(rigid, nodes, bare.size)
    points = {name: row @ transformation for name, row in {**bare.points, **rows}.items()}
    for name, column in first.items():
        points[name] = np.eye(6, transformation.shape[1], k=column)
    mass, damping, stiffness = (
        symmetrised(transformation.T @ matrix @ transformation)
        for matrix in (bare.mass, bare.damping, bare.stiffness)
    )
    return LinearStructure(mass, damping, stiffness, points)


def read_nodes(path: str | Path, size: int) -> Nodes:
    """Read a table of nodes.

    Parameters
    ----------
    path : path
        CSV with a header and the columns node, x, y, z (m). If freedoms are not three or six a
        node one after another, also ux, uy, uz, and rx, ry, rz: the row of the matrices, from 1,
        of that freedom, or nothing where it is held or there is none.
    size : int
        Rows of the matrices.

    Raises
    ------
    StructureError
        Naming the file, line and column.
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


def _zeros(matrix: Matrix) -> Matrix:
    return (
        scipy.sparse.csr_array(matrix.shape, dtype=np.float64)
        if scipy.sparse.issparse(matrix)
        else np.zeros(matrix.shape)
    )
