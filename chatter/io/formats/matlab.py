"""MAT files of MATLAB: version 4 to 7 by scipy, version 7.3 (HDF5) by h5py."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from chatter.io.files import read_content
from chatter.io.formats.format import Format
from chatter.io.formats.frf_columns import frfs_of_tables
from chatter.io.formats.matlab_hdf5 import variables_of_hdf5
from chatter.io.formats.matlab_nodes import DEPTH, Node, require_count
from chatter.io.formats.matlab_records import tables_of_variables
from chatter.io.formats.matlab_size import require_unpacked_size
from chatter.io.formats.named_arrays import require_size
from chatter.io.formats.records import Tables, of_file, only_record
from dynamics.frf.container import MeasurementError

_HDF5 = b"\x89HDF\r\n\x1a\n"


def read_records(path: Path) -> Tables:
    """Numeric variables and fields of structures, a column each; the columns of a matrix.

    Structures of the same fields, and the elements of an array of structures, are a record each.
    MeasurementError if the file is no MAT file that is read, too large, h5py is not installed
    where it is needed, or the variables of a record differ in length.
    """
    head = read_content(path, 1024)
    is_hdf5 = head.startswith((b"MATLAB 7.3", _HDF5)) or head[512:520] == _HDF5
    variables = variables_of_hdf5(path) if is_hdf5 else _of_version_5(path)
    return of_file(path, tables_of_variables(path, variables))


def _of_version_5(path: Path) -> dict[str, Node]:
    try:
        shapes = [shape for _, shape, _ in scipy.io.whosmat(path)]
        require_size(path, 8.0 * sum(float(np.prod(shape, dtype=float)) for shape in shapes))
        require_unpacked_size(path)
        content = scipy.io.loadmat(path)
    except MeasurementError:
        raise
    except Exception as error:  # whatever the library raises on a broken file
        raise MeasurementError(f"{path}: is no MAT file that can be read: {error}") from error
    named = {name: one for name, one in content.items() if not name.startswith("__")}
    nodes = {name: _node(path, name, one) for name, one in named.items()}
    return {name: one for name, one in nodes.items() if one is not None}


def _node(path: Path, called: str, value: Any, depth: int = 0) -> Node | None:
    """Numbers, text, structure or list of elements; None of what is none of these."""
    # tables and other objects of MATLAB, which only it can read
    if not isinstance(value, np.ndarray) or isinstance(value, scipy.io.matlab.MatlabOpaque):
        return None
    if value.dtype.names is None and value.dtype.kind != "O":
        if value.dtype.kind not in "US":
            return value
        return str(value.ravel()[0]) if value.size == 1 else None
    if depth > DEPTH or value.size == 0:
        return None
    require_count(path, called, value.size)
    elements = value.ravel(order="F")
    if value.dtype.names is None:
        nodes = (_node(path, called, each, depth + 1) for each in elements)
        return [one for one in nodes if one is not None]
    structures = [_fields(path, one, value.dtype.names, depth) for one in elements]
    return structures[0] if value.size == 1 else structures


def _fields(path: Path, element: Any, names: Sequence[str], depth: int) -> dict[str, Node]:
    """Fields of a structure that hold numbers, text or structures."""
    nodes = {name: _node(path, name, element[name], depth + 1) for name in names}
    return {name: one for name, one in nodes.items() if one is not None}


MATLAB = Format(
    name="matlab",
    label="MAT of MATLAB",
    help="numeric variables and fields of structures, such as `force_N`; structures of the same "
    'fields are records, and matrices with a time; matrices with "--columns"; functions as Testlab '
    "exports them; a number `fs` gives the time; version 7.3 "
    'needs "chatter[formats]"',
    extensions=(".mat",),
    read_frfs=lambda path: frfs_of_tables(read_records(path)),
    read_signals=only_record(read_records),
    read_records=read_records,
    recognises=lambda head: head.startswith((b"MATLAB 5.0 MAT", b"MATLAB 7.3 MAT")),
)
