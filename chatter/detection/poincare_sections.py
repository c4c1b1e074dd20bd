"""Signals over the spindle angle: whole periods, and samples once a turn and once a tooth."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from chatter.detection.record import CutRecord
from chatter.detection.varying_speed import without_speed_variation

_TURN = 2.0 * math.pi
#: points a turn at most
_MOST_POINTS = 480


class Periods(NamedTuple):
    """Signals cut into whole periods of the spindle angle.

    The last sample of the record lies in the last period; what is too short for a period at the
    start is left out.
    """

    values: NDArray[np.float64]  # (periods, points, k), in units of `scale`
    scale: float  # m or N: largest rms of a channel about its mean
    period: float  # s, mean over the later half
    per_turn: int  # periods in a turn
    roughness: float  # rms of what sampling does not resolve, noise included, units of `scale`
    speed_variation: float  # rms of the relative speed from period to period


def cut_into_periods(record: CutRecord, per_turn: int) -> Periods:
    """Resample the signals over the spindle angle and cut them into periods.

    What follows from a speed that varies is taken off.

    Parameters
    ----------
    record : CutRecord
    per_turn : int
        Periods in a turn of the spindle: 1, or the number of teeth of a symmetric tool.

    Returns
    -------
    Periods
    """
    angle, signals = _averaged(record)
    samples = len(angle) / ((angle[-1] - angle[0]) / _TURN)
    points = max(4, math.floor(min(samples, _MOST_POINTS) / per_turn))
    length = _TURN / per_turn
    count = math.floor((angle[-1] - angle[0]) / length * (1.0 + 1e-12))
    first = angle[-1] - count * length
    grid = first + length / points * np.arange(count * points)
    values = CubicSpline(angle, signals, axis=0)(grid).reshape(count, points, -1)
    edges = first + length * np.arange(count + 1)
    durations = np.diff(np.interp(edges, record.spindle_angle, record.time))
    values = without_speed_variation(values, durations)
    later = values[count // 2 :]
    spread = np.sqrt(np.mean((later - later.mean(axis=(0, 1))) ** 2, axis=(0, 1)))
    scale = float(spread.max()) or 1.0
    period = float(durations[count // 2 :].mean())
    rough = roughness_of(signals) / scale
    return Periods(
        values / scale, scale, period, per_turn, rough, float(np.std(durations) / period)
    )


def _averaged(record: CutRecord) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Angle and signals, averaged over neighbouring samples where there are far more than needed.

    The average keeps noise above the new Nyquist frequency from folding down.
    """
    block = int(len(record.time) / (record.turns * _MOST_POINTS))
    if block < 2:
        return record.spindle_angle, record.signals
    n = len(record.time) // block * block
    lead = len(record.time) - n
    angle = record.spindle_angle[lead:].reshape(-1, block).mean(axis=1)
    signals = record.signals[lead:].reshape(len(angle), block, -1).mean(axis=1)
    return angle, signals


def roughness_of(signals: NDArray[np.float64]) -> float:
    """Rms of the error with which a cubic through its neighbours predicts a sample, as noise.

    White noise gives its own rms; a force that jumps where a tooth enters gives more, and so much
    differs from turn to turn where the samples do not fall on the same angles.
    """
    near = signals[1:-3] + signals[3:-1]
    far = signals[:-4] + signals[4:]
    error = signals[2:-2] - (4.0 * near - far) / 6.0
    return float(
        np.sqrt(np.mean(error[len(error) // 2 :] ** 2, axis=0).max() / (1.0 + 34.0 / 36.0))
    )


def once_a_turn(record: CutRecord) -> NDArray[np.float64]:
    """Signals where the first tooth is at zero angle, (turns, k), m or N."""
    return _at(record, 0.0)


def once_a_tooth(record: CutRecord) -> NDArray[np.float64]:
    """Signals where any tooth is at zero angle, (tooth passes, k), m or N, in time order."""
    offsets = record.tooth_angles - record.tooth_angles[0]
    return _at(record, *np.mod(offsets, _TURN))


def _at(record: CutRecord, *offsets: float) -> NDArray[np.float64]:
    first, last = record.spindle_angle[0], record.spindle_angle[-1]
    turns = np.arange(math.floor(first / _TURN) - 1, math.ceil(last / _TURN) + 2)
    angles = np.sort((turns[:, None] * _TURN + np.array(offsets)).ravel())
    angles = angles[(angles >= first - 1e-9) & (angles <= last + 1e-9)]
    return CubicSpline(record.spindle_angle, record.signals, axis=0)(angles)
