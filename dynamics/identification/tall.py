"""Products and factors of tall matrices, block by block.

The matrices here have thousands of rows and some twenty columns. A linear-algebra library spreads
each of the many small operations over threads, which gains nothing and on shared cores costs ten
times the work; blocks of a few hundred rows stay on one thread.
"""

import numpy as np
from numpy.typing import NDArray

#: rows of a block of a product at the least and most, of a block that is factorised
ROWS, MOST_ROWS, FACTORISED_ROWS = 32, 1024, 256
#: multiplications that OpenBLAS does on one thread: half of its threshold
_PRODUCTS_ON_ONE_THREAD = 1 << 17
#: part of a unit column that is new, below which normal equations lose more than a step of
#: correction gives back
_LEAST_NEW = 1e-4


def padded(matrix: NDArray, rows: int = ROWS) -> NDArray:
    """Append rows of zeros up to a whole number of blocks, (n, ...) -> (blocks * rows, ...)."""
    missing = -matrix.shape[0] % rows
    if missing == 0:
        return matrix
    return np.concatenate([matrix, np.zeros((missing, *matrix.shape[1:]), dtype=matrix.dtype)])


def blocks(matrix: NDArray, rows: int = ROWS) -> NDArray:
    """View a padded matrix (n, k) as (n / rows, rows, k)."""
    return matrix.reshape(matrix.shape[0] // rows, rows, matrix.shape[1])


def gram(left: NDArray, right: NDArray) -> NDArray:
    """Conjugate transpose of `left` times `right`.

    (n, k) and (n, j) make (k, j).
    """
    rows = _rows_of_product(left.shape[1], right.shape[1])
    whole = left.shape[0] - left.shape[0] % rows
    a, b = blocks(left[:whole], rows), blocks(right[:whole], rows)
    rest = left[whole:].conj().T @ right[whole:]
    return rest + np.sum(a.conj().transpose(0, 2, 1) @ b, axis=0)


def _rows_of_product(columns: int, others: int) -> int:
    """Rows of a block whose product a library makes on one thread."""
    fitting = _PRODUCTS_ON_ONE_THREAD // max(1, columns * others)
    return min(max(ROWS, 1 << max(0, fitting.bit_length() - 1)), MOST_ROWS)


def product(left: NDArray, right: NDArray) -> NDArray:
    """Tall matrix times small one.

    (n, k) and (k, j) make (n, j).
    """
    rows = _rows_of_product(left.shape[1], right.shape[1])
    whole = left.shape[0] - left.shape[0] % rows
    found = np.empty((left.shape[0], right.shape[1]), dtype=np.result_type(left, right))
    found[:whole] = (blocks(left[:whole], rows) @ right).reshape(whole, right.shape[1])
    found[whole:] = left[whole:] @ right
    return found


def triangle_of(normal: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Cholesky factor (k, k), lower, of the products of scaled columns; None where it is not sound.

    With unit columns a small entry of its diagonal is what a column adds to those before it.
    """
    try:
        lower = np.linalg.cholesky(normal)
    except np.linalg.LinAlgError:
        return None
    return lower if float(np.min(np.diag(lower), initial=1.0)) > _LEAST_NEW else None


def factorise(matrix: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """QR factors of a tall matrix, by those of its blocks (Demmel et al. 2012, TSQR).

    Of (n, k), n >= k: orthonormal columns (n, k) and a triangle (k, k).
    """
    rows, columns = matrix.shape
    if rows <= 2 * FACTORISED_ROWS or 2 * columns > FACTORISED_ROWS:
        return np.linalg.qr(matrix)
    first, triangles = np.linalg.qr(blocks(padded(matrix, FACTORISED_ROWS), FACTORISED_ROWS))
    second, triangle = factorise(triangles.reshape(-1, columns))
    basis = first @ second.reshape(-1, columns, columns)
    return basis.reshape(-1, columns)[:rows], triangle
