"""Zeroth-order solution for teeth that are not evenly spaced.

Altintas, Engin and Budak 1999 (J. Manuf. Sci. Eng. 121): with a mean coupling H_g for every delay,

    det(I + w G(i omega) sum_g H_g (1 - exp(-i omega tau_g))) = 0,

so that at every speed and frequency each eigenvalue lambda of what stands beside w gives a depth
w = -1/lambda; it is a limit where it is real and positive.
"""

import math

import numpy as np
from numba import njit

from chatter.description.arrays import Array, ComplexArray, IntegerArray
from chatter.engine.parallel import sweep
from chatter.engine.presets import DRIVER, INNER_KERNEL
from chatter.stability.methods.zeroth_order.kernels import order_like

_ROOT_SWEEPS = 60
#: lines: the phase of the longest delay turns by no more than this from one to the next, rad
_LARGEST_PHASE_STEP = 0.25
#: share by which the receptance may change between coarse lines
_LARGEST_CHANGE = 0.1
#: many delays are taken together on a lattice of this phase at the highest line, rad: cubics are
#: off by less than 2e-3 there
_LATTICE_PHASE = 0.5


@njit(**INNER_KERNEL)
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


@njit(**INNER_KERNEL)
def _inverse_depths(omega, receptance, delays, means, speed, before, now):
    """Set now (r,) to the inverse critical depths at a line, in the order of those before."""
    rank = receptance.shape[0]
    regenerated = np.zeros((rank, rank), dtype=np.complex128)
    for g in range(delays.shape[0]):
        factor = 1.0 - np.exp(-1j * omega * delays[g] / speed)
        for j in range(rank):
            for k in range(rank):
                regenerated[j, k] += factor * means[g, j, k]
    matrix = np.zeros((rank, rank), dtype=np.complex128)
    for j in range(rank):
        for k in range(rank):
            for m in range(rank):
                matrix[j, k] += receptance[j, m] * regenerated[m, k]
    small_eigenvalues(matrix, now)
    for j in range(rank):
        # inverse depth: it passes through zero, where the depth goes to infinity
        now[j] = -now[j]
    order_like(before, now)


@njit(**INNER_KERNEL)
def _lowest_between(omega, receptance, delays, means, speed, first, last, before, now):
    """Lowest limit between two lines and its frequency (rad/s), and whether there may be any."""
    depth, frequency = np.inf, np.nan
    for line in range(first + 1, last + 1):
        _inverse_depths(omega[line], receptance[line], delays, means, speed, before, now)
        for j in range(now.shape[0]):
            a, b = before[j].imag, now[j].imag
            if (a > 0.0) == (b > 0.0):
                continue
            t = a / (a - b)
            inverse = before[j].real + t * (now[j].real - before[j].real)
            if inverse > 0.0 and 1.0 / inverse < depth:
                depth = 1.0 / inverse
                frequency = omega[line - 1] + t * (omega[line] - omega[line - 1])
        before[:] = now
    return depth, frequency


@njit(**DRIVER)
def _limits(omega, receptance, coarse, delays, means, speeds):
    """Lowest limit and its frequency (rad/s) at each speed; inf and nan where there is none.

    All lines are evaluated only between two of the coarse ones where an eigenvalue turns real.
    """
    rank = receptance.shape[1]
    depth, frequency = np.full(speeds.shape[0], np.inf), np.full(speeds.shape[0], np.nan)
    now, before = np.zeros(rank, dtype=np.complex128), np.zeros(rank, dtype=np.complex128)
    inner, inner_now = before.copy(), before.copy()
    for i in range(speeds.shape[0]):
        for c in range(coarse.shape[0]):
            line = coarse[c]
            _inverse_depths(omega[line], receptance[line], delays, means, speeds[i], before, now)
            turns = False
            for j in range(rank):
                turns |= c > 0 and (before[j].imag > 0.0) != (now[j].imag > 0.0)
            if turns:
                inner[:] = before
                lowest, at = _lowest_between(
                    omega, receptance, delays, means, speeds[i], coarse[c - 1], line, inner,
                    inner_now,
                )  # fmt: skip
                if lowest < depth[i]:
                    depth[i], frequency[i] = lowest, at
            before[:] = now
    return depth, frequency


def limits_of_delays(
    frequency: Array, receptance: ComplexArray, delays: Array, means: Array, speeds: Array
) -> tuple[Array, Array]:
    """Critical depth (m) and chatter frequency (Hz) at every spindle speed (rad/s).

    Receptance (m, r, r), m/N, at frequencies (m,), Hz, ascending, > 0; mean directional matrices
    (g, r, r), N/m^2, of delays (g,), rad.
    """

    def chunk(index: IntegerArray) -> tuple[Array, Array]:
        own = speeds[index]
        lines, values = _enough_lines(frequency, receptance, delays.max() / own.min())
        omega = 2.0 * np.pi * lines
        few = _on_lattice(delays, means, _LATTICE_PHASE * own.min() / omega[-1])
        coarse = _coarse_lines(omega, values, delays.max() / own.min())
        return _limits(omega, values, coarse, *few, own)

    parts = sweep(chunk, len(speeds), points_a_chunk=8)
    depth, omega = (np.concatenate(part) for part in zip(*parts, strict=True))
    return depth, omega / (2.0 * np.pi)


def _coarse_lines(omega: Array, receptance: ComplexArray, delay: float) -> IntegerArray:
    """Lines between which neither the phase of a delay nor the receptance changes by much."""
    flat = receptance.reshape(omega.size, -1)
    size = np.linalg.norm(flat, axis=1)
    change = np.linalg.norm(np.diff(flat, axis=0), axis=1)
    change /= _LARGEST_CHANGE * np.maximum(np.minimum(size[1:], size[:-1]), 1e-300)
    change += np.diff(omega) * delay / _LARGEST_PHASE_STEP
    passed = np.floor(np.concatenate([[0.0], np.cumsum(change)]))
    kept = np.flatnonzero(np.diff(passed) > 0.0)
    return np.unique(np.concatenate([[0], kept, [omega.size - 1]])).astype(np.int64)


def _on_lattice(delays: Array, means: Array, spacing: float) -> tuple[Array, Array]:
    """Fewer delays, evenly spaced, that stand for many by cubic interpolation of the phase."""
    position = np.floor(delays / spacing).astype(np.int64)
    number = position[:, None] + np.arange(-1, 3)
    nodes, node = np.unique(number, return_inverse=True)
    if nodes.size >= delays.size:
        return delays, means
    s = delays / spacing - position
    share = np.stack(
        [
            -s * (s - 1.0) * (s - 2.0) / 6.0,
            (s + 1.0) * (s - 1.0) * (s - 2.0) / 2.0,
            -(s + 1.0) * s * (s - 2.0) / 2.0,
            (s + 1.0) * s * (s - 1.0) / 6.0,
        ],
        axis=1,
    )
    merged = np.zeros((nodes.size, *means.shape[1:]))
    np.add.at(merged, node.reshape(share.shape), share[:, :, None, None] * means[:, None])
    return nodes * spacing, merged


def _enough_lines(
    frequency: Array, receptance: ComplexArray, delay: float
) -> tuple[Array, ComplexArray]:
    """More lines, between those there are, where the phase of a delay turns too far."""
    spacing = _LARGEST_PHASE_STEP / (2.0 * np.pi * delay)
    between = np.ceil(np.diff(frequency) / spacing).astype(np.int64)
    if between.max() <= 1:
        return frequency, receptance
    position = np.repeat(np.arange(between.size), between)
    first = np.cumsum(between) - between
    share = (np.arange(position.size) - first[position]) / between[position]
    step = np.diff(frequency)[position]
    lines = np.append(frequency[position] + share * step, frequency[-1])
    change = np.diff(receptance, axis=0)[position]
    values = receptance[position] + share[:, None, None] * change
    return lines, np.ascontiguousarray(np.concatenate([values, receptance[-1:]]))
