"""Frequency that is heard of the dominant motion of a cut."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from chatter.kernels import INNER_KERNEL, SINGLE_KERNEL
from chatter.lanes import LANES
from chatter.stability.element_map import apply_element_map, element_scratch

#: harmonics looked at, up to this factor beyond the highest mode
_HIGHEST = 2.0


@njit(**SINGLE_KERNEL)
def _amplitude(structure, s, force):
    """Displacement of the tool point under a force exp(s t), squared."""
    modes, rank = structure.shape.shape
    motion = np.zeros(rank, dtype=np.complex128)
    for m in range(modes):
        w, zeta = structure.natural_frequency[m], structure.damping[m]
        push = complex(0.0, 0.0)
        for k in range(rank):
            push += structure.force_gain[m, k] * force[k]
        push /= s * s + 2.0 * zeta * w * s + w * w
        for k in range(rank):
            motion[k] += structure.shape[m, k] * push
    total = 0.0
    for k in range(rank):
        total += motion[k].real ** 2 + motion[k].imag ** 2
    return total


@njit(**SINGLE_KERNEL)
def _loudest(structure, value, time, weighted, period):
    """Frequency (Hz) at which a motion is largest whose force at n times is weighted (n, r).

    The force is taken apart into exp((sigma + i omega_l) t) over the period, and drives the
    structure at each omega_l.
    """
    base = np.log(value if value != 0.0 else complex(1e-300, 0.0)) / period
    line = 2.0 * math.pi / period
    order = math.ceil(_HIGHEST * structure.natural_frequency.max() / line) + 1
    step = np.exp(complex(0.0, -line) * time)
    now = np.exp(-(base - complex(0.0, order * line)) * time)
    force = np.empty(weighted.shape[1], dtype=np.complex128)
    best, loudest = -1.0, 0.0
    for harmonic in range(-order, order + 1):
        force[:] = 0.0
        for i in range(time.shape[0]):
            for k in range(force.shape[0]):
                force[k] += now[i] * weighted[i, k]
            now[i] *= step[i]
        s = base + complex(0.0, harmonic * line)
        amplitude = _amplitude(structure, s, force)
        if amplitude > best:
            best, loudest = amplitude, abs(s.imag)
    return loudest / (2.0 * math.pi)


@njit(**INNER_KERNEL)
def _vectors(found):
    """Real and imaginary part of the dominant vector of every lane (2, D, 8)."""
    vectors = np.zeros((2, found.basis.shape[1], LANES))
    for lane in range(LANES):
        for j in range(found.used[lane]):
            c = found.coordinates[lane, j]
            for i in range(found.basis.shape[1]):
                vectors[0, i, lane] += c.real * found.basis[j, i, lane]
                vectors[1, i, lane] += c.imag * found.basis[j, i, lane]
    return vectors


@njit(**SINGLE_KERNEL)
def heard_frequencies(arrays, plans, members, speeds, period, found, out):
    """Set out (8,) to the chatter frequency (Hz) of the dominant motion of every lane.

    Parameters
    ----------
    arrays : MapArrays
    plans : Plans
    members : (8,) array of int
        Point of every lane.
    speeds : (1, 8) array of float
        rad/s.
    period : ElementMap
    found : DominantPairs
    out : (8,) array of float
    """
    structure, points = arrays.structure, arrays.points
    cuts = period.couple.shape[0]
    rank, count = period.output.shape[0], points.weight.shape[0]
    vectors, image = _vectors(found), np.empty((found.basis.shape[1], LANES))
    real, imaginary = element_scratch(period), element_scratch(period)
    apply_element_map(period, vectors[0], image, real)
    apply_element_map(period, vectors[1], image, imaginary)
    time = np.empty(cuts * count)
    weighted = np.empty((cuts * count, rank), dtype=np.complex128)
    first = 1 + period.free.shape[0]
    for lane in range(LANES):
        plan, speed = plans.of_point[members[lane]], speeds[0, lane]
        of_plan = plans.number[plans.first_number[plan] : plans.first_number[plan + 1]]
        for e in range(cuts):
            start, length = of_plan[first + e] / speed, of_plan[first + cuts + e] / speed
            for i in range(count):
                row = e * count + i
                time[row] = start + length * points.place[i + 1]
                for k in range(rank):
                    at = i * rank + k
                    force = complex(real.force[e, at, lane], imaginary.force[e, at, lane])
                    weighted[row, k] = length * points.weight[i] * force
        out[lane] = _loudest(structure, found.value[lane], time, weighted, of_plan[0] / speed)
