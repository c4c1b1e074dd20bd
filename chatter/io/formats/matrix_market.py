"""Matrices in Matrix Market files."""

from __future__ import annotations

import warnings
from pathlib import Path

import scipy

from chatter.io.formats.format import Format
from chatter.io.formats.model_parts import MOST_ROWS, StoredMatrix
from dynamics.frf.container import MeasurementError


def require_square(path: Path, shape: tuple[int, ...]) -> None:
    """Raise MeasurementError unless a matrix is square, of a size that can be worked with."""
    if len(shape) != 2 or shape[0] != shape[1] or not 1 <= shape[0] <= MOST_ROWS:
        size = " x ".join(str(length) for length in shape)
        raise MeasurementError(f"{path}: is {size}; it must be square, 1 to {MOST_ROWS} rows")


def read_matrices(path: Path) -> list[StoredMatrix]:
    """Real, integer or complex matrix, general or symmetric.

    MeasurementError if it is a pattern, or larger than its file.
    """
    rows, columns, _, layout, kind, symmetry = scipy.io.mminfo(path)
    if kind not in ("real", "integer", "complex") or symmetry not in ("general", "symmetric"):
        raise MeasurementError(
            f"{path}: {kind} {symmetry}; a matrix must have numbers, and be general or symmetric"
        )
    require_square(path, (rows, columns))
    if layout == "array" and rows * columns > path.stat().st_size:
        raise MeasurementError(f"{path}: {rows} x {columns} entries do not fit into the file")
    with warnings.catch_warnings():
        # scipy 1.18 warns that it will return a sparse array; either kind does here
        warnings.simplefilter("ignore", DeprecationWarning)
        return [StoredMatrix(scipy.io.mmread(path))]


MATRIX_MARKET = Format(
    name="matrix-market",
    label="Matrix Market",
    help="real or integer entries, general or symmetric",
    extensions=(".mtx",),
    read_matrices=read_matrices,
    recognises=lambda head: head.startswith(b"%%MatrixMarket"),
)
