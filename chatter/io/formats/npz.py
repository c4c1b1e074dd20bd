"""NumPy archives: signals and FRFs as arrays by name, matrices dense or sparse."""

from __future__ import annotations

import struct
import tokenize
import zipfile
import zlib
from pathlib import Path
from typing import BinaryIO

import numpy as np
import scipy

from chatter.io.formats.format import Format
from chatter.io.formats.frf_columns import frfs_of_table
from chatter.io.formats.matrix_market import require_square
from chatter.io.formats.model_parts import MatrixQuantity, StoredMatrix
from chatter.io.formats.named_arrays import require_size, table_of_arrays
from chatter.io.table import Table
from dynamics.frf.container import MeasurementError

#: what NumPy, zipfile and zlib raise on a damaged archive: codecs and passwords that are none, too
_FAULTS = (
    *(OSError, ValueError, EOFError, KeyError, MemoryError, RuntimeError, SyntaxError),
    *(zipfile.BadZipFile, zlib.error, struct.error, tokenize.TokenError),
)

#: names of arrays in lower case, and what they are; others say it in the machine file
_QUANTITIES: dict[str, MatrixQuantity] = {
    **dict.fromkeys(("m", "mass", "mass_matrix"), "mass"),
    **dict.fromkeys(("k", "stiffness", "stiffness_matrix"), "stiffness"),
    **dict.fromkeys(("c", "d", "b", "damping", "damping_matrix"), "damping"),
}
#: what the file of a single array begins with
_ARRAY = b"\x93NUMPY"


def read_columns(path: Path) -> Table:
    """Arrays of an archive by name; a complex one as its real and imaginary part.

    MeasurementError if the file is no archive of arrays, unpacks to too much, or their lengths
    differ.
    """
    try:
        # NumPy leaves a file that it opened itself open where the archive is damaged
        with path.open("rb") as file:
            _require_archive(path, file)
            with np.load(file, allow_pickle=False) as content:
                require_size(path, float(sum(one.file_size for one in content.zip.infolist())))
                arrays = {name: content[name] for name in content.files}
    except MeasurementError:
        raise
    except _FAULTS as error:
        raise MeasurementError(f"{path}: cannot be read: {error}") from error
    return table_of_arrays(path, arrays)


def _require_archive(path: Path, file: BinaryIO) -> None:
    """MeasurementError if an open file is a single array, or nothing of NumPy; at its start then.

    NumPy itself takes anything else for a pickle, and says how to load that.
    """
    if file.read(len(_ARRAY)) == _ARRAY:
        raise MeasurementError(f"{path}: holds one array; save them by name with numpy.savez")
    if not zipfile.is_zipfile(file):
        raise MeasurementError(f"{path}: cannot be read: it is no NumPy archive, or a damaged one")
    file.seek(0)


def read_matrices(path: Path) -> list[StoredMatrix]:
    """Matrix of `scipy.sparse.save_npz`, or the plain square arrays of an archive by their names.

    MeasurementError if there is none; what is no square array beside others is passed over.
    """
    with path.open("rb") as file, zipfile.ZipFile(file) as archive:
        require_size(path, float(sum(one.file_size for one in archive.infolist())))
        names = [Path(name).stem for name in archive.namelist()]
        file.seek(0)
        arrays = np.load(file, allow_pickle=False)
        if "format" not in names:
            return _plain_arrays(path, {name: arrays[name] for name in arrays.files})
        require_square(path, tuple(arrays["shape"]))
        file.seek(0)
        matrix = scipy.sparse.load_npz(file)
        if hasattr(matrix, "check_format"):
            matrix.check_format(full_check=True)
        return [StoredMatrix(matrix)]


def _plain_arrays(path: Path, arrays: dict[str, object]) -> list[StoredMatrix]:
    """Square arrays of an archive; one that is alone is what it is taken for."""
    plain = {name: one for name, one in arrays.items() if isinstance(one, np.ndarray)}
    if len(arrays) == 1 and plain:
        return [StoredMatrix(*plain.values())]
    square = {
        name: one for name, one in plain.items() if one.ndim == 2 and one.shape[0] == one.shape[1]
    }
    if not square:
        there = ", ".join(arrays) or "nothing"
        raise MeasurementError(f"{path}: has no square array; there is {there}")
    return [
        StoredMatrix(one, name=name, quantity=_QUANTITIES.get(name.lower()))
        for name, one in square.items()
    ]


NPZ = Format(
    name="npz",
    label="NumPy archive",
    help='arrays by name and unit, such as "time [s]"; FRFs may be complex; matrices by '
    "`scipy.sparse.save_npz`, or plain arrays by name (M, K, C)",
    extensions=(".npz",),
    read_frfs=lambda path: frfs_of_table(read_columns(path)),
    read_signals=read_columns,
    read_matrices=read_matrices,
)
