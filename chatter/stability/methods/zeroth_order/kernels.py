"""Critical depth of the zeroth-order frequency solution at given speeds, in compiled code."""

import math

import numpy as np
from numba import njit

from chatter.engine.presets import DRIVER, INNER_KERNEL

_BISECTIONS = 48


@njit(**INNER_KERNEL)
def _regeneration_phase(real, imag):
    """Angle theta in (0, 2 pi) with w (1 - exp(-i theta)) = z, for Re z > 0."""
    return 2.0 * math.atan2(real, imag)


@njit(**INNER_KERNEL)
def _depth(real, imag):
    """Depth w with w (1 - exp(-i theta)) = z."""
    return (real * real + imag * imag) / (2.0 * real)


@njit(**INNER_KERNEL)
def _excess_phase(delay, omega, step, start, change, t):
    real = start.real + t * change.real
    imag = start.imag + t * change.imag
    return (omega + t * step) * delay - _regeneration_phase(real, imag)


@njit(**INNER_KERNEL)
def _lowest_between_lines(delay, omega, step, start, change, limit, frequency):
    """Lower the limit by the lobes that cross the speed between two frequency lines."""
    # keep to the part of the interval where the depth is positive
    first, last = 0.0, 1.0
    if start.real <= 0.0 and start.real + change.real <= 0.0:
        return limit, frequency
    if start.real <= 0.0:
        first = -start.real / change.real + 1e-12
    elif start.real + change.real <= 0.0:
        last = -start.real / change.real - 1e-12
    at_first = _excess_phase(delay, omega, step, start, change, first)
    at_last = _excess_phase(delay, omega, step, start, change, last)
    lowest = math.ceil(min(at_first, at_last) / (2.0 * math.pi))
    highest = math.floor(max(at_first, at_last) / (2.0 * math.pi))
    for lobe in range(lowest, highest + 1):
        target = 2.0 * math.pi * lobe
        a, b = first, last
        rising = at_last > at_first
        for _ in range(_BISECTIONS):
            t = 0.5 * (a + b)
            if (_excess_phase(delay, omega, step, start, change, t) < target) == rising:
                a = t
            else:
                b = t
        t = 0.5 * (a + b)
        depth = _depth(start.real + t * change.real, start.imag + t * change.imag)
        if 0.0 < depth < limit:
            limit, frequency = depth, (omega + t * step) / (2.0 * math.pi)
    return limit, frequency


@njit(**INNER_KERNEL)
def order_like(before, now):
    """Reorder values (r,) in position, each next to that before it."""
    for branch in range(now.shape[0] - 1):
        nearest = branch
        for other in range(branch + 1, now.shape[0]):
            if abs(now[other] - before[branch]) < abs(now[nearest] - before[branch]):
                nearest = other
        now[branch], now[nearest] = now[nearest], now[branch]


@njit(**DRIVER)
def order_like_neighbours(eigenvalues):
    """Reorder the rows (n, r) in position so that each column is continuous."""
    for line in range(1, eigenvalues.shape[0]):
        order_like(eigenvalues[line - 1], eigenvalues[line])


@njit(**INNER_KERNEL)
def _no_lobe_between(omega, phase, line, branch, delay):
    """Quick refusal: True where no lobe can cross the speed between two lines."""
    a, b = phase[line, branch], phase[line + 1, branch]
    if np.isnan(a) and np.isnan(b):
        return True
    if np.isnan(a) or np.isnan(b):
        return False
    first = (omega[line] * delay - a) / (2.0 * math.pi)
    last = (omega[line + 1] * delay - b) / (2.0 * math.pi)
    return math.floor(first) == math.floor(last)


@njit(**DRIVER)
def zero_order_limits(omega, inverse, delays):
    """Lowest depth over all lobes and eigenvalues at each delay.

    Frequencies omega (n,), rad/s, ascend; `inverse` (n, r) is z = -1/eigenvalue of G(i omega) H0,
    m, each column one branch, continuous in omega; delays (k,) are tooth periods, s. Returned are
    the depth (k,), m, infinite where no lobe reaches the speed, and the chatter frequency (k,), Hz,
    nan there.
    """
    depth = np.full(delays.shape[0], np.inf)
    frequency = np.full(delays.shape[0], np.nan)
    lines, branches = inverse.shape
    phase = np.full((lines, branches), np.nan)
    for line in range(lines):
        for branch in range(branches):
            z = inverse[line, branch]
            if z.real > 0.0:
                phase[line, branch] = _regeneration_phase(z.real, z.imag)
    for i in range(delays.shape[0]):
        limit, at = np.inf, np.nan
        for branch in range(branches):
            for line in range(lines - 1):
                if _no_lobe_between(omega, phase, line, branch, delays[i]):
                    continue
                start = inverse[line, branch]
                change = inverse[line + 1, branch] - start
                step = omega[line + 1] - omega[line]
                limit, at = _lowest_between_lines(
                    delays[i], omega[line], step, start, change, limit, at
                )
        depth[i], frequency[i] = limit, at
    return depth, frequency
