"""Zeroth-order solution for teeth that are not evenly spaced.

Altintas, Engin and Budak 1999 (J. Manuf. Sci. Eng. 121): with a mean coupling H_g for every delay,

    det(I + w G(i omega) sum_g H_g (1 - exp(-i omega tau_g))) = 0,

so that at every speed and frequency each eigenvalue lambda of what stands beside w gives a depth
w = -1/lambda; it is a limit where it is real and positive.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from chatter.kernels import DRIVER, KERNEL
from chatter.stability.sweep import sweep

_ROOT_SWEEPS = 60
#: lines: the phase of the longest delay turns by no more than this from one to the next, rad
_LARGEST_PHASE_STEP = 0.25


@njit(**KERNEL)
def small_eigenvalues(matrix, out):
    """Set out (n,) to the eigenvalues of a complex matrix (n, n), n at most 3."""
    n = matrix.shape[0]
    if n == 1:
        out[0] = matrix[0, 0]
        return
    trace = matrix[0, 0] + matrix[1, 1]
    minor = matrix[0, 0] * matrix[1, 1] - matrix[0, 1] * matrix[1, 0]
    if n == 2:
        root = np.sqrt(0.25 * trace * trace - minor)
        out[0], out[1] = 0.5 * trace + root, 0.5 * trace - root
        return
    a, b, c = matrix[0], matrix[1], matrix[2]
    trace += c[2]
    minors = minor + a[0] * c[2] - a[2] * c[0] + b[1] * c[2] - b[2] * c[1]
    determinant = (
        a[0] * (b[1] * c[2] - b[2] * c[1])
        - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
    )
    size = max(abs(trace), math.sqrt(abs(minors)), abs(determinant) ** (1.0 / 3.0), 1e-300)
    p, q, r = trace / size, minors / size / size, determinant / size / size / size
    x, y, z = complex(1.0, 0.0), complex(0.4, 0.9), complex(0.4, 0.9) ** 2
    # Weierstrass iteration on the characteristic polynomial
    for _ in range(_ROOT_SWEEPS):
        dx = (((x - p) * x + q) * x - r) / ((x - y) * (x - z))
        x -= dx
        dy = (((y - p) * y + q) * y - r) / ((y - x) * (y - z))
        y -= dy
        dz = (((z - p) * z + q) * z - r) / ((z - x) * (z - y))
        z -= dz
        if abs(dx) + abs(dy) + abs(dz) < 1e-13:
            break
    out[0], out[1], out[2] = x * size, y * size, z * size


@njit(**DRIVER)
def _limits(omega, receptance, delays, means, speeds):
    """Lowest limit and its frequency (rad/s) at each speed; inf and nan where there is none."""
    rank = receptance.shape[1]
    groups = delays.shape[0]
    depth, frequency = np.full(speeds.shape[0], np.inf), np.full(speeds.shape[0], np.nan)
    regenerated = np.empty((rank, rank), dtype=np.complex128)
    matrix = np.empty((rank, rank), dtype=np.complex128)
    now, before = np.empty(rank, dtype=np.complex128), np.empty(rank, dtype=np.complex128)
    for i in range(speeds.shape[0]):
        for line in range(omega.shape[0]):
            regenerated[:, :] = 0.0
            for g in range(groups):
                factor = 1.0 - np.exp(-1j * omega[line] * delays[g] / speeds[i])
                for j in range(rank):
                    for k in range(rank):
                        regenerated[j, k] += factor * means[g, j, k]
            for j in range(rank):
                for k in range(rank):
                    total = complex(0.0, 0.0)
                    for m in range(rank):
                        total += receptance[line, j, m] * regenerated[m, k]
                    matrix[j, k] = total
            small_eigenvalues(matrix, now)
            for j in range(rank):
                # inverse depth: it passes through zero, where the depth goes to infinity
                now[j] = -now[j]
            if line > 0:
                for j in range(rank - 1):
                    nearest = j
                    for k in range(j + 1, rank):
                        if abs(now[k] - before[j]) < abs(now[nearest] - before[j]):
                            nearest = k
                    now[j], now[nearest] = now[nearest], now[j]
                for j in range(rank):
                    a, b = before[j].imag, now[j].imag
                    if (a > 0.0) == (b > 0.0):
                        continue
                    t = a / (a - b)
                    inverse = before[j].real + t * (now[j].real - before[j].real)
                    if inverse > 0.0 and 1.0 / inverse < depth[i]:
                        depth[i] = 1.0 / inverse
                        frequency[i] = omega[line - 1] + t * (omega[line] - omega[line - 1])
            before[:] = now
    return depth, frequency


def limits_of_delays(
    frequency: NDArray[np.float64],
    receptance: NDArray[np.complex128],
    delays: NDArray[np.float64],
    means: NDArray[np.float64],
    speeds: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Limit depth (m) and chatter frequency (Hz) at every spindle speed.

    Parameters
    ----------
    frequency : (m,) array of float
        Hz, ascending, > 0.
    receptance : (m, r, r) array of complex
        m/N.
    delays : (g,) array of float
        rad.
    means : (g, r, r) array of float
        Mean directional matrix of each delay, N/m^2.
    speeds : (n,) array of float
        rad/s.
    """

    def chunk(index: NDArray[np.int64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        own = speeds[index]
        lines, values = _enough_lines(frequency, receptance, delays.max() / own.min())
        return _limits(2.0 * np.pi * lines, values, delays, means, own)

    parts = sweep(chunk, len(speeds), points_a_chunk=8)
    depth, omega = (np.concatenate(part) for part in zip(*parts, strict=True))
    return depth, omega / (2.0 * np.pi)


def _enough_lines(
    frequency: NDArray[np.float64], receptance: NDArray[np.complex128], delay: float
) -> tuple[NDArray[np.float64], NDArray[np.complex128]]:
    """More lines, between those there are, where the phase of a delay turns too far."""
    spacing = _LARGEST_PHASE_STEP / (2.0 * np.pi * delay)
    between = np.ceil(np.diff(frequency) / spacing).astype(np.int64)
    if between.max() <= 1:
        return frequency, receptance
    place = np.repeat(np.arange(between.size), between)
    first = np.cumsum(between) - between
    share = (np.arange(place.size) - first[place]) / between[place]
    step = np.diff(frequency)[place]
    lines = np.append(frequency[place] + share * step, frequency[-1])
    change = np.diff(receptance, axis=0)[place]
    values = receptance[place] + share[:, None, None] * change
    return lines, np.ascontiguousarray(np.concatenate([values, receptance[-1:]]))
