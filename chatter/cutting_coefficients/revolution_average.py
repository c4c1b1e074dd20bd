"""Force waveforms averaged over the revolutions of a cut, at the speed that the record shows."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from chatter.cutting_coefficients.mean_forces import force_channels
from chatter.description.arrays import Array
from chatter.description.case import Case
from chatter.explain.measurement import Measurement, Run

#: share by which the spindle may run off its nominal speed
_SLIP = 0.01
#: revolutions that are averaged at most, and by which the speed is looked for first
_MOST_REVOLUTIONS, _FIRST_REVOLUTIONS = 400, 40
#: harmonics of the revolution: kept at most, used for the speed, and as a share of half the rate
_MOST_HARMONICS, _SPEED_HARMONICS, _BAND = 40, 12, 0.8


@dataclass(frozen=True, eq=False)
class RevolutionAverage:
    """One cut: Fourier coefficients over the revolution, F = c_0 + 2 Re sum c_k exp(i k Omega t).

    Parameters
    ----------
    run : str
    case : Case
        Of the run.
    channels : tuple of str
    directions : (channels, 3) array
        Of the force on the tool.
    speed : float
        Of the spindle, as the record shows it, rad/s.
    amplitude : (channels, harmonics + 1) complex array
        c_k, N.
    repeated : (channels,) array
        Share of the variance of the record that repeats with the revolution.
    """

    run: str
    case: Case
    channels: tuple[str, ...]
    directions: Array
    speed: float
    amplitude: NDArray[np.complex128]
    repeated: Array

    @property
    def harmonic(self) -> NDArray[np.int64]:
        """Harmonics of the revolution, 0 first."""
        return np.arange(self.amplitude.shape[1])


def revolution_average(measurement: Measurement, run: Run) -> RevolutionAverage:
    """Average the forces of one run over the revolution; a drift that is a line is taken off."""
    case = run.of(measurement.case)
    found = force_channels(measurement, run)
    time = run.signals["time"] - run.signals["time"][0]
    step = float(np.median(np.diff(time)))
    period = 2.0 * math.pi / case.cut.spindle_speed
    count = min(time.size, round(_MOST_REVOLUTIONS * period / step))
    values = np.array([run.signals[name][:count] for name in found])
    highest = max(1, min(_MOST_HARMONICS, int(_BAND * 0.5 * period / step)))
    speed = _spindle_speed(time[:count], values, case.cut.spindle_speed, highest)
    amplitude, repeated = _harmonics(time[:count], values, speed, highest)
    directions = np.array([direction for direction, _ in found.values()])
    return RevolutionAverage(run.name, case, tuple(found), directions, speed, amplitude, repeated)


def _spindle_speed(time: Array, values: Array, nominal: float, highest: int) -> float:
    """Speed within 1 % of the nominal one at which most of the forces repeats, rad/s."""
    used = np.arange(1, min(highest, _SPEED_HARMONICS) + 1)
    centred = values - values.mean(axis=1, keepdims=True)
    size = min(time.size, int(np.searchsorted(time, _FIRST_REVOLUTIONS * 2.0 * math.pi / nominal)))
    width = 2.0 * math.pi / time[size - 1]

    def left(speed: float) -> float:
        # a window, or what leaks between the harmonics would move the speed
        wave = np.exp(-1j * speed * used[:, None] * time[:size]) * np.hanning(size)
        return -float(np.sum(np.abs(wave @ centred[:, :size].T) ** 2))

    grid = np.arange((1.0 - _SLIP) * nominal, (1.0 + _SLIP) * nominal, 0.2 * width / used[-1])
    best = float(grid[np.argmin([left(speed) for speed in grid])])
    while True:
        reach = 0.4 * width / used[-1]
        best = scipy.optimize.minimize_scalar(
            left, bounds=(best - reach, best + reach), method="bounded",
            options={"xatol": 1e-9 * nominal},
        ).x  # fmt: skip
        if size == time.size:
            return float(best)
        size = min(time.size, 3 * size)
        width = 2.0 * math.pi / time[size - 1]


def _harmonics(
    time: Array, values: Array, speed: float, highest: int
) -> tuple[NDArray[np.complex128], Array]:
    """Least squares of harmonics and of a drift that is a line and has no mean."""
    phase = speed * time[:, None] * np.arange(1, highest + 1)
    drift = (time - time.mean()) / time[-1]
    columns = np.column_stack([np.ones(time.size), drift, np.cos(phase), np.sin(phase)])
    fitted = np.linalg.lstsq(columns, values.T, rcond=None)[0]
    amplitude = np.empty((values.shape[0], highest + 1), dtype=np.complex128)
    amplitude[:, 0] = fitted[0]
    amplitude[:, 1:] = 0.5 * (fitted[2 : highest + 2] - 1j * fitted[highest + 2 :]).T
    level = values - np.outer(fitted[1], drift)
    left = (values.T - columns @ fitted).var(axis=0)
    variance = np.maximum(level.var(axis=1), 1e-300)
    return amplitude, 1.0 - left / variance
