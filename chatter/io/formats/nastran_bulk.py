"""Nastran bulk data: matrices in DMIG entries, nodes in GRID entries.

Nastran writes DMIG to its punch file (`PARAM,EXTOUT,DMIGPCH`, `EXTSEOUT(DMIGPCH)`). Entries of
small field (8 columns), large field (16) and free field (commas) are read; others are passed over.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from chatter.io.files import read_lines
from chatter.io.formats.format import Format
from chatter.io.formats.model_parts import (
    MatrixQuantity,
    StoredMatrix,
    StoredNodes,
    symmetric_from_entries,
)
from dynamics.frf.container import MeasurementError

#: "1.5-3" for 1.5e-3, as Nastran writes it
_SHORT_EXPONENT = re.compile(r"(?<=[\d.])([+-]\d+)$")
#: first letters of the names that Nastran gives its matrices
_QUANTITIES: dict[str, MatrixQuantity] = {"K": "stiffness", "M": "mass", "B": "damping"}
#: beginning of an entry that is read, in a file of any extension
_ENTRY = re.compile(rb"(?im)^(?:GRID\*?[ ,]\s*\d|DMIG\*?[ ,]\s*[A-Z])")
_SYMMETRIC, _SQUARE = 6, 1
_REAL = (1, 2)

#: line number, name of the entry, fields
Entry = tuple[int, str, list[str]]


def read_matrices(path: Path) -> list[StoredMatrix]:
    """Real square matrices of the DMIG entries of a file.

    MeasurementError if there are none, or one is malformed; others (of shapes, loads, complex ones)
    are passed over.
    """
    left_out: dict[str, str] = {}  # by name: why; "" for those that are read
    cells: dict[str, list[tuple]] = defaultdict(list)
    for line, entry, fields in _entries(path, ("DMIG",)):
        name = fields[0].upper()
        if _whole(path, line, entry, fields[1]) == 0:
            left_out[name] = _why_left_out(path, line, fields)
            continue
        if name not in left_out:
            raise MeasurementError(
                f"{path}, line {line}: DMIG {name} has a column but no header (DMIG,{name},0,...)"
            )
        if left_out[name]:
            continue
        column = (_whole(path, line, entry, fields[1]), _whole(path, line, entry, fields[2]))
        for start in range(4, len(fields), 4):
            quad = [*fields[start : start + 4], "", ""]
            if quad[0]:
                row = (_whole(path, line, entry, quad[0]), _whole(path, line, entry, quad[1]))
                cells[name].append((row, column, _real(path, line, quad[2])))
    if not cells:
        why = "; ".join(f"DMIG {name} is {reason}" for name, reason in left_out.items() if reason)
        raise MeasurementError(
            f"{path}: has no DMIG entries of a real square matrix" + (f"; {why}" if why else "")
        )
    return [
        StoredMatrix(*symmetric_from_entries(path, *zip(*of, strict=True)), name, quantity_of(name))
        for name, of in cells.items()
    ]


def read_nodes(path: Path) -> StoredNodes:
    """Nodes of the GRID entries of a file.

    MeasurementError if there are none, or one has coordinate systems of its own.
    """
    numbers, coordinates = [], []
    for line, entry, fields in _entries(path, ("GRID", "GRDSET")):
        fields = [*fields, *[""] * 8]
        if any(_whole(path, line, entry, fields[place]) for place in (1, 5)):
            raise MeasurementError(
                f"{path}, line {line}: {entry} {fields[0]} has a coordinate system of its own; "
                "write nodes and displacements in the basic one"
            )
        if entry == "GRID":
            numbers.append(_whole(path, line, entry, fields[0]))
            coordinates.append([_real(path, line, one) for one in fields[2:5]])
    if not numbers:
        raise MeasurementError(f"{path}: has no GRID entries")
    return StoredNodes(np.array(numbers, dtype=np.int64), np.array(coordinates))


def quantity_of(name: str) -> MatrixQuantity | None:
    """What a matrix is by the name that Nastran gives it."""
    # K4 is structural damping
    return None if name.startswith("K4") else _QUANTITIES.get(name[0])


def _why_left_out(path: Path, line: int, fields: list[str]) -> str:
    form, kind = (_whole(path, line, "DMIG", fields[place]) for place in (2, 3))
    if form not in (_SYMMETRIC, _SQUARE):
        return f"of form {form}, not {_SYMMETRIC} (symmetric) or {_SQUARE} (square)"
    return "" if kind in _REAL else "complex"


def _entries(path: Path, names: tuple[str, ...]) -> Iterator[Entry]:
    """Entries of some names, with their continuations."""
    begun: Entry | None = None
    wide = False
    for line, text in enumerate(read_lines(path), start=1):
        text = text.split("$", 1)[0].expandtabs(8).rstrip()
        if not text.strip():
            continue
        first, fields = _fields(text, wide)
        if not first or first[0] in "+*":
            if begun is not None:
                begun[2].extend(fields)
            continue
        if begun is not None:
            yield begun
        name = first.rstrip("*").upper()
        wide = first.endswith("*")
        begun = (line, name, _fields(text, wide)[1]) if name in names else None
    if begun is not None:
        yield begun


def _fields(text: str, wide: bool) -> tuple[str, list[str]]:
    """First field of a line, and its data fields: four wide ones or eight."""
    if "," in text:
        first, *fields = (field.strip() for field in text.split(","))
        wide = wide or first.endswith("*")
    else:
        first = text[:8].strip()
        wide = wide or first[:1] == "*" or first.endswith("*")
        width = 16 if wide else 8
        fields = [text[start : start + width].strip() for start in range(8, 72, width)]
    count = 4 if wide else 8
    return first, [*fields[:count], *[""] * (count - len(fields))]


def _whole(path: Path, line: int, entry: str, text: str) -> int:
    try:
        return int(text or 0)
    except ValueError:
        raise MeasurementError(
            f'{path}, from line {line}: {entry} has "{text}" where a whole number belongs'
        ) from None


def _real(path: Path, line: int, text: str) -> float:
    plain = text.upper().replace("D", "E")
    if "E" not in plain:
        plain = _SHORT_EXPONENT.sub(r"E\1", plain)
    try:
        return float(plain or 0.0)
    except ValueError:
        raise MeasurementError(
            f'{path}, from line {line}: "{text}" stands where a number belongs'
        ) from None


NASTRAN_BULK = Format(
    name="nastran",
    label="Nastran bulk data",
    help="matrices in DMIG entries, as in punch files; nodes in GRID entries, basic coordinates",
    extensions=(".pch", ".bdf", ".nas", ".dmig", ".dat", ".blk"),
    read_matrices=read_matrices,
    read_nodes=read_nodes,
    recognises=lambda head: _ENTRY.search(head) is not None,
)
