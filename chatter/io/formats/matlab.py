"""MAT files of MATLAB: version 4 to 7 by scipy, version 7.3 (HDF5) by h5py."""

import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from chatter.io.files import read_content
from chatter.io.formats.format import Format
from chatter.io.formats.frf_columns import frfs_of_table
from chatter.io.formats.named_arrays import require_size, table_of_arrays
from chatter.io.table import Table
from dynamics.frf.container import MeasurementError

_HDF5 = b"\x89HDF\r\n\x1a\n"
#: how deep structures of structures are followed
_DEPTH = 4
#: type of a compressed data element of version 5, and bytes unpacked at a time
_COMPRESSED, _BLOCK = 15, 2**20


def read_variables(path: Path) -> Table:
    """Numeric variables and fields of structures, a column each; the columns of a matrix.

    MeasurementError if the file is no MAT file that is read, too large, h5py is not installed
    where it is needed, or the variables differ in length.
    """
    head = read_content(path, 1024)
    is_hdf5 = head.startswith((b"MATLAB 7.3", _HDF5)) or head[512:520] == _HDF5
    arrays = _of_hdf5(path) if is_hdf5 else _of_version_5(path)
    return table_of_arrays(path, arrays)


def _of_version_5(path: Path) -> dict[str, np.ndarray]:
    try:
        shapes = [shape for _, shape, _ in scipy.io.whosmat(path)]
        require_size(path, 8.0 * sum(float(np.prod(shape, dtype=float)) for shape in shapes))
        _require_unpacked_size(path)
        content = scipy.io.loadmat(path)
    except MeasurementError:
        raise
    except Exception as error:  # whatever the library raises on a broken file
        raise MeasurementError(f"{path}: is no MAT file that can be read: {error}") from error
    variables = {name: one for name, one in content.items() if not name.startswith("__")}
    return dict(_leaves(variables))


def _require_unpacked_size(path: Path) -> None:
    """Unpack the compressed variables of version 5, block by block, as far as is allowed.

    Shapes alone do not bound them: those of a structure say nothing about its fields. Source:
    MathWorks, MAT-File Format, data element of type miCOMPRESSED.
    """
    content = read_content(path)
    order = {b"IM": "<", b"MI": ">"}.get(content[126:128])
    unpacked, position = 0, 128
    while order is not None and position + 8 <= len(content):
        kind, size = struct.unpack_from(f"{order}II", content, position)
        packed = content[position + 8 : position + 8 + size]
        position += 8 + size
        if kind != _COMPRESSED:
            continue
        inflation = zlib.decompressobj()
        while packed and not inflation.eof:
            unpacked += len(inflation.decompress(packed, _BLOCK))
            require_size(path, float(unpacked))
            packed = inflation.unconsumed_tail


def _leaves(variables: dict[str, Any], depth: int = 0) -> Iterator[tuple[str, np.ndarray]]:
    """Arrays of numbers of variables, and of the fields of single structures, by dotted name."""
    for name, value in variables.items():
        if not isinstance(value, np.ndarray):
            continue
        if value.dtype.names is None:
            yield name, value
        elif value.size == 1 and depth < _DEPTH:
            fields = value.ravel()[0]
            inner = {f"{name}.{field}": fields[field] for field in value.dtype.names}
            yield from _leaves(inner, depth + 1)


def _of_hdf5(path: Path) -> dict[str, np.ndarray]:
    try:
        import h5py
    except ImportError as error:
        raise MeasurementError(
            f'{path}: MAT files of version 7.3 are read with h5py: install "chatter[formats]", '
            "or save with -v7"
        ) from error
    try:
        with h5py.File(path, "r") as file:
            found = dict(_datasets(h5py, file, ""))
            require_size(path, 8.0 * sum(float(one.size) for one in found.values()))
            return {name: _numbers(one) for name, one in found.items()}
    except MeasurementError:
        raise
    except Exception as error:  # whatever the library raises on a broken file
        raise MeasurementError(f"{path}: is no MAT file that can be read: {error}") from error


def _datasets(h5py: Any, group: Any, prefix: str, depth: int = 0) -> Iterator[tuple[str, Any]]:
    """Datasets of the file itself; links to other files are not followed."""
    for name in group:
        is_here = isinstance(group.get(name, getlink=True), h5py.HardLink)
        if not is_here or name.startswith("#"):
            continue
        item = group[name]
        if isinstance(item, h5py.Group):
            if depth < _DEPTH and "MATLAB_sparse" not in item.attrs:
                yield from _datasets(h5py, item, f"{prefix}{name}.", depth + 1)
        elif not (item.external or item.is_virtual or _is_text(item)):
            yield f"{prefix}{name}", item


def _is_text(dataset: Any) -> bool:
    kind = dataset.attrs.get("MATLAB_class", b"")
    return kind not in (b"", b"double", b"single") and not bytes(kind).startswith((b"int", b"uint"))


def _numbers(dataset: Any) -> np.ndarray:
    """Array as MATLAB has it: HDF5 holds it transposed, complex numbers as two fields."""
    values = dataset[()]
    if getattr(values.dtype, "names", None) == ("real", "imag"):
        values = values["real"] + 1j * values["imag"]
    return np.asarray(values).T


MATLAB = Format(
    name="matlab",
    label="MAT of MATLAB",
    help="numeric variables and fields of structures, such as `force_N`; matrices with "
    '"--columns"; a number `fs` gives the time; version 7.3 needs "chatter[formats]"',
    extensions=(".mat",),
    read_frfs=lambda path: frfs_of_table(read_variables(path)),
    read_signals=read_variables,
    recognises=lambda head: head.startswith((b"MATLAB 5.0 MAT", b"MATLAB 7.3 MAT")),
)
