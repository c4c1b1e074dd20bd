"""Frequency evaluated of the dominant motion of a cut, eight points at once."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from chatter.description.arrays import Array
from chatter.engine.presets import INNER_KERNEL, LEAF_KERNEL, SINGLE_KERNEL
from chatter.stability.methods.collocation.monodromy import apply_batch_monodromy, batch_scratch
from chatter.stability.simd_batch import BATCH_SIZE, load, spread, store

#: harmonics searched, up to this factor beyond the highest mode
_HIGHEST = 2.0


class _Turning(NamedTuple):
    """exp(-(sigma + i omega) t) at N times, and what takes it to the next harmonic (N, 8)."""

    real: Array
    imaginary: Array
    real_step: Array
    imaginary_step: Array


@njit(**INNER_KERNEL)
def _vectors(found):
    """Real and imaginary part of the dominant vector of every member (2, D, 8)."""
    vectors = np.zeros((2, found.basis.shape[1], BATCH_SIZE))
    for member in range(BATCH_SIZE):
        for j in range(found.used[member]):
            c = found.coordinates[member, j]
            for i in range(found.basis.shape[1]):
                vectors[0, i, member] += c.real * found.basis[j, i, member]
                vectors[1, i, member] += c.imag * found.basis[j, i, member]
    return vectors


@njit(**INNER_KERNEL)
def _weighted(points, assemblies, batch_points, speeds, lengths, real, imaginary):
    """Times (N, 8) of all points in the cut and forces there times weights (2, N r, 8)."""
    cuts, values, _ = real.shape
    count = points.weight.shape[0]
    rank = values // count
    time, force = np.empty((cuts * count, BATCH_SIZE)), np.empty((2, cuts * values, BATCH_SIZE))
    for member in range(BATCH_SIZE):
        assembly, speed = assemblies.of_point[batch_points[member]], speeds[0, member]
        of_assembly = assemblies.number[
            assemblies.first_number[assembly] : assemblies.first_number[assembly + 1]
        ]
        first = 1 + lengths
        for e in range(cuts):
            start, length = of_assembly[first + e] / speed, of_assembly[first + cuts + e] / speed
            for i in range(count):
                time[e * count + i, member] = start + length * points.position[i + 1]
                weight = length * points.weight[i]
                for k in range(i * rank, (i + 1) * rank):
                    force[0, e * values + k, member] = weight * real[e, k, member]
                    force[1, e * values + k, member] = weight * imaginary[e, k, member]
    return time, force


@njit(**INNER_KERNEL)
def _turning(time, base, line, lowest):
    """Values at the lowest harmonic; base (8,) complex, line (8,) rad/s."""
    out = _Turning(
        np.empty(time.shape), np.empty(time.shape), np.empty(time.shape), np.empty(time.shape)
    )
    for i in range(time.shape[0]):
        for member in range(BATCH_SIZE):
            t = time[i, member]
            now = np.exp(-(base[member] + complex(0.0, lowest * line[member])) * t)
            out.real[i, member], out.imaginary[i, member] = now.real, now.imag
            out.real_step[i, member] = math.cos(line[member] * t)
            out.imaginary_step[i, member] = -math.sin(line[member] * t)
    return out


@njit(**LEAF_KERNEL)
def _force_at_harmonic(turning, force, rank, out):
    """Set out (2, r, 8) to the force at a harmonic, and go on to the next."""
    for k in range(rank):
        store(out, (0, k), spread(0.0))
        store(out, (1, k), spread(0.0))
    for i in range(turning.real.shape[0]):
        a, b = load(turning.real, i), load(turning.imaginary, i)
        for k in range(rank):
            x, y = load(force, (0, i * rank + k)), load(force, (1, i * rank + k))
            store(out, (0, k), load(out, (0, k)) + (a * x - b * y))
            store(out, (1, k), load(out, (1, k)) + (a * y + b * x))
        c, d = load(turning.real_step, i), load(turning.imaginary_step, i)
        store(turning.real, i, a * c - b * d)
        store(turning.imaginary, i, a * d + b * c)


@njit(**LEAF_KERNEL)
def _amplitudes(structure, sigma, omega, force, motion, out):
    """Set out (1, 8) to the displacement of the tool point, squared, under a force exp(s t).

    s = sigma + i omega, (1, 8) each; force (2, r, 8); motion (2, r, 8) is scratch.
    """
    modes, rank = structure.shape.shape
    re, im = load(sigma, 0), load(omega, 0)
    for k in range(rank):
        store(motion, (0, k), spread(0.0))
        store(motion, (1, k), spread(0.0))
    for m in range(modes):
        w, twice = structure.natural_frequency[m], 2.0 * structure.damping[m]
        below = re * re - im * im + twice * w * re + w * w
        beside = 2.0 * re * im + twice * w * im
        size = below * below + beside * beside
        x, y = spread(0.0), spread(0.0)
        for k in range(rank):
            x += structure.force_gain[m, k] * load(force, (0, k))
            y += structure.force_gain[m, k] * load(force, (1, k))
        real, imaginary = (x * below + y * beside) / size, (y * below - x * beside) / size
        for k in range(rank):
            store(motion, (0, k), load(motion, (0, k)) + structure.shape[m, k] * real)
            store(motion, (1, k), load(motion, (1, k)) + structure.shape[m, k] * imaginary)
    total = spread(0.0)
    for k in range(rank):
        x, y = load(motion, (0, k)), load(motion, (1, k))
        total += x * x + y * y
    store(out, 0, total)


@njit(**SINGLE_KERNEL)
def _loudest(structure, base, line, time, force, out):
    """Set out (8,) to the frequency (Hz) at which a motion is largest.

    The force is taken apart into exp((sigma + i omega_l) t) over the period, and drives the
    structure at each omega_l.
    """
    rank = structure.shape.shape[1]
    orders = np.empty(BATCH_SIZE, dtype=np.int64)
    highest = _HIGHEST * structure.natural_frequency.max()
    for member in range(BATCH_SIZE):
        orders[member] = math.ceil(highest / line[member]) + 1
    order = orders.max()
    turning = _turning(time, base, line, -order)
    at_harmonic, motion = np.empty((2, rank, BATCH_SIZE)), np.empty((2, rank, BATCH_SIZE))
    sigma, omega, amplitude = (
        np.empty((1, BATCH_SIZE)),
        np.empty((1, BATCH_SIZE)),
        np.empty((1, BATCH_SIZE)),
    )
    best = np.full(BATCH_SIZE, -1.0)
    for member in range(BATCH_SIZE):
        sigma[0, member] = base[member].real
    for harmonic in range(-order, order + 1):
        _force_at_harmonic(turning, force, rank, at_harmonic)
        for member in range(BATCH_SIZE):
            omega[0, member] = base[member].imag + harmonic * line[member]
        _amplitudes(structure, sigma, omega, at_harmonic, motion, amplitude)
        for member in range(BATCH_SIZE):
            # the frequency of a member does not depend on its neighbours
            if abs(harmonic) <= orders[member] and amplitude[0, member] > best[member]:
                best[member] = amplitude[0, member]
                out[member] = abs(omega[0, member]) / (2.0 * math.pi)


@njit(**SINGLE_KERNEL)
def chatter_frequencies_of(arrays, assemblies, batch_points, speeds, period, found, out):
    """Set out (8,) to the chatter frequency (Hz) of the dominant motion of every member.

    `batch_points` (8,) are their points among the `CouplingAssemblies`, `speeds` (1, 8) in rad/s,
    `period` is their `BatchMonodromy` and `found` their `DominantPairs`.
    """
    vectors, image = _vectors(found), np.empty((found.basis.shape[1], BATCH_SIZE))
    real, imaginary = batch_scratch(period), batch_scratch(period)
    apply_batch_monodromy(period, vectors[0], image, real)
    apply_batch_monodromy(period, vectors[1], image, imaginary)
    time, force = _weighted(
        arrays.points,
        assemblies,
        batch_points,
        speeds,
        period.free.shape[0],
        real.force,
        imaginary.force,
    )
    base, line = np.empty(BATCH_SIZE, dtype=np.complex128), np.empty(BATCH_SIZE)
    for member in range(BATCH_SIZE):
        assembly = assemblies.of_point[batch_points[member]]
        lasting = assemblies.number[assemblies.first_number[assembly]] / speeds[0, member]
        value = found.value[member]
        base[member] = np.log(value if value != 0.0 else complex(1e-300, 0.0)) / lasting
        line[member] = 2.0 * math.pi / lasting
        out[member] = 0.0
    _loudest(arrays.structure, base, line, time, force, out)
