"""Exact response of the modes over one step of the matrix-free method.

Over a plain step the cutting force is the line through its values at the two Gauss points. Over one
that is graded towards a vanishing chip, force times rate of time is that line; see
`matrix_free_steps`.
"""

import math

import numpy as np
from numba import njit

from chatter.engine.presets import INNER_KERNEL, KERNEL

#: Gauss points of a step, and where the motion is kept besides: its middle and its end
_ROOT = math.sqrt(3.0) / 6.0
POSITIONS = np.array([0.5 - _ROOT, 0.5 + _ROOT, 0.5, 1.0])
#: below this angle of a mode in a step the series holds more digits than the closed form
_SERIES_BELOW = 1.5
_TERMS = 40
#: points of the quadrature over a graded step: so many, one more a radian of the mode, and the most
_FEWEST_POINTS, _MOST_POINTS = 6, 16


@njit(**INNER_KERNEL)
def _ramp(angle, damping, s):
    """Answer of y'' + 2 zeta a y' + a^2 y = s, at rest at zero: y, y', y'' at s.

    y' is the response to a step of force, y'' that to an impulse.
    """
    if angle > _SERIES_BELOW:
        root = math.sqrt(1.0 - damping * damping)
        fade = math.exp(-damping * angle * s)
        sine, cosine = fade * math.sin(root * angle * s), fade * math.cos(root * angle * s)
        impulse = sine / (root * angle)
        step = (1.0 - cosine - damping / root * sine) / angle**2
        return (s - impulse - 2.0 * damping * angle * step) / angle**2, step, impulse
    before, last = 0.0, 1.0 / 6.0
    power = s
    ramp, step, impulse = last * power * s * s, 3.0 * last * power * s, 6.0 * last * power
    for k in range(2, _TERMS):
        following = -2.0 * damping * angle * (k + 1) * last - angle * angle * before
        following /= (k + 2) * (k + 1)
        power *= s
        impulse += (k + 2) * (k + 1) * following * power
        step += (k + 2) * following * power * s
        ramp += following * power * s * s
        before, last = last, following
    return ramp, step, impulse


@njit(**KERNEL)
def mode_response(frequency, damping, length, out):
    """Answer of one mode at the positions of a step.

    Frequency in rad/s, damping ratio, length of the step in s. Overwritten is `out` (4, 2, 4): for
    each of `POSITIONS` the coordinate x and x'/omega from x and x'/omega at the start and the
    accelerations at the two Gauss points.
    """
    angle = frequency * length
    root = math.sqrt(1.0 - damping * damping)
    first, second = POSITIONS[0], POSITIONS[1]
    for p in range(4):
        s = POSITIONS[p]
        fade = math.exp(-damping * angle * s)
        sine, cosine = fade * math.sin(root * angle * s), fade * math.cos(root * angle * s)
        out[p, 0, 0], out[p, 0, 1] = cosine + damping / root * sine, sine / root
        out[p, 1, 0], out[p, 1, 1] = -sine / root, cosine - damping / root * sine
        ramp, step, impulse = _ramp(angle, damping, s)
        scale = length * length / (second - first)
        rate = length / frequency / (second - first)
        out[p, 0, 2], out[p, 0, 3] = scale * (second * step - ramp), scale * (ramp - first * step)
        out[p, 1, 2] = rate * (second * impulse - step)
        out[p, 1, 3] = rate * (step - first * impulse)


@njit(**INNER_KERNEL)
def _free_motion(frequency, damping, elapsed):
    """Answer of a mode at rest to an impulse: x omega and x'."""
    root = math.sqrt(1.0 - damping * damping)
    fade = math.exp(-damping * frequency * elapsed)
    sine = fade * math.sin(root * frequency * elapsed) / root
    return sine, fade * math.cos(root * frequency * elapsed) - damping * sine


@njit(**KERNEL)
def graded_response(frequency, damping, rule, graded, out):
    """Answer of one mode at the positions of a step that is graded towards a border.

    Frequency in rad/s, damping ratio, `out` as in `mode_response`. The rule holds places and
    weights (17, 16) of the Gauss quadratures on [0, 1], a row an order. `graded` is (span, power,
    low, high): the time beyond the border is span s^power, s, as s goes from low to high.
    """
    span, power, low, high = graded
    gauss, weight = rule
    width = high - low
    start = span * low**power
    angle = frequency * (span * high**power - start)
    order = min(_MOST_POINTS, _FEWEST_POINTS + math.ceil(angle))
    first, second = POSITIONS[0], POSITIONS[1]
    # of time to the share of the step that has passed, at the Gauss points
    rate_first = span * power * (low + first * width) ** (power - 1.0) * width
    rate_second = span * power * (low + second * width) ** (power - 1.0) * width
    for p in range(4):
        position = POSITIONS[p]
        now = span * (low + position * width) ** power
        sine, cosine = _free_motion(frequency, damping, now - start)
        out[p, 0, 0], out[p, 0, 1] = cosine + 2.0 * damping * sine, sine
        out[p, 1, 0], out[p, 1, 1] = -sine, cosine
        for part in range(2):
            out[p, part, 2], out[p, part, 3] = 0.0, 0.0
        for i in range(order):
            share = position * gauss[order, i]
            before = now - span * (low + share * width) ** power
            scale = position * weight[order, i] / frequency / (second - first)
            sine, cosine = _free_motion(frequency, damping, before)
            early = scale * (second - share) * rate_first
            late = scale * (share - first) * rate_second
            out[p, 0, 2] += early * sine
            out[p, 0, 3] += late * sine
            out[p, 1, 2] += early * cosine
            out[p, 1, 3] += late * cosine
