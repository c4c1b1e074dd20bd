"""What files of finite element programs hold: matrices, and the nodes that their rows belong to."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import scipy

from chatter.description.arrays import Array, IntegerArray
from dynamics.frf.container import MeasurementError
from dynamics.structure.linear_structure import Matrix
from dynamics.structure.rigid_body_motion import DIRECTIONS

MatrixQuantity = Literal["mass", "stiffness", "damping"]
#: more rows than a desk computer can factorise
MOST_ROWS = 5_000_000


@dataclass(frozen=True, eq=False)
class StoredMatrix:
    """Matrix of a file, and which freedom each of its rows is where the file says so."""

    values: Matrix  # (n, n), both triangles
    #: (n, 2), node and direction (1 to 3 displacements, 4 to 6 rotations, 0 a scalar), ascending
    freedoms: IntegerArray | None = None
    name: str = ""  # in the file
    quantity: MatrixQuantity | None = None  # where the file tells


@dataclass(frozen=True, eq=False)
class StoredNodes:
    """Nodes of a file."""

    numbers: IntegerArray  # (m,)
    coordinates: Array  # (m, 3), in the file's unit of length
    #: (m, 6), row of the matrices, from 0, -1 for none; None where the file does not say
    rows: IntegerArray | None = None


def freedom_title(freedom: Sequence[int]) -> str:
    """Freedom in words: "node 12 x"."""
    node, direction = (int(part) for part in freedom)
    return f"node {node} {DIRECTIONS[direction - 1]}" if direction else f"scalar point {node}"


def symmetric_from_entries(
    path: Path,
    rows: Iterable[tuple[int, int]],
    columns: Iterable[tuple[int, int]],
    values: Iterable[float],
) -> tuple[scipy.sparse.csr_array, IntegerArray]:
    """Matrix of entries by node and direction, and its freedoms (n, 2), ascending.

    An entry that stands on one side of the diagonal alone counts on both; a matrix with both is
    taken as it is. MeasurementError if an entry is there twice.
    """
    ends = np.vstack([np.reshape(list(one), (-1, 2)) for one in (rows, columns)]).astype(np.int64)
    freedoms, places = np.unique(ends, axis=0, return_inverse=True)
    row, column = np.reshape(places, (2, -1))
    entries = np.fromiter(values, dtype=np.float64, count=len(row))
    return mirrored(path, row, column, entries, len(freedoms), freedoms), freedoms


def mirrored(
    path: Path,
    row: IntegerArray,
    column: IntegerArray,
    entries: Array,
    size: int,
    freedoms: IntegerArray | None = None,
) -> scipy.sparse.csr_array:
    """Matrix (size, size) of entries that may stand on one side of the diagonal alone."""
    if size > MOST_ROWS:
        raise MeasurementError(f"{path}: has {size} rows; at most {MOST_ROWS} are read")
    place = row * size + column
    _, first, counts = np.unique(place, return_index=True, return_counts=True)
    if np.any(counts > 1):
        twice = first[np.argmax(counts > 1)]
        ends = [int(row[twice]), int(column[twice])]
        shown = [f"{end + 1}" if freedoms is None else freedom_title(freedoms[end]) for end in ends]
        raise MeasurementError(f"{path}: the entry {shown[0]}, {shown[1]} is there twice")
    off = row != column
    one_sided = not np.any(np.isin(column[off] * size + row[off], place[off]))
    if one_sided:
        row, column = np.append(row, column[off]), np.append(column, row[off])
        entries = np.append(entries, entries[off])
    return scipy.sparse.csr_array((entries, (row, column)), shape=(size, size))
