"""How the spindle turns over a period of the cut: evenly, or with a varying speed."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from chatter.engine.presets import INLINED_KERNEL, KERNEL

#: of the angle, the last that matters on the way to a time
_SMALL_STEP = 1e-9
#: variations in a period
_MOST_CYCLES = 40
#: a variation so many times the least period long meets the teeth at phases enough by itself
_FEW_SHARES = 2
#: ratios closer than this share are the same
_SAME_RATIO = 1e-9


class SpeedVariation(NamedTuple):
    """Periodic variation of the spindle speed around its mean."""

    amplitude: float  # share of the mean; 0 for none
    frequency: float  # Hz
    triangle: int  # 1 for a triangle, 0 for a sine
    tuning: float  # by that share it may be taken faster or slower to fit into a period
    least_periods: int  # 0, or periods of the tool that a period holds at least, where it is one of
    # two between which the true ratio lies
    beyond: int  # 1 for the one of the two with more of them


class SpindleTurn(NamedTuple):
    """Turn of the spindle at one mean speed."""

    speed: float  # mean, rad/s
    amplitude: float
    frequency: float  # Hz, made to fit the period
    triangle: int
    patterns: int  # periods of the tool in a period of the cut
    cycles: int  # of the variation in a period of the cut


#: at a constant speed, in mean angle
STEADY_TURN = SpindleTurn(1.0, 0.0, 1.0, 0, 1, 1)


@njit(**KERNEL)
def _common_divisor(a, b):
    """Greatest common divisor."""
    while b > 0:
        a, b = b, a % b
    return a


@njit(**KERNEL)
def _beside_true_ratio(variation, speed, pattern, a_cycle):
    """Turn with fewer or more tool periods in a period than the true ratio asks for.

    Their number has no divisor in common with that of the variations: the teeth then meet the
    variation at as many phases as there are variations. At a few phases alone, as with a whole
    number of tool periods in a variation, growth is not that of a ratio next to it.
    """
    least = variation.least_periods
    cycles = math.ceil(least / a_cycle)
    if a_cycle < _FEW_SHARES * least:
        cycles = max(2, cycles)
    true = cycles * a_cycle
    patterns = int(max(1.0, np.round(true)))
    if abs(true - patterns) < _SAME_RATIO * true:
        # it fits as it is
        divisor = _common_divisor(patterns, cycles)
        patterns, cycles = patterns // divisor, cycles // divisor
    else:
        # in steps, so that many speeds have like periods
        step = max(1, math.floor(true / least))
        while _common_divisor(step, cycles) > 1:
            step -= 1
        patterns = step * (math.floor(true / step) + variation.beyond)
        while _common_divisor(patterns, cycles) > 1 and patterns > 1:
            patterns += step if variation.beyond == 1 else -step
        patterns = max(1, patterns)
    frequency = cycles * speed / (patterns * pattern)
    return SpindleTurn(speed, variation.amplitude, frequency, variation.triangle, patterns, cycles)


@njit(**KERNEL)
def spindle_turn(variation, speed, pattern):
    """Fit a whole number of variations into a whole number of tool periods.

    Parameters
    ----------
    variation : SpeedVariation
    speed : float
        rad/s.
    pattern : float
        Angle after which the tool looks the same again, rad.

    Returns
    -------
    SpindleTurn
    """
    if variation.amplitude == 0.0:
        return SpindleTurn(speed, 0.0, 1.0, 0, 1, 1)
    a_cycle = speed / (variation.frequency * pattern)
    if variation.least_periods > 0:
        return _beside_true_ratio(variation, speed, pattern, a_cycle)
    best, best_error = 1, np.inf
    for cycles in range(1, _MOST_CYCLES + 1):
        whole = max(1.0, np.round(cycles * a_cycle))
        error = abs(whole / (cycles * a_cycle) - 1.0)
        if error < 0.5 * best_error:
            best, best_error = cycles, error
        if best_error < variation.tuning:
            break
    # in steps, so that many speeds have like periods
    step = max(1.0, np.floor(variation.tuning * best * a_cycle))
    patterns = int(max(1.0, step * np.round(best * a_cycle / step)))
    frequency = best * speed / (patterns * pattern)
    return SpindleTurn(speed, variation.amplitude, frequency, variation.triangle, patterns, best)


@njit(**KERNEL)
def in_mean_angle(turn):
    """The same turn with the mean angle in place of time: the mean speed is 1."""
    return SpindleTurn(
        1.0, turn.amplitude, turn.frequency / turn.speed, turn.triangle, turn.patterns, turn.cycles
    )


@njit(**INLINED_KERNEL)
def angle_at(turn, time):
    """Angle turned since time zero, rad."""
    if turn.amplitude == 0.0:
        return turn.speed * time
    cycle = turn.frequency * time
    cycle -= math.floor(cycle)
    if turn.triangle == 0:
        swing = (1.0 - math.cos(2.0 * math.pi * cycle)) / (2.0 * math.pi)
    elif cycle < 0.25:
        swing = 2.0 * cycle * cycle
    elif cycle < 0.75:
        swing = 0.25 - 2.0 * (cycle - 0.5) ** 2
    else:
        swing = 2.0 * (1.0 - cycle) ** 2
    return turn.speed * (time + turn.amplitude / turn.frequency * swing)


@njit(**INLINED_KERNEL)
def speed_at(turn, time):
    """Spindle speed, rad/s."""
    if turn.amplitude == 0.0:
        return turn.speed
    cycle = turn.frequency * time
    cycle -= math.floor(cycle)
    if turn.triangle == 0:
        wave = math.sin(2.0 * math.pi * cycle)
    elif cycle < 0.25:
        wave = 4.0 * cycle
    elif cycle < 0.75:
        wave = 2.0 - 4.0 * cycle
    else:
        wave = 4.0 * cycle - 4.0
    return turn.speed * (1.0 + turn.amplitude * wave)


@njit(**KERNEL)
def time_at(turn, angle):
    """Time at which the spindle has turned by an angle, s."""
    time = angle / turn.speed
    if turn.amplitude == 0.0:
        return time
    time -= (angle_at(turn, time) - angle) / turn.speed
    for _ in range(60):
        step = (angle_at(turn, time) - angle) / speed_at(turn, time)
        time -= step
        # the error of the next is as the square of that of the last
        if abs(step) * turn.speed < _SMALL_STEP * max(1.0, abs(angle)):
            break
    return time
