"""Turning with a delay that varies in time, and its largest multiplier over a period.

    x'' + damping x' + (1 + cut) x = cut x(t - delay(t))

Independent of the product: Chebyshev points on equal elements of the period, no steps in time.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.linalg import eigvals
from scipy.optimize import brentq


def spectral_radius(delay, period, damping, cut, elements=30, points=16):
    """Largest multiplier over a period that is longer than any delay."""
    place = -np.cos(np.pi * np.arange(points) / (points - 1))
    weight = (-1.0) ** np.arange(points)
    weight[[0, -1]] *= 0.5
    apart = place[:, None] - place + np.eye(points)
    slope = np.where(np.eye(points), 0.0, weight / weight[:, None] / apart)
    slope -= np.diag(slope.sum(axis=1))
    length = period / elements
    slope *= 2.0 / length
    size = elements * points
    # rows: position first, speed after it; `now` acts on this period, `before` on the last one
    now, before = np.zeros((2, 2 * size, 2 * size))
    for row in range(size):
        element, i = divmod(row, points)
        x = slice(element * points, (element + 1) * points)
        v = slice(size + x.start, size + x.stop)
        if i == 0:
            last = (row - 1) % size
            for shift in (0, size):
                now[row + shift, row + shift] = 1.0
                if element:
                    now[row + shift, last + shift] = -1.0
                else:
                    before[row + shift, last + shift] = 1.0
            continue
        now[row, x], now[size + row, v] = slope[i], slope[i]
        now[row, size + row] -= 1.0
        now[size + row, size + row] += damping
        now[size + row, row] += 1.0 + cut
        t = length * (element + 0.5 * (place[i] + 1.0))
        ago = t - delay(t)
        target, sign = (now, -cut) if ago >= 0.0 else (before, cut)
        at, share = _interpolation(ago % period / length, elements, place, weight)
        target[size + row, at : at + points] += sign * share
    return float(np.abs(eigvals(np.linalg.solve(now, before))).max())


def _interpolation(where, elements, place, weight):
    """First point of the element (counted from zero) at a place, and the weights of its points."""
    element = min(int(where), elements - 1)
    apart = 2.0 * (where - element) - 1.0 - place
    on = np.abs(apart) < 1e-14
    share = on.astype(float) if on.any() else weight / apart
    return element * place.size, share / share.sum()


def delay_of_a_spindle(mean, amplitude, frequency, triangle=False):
    """Time in which a spindle of varying speed turns by what it turns on average in `mean`."""

    def turned(t):
        cycle = frequency * t % 1.0
        if not triangle:
            swing = (1.0 - math.cos(2.0 * math.pi * cycle)) / (2.0 * math.pi)
        elif cycle < 0.25:
            swing = 2.0 * cycle**2
        elif cycle < 0.75:
            swing = 0.25 - 2.0 * (cycle - 0.5) ** 2
        else:
            swing = 2.0 * (1.0 - cycle) ** 2
        return t + amplitude / frequency * swing

    def delay(t):
        end = turned(t) - mean
        return t - brentq(lambda s: turned(s) - end, t - 4.0 * mean, t, xtol=1e-14 * mean)

    return delay
