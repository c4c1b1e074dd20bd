"""Steps of the matrix-free method over a period, and the exact answer of the modes over one step.

Steps end where a tip or a top of an edge enters or leaves, and where a triangular variation of the
speed has its corners, so that all is smooth inside them. Over a step the cutting force is the line
through its values at the two Gauss points; the modes answer to that and to their state exactly.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from chatter.kernels import KERNEL
from chatter.stability.spindle_turn import SpeedVariation, angle_at, time_at
from cutting.edge_coupling import chip_vanishes, part_below, share_of_height
from cutting.edge_pieces import EdgePieces

#: Gauss points of a step, and where the motion is kept besides: its middle and its end
_ROOT = math.sqrt(3.0) / 6.0
PLACES = np.array([0.5 - _ROOT, 0.5 + _ROOT, 0.5, 1.0])
#: borders closer than this share of the period are the same
_SAME = 1e-10
#: levels and ratio of the steps towards a place where the slope of the force law is infinite
_LEVELS = 6
_RATIO = 0.2
#: a step turns the spindle by no more than this over the steps a wave, rad
_ANGLE_A_WAVE = 3.0
#: below this angle of a mode in a step the series holds more digits than the closed form
_SERIES_BELOW = 1.5
_TERMS = 40


class SteppedCut(NamedTuple):
    """A milling cut with speed and depth left open; n modes, r directions of motion."""

    natural_frequency: NDArray[np.float64]  # rad/s (n,)
    damping: NDArray[np.float64]  # ratio (n,)
    shape: NDArray[np.float64]  # displacement per modal coordinate (n, r)
    force_gain: NDArray[np.float64]  # modal acceleration per force, 1/kg (n, r)
    basis: NDArray[np.float64]  # directions of motion (3, r)
    pieces: EdgePieces
    period_angle: float  # after which the tool looks the same again, rad
    variation: SpeedVariation
    fastest: float  # vibration that steps resolve, with no cut, rad/s
    stiffening: float  # by which its square grows with depth, rad^2/s^2/m
    contact: NDArray[np.float64]  # stiffness N/m, damping N s/m, share at which it is whole (3,)
    edge_place: NDArray[np.float64]  # Gauss points on [0, 1], row q for q of them (17, 16)
    edge_weight: NDArray[np.float64]  # (17, 16)


@njit(**KERNEL)
def _border_angles(cut, depth):
    """Borders in one period of the tool (rad), unsorted, and 1 for each that is singular."""
    pieces, period = cut.pieces, cut.period_angle
    angles = np.empty(4 * pieces.bottom.shape[0] + 1)
    singular = np.zeros(angles.shape[0], dtype=np.int64)
    count = 0
    lowest = pieces.bottom[0]
    for piece in range(pieces.bottom.shape[0]):
        lowest = min(lowest, pieces.bottom[piece])
    for piece in range(pieces.bottom.shape[0]):
        top = part_below(pieces, piece, depth)
        ends = pieces.bottom[piece] + pieces.thickness[piece] * (1.0 + 1e-12)
        for end in range(2):
            # between the tip, the top of the cut and where an edge first meets the stock the
            # pieces of an edge follow one another
            inner = depth > ends if end == 1 else pieces.bottom[piece] > lowest
            if top <= 0.0 or (inner and pieces.turning[piece, end] == 0):
                continue
            place = top if end == 1 else 0.0
            turned = pieces.angle[piece, 1] - pieces.angle[piece, 0]
            lag = pieces.angle[piece, 0] + share_of_height(pieces, piece, place) * turned
            for side in range(2):
                arc = pieces.entry[piece] if side == 0 else pieces.exit[piece]
                immersed = arc[0] + place * (arc[1] - arc[0])
                angle = immersed - lag
                angles[count] = angle - period * math.floor(angle / period)
                if pieces.exponent != 0.0 and chip_vanishes(pieces, piece, place, immersed):
                    singular[count] = 1
                count += 1
    if count == 0:
        count, angles[0] = 1, 0.0
    return angles[:count], singular[:count]


@njit(**KERNEL)
def _sort(times, flags):
    """Sort times, and their flags with them, by insertion: there are few."""
    for i in range(1, times.shape[0]):
        time, flag, place = times[i], flags[i], i
        while place > 0 and times[place - 1] > time:
            times[place], flags[place] = times[place - 1], flags[place - 1]
            place -= 1
        times[place], flags[place] = time, flag


@njit(**KERNEL)
def _border_times(cut, turn, depth):
    """Border times over the whole period, ascending (s), and their flags."""
    angles, singular = _border_angles(cut, depth)
    per_tool = angles.shape[0]
    corners = 2 * turn.cycles if turn.triangle == 1 and turn.amplitude > 0.0 else 0
    times = np.empty(turn.patterns * per_tool + corners)
    flags = np.zeros(times.shape[0], dtype=np.int64)
    period = turn.patterns * cut.period_angle / turn.speed
    for i in range(times.shape[0]):
        if i < turn.patterns * per_tool:
            pattern, k = i // per_tool, i % per_tool
            times[i] = time_at(turn, angles[k] + pattern * cut.period_angle)
            flags[i] = singular[k]
        else:
            times[i] = (0.25 + 0.5 * (i - turn.patterns * per_tool)) / turn.frequency
        times[i] -= period * math.floor(times[i] / period)
    _sort(times, flags)
    out, marks = np.empty(times.shape[0] + 1), np.zeros(times.shape[0] + 1, dtype=np.int64)
    kept = 0
    for i in range(times.shape[0]):
        again = kept > 0 and times[i] - out[kept - 1] <= _SAME * period
        wrapped = kept > 0 and out[0] + period - times[i] <= _SAME * period
        if again or wrapped:
            same = kept - 1 if again else 0
            marks[same] = max(marks[same], flags[i])
            continue
        out[kept], marks[kept] = times[i], flags[i]
        kept += 1
    out[kept], marks[kept] = out[0] + period, marks[0]
    return out[: kept + 1], marks[: kept + 1]


@njit(**KERNEL)
def period_steps(cut, turn, depth, steps_a_wave, refinement):
    """Cut a period into steps.

    Parameters
    ----------
    cut : SteppedCut
    turn : SpindleTurn
    depth : float
        Axial depth, m.
    steps_a_wave : float
        Steps in a period of the fastest vibration.
    refinement : int
        Every step that this gives is divided by this.

    Returns
    -------
    (N + 1,) array of float
        Borders of the steps, s.
    """
    borders, singular = _border_times(cut, turn, depth)
    longest = 2.0 * math.pi / (steps_a_wave * math.sqrt(cut.fastest**2 + cut.stiffening * depth))
    counts = np.empty(borders.shape[0] - 1, dtype=np.int64)
    total = 0
    for i in range(counts.shape[0]):
        turned = angle_at(turn, borders[i + 1]) - angle_at(turn, borders[i])
        need = (borders[i + 1] - borders[i]) / longest
        need = max(need, turned * steps_a_wave / _ANGLE_A_WAVE)
        counts[i] = max(1, math.ceil(need - 1e-9))
        total += counts[i]
    ends = np.empty(refinement * (total + 2 * _LEVELS * counts.shape[0]) + 1)
    count = 0
    ends[0] = borders[0]
    for i in range(counts.shape[0]):
        step = (borders[i + 1] - borders[i]) / counts[i]
        marks = np.empty(counts[i] + 2 * _LEVELS)
        n = 0
        for level in range(_LEVELS if singular[i] == 1 else 0, 0, -1):
            marks[n] = borders[i] + 0.5 * step * _RATIO**level
            n += 1
        for k in range(1, counts[i]):
            marks[n] = borders[i] + k * step
            n += 1
        for level in range(1, _LEVELS + 1 if singular[i + 1] == 1 else 1):
            marks[n] = borders[i + 1] - 0.5 * step * _RATIO**level
            n += 1
        marks[n] = borders[i + 1]
        for k in range(n + 1):
            low = ends[count]
            for part in range(1, refinement + 1):
                ends[count + 1] = low + (marks[k] - low) * part / refinement
                count += 1
    return ends[: count + 1]


@njit(**KERNEL)
def _ramp(angle, damping, s):
    """Answer of y'' + 2 zeta a y' + a^2 y = s, at rest at zero: y, y', y'' at s.

    y' is the answer to a step of force, y'' that to an impulse.
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
def mode_answer(frequency, damping, length, out):
    """Answer of one mode at the places of a step.

    Parameters
    ----------
    frequency, damping : float
        rad/s and ratio.
    length : float
        Of the step, s.
    out : (4, 2, 4) array of float
        For each of `PLACES` the coordinate x and x'/omega from x and x'/omega at the start and
        the accelerations at the two Gauss points. Overwritten.
    """
    angle = frequency * length
    root = math.sqrt(1.0 - damping * damping)
    first, second = PLACES[0], PLACES[1]
    for p in range(4):
        s = PLACES[p]
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
