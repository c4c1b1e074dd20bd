"""Products and factors of tall matrices, block by block.

The matrices here have thousands of rows and some twenty columns. A linear-algebra library spreads
each of the many small operations over threads, which gains nothing and on shared cores costs ten
times the work; blocks of a few hundred rows stay on one thread.
"""

import numpy as np
from numpy.typing import NDArray

#: rows of a block of a product, of a block that is factorised
ROWS, FACTORISED_ROWS = 32, 256


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
    a, b = blocks(padded(left)), blocks(padded(right))
    return np.sum(a.conj().transpose(0, 2, 1) @ b, axis=0)


def product(left: NDArray, right: NDArray) -> NDArray:
    """Tall matrix times small one.

    (n, k) and (k, j) make (n, j).
    """
    whole = blocks(padded(left)) @ right
    return whole.reshape(whole.shape[0] * ROWS, right.shape[1])[: left.shape[0]]


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
