"""Frequency that is heard of the dominant motion of a cut."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from chatter.kernels import KERNEL
from chatter.lanes import LANES
from chatter.stability.element_map import force_over_period

#: harmonics looked at, up to this factor beyond the highest mode
_HIGHEST = 2.0


@njit(**KERNEL)
def _amplitude(cut, s, force):
    """Displacement of the tool point under a force exp(s t), squared."""
    modes, rank = cut.shape.shape
    motion = np.zeros(rank, dtype=np.complex128)
    for m in range(modes):
        w, zeta = cut.natural_frequency[m], cut.damping[m]
        push = complex(0.0, 0.0)
        for k in range(rank):
            push += cut.force_gain[m, k] * force[k]
        push /= s * s + 2.0 * zeta * w * s + w * w
        for k in range(rank):
            motion[k] += cut.shape[m, k] * push
    total = 0.0
    for k in range(rank):
        total += motion[k].real ** 2 + motion[k].imag ** 2
    return total


@njit(**KERNEL)
def _loudest(cut, value, time, weighted, period):
    """Frequency (Hz) at which a motion is largest whose force at n times is weighted (n, r).

    The force is taken apart into exp((sigma + i omega_l) t) over the period, and drives the
    structure at each omega_l.
    """
    base = np.log(value if value != 0.0 else complex(1e-300, 0.0)) / period
    line = 2.0 * math.pi / period
    order = math.ceil(_HIGHEST * cut.natural_frequency.max() / line) + 1
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
        amplitude = _amplitude(cut, s, force)
        if amplitude > best:
            best, loudest = amplitude, abs(s.imag)
    return loudest / (2.0 * math.pi)


@njit(**KERNEL)
def heard_frequencies(cut, plans, members, speeds, period, found, out):
    """Set out (8,) to the chatter frequency (Hz) of the dominant motion of every lane.

    Parameters
    ----------
    cut : CutArrays
    plans : list of CutPlan
    members : (8,) array of int
        Plan of every lane.
    speeds : (8,) array of float
        rad/s.
    period : ElementMap
    found : DominantPairs
    out : (8,) array of float
    """
    cuts, values, _, _ = period.couple.shape
    rank = period.output.shape[0]
    points = values // rank
    dimension = found.basis.shape[1]
    vectors = np.zeros((2, dimension, LANES))
    for lane in range(LANES):
        for j in range(found.used[lane]):
            c = found.coordinates[lane, j]
            for i in range(dimension):
                vectors[0, i, lane] += c.real * found.basis[j, i, lane]
                vectors[1, i, lane] += c.imag * found.basis[j, i, lane]
    force = np.zeros((2, cuts, values, LANES))
    force_over_period(period, vectors[0], force[0])
    force_over_period(period, vectors[1], force[1])
    time = np.empty(cuts * points)
    weighted = np.empty((cuts * points, rank), dtype=np.complex128)
    for lane in range(LANES):
        layout, speed = plans[members[lane]].layout, speeds[lane]
        for e in range(cuts):
            length = layout.cut_length[e]
            for i in range(points):
                row = e * points + i
                time[row] = (layout.cut_start[e] + length * cut.points.place[i + 1]) / speed
                weight = length / speed * cut.points.weight[i]
                for k in range(rank):
                    at = i * rank + k
                    weighted[row, k] = weight * complex(force[0, e, at, lane], force[1, e, at, lane])
        out[lane] = _loudest(cut, found.value[lane], time, weighted, layout.period / speed)
