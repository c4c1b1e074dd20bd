"""Chatter frequency: argument of the multiplier of a motion, and its line in the spectrum."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.detection.deviations import directions_of

#: directions of the motion from period to period that are fitted
_MOST_DIRECTIONS = 12
#: zero padding of the spectrum in which the rotation is first sought
_PADDING = 8
#: combination of columns, against the strongest, that is too weak to be fitted
_WEAK_COLUMN = 0.05


class ChatterLine(NamedTuple):
    """The strongest motion that does not repeat from period to period."""

    rotation: float  # rad a period, 0 to pi: argument of its multiplier
    cycles: float  # cycles a period of its strongest line in the spectrum of the signals
    share: float  # of the variance from period to period that it explains
    amplitude: float  # of that line, unit of the values


def strongest_line(
    values: NDArray[np.float64], growth_rate: float = 0.0, rotation: float | None = None
) -> ChatterLine:
    """Fit one rotating motion to the change from period to period.

    At every point of the period the signal is taken as a + growth^r (b cos(r theta) + c
    sin(r theta)) over the periods r, with one angle theta for all points and channels: a part that
    repeats and one Floquet multiplier. In b and c lie the lines theta/(2 pi) + k cycles a period;
    the strongest is the chatter line. What repeats is fitted along with it, so that a line close
    to a harmonic is not pulled.

    Values (periods, points, k), logarithm of the growth a period, and rotation, rad a period, where
    it is known.
    """
    count, points, channels = values.shape
    matrix = values.reshape(count, -1)
    centred = matrix - matrix.mean(axis=0)
    left, singular = directions_of(centred)
    kept = int(np.count_nonzero(singular[:_MOST_DIRECTIONS] > 1e-6 * singular[0]))
    if kept == 0:
        return ChatterLine(math.nan, math.nan, 0.0, 0.0)
    scores = left[:, :kept] * singular[:kept]
    right = scores.T @ centred / singular[:kept, None] ** 2
    total = float(np.sum(scores**2))
    if rotation is None:
        rotation = _rotation(scores, growth_rate)
    base = _columns(rotation, growth_rate, count)
    # at a doubled period the sine vanishes and must not be fitted
    coefficients, *_ = np.linalg.lstsq(base, scores, rcond=_WEAK_COLUMN)
    share = 1.0 - float(np.sum((scores - base @ coefficients) ** 2)) / total
    shape = ((coefficients[1] - 1j * coefficients[2]) @ right[:kept]).reshape(points, channels)
    # a multiplier rotates within the period as well: without it whole cycles are left
    share_of_period = np.arange(points) / points
    lines = np.fft.fft(shape * np.exp(-1j * rotation * share_of_period)[:, None], axis=0) / points
    strength = np.linalg.norm(lines, axis=1)
    strongest = int(np.argmax(strength))
    cycles = abs(np.fft.fftfreq(points, 1.0 / points)[strongest] + rotation / (2.0 * math.pi))
    return ChatterLine(rotation, float(cycles), share, float(strength[strongest]))


def _columns(rotation: float, growth_rate: float, count: int) -> NDArray[np.float64]:
    period = np.arange(count) - 0.5 * count
    swell = np.exp(growth_rate * (period - period[-1]))
    return np.stack(
        [np.ones(count), swell * np.cos(rotation * period), swell * np.sin(rotation * period)],
        axis=1,
    )


def _rotation(scores: NDArray[np.float64], growth_rate: float) -> float:
    """Angle of the rotation that leaves the least unexplained."""
    count = len(scores)
    padded = _PADDING * count
    power = np.sum(np.abs(np.fft.rfft(scores, padded, axis=0)) ** 2, axis=1)
    power[: _PADDING // 2] = 0.0
    step = 2.0 * math.pi / padded
    start = step * int(np.argmax(power))

    def negative_explained(rotation: float) -> float:
        base, _ = np.linalg.qr(_columns(rotation, growth_rate, count))
        return -float(np.sum((base.T @ scores) ** 2))

    reach = 0.6 * _PADDING * step
    grid = np.linspace(max(start - reach, 0.5 * step), min(start + reach, math.pi), 4 * _PADDING)
    best = int(np.argmin([negative_explained(angle) for angle in grid]))
    low, high = grid[max(best - 1, 0)], grid[min(best + 1, len(grid) - 1)]
    # slow to import, and what judges a case by its multiplier has no signal to fit
    from scipy.optimize import minimize_scalar

    found = minimize_scalar(
        negative_explained, bounds=(low, high), method="bounded", options={"xatol": 1e-4 / count}
    )
    return float(found.x if found.fun <= negative_explained(grid[best]) else grid[best])
