"""Prediction of a settled cut laid beside a record: what the record does not tell is estimated.

Over whole revolutions the harmonics of the revolution are orthogonal, so that start angle and band
of the anti-alias filter are found from the harmonics of the record alone, by Gauss-Newton steps;
offset and drift of every channel drop out linearly (variable projection, Golub and Pereyra 1973).
None of them asks for another simulation. What the filter lets pass above half the sampling
frequency is folded back by the sampling, and is predicted as such.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

#: sampling frequency over the corner frequency of the anti-alias filter: where the search begins,
#: as is usual, and largest; zero is no filter
USUAL_FILTER, _LOWEST_FILTER = 2.5, 6.0
_FILTER_STEP = 1e-3
#: angles of the scan, steps of the search, and changes below which it ends
_SCANNED, _MOST_STEPS, _CONVERGED = 720, 20, 1e-8
#: highest order that is predicted, over the highest in the band: a usual filter leaves a hundredth
#: of what is beyond
_FOLDED = 3.0
#: points of a revolution for each order of its highest harmonic
_POINTS_AN_ORDER = 24
#: widest steps, as a part of a pitch, and of the filter
_WIDEST_TURN, _WIDEST_FILTER = 0.1, 0.5
#: of the normal equations, so that what the record does not show stays where it is
_DAMPING = 1e-12


@dataclass(frozen=True, eq=False)
class Recorded:
    """Settled part of a record, as a prediction is laid beside it."""

    time: Array  # (n,), s
    signals: Array  # (c, n), SI
    deviation: Array  # (c,), typical of the noise, SI
    usable: Array  # (n,), 1 or 0
    speed: float  # of the spindle, rad/s
    pitch: float  # smallest angle by which a tool may be turned unseen, rad
    angle: Array | None = None  # (n,) of the spindle, rad, where it is known
    expected: float | None = None  # angle in the middle of the record, where a tacho tells it

    @property
    def sampling(self) -> float:
        """Samples a second."""
        return (self.time.size - 1) / float(self.time[-1] - self.time[0])

    @cached_property
    def orders(self) -> Array:
        """Harmonics (M,) of the revolution that are predicted, without the mean."""
        return np.arange(1, int(_FOLDED * self.in_band) + 1)

    @cached_property
    def in_band(self) -> int:
        """Number K of harmonics below half the sampling frequency."""
        return max(int(math.pi * self.sampling / self.speed), 1)

    @cached_property
    def _folding(self) -> tuple[Complex, Complex]:
        """Shares (M - K, K) of harmonics above the band, and of their conjugates, within it."""
        high, low = self.orders[self.in_band :], self.orders[: self.in_band]
        count = max(float(self.usable.sum()), 1.0)
        waves = np.exp(-1j * np.outer(self.turned, low)) * (self.usable / count)[:, None]
        above = np.exp(1j * np.outer(high, self.turned))
        return above @ waves, np.conj(above) @ waves

    def folded(self, harmonics: Complex) -> Complex:
        """Harmonics (c, K) that a record shows of a signal of harmonics (c, M)."""
        direct, mirrored = self._folding
        above = harmonics[:, self.in_band :]
        return harmonics[:, : self.in_band] + above @ direct + np.conj(above) @ mirrored

    @cached_property
    def middle(self) -> Array:
        """Time (n,) from the middle of the record, s."""
        return self.time - 0.5 * (self.time[0] + self.time[-1])

    @cached_property
    def turned(self) -> Array:
        """Angle (n,) from the middle of the record; the angle itself where it is known, rad."""
        return self.speed * self.middle if self.angle is None else self.angle

    @cached_property
    def content(self) -> Complex:
        """Harmonics (c, K) of the channels over `turned`, over their deviations."""
        flat = (self.signals - self.drift(self.signals)) * self.usable
        waves = np.exp(-1j * np.outer(self.turned, self.orders[: self.in_band]))
        count = max(float(self.usable.sum()), 1.0)
        return 2.0 / count * (flat @ waves) / self.deviation[:, None]

    def filtered(self, corner_ratio: float) -> Complex:
        """Anti-alias filter (M,) at the harmonics."""
        frequency = self.orders * self.speed / (2.0 * math.pi)
        return low_pass(frequency, corner_ratio, self.sampling)

    def drift(self, values: Array) -> Array:
        """Offset and drift (c, n) of values (c, n), from the usable samples."""
        basis = np.stack([np.ones(self.time.size), self.middle / self.middle[-1]])
        weighted = basis * self.usable
        return np.linalg.solve(weighted @ basis.T, weighted @ values.T).T @ basis

    def at(self, harmonics: Complex, start: float) -> Array:
        """Channels (c, n) of harmonics (c, M) where the angle begins at a start angle."""
        points = 1 << math.ceil(math.log2(_POINTS_AN_ORDER * self.orders.size))
        padded = np.zeros((len(harmonics), points // 2 + 1), dtype=np.complex128)
        padded[:, 1 : self.orders.size + 1] = 0.5 * points * harmonics
        rows = np.fft.irfft(padded, points, axis=1)
        grid = np.arange(points + 1) * 2.0 * math.pi / points
        angle = np.mod(self.turned + start, 2.0 * math.pi)
        return np.array([np.interp(angle, grid, np.append(row, row[0])) for row in rows])


@dataclass(frozen=True, eq=False)
class Alignment:
    """How a prediction lies beside a record."""

    predicted: Array  # (c, n), with offset and drift, SI
    angle: Array  # (n,) of the spindle, zero where the first tooth is at +y, rad
    start: float  # angle in the middle of the record, rad
    corner: float  # frequency of the anti-alias filter, Hz; inf for none


def low_pass(frequency: Array, corner_ratio: float, sampling: float) -> Complex:
    """Fourth-order Butterworth filter at frequencies, Hz, by the sampling over the corner one."""
    s = 1j * frequency * corner_ratio / sampling
    return 1.0 / ((s * s + 1.8477590650 * s + 1.0) * (s * s + 0.7653668647 * s + 1.0))


def aligned(harmonics: Complex, recorded: Recorded) -> Alignment:
    """Lay harmonics (c, M) of channels over the angle, from the first order on, beside a record."""
    start, ratio = _found(harmonics, recorded)
    predicted = recorded.at(harmonics * recorded.filtered(ratio), start)
    predicted += recorded.drift(recorded.signals - predicted)
    corner = recorded.sampling / ratio if ratio > 0.0 else math.inf
    return Alignment(predicted, recorded.turned + start, start, corner)


def _found(harmonics: Complex, recorded: Recorded) -> tuple[float, float]:
    """Start angle, rad, and sampling over corner frequency, at which harmonics (c, M) fit best."""
    scaled = harmonics / recorded.deviation[:, None]
    unknown = np.array([0.0, USUAL_FILTER])
    if recorded.angle is None:
        unknown[0] = _scanned(scaled * recorded.filtered(USUAL_FILTER), recorded)
    best = _Step(math.inf, unknown, np.zeros(2))
    for _ in range(_MOST_STEPS):
        now = _step_from(scaled, recorded, unknown)
        # too far: half the way
        best = replace(best, step=0.5 * best.step) if now.cost > best.cost else now
        unknown = best.unknown + best.step
        unknown[1] = min(max(unknown[1], 0.0), _LOWEST_FILTER)
        if np.max(np.abs(unknown - best.unknown)) < _CONVERGED:
            break
    return float(best.unknown[0]), float(best.unknown[1])


@dataclass(frozen=True, eq=False)
class _Step:
    """Start angle and filter that were tried, sum of squares there, and the step from there."""

    cost: float
    unknown: Array
    step: Array


def _step_from(scaled: Complex, recorded: Recorded, unknown: Array) -> _Step:
    """Gauss-Newton step of scaled harmonics (c, M)."""
    turn = np.exp(1j * recorded.orders * unknown[0])
    now, above, below = (
        scaled * recorded.filtered(unknown[1] + step) * turn
        for step in (0.0, _FILTER_STEP, -_FILTER_STEP)
    )
    slopes = [1j * recorded.orders * now, (above - below) / (2.0 * _FILTER_STEP)]
    matrix = np.array([recorded.folded(one).ravel() for one in slopes])
    matrix[0] *= recorded.angle is None
    residual = (recorded.content - recorded.folded(now)).ravel()
    normal = np.real(np.conj(matrix) @ matrix.T)
    normal += _DAMPING * (np.trace(normal) + 1e-300) * np.eye(2)
    step = np.linalg.solve(normal, np.real(np.conj(matrix) @ residual))
    limits = np.array([_WIDEST_TURN * recorded.pitch, _WIDEST_FILTER])
    cost = float(np.sum(np.abs(residual) ** 2))
    return _Step(cost, unknown, np.clip(step, -limits, limits))


def _scanned(scaled: Complex, recorded: Recorded) -> float:
    """Angle in the middle of the record at which scaled harmonics (c, M) fit best."""
    orders = recorded.orders[: recorded.in_band]
    product = np.sum(np.conj(scaled[:, : orders.size]) * recorded.content, axis=0)
    angles = np.arange(_SCANNED) / _SCANNED * 2.0 * math.pi
    if recorded.expected is not None:
        span = recorded.pitch * (np.arange(_SCANNED) / _SCANNED - 0.5)
        angles = recorded.expected + span
    fits = np.real(np.exp(-1j * np.outer(angles, orders)) @ product)
    return float(angles[int(np.argmax(fits))])
