"""Eigenvalues of the small Hessenberg matrices that the Arnoldi iteration leaves.

LAPACK's driver for general matrices, the only one that compiled code can reach, spends most of
its time on what these matrices do not need (complex arithmetic, reduction to the form they have).
"""

import math

import numpy as np
from numba import njit

from chatter.engine.presets import INNER_KERNEL

_MOST_SWEEPS = 60
_EXCEPTIONAL_SHIFTS = (10, 20, 30, 40, 50)


@njit(**INNER_KERNEL)
def _small_subdiagonal(h, last, norm):
    """Row at which the active block begins."""
    row = last
    while row >= 1:
        size = abs(h[row - 1, row - 1]) + abs(h[row, row])
        if size == 0.0:
            size = norm
        if abs(h[row, row - 1]) <= 2.3e-16 * size:
            h[row, row - 1] = 0.0
            break
        row -= 1
    return row


@njit(**INNER_KERNEL)
def _pair_of_block(x, y, w, shift):
    """Eigenvalues of the last two rows; x and y its diagonal, w the product off it."""
    p = 0.5 * (y - x)
    q = p * p + w
    z = math.sqrt(abs(q))
    x += shift
    if q >= 0.0:
        z = p + math.copysign(z, p)
        first = x + z
        second = first if z == 0.0 else x - w / z
        return complex(first, 0.0), complex(second, 0.0)
    return complex(x + p, z), complex(x + p, -z)


@njit(**INNER_KERNEL)
def _double_step(h, first, last, x, y, w):
    """One implicit double-shift QR sweep on the rows first to last."""
    m = last - 2
    while True:
        z = h[m, m]
        r, s = x - z, y - z
        p = (r * s - w) / h[m + 1, m] + h[m, m + 1]
        q = h[m + 1, m + 1] - z - r - s
        r = h[m + 2, m + 1]
        s = abs(p) + abs(q) + abs(r)
        p, q, r = p / s, q / s, r / s
        if m == first:
            break
        off = abs(h[m, m - 1]) * (abs(q) + abs(r))
        on = abs(p) * (abs(h[m - 1, m - 1]) + abs(z) + abs(h[m + 1, m + 1]))
        if off <= 2.3e-16 * on:
            break
        m -= 1
    for i in range(m + 2, last + 1):
        h[i, i - 2] = 0.0
        if i != m + 2:
            h[i, i - 3] = 0.0
    for k in range(m, last):
        x = 1.0
        if k != m:
            p, q = h[k, k - 1], h[k + 1, k - 1]
            r = h[k + 2, k - 1] if k != last - 1 else 0.0
            x = abs(p) + abs(q) + abs(r)
            if x == 0.0:
                continue
            p, q, r = p / x, q / x, r / x
        s = math.copysign(math.sqrt(p * p + q * q + r * r), p)
        if k != m:
            h[k, k - 1] = -s * x
        elif first != m:
            h[k, k - 1] = -h[k, k - 1]
        p += s
        x, y, z = p / s, q / s, r / s
        q, r = q / p, r / p
        third = k != last - 1
        for j in range(k, last + 1):
            p = h[k, j] + q * h[k + 1, j]
            if third:
                p += r * h[k + 2, j]
                h[k + 2, j] -= p * z
            h[k + 1, j] -= p * y
            h[k, j] -= p * x
        for i in range(first, min(last, k + 3) + 1):
            p = x * h[i, k] + y * h[i, k + 1]
            if third:
                p += z * h[i, k + 2]
                h[i, k + 2] -= p * r
            h[i, k + 1] -= p * q
            h[i, k] -= p


@njit(**INNER_KERNEL)
def hessenberg_eigenvalues(h):
    """Eigenvalues (n,) of a real upper Hessenberg matrix by the double-shift QR algorithm.

    The matrix (n, n) is overwritten. Eigenvalues come in no order, nan for any that did not
    converge. Francis 1961; the procedure hqr of Martin, Peters and Wilkinson 1970, Numer. Math. 14.
    """
    n = h.shape[0]
    values = np.full(n, complex(np.nan, np.nan))
    norm = np.abs(h).sum()
    if norm == 0.0:
        values[:] = 0.0
        return values
    shift, sweeps, last = 0.0, 0, n - 1
    while last >= 0 and sweeps < _MOST_SWEEPS:
        first = _small_subdiagonal(h, last, norm)
        x = h[last, last]
        if first == last:
            values[last] = complex(x + shift, 0.0)
            last, sweeps = last - 1, 0
            continue
        y, w = h[last - 1, last - 1], h[last, last - 1] * h[last - 1, last]
        if first == last - 1:
            values[last - 1], values[last] = _pair_of_block(x, y, w, shift)
            last, sweeps = last - 2, 0
            continue
        if sweeps in _EXCEPTIONAL_SHIFTS:
            shift += x
            for i in range(last + 1):
                h[i, i] -= x
            size = abs(h[last, last - 1]) + abs(h[last - 1, last - 2])
            x = y = 0.75 * size
            w = -0.4375 * size * size
        sweeps += 1
        _double_step(h, first, last, x, y, w)
    return values


@njit(**INNER_KERNEL)
def hessenberg_vector(h, value):
    """Eigenvector (n,) of unit norm of a Hessenberg matrix (n, n), by one inverse iteration.

    `value` is its known eigenvalue.
    """
    n = h.shape[0]
    a = np.empty((n, n), dtype=np.complex128)
    size = 1e-300
    for i in range(n):
        for j in range(n):
            a[i, j] = h[i, j]
            size = max(size, abs(h[i, j]))
        a[i, i] -= value
    x = np.ones(n, dtype=np.complex128)
    for k in range(n - 1):
        if abs(a[k + 1, k]) > abs(a[k, k]):
            for j in range(k, n):
                a[k, j], a[k + 1, j] = a[k + 1, j], a[k, j]
            x[k], x[k + 1] = x[k + 1], x[k]
        if abs(a[k, k]) < 1e-15 * size:
            a[k, k] = 1e-15 * size
        factor = a[k + 1, k] / a[k, k]
        for j in range(k + 1, n):
            a[k + 1, j] -= factor * a[k, j]
        x[k + 1] -= factor * x[k]
    if abs(a[n - 1, n - 1]) < 1e-15 * size:
        a[n - 1, n - 1] = 1e-15 * size
    total = 0.0
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            x[i] -= a[i, j] * x[j]
        x[i] /= a[i, i]
        total += abs(x[i]) ** 2
    return x / math.sqrt(total)


@njit(**INNER_KERNEL)
def dominant_pair(h):
    """Eigenvalue of largest magnitude (imaginary part >= 0) and its eigenvector of unit norm."""
    values = hessenberg_eigenvalues(h.copy())
    best = 0
    for i in range(values.shape[0]):
        if abs(values[i]) > abs(values[best]):
            best = i
    value = complex(values[best].real, abs(values[best].imag))
    return value, hessenberg_vector(h, value)
