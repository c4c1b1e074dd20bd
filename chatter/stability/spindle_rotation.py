"""Rotation of the spindle over a period of the cut, at a constant or a varying speed."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from chatter.engine.presets import DRIVER, INLINED_KERNEL, INNER_KERNEL, KERNEL

#: of the angle, relative to it and to a radian: no more is left on the way to a time
_ANGLE_LEFT = 1e-14
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


class PeriodFit(NamedTuple):
    """How a whole number of variations is fitted into a whole number of tool periods."""

    tuning: float = 1e-3  # share by which the frequency may be moved
    least_periods: int = 0  # tool periods in a period at least, where its ratio is one of the two
    # between which the true one lies; 0 for the nearest ratio within the tuning
    tried: int = 1  # numbers of variations in such a period, from the least on
    beyond: int = 0  # 1 for the one of the two with more tool periods


class SpindleRotation(NamedTuple):
    """Rotation of the spindle at one mean speed."""

    speed: float  # mean, rad/s
    amplitude: float
    frequency: float  # Hz, made to fit the period
    triangle: int
    patterns: int  # periods of the tool in a period of the cut
    cycles: int  # of the variation in a period of the cut


CONSTANT_SPEED = SpeedVariation(0.0, 1.0, 0)
#: at a constant speed, in mean angle
STEADY_ROTATION = SpindleRotation(1.0, 0.0, 1.0, 0, 1, 1)


@njit(**INNER_KERNEL)
def _common_divisor(a, b):
    """Greatest common divisor."""
    while b > 0:
        a, b = b, a % b
    return a


@njit(**INNER_KERNEL)
def _beside_true_ratio(variation, fit, speed, pattern, per_cycle):
    """Rotation with fewer or more tool periods in a variation than the true ratio.

    Of all ratios with as many variations in a period as are tried it is the nearest one. Tool
    periods and variations have no divisor in common: the teeth then meet the variation at as many
    phases as there are variations. At a few phases alone, as with a whole number of tool periods in
    a variation, growth is not that of a ratio next to it.
    """
    least = fit.least_periods
    fewest = math.ceil(least / per_cycle)
    if per_cycle < _FEW_SHARES * least:
        fewest = max(2, fewest)
    side = 1.0 if fit.beyond == 1 else -1.0
    patterns, cycles, nearest = 0, fewest, np.inf
    for tried in range(fewest, fewest + fit.tried):
        true = tried * per_cycle
        whole = int(max(1.0, np.round(true)))
        if abs(true - whole) < _SAME_RATIO * true:
            # it fits as it is
            divisor = _common_divisor(whole, tried)
            patterns, cycles = whole // divisor, tried // divisor
            break
        whole = int(math.ceil(true) if fit.beyond == 1 else math.floor(true))
        while _common_divisor(whole, tried) > 1 and whole > 1:
            whole += int(side)
        whole = max(1, whole)
        apart = side * (whole / tried - per_cycle)
        if patterns == 0 or apart < nearest:
            patterns, cycles, nearest = whole, tried, apart
    frequency = cycles * speed / (patterns * pattern)
    return SpindleRotation(
        speed, variation.amplitude, frequency, variation.triangle, patterns, cycles
    )


@njit(**KERNEL)
def spindle_rotation_at(variation, fit, speed, pattern):
    """Fit a whole number of variations into a whole number of tool periods at a speed (rad/s).

    `pattern` is the angle after which the tool repeats itself, rad.
    """
    if variation.amplitude == 0.0:
        return SpindleRotation(speed, 0.0, 1.0, 0, 1, 1)
    per_cycle = speed / (variation.frequency * pattern)
    if fit.least_periods > 0:
        return _beside_true_ratio(variation, fit, speed, pattern, per_cycle)
    best, best_error = 1, np.inf
    for cycles in range(1, _MOST_CYCLES + 1):
        whole = max(1.0, np.round(cycles * per_cycle))
        error = abs(whole / (cycles * per_cycle) - 1.0)
        if error < 0.5 * best_error:
            best, best_error = cycles, error
        if best_error < fit.tuning:
            break
    # in steps, so that many speeds have like periods
    step = max(1.0, np.floor(fit.tuning * best * per_cycle))
    patterns = int(max(1.0, step * np.round(best * per_cycle / step)))
    frequency = best * speed / (patterns * pattern)
    return SpindleRotation(
        speed, variation.amplitude, frequency, variation.triangle, patterns, best
    )


@njit(**DRIVER)
def fitted_periods(variation, fit, speeds, pattern):
    """Tool periods and variations in a period of the cut at n speeds (rad/s), both (n,)."""
    patterns = np.empty(speeds.shape[0], dtype=np.int64)
    cycles = np.empty(speeds.shape[0], dtype=np.int64)
    for i in range(speeds.shape[0]):
        rotation = spindle_rotation_at(variation, fit, speeds[i], pattern)
        patterns[i], cycles[i] = rotation.patterns, rotation.cycles
    return patterns, cycles


@njit(**INNER_KERNEL)
def in_mean_angle(rotation, pattern):
    """The same rotation with the mean angle in place of time: the mean speed is 1.

    `pattern` is the angle after which the tool repeats itself, rad. Rotations of like periods are
    the same to the last digit.
    """
    return SpindleRotation(
        1.0,
        rotation.amplitude,
        rotation.cycles / (rotation.patterns * pattern),
        rotation.triangle,
        rotation.patterns,
        rotation.cycles,
    )


@njit(**INLINED_KERNEL)
def angle_at(rotation, time):
    """Angle turned since time zero, rad."""
    if rotation.amplitude == 0.0:
        return rotation.speed * time
    cycle = rotation.frequency * time
    cycle -= math.floor(cycle)
    if rotation.triangle == 0:
        swing = (1.0 - math.cos(2.0 * math.pi * cycle)) / (2.0 * math.pi)
    elif cycle < 0.25:
        swing = 2.0 * cycle * cycle
    elif cycle < 0.75:
        swing = 0.25 - 2.0 * (cycle - 0.5) ** 2
    else:
        swing = 2.0 * (1.0 - cycle) ** 2
    return rotation.speed * (time + rotation.amplitude / rotation.frequency * swing)


@njit(**INLINED_KERNEL)
def speed_at(rotation, time):
    """Spindle speed, rad/s."""
    if rotation.amplitude == 0.0:
        return rotation.speed
    cycle = rotation.frequency * time
    cycle -= math.floor(cycle)
    if rotation.triangle == 0:
        wave = math.sin(2.0 * math.pi * cycle)
    elif cycle < 0.25:
        wave = 4.0 * cycle
    elif cycle < 0.75:
        wave = 2.0 - 4.0 * cycle
    else:
        wave = 4.0 * cycle - 4.0
    return rotation.speed * (1.0 + rotation.amplitude * wave)


@njit(**INLINED_KERNEL)
def swing_range(rotation):
    """How far the angle gained and lost over a variation lies apart, over that of one variation."""
    return 1.0 / math.pi if rotation.triangle == 0 else 0.25


@njit(**INNER_KERNEL)
def time_near(rotation, angle, time):
    """Time at which the spindle has turned by an angle, s, searched from another on."""
    if rotation.amplitude == 0.0:
        return angle / rotation.speed
    # Newton: of an error this share of its square is left at the most, rad
    steepest = math.pi if rotation.triangle == 0 else 2.0
    bend = steepest * rotation.amplitude * rotation.frequency
    bend /= rotation.speed * (1.0 - rotation.amplitude) ** 2
    for _ in range(60):
        step = (angle_at(rotation, time) - angle) / speed_at(rotation, time)
        time -= step
        if bend * (rotation.speed * step) ** 2 < _ANGLE_LEFT * max(1.0, abs(angle)):
            break
    return time


@njit(**KERNEL)
def time_at(rotation, angle):
    """Time at which the spindle has turned by an angle, s."""
    time = angle / rotation.speed
    if rotation.amplitude == 0.0:
        return time
    return time_near(rotation, angle, time - (angle_at(rotation, time) - angle) / rotation.speed)
