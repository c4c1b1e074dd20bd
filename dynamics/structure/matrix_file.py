"""Symmetric matrices from Matrix Market files and NPZ archives, checked."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import scipy.io
import scipy.linalg
import scipy.sparse
import scipy.sparse.linalg
from numpy.typing import NDArray

from dynamics.structure.linear_structure import Matrix, StructureError

# More rows than a desk computer can factorise.
MOST_ROWS = 5_000_000
# Unequal halves of a matrix, relative to the diagonal, that digits cut by a file explain.
UNSYMMETRIC = 1e-8
MOST_DENSE_ROWS = 1000
# Of a mass matrix with a unit diagonal: rounding of a mode without mass.
MASSLESS = 1e-12


def read_matrix(path: str | Path) -> Matrix:
    """Read one symmetric matrix of finite real numbers.

    Parameters
    ----------
    path : path
        ".mtx": Matrix Market, real or integer, general or symmetric; ".npz": of
        `scipy.sparse.save_npz`, or with one plain array.

    Returns
    -------
    (n, n) array or sparse array of float

    Raises
    ------
    StructureError
        Naming the file and the entry (rows and columns from 1).
    """
    path = Path(path)
    readers = {".mtx": _read_matrix_market, ".npz": _read_npz}
    if path.suffix.lower() not in readers:
        raise StructureError(f"{path}: a matrix must be a .mtx or .npz file")
    try:
        matrix = readers[path.suffix.lower()](path)
    except StructureError:
        raise
    except Exception as error:  # the readers raise nearly anything on a broken file
        raise StructureError(f"{path}: cannot be read as a matrix: {error}") from error
    return _checked(matrix, path)


def refuse_indefinite(mass: Matrix, where: str) -> None:
    """Refuse a mass matrix that is not positive definite.

    Parameters
    ----------
    mass : (n, n) array or sparse array of float
        Symmetric.
    where : str
        Begins the message: the file.

    Raises
    ------
    StructureError
        Naming the row, from 1.
    """
    diagonal = mass.diagonal()
    if np.any(diagonal <= 0.0):
        row = int(np.argmin(diagonal)) + 1
        raise StructureError(
            f"{where}: row {row}, column {row} is {diagonal[row - 1]:g}; every freedom needs mass "
            "(condense those without it before export)"
        )
    search = _sparse_eigenvalue if scipy.sparse.issparse(mass) else _dense_pivots
    found = search(mass, 1.0 / np.sqrt(diagonal))
    if found is not None:
        raise StructureError(
            f"{where}: the mass matrix is not positive definite, found at row {found + 1}"
        )


def symmetrised(matrix: Matrix) -> Matrix:
    """Mean of a matrix and its transpose; a sparse one in rows."""
    half = 0.5 * (matrix + matrix.T)
    return scipy.sparse.csr_array(half) if scipy.sparse.issparse(half) else half


def _read_matrix_market(path: Path) -> Matrix:
    rows, columns, _, layout, kind, symmetry = scipy.io.mminfo(path)
    if kind not in ("real", "integer") or symmetry not in ("general", "symmetric"):
        raise StructureError(
            f"{path}: {kind} {symmetry}; a matrix must be real, and general or symmetric"
        )
    _refuse_shape(path, (rows, columns))
    if layout == "array" and rows * columns > path.stat().st_size:
        raise StructureError(f"{path}: {rows} x {columns} entries do not fit into the file")
    return scipy.io.mmread(path)


def _read_npz(path: Path) -> Matrix:
    with path.open("rb") as file, zipfile.ZipFile(file) as archive:
        names = [Path(name).stem for name in archive.namelist()]
        file.seek(0)
        arrays = np.load(file, allow_pickle=False)
        if "format" in names:
            _refuse_shape(path, tuple(arrays["shape"]))
            file.seek(0)
            matrix = scipy.sparse.load_npz(file)
            if hasattr(matrix, "check_format"):
                matrix.check_format(full_check=True)
            return matrix
        if len(names) != 1 or not isinstance(arrays[arrays.files[0]], np.ndarray):
            raise StructureError(f"{path}: has {', '.join(names)}; it must have one array")
        return arrays[arrays.files[0]]


def _refuse_shape(path: Path, shape: tuple[int, ...]) -> None:
    if len(shape) != 2 or shape[0] != shape[1] or not 1 <= shape[0] <= MOST_ROWS:
        size = " x ".join(str(length) for length in shape)
        raise StructureError(f"{path}: is {size}; it must be square, 1 to {MOST_ROWS} rows")


def _checked(matrix: Matrix, path: Path) -> Matrix:
    _refuse_shape(path, matrix.shape)
    if not np.issubdtype(matrix.dtype, np.integer) and not np.issubdtype(matrix.dtype, np.floating):
        raise StructureError(f"{path}: has entries of type {matrix.dtype}; they must be real")
    sparse = scipy.sparse.csr_array(matrix, dtype=np.float64)
    entries = scipy.sparse.coo_array(sparse)
    for row, column, value in _where(entries, ~np.isfinite(entries.data)):
        raise StructureError(f"{path}: row {row + 1}, column {column + 1} is {value}")
    unequal = scipy.sparse.coo_array(sparse - sparse.T)
    scale = np.sqrt(np.abs(sparse.diagonal()))
    limit = UNSYMMETRIC * scale[unequal.row] * scale[unequal.col] + 1e-14 * np.max(scale) ** 2
    for row, column, _ in _where(unequal, np.abs(unequal.data) > limit):
        raise StructureError(
            f"{path}: not symmetric: row {row + 1}, column {column + 1} is "
            f"{sparse[row, column]:g}, row {column + 1}, column {row + 1} is "
            f"{sparse[column, row]:g}"
        )
    return symmetrised(sparse if scipy.sparse.issparse(matrix) else np.asarray(matrix, np.float64))


def _where(entries: scipy.sparse.coo_array, wrong: NDArray[np.bool_]) -> list[tuple]:
    """Row, column and value of the wrong entry that is wrong by most, or nothing."""
    if not np.any(wrong):
        return []
    sizes = np.where(wrong, np.nan_to_num(np.abs(entries.data), nan=np.inf), -1.0)
    worst = int(np.argmax(sizes))
    return [(int(entries.row[worst]), int(entries.col[worst]), entries.data[worst])]


def _dense_pivots(mass: NDArray[np.float64], scale: NDArray[np.float64]) -> int | None:
    """Row where the elimination of the scaled matrix fails, if it does."""
    _, failed = scipy.linalg.lapack.dpotrf(scale[:, None] * mass * scale)
    return failed - 1 if failed else None


def _sparse_eigenvalue(mass: scipy.sparse.csr_array, scale: NDArray[np.float64]) -> int | None:
    """Row that has most of a mode without mass of the scaled matrix, if there is one.

    Scaled to a unit diagonal a consistent mass matrix has eigenvalues bounded by those of its
    elements, whatever the mesh (Wathen, IMA Journal of Numerical Analysis 7, 1987), so the
    smallest comes out in few products; a factorisation would cost as much as the stiffness's.
    """
    if len(scale) <= MOST_DENSE_ROWS:
        return _dense_pivots(mass.toarray(), scale)
    around = scipy.sparse.diags(scale)
    start = np.random.default_rng(0).standard_normal(len(scale))
    try:
        value, mode = scipy.sparse.linalg.eigsh(
            around @ mass @ around, k=1, which="SA", tol=1e-6, v0=start
        )
    except scipy.sparse.linalg.ArpackNoConvergence:
        # An eigenvalue this close to others is not one of a faulty export: take the matrix.
        return None
    return int(np.argmax(np.abs(mode))) if value[0] <= MASSLESS else None
