"""Matrices and nodes that a finite element program wrote, read and checked."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple, TypeVar

import numpy as np
import scipy

from chatter.description.arrays import BooleanArray, IntegerArray
from chatter.io.formats.format import Content, Format
from chatter.io.formats.format_list import format_of
from chatter.io.formats.matrix_market import require_square
from chatter.io.formats.model_parts import MatrixQuantity, StoredMatrix, StoredNodes, freedom_title
from chatter.io.formats.node_table import ROW_COLUMNS
from dynamics.frf.container import MeasurementError
from dynamics.structure.imported import (
    ModelUnits,
    in_si,
    refuse_indefinite,
    refuse_other_mass,
    symmetrised,
    tied_structure,
)
from dynamics.structure.linear_structure import LinearStructure, Matrix, StructureError
from dynamics.structure.surface_constraint import InterpolatedPoint, Nodes, RigidSurface

#: unequal halves of a matrix, relative to the diagonal, that digits cut by a file explain
UNSYMMETRIC = 1e-8
#: nodes that a message names before it counts the others
_SHOWN = 3
#: what a reader of a format returns
Stored = TypeVar("Stored")


class ImportedModel(NamedTuple):
    """Structure in SI without points, and its nodes."""

    structure: LinearStructure
    nodes: Nodes | None


def imported_model(
    mass: str | Path,
    stiffness: str | Path,
    damping: str | Path | None = None,
    nodes: str | Path | Nodes | None = None,
    names: Mapping[MatrixQuantity, str] | None = None,
    units: ModelUnits | None = None,
    total_mass: float | None = None,
) -> ImportedModel:
    """Read matrices and nodes into SI.

    Parameters
    ----------
    mass, stiffness, damping, nodes : path
        Files as for `read_matrix` and `read_nodes`; one may hold several. Without damping the
        structure has none. Where matrices name their freedoms, the nodes need no rows.
    names : mapping, optional
        Name in its file of the mass, stiffness or damping matrix, where there are several.
    units : ModelUnits, optional
        Of all these files; SI by default.
    total_mass : float, optional
        kg; what the matrices must have in a rigid motion along x, y and z.

    Raises
    ------
    StructureError
        If a file cannot be used, a matrix is not symmetric, sizes or freedoms differ, nodes are
        missing, the mass matrix is not positive definite, or the mass is not that stated.
    """
    paths = {"mass": mass, "stiffness": stiffness} | ({"damping": damping} if damping else {})
    stored = {
        quantity: _stored(path, quantity, (names or {}).get(quantity))
        for quantity, path in paths.items()
    }
    freedoms = _common_freedoms(paths, stored)
    matrices = {quantity: _spread(one, freedoms) for quantity, one in stored.items()}
    size = matrices["mass"].shape[0]
    refuse_indefinite(matrices["mass"], str(mass), _titles(freedoms))
    structure = LinearStructure(
        matrices["mass"],
        matrices.get("damping", _zeros(matrices["mass"])),
        matrices["stiffness"],
        {},
    )
    if nodes is not None and not isinstance(nodes, Nodes):
        nodes = read_nodes(nodes, size, freedoms)
    if units is not None:
        structure, nodes = in_si(structure, nodes, units)
    if total_mass is not None:
        refuse_other_mass(structure, nodes, total_mass, str(mass))
    return ImportedModel(structure, nodes)


def imported_structure(
    mass: str | Path,
    stiffness: str | Path,
    damping: str | Path | None = None,
    nodes: str | Path | Nodes | None = None,
    rigid: Sequence[RigidSurface] = (),
    interpolated: Sequence[InterpolatedPoint] = (),
) -> LinearStructure:
    """Read matrices in SI and tie points to them.

    Files as for `imported_model`. Nodes are needed for points. StructureError as there, or if a
    point cannot be tied.
    """
    bare, read = imported_model(mass, stiffness, damping, nodes)
    return tied_structure(bare, read, rigid, interpolated)


def read_matrix(path: str | Path) -> Matrix:
    """Read one symmetric matrix (n, n) of finite real numbers, full or sparse.

    From a file of a format that holds matrices (docs/file-formats.md) and has one. StructureError
    names the file and the entry (rows and columns from 1, or nodes).
    """
    return _stored(path, None, None).values


def read_nodes(path: str | Path, size: int, freedoms: IntegerArray | None = None) -> Nodes:
    """Read the nodes of a structure whose matrices have `size` rows.

    From a table or an input file of a finite element program (docs/file-formats.md). Freedoms (n,
    2), node and direction of each row, where the matrices name them; else the table says the rows,
    or they are three or six a node one after another. StructureError names the file and the node.
    """
    path = Path(path)
    stored: StoredNodes = _read(path, "nodes", lambda one: one.read_nodes)
    try:
        if freedoms is not None:
            return _nodes_of_freedoms(path, stored, freedoms)
        if stored.rows is None:
            return Nodes.in_order(stored.numbers, stored.coordinates, size)
        _refuse_rows_beyond(path, stored, size)
        return Nodes(stored.numbers, stored.coordinates, stored.rows)
    except StructureError as error:
        raise StructureError(str(error).replace("nodes:", f"{path}:", 1)) from error


def _read(
    path: Path, content: Content, reader: Callable[[Format], Callable[[Path], Stored]]
) -> Stored:
    try:
        return reader(format_of(path, content))(path)
    except MeasurementError as error:
        raise StructureError(str(error)) from error
    except Exception as error:  # the libraries raise nearly anything on a broken file
        raise StructureError(f"{path}: {content} cannot be read: {error}") from error


def _stored(path: str | Path, quantity: MatrixQuantity | None, name: str | None) -> StoredMatrix:
    """Matrix of a file by its name or by what it is, checked."""
    path = Path(path)
    held = _read(path, "matrices", lambda one: one.read_matrices)
    chosen = _chosen(path, held, quantity, name)
    try:
        require_square(path, chosen.values.shape)
    except MeasurementError as error:
        raise StructureError(str(error)) from error
    values = _checked(_whole(chosen.values), path, _titles(chosen.freedoms))
    return dataclasses.replace(chosen, values=values)


def _chosen(
    path: Path, held: Sequence[StoredMatrix], quantity: MatrixQuantity | None, name: str | None
) -> StoredMatrix:
    if name is not None:
        found = [one for one in held if one.name.upper() == name.upper()]
    elif len(held) == 1:
        found = [one for one in held if quantity is None or one.quantity in (None, quantity)]
    else:
        found = [one for one in held if one.quantity == quantity]
    if len(found) == 1:
        return found[0]
    there = ", ".join(
        f'"{one.name}"' + (f" ({one.quantity})" if one.quantity else "") for one in held
    )
    if name is not None:
        raise StructureError(f'{path}: has no matrix "{name}"; there is {there}')
    if len(held) == 1:
        raise StructureError(f"{path}: holds {held[0].quantity}; {quantity} is to be read from it")
    raise StructureError(
        f"{path}: holds {there}; say by its name which one is the {quantity or 'matrix'}"
    )


def _common_freedoms(
    paths: Mapping[str, str | Path], stored: Mapping[str, StoredMatrix]
) -> IntegerArray | None:
    """Freedoms of all matrices (n, 2), or None where rows have the same numbers in all."""
    named = {quantity: one.freedoms is not None for quantity, one in stored.items()}
    if not any(named.values()):
        size = stored["mass"].values.shape[0]
        for quantity, one in stored.items():
            if one.values.shape[0] != size:
                raise StructureError(
                    f"{paths[quantity]}: {one.values.shape[0]} rows; {paths['mass']} has {size}, "
                    "and both must be the same"
                )
        return None
    if not all(named.values()):
        first, second = (next(q for q, is_so in named.items() if is_so == so) for so in (1, 0))
        raise StructureError(
            f"{paths[first]} names the freedoms of its rows, {paths[second]} does not; write both "
            "in one format"
        )
    return np.unique(np.vstack([one.freedoms for one in stored.values()]), axis=0)


def _spread(stored: StoredMatrix, freedoms: IntegerArray | None) -> Matrix:
    """Matrix over all freedoms: zero where the file has none."""
    if freedoms is None or len(freedoms) == len(stored.freedoms):
        return stored.values
    place = {tuple(freedom): row for row, freedom in enumerate(freedoms.tolist())}
    rows = np.array([place[tuple(freedom)] for freedom in stored.freedoms.tolist()])
    entries = scipy.sparse.coo_array(stored.values)
    shape = (len(freedoms), len(freedoms))
    return scipy.sparse.csr_array((entries.data, (rows[entries.row], rows[entries.col])), shape)


def _titles(freedoms: IntegerArray | None) -> Callable[[int], str]:
    """Row of a matrix, from 0, in words."""
    if freedoms is None:
        return lambda row: f"row {row + 1}"
    return lambda row: freedom_title(freedoms[row])


def _nodes_of_freedoms(path: Path, stored: StoredNodes, freedoms: IntegerArray) -> Nodes:
    if stored.rows is not None:
        raise StructureError(
            f"{path}: says rows (ux, uy, ...), and the matrices name their freedoms themselves; "
            "leave these columns out"
        )
    index = {int(number): place for place, number in enumerate(stored.numbers)}
    missing = sorted({int(n) for n, direction in freedoms if direction and int(n) not in index})
    if missing:
        shown = ", ".join(str(node) for node in missing[:_SHOWN])
        further = f" and {len(missing) - _SHOWN} more" if len(missing) > _SHOWN else ""
        raise StructureError(f"{path}: lacks node {shown}{further}, which the matrices have")
    rows = np.full((len(stored.numbers), 6), -1, dtype=np.int64)
    for row, (node, direction) in enumerate(freedoms.tolist()):
        if direction:
            rows[index[node], direction - 1] = row
    there = np.any(rows >= 0, axis=1)
    return Nodes(stored.numbers[there], stored.coordinates[there], rows[there])


def _refuse_rows_beyond(path: Path, stored: StoredNodes, size: int) -> None:
    if np.any(stored.rows >= size):
        node, part = np.argwhere(stored.rows >= size)[0]
        raise StructureError(
            f"{path}: node {stored.numbers[node]}: {ROW_COLUMNS[part]} is "
            f"{stored.rows[node, part] + 1}; rows are 1 to {size}"
        )


def _real(matrix: Matrix, path: Path) -> Matrix:
    """Real part of a complex matrix without an imaginary one."""
    if abs(matrix.imag).max() > 0.0:
        raise StructureError(
            f"{path}: is complex; give its real part, and damping as a matrix of its own or in the "
            "machine file (damping_ratio)"
        )
    return matrix.real


def _whole(matrix: Matrix) -> Matrix:
    """Both triangles of a matrix of which a program wrote one.

    No structure has a matrix of one triangle: it would not be symmetric.
    """
    if scipy.sparse.issparse(matrix):
        lower, upper = scipy.sparse.tril(matrix, -1), scipy.sparse.triu(matrix, 1)
        one_sided = (lower.count_nonzero() == 0) != (upper.count_nonzero() == 0)
        return scipy.sparse.csr_array(matrix + (lower + upper).T) if one_sided else matrix
    whole = np.asarray(matrix)
    lower, upper = np.tril(whole, -1), np.triu(whole, 1)
    return whole + (lower + upper).T if np.any(lower) != np.any(upper) else whole


def _checked(matrix: Matrix, path: Path, title: Callable[[int], str]) -> Matrix:
    if np.issubdtype(matrix.dtype, np.complexfloating):
        matrix = _real(matrix, path)
    if not np.issubdtype(matrix.dtype, np.integer) and not np.issubdtype(matrix.dtype, np.floating):
        raise StructureError(f"{path}: has entries of type {matrix.dtype}; they must be real")
    sparse = scipy.sparse.csr_array(matrix, dtype=np.float64)
    entries = scipy.sparse.coo_array(sparse)
    for row, column, value in _where(entries, ~np.isfinite(entries.data)):
        raise StructureError(f"{path}: {_entry(title, row, column)} is {value}")
    unequal = scipy.sparse.coo_array(sparse - sparse.T)
    scale = np.sqrt(np.abs(sparse.diagonal()))
    limit = UNSYMMETRIC * scale[unequal.row] * scale[unequal.col] + 1e-14 * np.max(scale) ** 2
    for row, column, _ in _where(unequal, np.abs(unequal.data) > limit):
        raise StructureError(
            f"{path}: not symmetric: {_entry(title, row, column)} is {sparse[row, column]:g}, "
            f"{_entry(title, column, row)} is {sparse[column, row]:g}"
        )
    return symmetrised(sparse if scipy.sparse.issparse(matrix) else np.asarray(matrix, np.float64))


def _entry(title: Callable[[int], str], row: int, column: int) -> str:
    return f"{title(row)}, {title(column).replace('row', 'column', 1)}"


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
