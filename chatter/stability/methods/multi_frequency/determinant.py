"""Multi-frequency solution in the frequency domain, straight from FRFs, by the argument principle.

Motion that grows as exp(s t) times a function of the period holds the frequencies s + i l W, W that
of the period. With the receptance G and the Fourier coefficients H_k of the directional matrix the
cut closes the loop between them (Budak and Altintas 1998; Merdol and Altintas 2004),

    det A(s) = 0,   A_lm = delta_lm I + G(s + i l W) sum_g H_g,l-m (1 - exp(-(s + i m W) tau_g)).

A cut is stable where no root lies right of the imaginary axis; how many do is the number of turns
that det A(i w) makes as w runs over one W, since G has no poles there. A verdict needs no root. One
harmonic alone is the zeroth-order solution; the harmonics kept reach beyond the highest resonance.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from chatter.description.arrays import Array, ComplexArray
from chatter.engine.presets import DRIVER, INNER_KERNEL

#: largest change of the phase of the determinant from one frequency to the next, rad
_LARGEST_PHASE = 0.7
_FEWEST_LINES = 24
#: finest step of the frequency, over that of the period
FINEST_STEP = 1e-7
#: frequencies at which the determinant at a limit is evaluated, four times around its least
_LINES_SEARCHED = 41
#: least values of the determinant around which the root is looked for
_DIPS_FOLLOWED = 6


class FrequencyResponse(NamedTuple):
    """Relative receptance in r directions over frequency."""

    omega: Array  # rad/s (m,)
    receptance: ComplexArray  # m/N (m, r, r)


@njit(**INNER_KERNEL)
def _receptance_at(response, omega, out):
    """Set out (r, r) to the receptance at a frequency, negative ones too."""
    lines = response.omega
    w = abs(omega)
    last = lines.shape[0] - 1
    if w <= lines[0]:
        low, t = 0, 0.0
    elif w >= lines[last]:
        low, t = last - 1, 1.0
    else:
        low = np.searchsorted(lines, w, side="right") - 1
        t = (w - lines[low]) / (lines[low + 1] - lines[low])
    # above what was measured the masses alone are left
    fade = (lines[last] / w) ** 2 if w > lines[last] else 1.0
    rank = out.shape[0]
    for i in range(rank):
        for j in range(rank):
            a, b = response.receptance[low, i, j], response.receptance[low + 1, i, j]
            value = fade * (a + t * (b - a))
            out[i, j] = value if omega >= 0.0 else value.conjugate()


@njit(**INNER_KERNEL)
def _loop(response, harmonics, speed, base, omega, count, matrix):
    """Set matrix ((2 count + 2) r)^2 to A(i omega); harmonics -count - 1 .. count."""
    rank = response.receptance.shape[1]
    orders = (harmonics.dashpot.shape[0] - 1) // 2
    receptance = np.empty((rank, rank), dtype=np.complex128)
    coupling = np.empty((rank, rank), dtype=np.complex128)
    size, held = 2 * count + 2, harmonics.stiffening
    factor = np.empty(harmonics.delay.shape[0], dtype=np.complex128)
    for m in range(size):
        w = omega + (m - count - 1) * base
        for g in range(factor.shape[0]):
            factor[g] = 1.0 - np.exp(-1j * w * harmonics.delay[g] / speed)
        for l in range(size):  # noqa: E741
            k = l - m + orders
            for i in range(rank):
                for j in range(rank):
                    coupling[i, j] = harmonics.dashpot[k, i, j] * (held + 1j * w / speed)
            for g in range(factor.shape[0]):
                for i in range(rank):
                    for j in range(rank):
                        coupling[i, j] += factor[g] * harmonics.stiffness[g, k, i, j]
            for i in range(rank):
                for j in range(rank):
                    matrix[l * rank + i, m * rank + j] = coupling[i, j]
    for l in range(size):  # noqa: E741
        _receptance_at(response, omega + (l - count - 1) * base, receptance)
        for column in range(size * rank):
            for i in range(rank):
                coupling[i, 0] = matrix[l * rank + i, column]
            for i in range(rank):
                total = complex(0.0, 0.0)
                for j in range(rank):
                    total += receptance[i, j] * coupling[j, 0]
                matrix[l * rank + i, column] = total
    for i in range(size * rank):
        matrix[i, i] += 1.0


@njit(**DRIVER)
def unstable_roots(response, harmonics, speed, base, count, marks):
    """Number of unstable multipliers.

    The harmonics hold orders up to 2 count + 1, with count harmonics on either side. The spindle
    speed, the frequency of the period `base` and the frequencies that no step goes beyond, `marks`
    (k,) of `frequency_marks`, are in rad/s.
    """
    rank = response.receptance.shape[1]
    size = (2 * count + 2) * rank
    matrix = np.empty((size, size), dtype=np.complex128)
    _loop(response, harmonics, speed, base, 0.0, count, matrix)
    value = np.linalg.det(matrix)
    turned, at, step = 0.0, 0.0, 0.5 * base / _FEWEST_LINES
    end, mark = 0.5 * base, 0
    while at < end * (1.0 - 1e-12):
        while mark < marks.shape[0] and marks[mark] <= at:
            mark += 1
        following = min(end, at + step)
        if mark < marks.shape[0]:
            following = min(following, marks[mark])
        _loop(response, harmonics, speed, base, following, count, matrix)
        ahead = np.linalg.det(matrix)
        change = np.angle(ahead / value)
        if abs(change) > _LARGEST_PHASE and following - at > FINEST_STEP * base:
            step = 0.4 * (following - at)
            continue
        turned += change
        value, at = ahead, following
        if abs(change) < 0.3 * _LARGEST_PHASE:
            step = min(2.0 * step, 0.5 * base / _FEWEST_LINES)
    return -int(np.round(turned / math.pi))


@njit(**DRIVER)
def chatter_frequency(response, harmonics, speed, base, count, marks):
    """Frequency of the strongest part of the motion that is nearest to a root, and its position.

    In rad/s, and the least frequency of it as a share of `base`, 0 .. 0.5. Arguments as of
    `unstable_roots`.
    """
    rank = response.receptance.shape[1]
    size = (2 * count + 2) * rank
    matrix = np.empty((size, size), dtype=np.complex128)
    coarse = np.sort(np.append(marks, np.linspace(0.0, 0.5 * base, _LINES_SEARCHED)))
    last = coarse.shape[0] - 1
    size_at = np.empty(last + 1)
    for i in range(last + 1):
        _loop(response, harmonics, speed, base, coarse[i], count, matrix)
        size_at[i] = abs(np.linalg.det(matrix))
    best, position, tried = np.inf, 0.0, 0
    # the dip at the root may be narrower than another that does not reach zero
    for i in np.argsort(size_at):
        before, after = size_at[max(0, i - 1)], size_at[min(last, i + 1)]
        if size_at[i] > before or size_at[i] > after or tried == _DIPS_FOLLOWED:
            continue
        tried += 1
        low, high = coarse[max(0, i - 1)], coarse[min(last, i + 1)]
        here, at = size_at[i], coarse[i]
        for _ in range(3):
            grid = np.linspace(low, high, _LINES_SEARCHED)
            for j in range(grid.shape[0]):
                _loop(response, harmonics, speed, base, grid[j], count, matrix)
                value = abs(np.linalg.det(matrix))
                if value <= here:
                    here, at = value, grid[j]
                    low = grid[max(0, j - 1)]
                    high = grid[min(grid.shape[0] - 1, j + 1)]
        if here < best:
            best, position = here, at
    _loop(response, harmonics, speed, base, position, count, matrix)
    vector = np.ones(size, dtype=np.complex128)
    for i in range(size):
        matrix[i, i] += 1e-12
    for _ in range(3):
        vector = np.linalg.solve(matrix, vector)
        vector /= np.sqrt((np.abs(vector) ** 2).sum())
    strongest, frequency = -1.0, 0.0
    for l in range(2 * count + 2):  # noqa: E741
        strength = 0.0
        for i in range(rank):
            strength += abs(vector[l * rank + i]) ** 2
        if strength > strongest:
            strongest, frequency = strength, abs(position + (l - count - 1) * base)
    return frequency, position / base
