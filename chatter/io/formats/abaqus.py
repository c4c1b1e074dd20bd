"""Abaqus: global matrices of `*MATRIX OUTPUT`, nodes of an input file."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from chatter.description.arrays import Array
from chatter.io.files import read_lines
from chatter.io.formats.format import Format
from chatter.io.formats.model_parts import (
    MatrixQuantity,
    StoredMatrix,
    StoredNodes,
    freedom_title,
    mirrored,
    symmetric_from_entries,
)
from dynamics.frf.container import MeasurementError

#: what Abaqus puts on the diagonal where a boundary condition holds a freedom
_HELD = 1e36
#: ends of the names of the files that Abaqus writes, before their number
_QUANTITIES: dict[str, MatrixQuantity] = {"_MASS": "mass", "_STIF": "stiffness", "_DMPV": "damping"}
_BY_NODE, _BY_ROW = 5, 3


def read_matrices(path: Path) -> list[StoredMatrix]:
    """Matrix of `FORMAT=MATRIX INPUT` or `LABELS` (nodes and directions), or `COORDINATE` (rows).

    MeasurementError if it is of a substructure, has boundary conditions or internal nodes, or is
    malformed.
    """
    numbers = _numbers(path)
    stem = path.stem.upper().rstrip("0123456789")
    quantity = next((what for end, what in _QUANTITIES.items() if stem.endswith(end)), None)
    ends, entries = numbers[:, :-1].astype(np.int64), numbers[:, -1]
    if np.any(ends != numbers[:, :-1]):
        raise MeasurementError(f"{path}: nodes, directions and rows must be whole numbers")
    _refuse_held(path, ends, entries)
    if numbers.shape[1] == _BY_ROW:
        if np.any(ends < 1):
            raise MeasurementError(f"{path}: rows and columns begin at 1")
        size = int(ends.max())
        matrix = mirrored(path, ends[:, 0] - 1, ends[:, 1] - 1, entries, size)
        return [StoredMatrix(matrix, quantity=quantity)]
    nodes, directions = ends[:, ::2], ends[:, 1::2]
    if np.any(nodes < 1):
        raise MeasurementError(
            f"{path}: node {nodes[nodes < 1][0]} is an internal one (a coupling, a contact or a "
            "Lagrange multiplier); leave these out of the model and tie points here"
        )
    if np.any((directions < 1) | (directions > 6)):
        wrong = directions[(directions < 1) | (directions > 6)][0]
        raise MeasurementError(f"{path}: direction {wrong}; displacements and rotations are 1 to 6")
    return [
        StoredMatrix(
            *symmetric_from_entries(path, ends[:, :2], ends[:, 2:], entries), quantity=quantity
        )
    ]


def read_nodes(path: Path) -> StoredNodes:
    """Nodes of the `*NODE` blocks of an input file.

    MeasurementError if there are none, an instance is moved, or there are several of them.
    """
    rows, instances = [], 0
    for line, keyword, cells in _data_lines(path):
        name = keyword.split(",")[0].strip().upper()
        if name == "*INSTANCE" and cells is not None:
            raise MeasurementError(
                f"{path}, line {line}: an instance is moved; write the input file without parts "
                "and assemblies, so that its nodes are those of the matrices"
            )
        instances += name == "*INSTANCE"
        if name == "*NODE" and cells is not None:
            if "SYSTEM" in keyword.upper().replace("=R", "="):
                raise MeasurementError(f"{path}, line {line}: nodes must be rectangular (SYSTEM=R)")
            rows.append(_node(path, line, cells))
    if instances > 1:
        raise MeasurementError(
            f"{path}: has {instances} instances, whose numbers of nodes repeat; write the input "
            "file without parts and assemblies"
        )
    if not rows:
        raise MeasurementError(f"{path}: has no nodes (*NODE)")
    numbers, coordinates = zip(*rows, strict=True)
    return StoredNodes(np.array(numbers, dtype=np.int64), np.array(coordinates))


def _data_lines(path: Path) -> Iterator[tuple[int, str, list[str] | None]]:
    """Line number, keyword line that holds, and the cells of a line of data or None."""
    keyword = ""
    for line, text in enumerate(read_lines(path), start=1):
        text = text.strip()
        if not text or text.startswith("**"):
            continue
        if text.startswith("*"):
            keyword = text
            yield line, keyword, None
        else:
            yield line, keyword, [cell.strip() for cell in text.split(",")]


def _node(path: Path, line: int, cells: list[str]) -> tuple[int, list[float]]:
    try:
        place = [float(cell or 0.0) for cell in cells[1:4]]
        return int(cells[0]), [*place, *[0.0] * (3 - len(place))]
    except ValueError:
        raise MeasurementError(
            f"{path}, line {line}: is no node (number, x, y, z): {', '.join(cells)}"
        ) from None


def _numbers(path: Path) -> Array:
    kept = []
    for text in read_lines(path):
        text = text.strip()
        if text.upper().replace(" ", "").startswith("*USERELEMENT"):
            raise MeasurementError(
                f"{path}: is the matrix of a substructure or an element; write global ones "
                "(*MATRIX GENERATE, *MATRIX OUTPUT, FORMAT=MATRIX INPUT)"
            )
        if text and not text.startswith("*"):
            kept.append(text.replace(",", " ").replace("D", "E").replace("d", "e"))
    try:
        numbers = np.loadtxt(io.StringIO("\n".join(kept)), ndmin=2) if kept else np.empty((0, 0))
    except ValueError as error:
        raise MeasurementError(f"{path}: is no matrix of Abaqus: {error}") from error
    if numbers.shape[1] not in (_BY_NODE, _BY_ROW):
        raise MeasurementError(
            f"{path}: is no matrix of Abaqus; lines are node, direction, node, direction, entry "
            "or row, column, entry"
        )
    return numbers


def _refuse_held(path: Path, ends: Array, entries: Array) -> None:
    held = np.abs(entries) >= _HELD
    if np.any(held):
        first = ends[np.argmax(held)]
        where = freedom_title(first[:2]) if len(first) == _BY_NODE - 1 else f"row {first[0]}"
        raise MeasurementError(
            f"{path}: {where} is held by a boundary condition ({_HELD:g} on the diagonal, "
            f"{np.sum(held)} in all); write the matrices of the free part"
        )


ABAQUS_MATRIX = Format(
    name="abaqus-matrix",
    label="Abaqus matrix",
    help="global matrices of `*MATRIX OUTPUT`: `FORMAT=MATRIX INPUT`, `LABELS` or `COORDINATE`",
    extensions=(".mtx",),
    read_matrices=read_matrices,
)
ABAQUS_INPUT = Format(
    name="abaqus-input",
    label="Abaqus input",
    help="nodes of `*NODE`, of a file without parts and assemblies",
    extensions=(".inp",),
    read_nodes=read_nodes,
)
