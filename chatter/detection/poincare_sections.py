"""Signals over the spindle angle: whole periods, Poincaré sections per revolution and tooth."""

import math
from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray

from chatter.detection.cut_record import CutRecord
from cutting.cubic_spline import CubicSpline

_REVOLUTION = 2.0 * math.pi
#: points per revolution at most
_MOST_POINTS = 480
#: relative change of the speed from period to period below which it counts as constant
_CONSTANT = 1e-6
#: change of the motion over its rms, per relative change of the speed, that may be laid to it:
#: about the order of a harmonic times the quality factor of a lightly damped mode
_STEEPEST = 100.0
#: periods after which a change of the speed is still felt
_LAGS = 3
#: further terms of a drift, which seldom is a sine, and periods for each of its terms
_CURVED, _PERIODS_A_TERM = 3, 4


class Periods(NamedTuple):
    """Signals cut into whole periods of the spindle angle.

    The last sample of the record lies in the last period; what is too short for a period at the
    start is left out.
    """

    values: NDArray[np.float64]  # (periods, points, k), in units of `scale`
    scale: float  # m or N: largest rms of a channel about its mean
    period: float  # s, mean over the later half
    per_revolution: int  # periods per revolution
    roughness: float  # rms of what sampling does not resolve, noise included, units of `scale`
    speed_variation: float  # rms of the relative speed from period to period that may cause motion


def cut_into_periods(record: CutRecord, per_revolution: int) -> Periods:
    """Resample the signals over the spindle angle and cut them into periods.

    What follows from a speed that varies is subtracted, unless the speed follows the cut.

    A revolution has 1 period, or one a tooth of a symmetric tool.
    """
    angle, signals = _averaged(record)
    samples = len(angle) / ((angle[-1] - angle[0]) / _REVOLUTION)
    points = max(4, math.floor(min(samples, _MOST_POINTS) / per_revolution))
    length = _REVOLUTION / per_revolution
    count = math.floor((angle[-1] - angle[0]) / length * (1.0 + 1e-12))
    first = angle[-1] - count * length
    grid = first + length / points * np.arange(count * points)
    values = CubicSpline(angle, signals)(grid).reshape(count, points, -1)
    edges = first + length * np.arange(count + 1)
    durations = np.diff(np.interp(edges, record.spindle_angle, record.time))
    variation = 0.0
    if not record.speed_follows:
        values = _without_speed_variation(values, durations)
        variation = float(np.std(durations)) / float(durations[count // 2 :].mean())
    later = values[count // 2 :]
    spread = np.sqrt(np.mean((later - later.mean(axis=(0, 1))) ** 2, axis=(0, 1)))
    scale = float(spread.max()) or 1.0
    period = float(durations[count // 2 :].mean())
    rough = _roughness(signals) / scale
    return Periods(values / scale, scale, period, per_revolution, rough, variation)


def _without_speed_variation(
    values: NDArray[np.float64], durations: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Subtract what is linear in the speed of this period and of the ones before.

    The motion of a stable cut depends on the spindle speed, steeply near a resonance. Where the
    speed differs between revolutions so does the motion, and that is no chatter.

    Values (periods, points, k) and durations of the periods (periods,), s.
    """
    relative = 1.0 / durations
    relative = relative / relative.mean() - 1.0
    spread = float(np.std(relative))
    if spread < _CONSTANT or len(values) < 6 * _LAGS:
        return values
    padded = np.concatenate([np.full(_LAGS - 1, relative[0]), relative])
    count = len(values)
    base = np.stack([padded[_LAGS - 1 - lag :][:count] for lag in range(_LAGS)], axis=1)
    # what is fitted are differences: a transient that decays is no trend of the speed
    steps = np.diff(base, axis=0)
    left, singular, right = np.linalg.svd(steps, full_matrices=False)
    kept = singular > 0.05 * singular[0]
    inverse = (right[kept].T / singular[kept]) @ left[:, kept].T
    matrix = values.reshape(count, -1)
    later = matrix[count // 2 :]
    rms = float(np.sqrt(np.mean((later - later.mean(axis=0)) ** 2)))
    rms = max(rms, float(np.std(later)))
    slaved = (base - base.mean(axis=0)) @ (inverse @ np.diff(matrix, axis=0))
    size = float(np.sqrt(np.mean(slaved**2)))
    allowed = min(1.0, _STEEPEST * spread * rms / max(size, 1e-300))
    return (matrix - allowed * slaved).reshape(values.shape)


def without_drift(periods: Periods, lowest_frequency: float) -> Periods:
    """Take off what moves more slowly than a frequency, Hz: creep of axes, a drift of the mean.

    A polynomial over the means of the periods, of so few terms that it follows nothing faster, nor
    anything that changes within a few periods.
    """
    count, points, _ = periods.values.shape
    cycles = 2.0 * lowest_frequency * periods.period * count
    degree = max(min(math.ceil(cycles) + _CURVED, count // _PERIODS_A_TERM), 1)
    centre = 2.0 * (np.arange(count) + 0.5) / count - 1.0
    place = 2.0 * (np.arange(count * points) + 0.5) / (count * points) - 1.0
    means = periods.values.mean(axis=1)
    terms, *_ = np.linalg.lstsq(legvander(centre, degree), means, rcond=None)
    drift = (legvander(place, degree) @ terms).reshape(periods.values.shape)
    return periods._replace(values=periods.values - drift)


def _averaged(record: CutRecord) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Angle and signals, averaged over neighbouring samples where there are far more than needed.

    The average keeps noise above the new Nyquist frequency from folding down.
    """
    block = int(len(record.time) / (record.revolutions * _MOST_POINTS))
    if block < 2:
        return record.spindle_angle, record.signals
    n = len(record.time) // block * block
    lead = len(record.time) - n
    angle = record.spindle_angle[lead:].reshape(-1, block).mean(axis=1)
    signals = record.signals[lead:].reshape(len(angle), block, -1).mean(axis=1)
    return angle, signals


def _roughness(signals: NDArray[np.float64]) -> float:
    """Rms of the error with which a cubic through its neighbours predicts a sample, as noise.

    White noise gives its own rms; a force that jumps where a tooth enters gives more, and so much
    differs between revolutions where the samples do not fall on the same angles.
    """
    near = signals[1:-3] + signals[3:-1]
    far = signals[:-4] + signals[4:]
    error = signals[2:-2] - (4.0 * near - far) / 6.0
    return float(
        np.sqrt(np.mean(error[len(error) // 2 :] ** 2, axis=0).max() / (1.0 + 34.0 / 36.0))
    )


def once_per_revolution(record: CutRecord) -> NDArray[np.float64]:
    """Signals where the first tooth is at zero angle, (revolutions, k), m or N."""
    return _sections_at(record, 0.0)


def once_per_tooth(record: CutRecord) -> NDArray[np.float64]:
    """Signals where any tooth is at zero angle, (tooth passes, k), m or N, in time order."""
    offsets = record.tooth_angles - record.tooth_angles[0]
    return _sections_at(record, *np.mod(offsets, _REVOLUTION))


def _sections_at(record: CutRecord, *offsets: float) -> NDArray[np.float64]:
    first, last = record.spindle_angle[0], record.spindle_angle[-1]
    revolutions = np.arange(math.floor(first / _REVOLUTION) - 1, math.ceil(last / _REVOLUTION) + 2)
    angles = np.sort((revolutions[:, None] * _REVOLUTION + np.array(offsets)).ravel())
    angles = angles[(angles >= first - 1e-9) & (angles <= last + 1e-9)]
    return CubicSpline(record.spindle_angle, record.signals)(angles)
