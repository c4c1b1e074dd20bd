"""Ansys: matrices of a `.full` file, nodes of the `NBLOCK` of a `.cdb` file.

Matrices are read by `ansys-mapdl-reader`, an extra; without it Ansys writes Matrix Market
(`*SMAT` and `*EXPORT,,MMF`), which needs none.
"""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import numpy as np
import scipy

from chatter.io.files import read_lines
from chatter.io.formats.format import Format
from chatter.io.formats.model_parts import StoredMatrix, StoredNodes
from dynamics.frf.container import MeasurementError

_LAYOUT = re.compile(r"\((\d+)i(\d+),(\d+)e(\d+)", re.IGNORECASE)


def read_matrices(path: Path) -> list[StoredMatrix]:
    """Mass and stiffness of a `.full` file; freedoms that Ansys holds are left out.

    MeasurementError if the library is missing, the file cannot be read, or it has freedoms other
    than displacements and rotations.
    """
    try:
        from ansys.mapdl.reader import read_binary
    except ImportError as error:
        raise MeasurementError(
            f'{path}: needs pip install "chatter[ansys]", or export Matrix Market from Ansys '
            "(*SMAT, *EXPORT,,MMF)"
        ) from error
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            file = read_binary(str(path))
            reference, stiffness, mass = file.load_km(sort=True)
        except Exception as error:  # whatever the library raises on a broken file
            raise MeasurementError(f"{path}: is no .full file that can be read: {error}") from error
    if mass is None or stiffness is None:
        raise MeasurementError(
            f"{path}: lacks mass or stiffness; write it in a modal analysis (ANTYPE,MODAL)"
        )
    freedoms = np.column_stack([reference[:, 0], reference[:, 1] + 1]).astype(np.int64)
    if np.any(freedoms[:, 1] > 6):
        raise MeasurementError(f"{path}: has freedoms other than displacements and rotations")
    free = np.flatnonzero(stiffness.diagonal() != 0.0)
    whole = {"stiffness": stiffness, "mass": mass}
    return [
        StoredMatrix(_both_triangles(matrix)[free][:, free], freedoms[free], name, name)
        for name, matrix in whole.items()
    ]


def read_nodes(path: Path) -> StoredNodes:
    """Nodes of the `NBLOCK` of a file that `CDWRITE` wrote.

    MeasurementError if there is none, it is malformed, or a node has turned axes.
    """
    lines = read_lines(path)
    begins = [k for k, line in enumerate(lines) if line.upper().startswith("NBLOCK")]
    layout = _LAYOUT.match(lines[begins[0] + 1].strip()) if begins else None
    if layout is None:
        raise MeasurementError(f"{path}: has no nodes (NBLOCK with its format below)")
    integers, width, _, wide = (int(part) for part in layout.groups())
    numbers, coordinates = [], []
    for place, line in enumerate(lines[begins[0] + 2 :], start=begins[0] + 3):
        if line.upper().startswith("N,") or line.strip() in ("-1", ""):
            break
        start = integers * width
        cells = [line[k : k + wide] for k in range(start, len(line.rstrip()), wide)]
        try:
            numbers.append(int(line[:width]))
            values = [float(cell) for cell in cells]
        except ValueError:
            raise MeasurementError(f"{path}, line {place}: is no node: {line.strip()}") from None
        if any(values[3:]):
            raise MeasurementError(
                f"{path}, line {place}: node {numbers[-1]} has turned axes (NROTAT); write "
                "matrices in the global ones"
            )
        coordinates.append([*values[:3], *[0.0] * (3 - len(values[:3]))])
    if not numbers:
        raise MeasurementError(f"{path}: its NBLOCK has no nodes")
    return StoredNodes(np.array(numbers, dtype=np.int64), np.array(coordinates))


def _both_triangles(upper: scipy.sparse.csc_matrix) -> scipy.sparse.csr_array:
    upper = scipy.sparse.csr_array(upper)
    return scipy.sparse.csr_array(upper + scipy.sparse.triu(upper, 1).T)


ANSYS_FULL = Format(
    name="ansys-full",
    label="Ansys matrices",
    help='mass and stiffness of a modal analysis; needs "chatter[ansys]"',
    extensions=(".full",),
    read_matrices=read_matrices,
)
ANSYS_ARCHIVE = Format(
    name="ansys-archive",
    label="Ansys archive",
    help="nodes of `NBLOCK`, as `CDWRITE` writes it",
    extensions=(".cdb",),
    read_nodes=read_nodes,
)
