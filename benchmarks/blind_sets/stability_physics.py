"""Limit of a stable cut by the growth of a small disturbance in time.

The disturbance of the steady cut of a straight-edged tool obeys a linear equation with one delay
and coefficients that repeat with the tooth; Runge-Kutta 4 from a random beginning, the delayed
displacement by Hermite polynomials. Stable is what dies out.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
STEPS_A_VIBRATION = 30


class LinearCut(NamedTuple):
    """Straight-edged tool on modes along x and y; SI."""

    teeth: int
    radius: float
    entry: float
    exit: float
    Ktc: float
    Krc: float
    ploughing: float
    ploughing_friction: float
    frequency: Array  # (M,) Hz
    damping: Array
    mass: Array
    direction: Array  # (M, 2)


@njit(cache=True, error_model="numpy")
def _rates(c, speed, depth, t, state, before, rate):
    modes = c.mass.shape[0]
    now, vel = np.zeros(2), np.zeros(2)
    for m in range(modes):
        for i in range(2):
            now[i] += c.direction[m, i] * state[2 * m]
            vel[i] += c.direction[m, i] * state[2 * m + 1]
    fx = fy = 0.0
    for j in range(c.teeth):
        phi = (speed * t + 2.0 * np.pi * j / c.teeth) % (2.0 * np.pi)
        if not c.entry <= phi < c.exit:
            continue
        sine, cosine = np.sin(phi), np.cos(phi)
        h = (now[0] - before[0]) * sine + (now[1] - before[1]) * cosine
        rub = c.ploughing / (speed * c.radius) * (vel[0] * sine + vel[1] * cosine)
        ft = depth * (c.Ktc * h + c.ploughing_friction * rub)
        fr = depth * (c.Krc * h + rub)
        fx += -ft * cosine - fr * sine
        fy += ft * sine - fr * cosine
    for m in range(modes):
        w = 2.0 * np.pi * c.frequency[m]
        push = c.direction[m, 0] * fx + c.direction[m, 1] * fy
        rate[2 * m] = state[2 * m + 1]
        rate[2 * m + 1] = (
            push / c.mass[m] - 2.0 * c.damping[m] * w * state[2 * m + 1] - w * w * state[2 * m]
        )


@njit(cache=True, error_model="numpy")
def growth(c, speed, depth, steps, periods, start):
    """Growth of a disturbance in a tooth period: mean of its logarithm over the later half."""
    size = start.shape[0]
    period = 2.0 * np.pi / (speed * c.teeth)
    step = period / steps
    u, v = np.zeros((2, steps + 1, 2)), np.zeros((2, steps + 1, 2))
    state, trial = start.copy(), start.copy()
    rate = np.zeros((4, size))
    before = np.zeros(2)
    gained, counted = 0.0, 0
    last = 0.0
    for n in range(periods):
        old, new = n % 2, (n + 1) % 2
        level = 0.0
        for k in range(steps + 1):
            for i in range(2):
                u[new, k, i] = v[new, k, i] = 0.0
                for m in range(size // 2):
                    u[new, k, i] += c.direction[m, i] * state[2 * m]
                    v[new, k, i] += c.direction[m, i] * state[2 * m + 1]
                level += u[new, k, i] ** 2
            if k == steps:
                break
            for stage in range(4):
                s = 0.0 if stage == 0 else (1.0 if stage == 3 else 0.5)
                for i in range(2):
                    p0, p1 = u[old, k, i], u[old, k + 1, i]
                    q0, q1 = v[old, k, i] * step, v[old, k + 1, i] * step
                    before[i] = (
                        (1 + 2 * s) * (1 - s) ** 2 * p0
                        + s * (1 - s) ** 2 * q0
                        + s * s * (3 - 2 * s) * p1
                        + s * s * (s - 1) * q1
                    )
                for i in range(size):
                    trial[i] = state[i]
                    if stage > 0:
                        trial[i] += s * step * rate[stage - 1, i]
                _rates(c, speed, depth, (n * steps + k + s) * step, trial, before, rate[stage])
            for i in range(size):
                state[i] += (
                    step / 6.0 * (rate[0, i] + 2.0 * rate[1, i] + 2.0 * rate[2, i] + rate[3, i])
                )
        logarithm = 0.5 * np.log(level + 1e-300)
        if n > periods // 2:
            gained += logarithm - last
            counted += 1
        last = logarithm
        # the equation is linear: scaled back so that it neither dies nor grows out of range
        scale = np.exp(-logarithm)
        state *= scale
        u[new] *= scale
        v[new] *= scale
        last = 0.0
    return gained / counted


def stable(cut: LinearCut, speed: float, depth: float, start: Array) -> bool:
    """Whether a small disturbance dies out."""
    period = 2.0 * np.pi / (speed * cut.teeth)
    steps = max(40, int(np.ceil(period * float(cut.frequency.max()) * STEPS_A_VIBRATION)))
    slowest = float(np.min(cut.damping * cut.frequency)) * 2.0 * np.pi
    # long enough for the slowest part to be left alone
    periods = int(np.clip(12.0 / (slowest * period), 40, 1500))
    return bool(growth(cut, speed, depth, steps, periods, start) < 0.0)


def limit_depth(cut: LinearCut, speed: float, deepest: float, start: Array) -> float:
    """Least depth that chatters, from a coarse search upwards and halving; m."""
    low = deepest / 400.0
    high = low
    while high < deepest and stable(cut, speed, high, start):
        low, high = high, 1.25 * high
    for _ in range(7):
        middle = 0.5 * (low + high)
        if stable(cut, speed, middle, start):
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)
