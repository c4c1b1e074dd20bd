"""Nastran: matrices of OP4 and OP2 files.

They are read by `pyNastran`, an extra; without it Nastran punches them (DMIG), which needs none.
Rows have no names there: the table of nodes says which freedom each of them is.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from chatter.io.formats.format import Format
from chatter.io.formats.model_parts import StoredMatrix
from chatter.io.formats.nastran_bulk import quantity_of
from dynamics.frf.container import MeasurementError


def read_matrices(path: Path) -> list[StoredMatrix]:
    """Square matrices of an OP4 or OP2 file by their names, with rows by number alone.

    MeasurementError if the library is missing, the file cannot be read, or holds none.
    """
    held = _matrices(path)
    named = [name for name, one in held.items() if getattr(one, "is_matpool", False)]
    square = {
        name: _compact(one.data)
        for name, one in held.items()
        if name not in named and one.data.shape[0] == one.data.shape[1]
    }
    if not square:
        pool = f"; {', '.join(named)} names nodes: punch it as DMIG" if named else ""
        there = ", ".join(held) or "nothing"
        raise MeasurementError(f"{path}: has no square matrix; there is {there}{pool}")
    return [
        StoredMatrix(one, name=name, quantity=quantity_of(name)) for name, one in square.items()
    ]


def _matrices(path: Path) -> Mapping[str, Any]:
    """Matrices of a file as the library has them, by name in capitals."""
    try:
        held = _read_op4(path) if path.suffix.lower() == ".op4" else _read_op2(path)
    except ImportError as error:
        raise MeasurementError(
            f'{path}: needs pip install "chatter[nastran]", or punch the matrices as DMIG'
        ) from error
    except Exception as error:  # whatever the library raises on a broken file
        raise MeasurementError(
            f"{path}: cannot be read by pyNastran ({error}); punch the matrices as DMIG"
        ) from error
    return {name.strip().upper(): one for name, one in held.items()}


def _read_op4(path: Path) -> Mapping[str, Any]:
    from pyNastran.op4.op4 import read_op4

    return read_op4(str(path))


def _read_op2(path: Path) -> Mapping[str, Any]:
    # pyNastran 1.4 cannot load this part of it beside NumPy 2.4 and later
    from pyNastran.op2.op2 import read_op2

    return read_op2(str(path), build_dataframe=False, debug=None).matrices


def _compact(matrix: Any) -> Any:
    return scipy.sparse.csr_array(matrix) if scipy.sparse.issparse(matrix) else np.asarray(matrix)


NASTRAN_OUTPUT = Format(
    name="nastran-output",
    label="Nastran matrices",
    help='matrices by name, rows by number; needs "chatter[nastran]"',
    extensions=(".op4", ".op2"),
    read_matrices=read_matrices,
)
