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
from chatter.io.formats.model_parts import StoredMatrix
from chatter.io.formats.named_arrays import require_size, table_of_arrays
from chatter.io.table import Table
from dynamics.frf.container import MeasurementError

#: what NumPy, zipfile and zlib raise on a damaged archive: codecs and passwords that are none, too
_FAULTS = (
    *(OSError, ValueError, EOFError, KeyError, MemoryError, RuntimeError, SyntaxError),
    *(zipfile.BadZipFile, zlib.error, struct.error, tokenize.TokenError),
)

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
    """Matrix of `scipy.sparse.save_npz`, or the one plain array of an archive."""
    with path.open("rb") as file, zipfile.ZipFile(file) as archive:
        require_size(path, float(sum(one.file_size for one in archive.infolist())))
        names = [Path(name).stem for name in archive.namelist()]
        file.seek(0)
        arrays = np.load(file, allow_pickle=False)
        if "format" not in names:
            if len(names) != 1 or not isinstance(arrays[arrays.files[0]], np.ndarray):
                raise MeasurementError(f"{path}: has {', '.join(names)}; it must have one array")
            return [StoredMatrix(arrays[arrays.files[0]])]
        require_square(path, tuple(arrays["shape"]))
        file.seek(0)
        matrix = scipy.sparse.load_npz(file)
        if hasattr(matrix, "check_format"):
            matrix.check_format(full_check=True)
        return [StoredMatrix(matrix)]


NPZ = Format(
    name="npz",
    label="NumPy archive",
    help='arrays by name and unit, such as "time [s]"; FRFs may be complex; matrices by '
    "`scipy.sparse.save_npz`, or one plain array",
    extensions=(".npz",),
    read_frfs=lambda path: frfs_of_table(read_columns(path)),
    read_signals=read_columns,
    read_matrices=read_matrices,
)
