"""Multipliers on points and stability limits along depth: the compiled loops over points."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from chatter.kernels import DRIVER, KERNEL
from chatter.stability.multipliers import dominant_multiplier
from chatter.stability.period_map import advance_step, build_period_map

#: crossings kept per speed
_MOST_CROSSINGS = 32
#: a limit is found when its bracket is this small, relative to the depth
_DEPTH_TOLERANCE = 1e-7
_MOST_ITERATIONS = 60
#: the plain value on the net may be off by this much in log|mu|
_DOUBTFUL_GROWTH = 0.2


@njit(**KERNEL)
def multiplier(arrays, speed, depth, steps, refinements):
    """Dominant multiplier, extrapolated over nested refinements of the steps.

    Parameters
    ----------
    arrays : MillingArrays
    speed, depth : float
        rad/s, m.
    steps : int
        Steps a tooth period.
    refinements : (1,) or (2,) array of int
        ``[1]`` for plain semi-discretization; ``[1, 2]`` removes its second-order error
        (Richardson).

    Returns
    -------
    complex
        Imaginary part >= 0.
    """
    period = build_period_map(arrays, speed, depth, steps, refinements[0], 1)
    value, _, _ = dominant_multiplier(period)
    if refinements.shape[0] > 1:
        period = build_period_map(arrays, speed, depth, steps, refinements[1], 1)
        finer, _, _ = dominant_multiplier(period)
        ratio = (refinements[1] / refinements[0]) ** 2
        correction = (finer - value) / (ratio - 1.0)
        # where two multipliers change places between the refinements there is nothing to correct
        if abs(correction) < 0.2 * abs(finer):
            finer += correction
        value = complex(finer.real, abs(finer.imag))
    return value


@njit(**DRIVER)
def multipliers_at(arrays, speeds, depths, steps, refinements):
    """Dominant multipliers (n,) of n points (speed, depth, steps)."""
    out = np.empty(speeds.shape[0], dtype=np.complex128)
    for i in range(speeds.shape[0]):
        out[i] = multiplier(arrays, speeds[i], depths[i], steps[i], refinements)
    return out


@njit(**KERNEL)
def _growth(arrays, speed, depth, steps, refinements):
    """Logarithm of the spectral radius: positive is unstable."""
    size = abs(multiplier(arrays, speed, depth, steps, refinements))
    return math.log(max(size, 1e-30))


@njit(**KERNEL)
def _limit_between(arrays, speed, low, high, at_low, at_high, steps, refinements):
    """Depth at which the growth changes sign (Illinois method, bracket kept)."""
    side = 0
    for iteration in range(_MOST_ITERATIONS):
        if high - low <= _DEPTH_TOLERANCE * high:
            break
        middle = high - at_high * (high - low) / (at_high - at_low)
        # stay inside where one end is far steeper than the other
        margin = 0.02 * (high - low) if iteration % 3 == 2 else 0.0
        middle = min(max(middle, low + margin), high - margin)
        at_middle = _growth(arrays, speed, middle, steps, refinements)
        if abs(at_middle) < 1e-9:
            return middle
        if (at_middle > 0.0) == (at_high > 0.0):
            high, at_high = middle, at_middle
            if side == 1:
                at_low *= 0.5
            side = 1
        else:
            low, at_low = middle, at_middle
            if side == -1:
                at_high *= 0.5
            side = -1
    return 0.5 * (low + high)


@njit(**KERNEL)
def _growth_on_net(arrays, speed, depths, steps, refinements):
    """Growth at each depth; extrapolated only where the plain value leaves the sign in doubt."""
    plain = np.ones(1, dtype=np.int64)
    growth = np.empty(depths.shape[0])
    for k in range(depths.shape[0]):
        growth[k] = _growth(arrays, speed, depths[k], steps, plain)
        if abs(growth[k]) < _DOUBTFUL_GROWTH:
            growth[k] = _growth(arrays, speed, depths[k], steps, refinements)
    return growth


@njit(**DRIVER)
def crossings_along_depth(arrays, speeds, depths, steps, refinements):
    """Depths at which stability is lost or regained, at each speed.

    Parameters
    ----------
    arrays : MillingArrays
    speeds : (n,) array of float
        rad/s.
    depths : (m,) array of float
        m, ascending, > 0: the net on which changes of stability are looked for. At zero depth
        the structure is damped and stable.
    steps : (n,) array of int
        Steps a tooth period at each speed.
    refinements : array of int
        As in `multiplier`.

    Returns
    -------
    count : (n,) array of int
        Number of crossings at each speed.
    crossing : (n, most) array of float
        m, ascending; stability is lost at even places and regained at odd ones.
    """
    count = np.zeros(speeds.shape[0], dtype=np.int64)
    crossing = np.full((speeds.shape[0], _MOST_CROSSINGS), np.nan)
    for i in range(speeds.shape[0]):
        speed = speeds[i]
        growth = _growth_on_net(arrays, speed, depths, steps[i], refinements)
        low, unstable = 0.0, False
        for k in range(depths.shape[0]):
            if (growth[k] > 0.0) != unstable and count[i] < _MOST_CROSSINGS:
                at_low = _growth(arrays, speed, low, steps[i], refinements)
                at_high = _growth(arrays, speed, depths[k], steps[i], refinements)
                limit = low
                if (at_low > 0.0) != (at_high > 0.0):
                    limit = _limit_between(
                        arrays, speed, low, depths[k], at_low, at_high, steps[i], refinements
                    )
                crossing[i, count[i]] = limit
                count[i] += 1
                unstable = not unstable
            low = depths[k]
    return count, crossing


@njit(**DRIVER)
def motion_harmonics(arrays, speed, depth, steps, harmonics):
    """Dominant multiplier and the spectrum of the motion that belongs to it.

    Parameters
    ----------
    arrays : MillingArrays
    speed, depth : float
        rad/s, m.
    steps : int
        Steps a tooth period, in and out of the cut.
    harmonics : int
        Highest tooth-passing harmonic on either side of the chatter frequency's base.

    Returns
    -------
    multiplier : complex
    frequency : (2 harmonics + 1,) array of float
        Hz, signed: (arg(mu) + 2 pi l)/T / 2 pi.
    amplitude : (2 harmonics + 1,) array of float
        Amplitude of each, relative.
    """
    period = build_period_map(arrays, speed, depth, steps, 1, steps)
    value, vector, _ = dominant_multiplier(period)
    total_steps, size, rank = period.from_left.shape
    duration = arrays.tooth_pitch / speed
    growth, base = math.log(max(abs(value), 1e-300)) / duration, np.angle(value) / duration
    frequency = np.empty(2 * harmonics + 1)
    amplitude = np.empty(2 * harmonics + 1)
    motion = np.zeros((total_steps + 1, rank), dtype=np.complex128)
    state, following = np.empty(size), np.empty(size)
    for part in range(2):
        factor = 1.0 + 0.0j if part == 0 else 1.0j
        source = vector.real.copy() if part == 0 else vector.imag.copy()
        _trace_motion(period, source, state, following, factor, motion)
    for m in range(2 * harmonics + 1):
        omega = base + 2.0 * math.pi * (m - harmonics) / duration
        frequency[m] = omega / (2.0 * math.pi)
        power = 0.0
        for k in range(rank):
            total = 0.0 + 0.0j
            time = 0.0
            for s in range(total_steps):
                h = period.duration[s]
                at_start = np.exp(-(growth + 1j * omega) * time) * motion[s, k]
                at_end = np.exp(-(growth + 1j * omega) * (time + h)) * motion[s + 1, k]
                total += 0.5 * h * (at_start + at_end)
                time += h
            power += abs(total / duration) ** 2
        amplitude[m] = math.sqrt(power)
    return value, frequency, amplitude


@njit(**KERNEL)
def _trace_motion(period, source, state, following, factor, motion):
    """Add factor times the motion at every step border to motion (steps+1, r)."""
    steps, size, rank = period.from_left.shape
    state[:] = source[:size]
    for s in range(steps + 1):
        for k in range(rank):
            for j in range(size):
                motion[s, k] += factor * period.output[k, j] * state[j]
        if s < steps:
            advance_step(period, s, source, state, following)
