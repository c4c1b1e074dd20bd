"""Prediction of a settled cut laid beside a record: what the record does not tell is estimated.

Over whole revolutions the harmonics of the revolution are orthogonal, so that start angle and band
of the anti-alias filter are found from the harmonics of the record alone, by Gauss-Newton steps;
offset and drift of every channel drop out linearly (variable projection, Golub and Pereyra 1973).
None of them asks for another simulation. What the filter lets pass above half the sampling
frequency is folded back by the sampling, and is predicted as such.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

#: sampling frequency over the corner frequency of the anti-alias filter: where the search begins,
#: as is usual, and largest; zero is no filter
USUAL_FILTER, _LOWEST_FILTER = 2.5, 6.0
#: order of the filter until the records tell another, and orders that are built
USUAL_ORDER, ORDERS = 4, (2, 4, 6, 8)
#: angles of the scan, steps of the search, and changes below which it ends
_SCANNED, _MOST_STEPS, _CONVERGED = 720, 20, 1e-8
#: highest order that is predicted, over the highest in the band: a usual filter leaves a hundredth
#: of what is beyond
_FOLDED = 3.0
#: points of a revolution for each order of its highest harmonic
_POINTS_AN_ORDER = 24
#: widest steps, as a part of a pitch, and of the filter
_WIDEST_TURN, _WIDEST_FILTER = 0.1, 0.5
#: orders of which the waves are made at once
_BLOCK = 32
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
    order: int = USUAL_ORDER  # of the anti-alias filter, a Butterworth filter

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
    def _spectrum_of_means(self) -> Complex:
        """Conjugate spectrum of the mean products of two harmonics, which depend on their distance.

        As many points as keep the ends of a correlation over all harmonics apart.
        """
        count = self.orders.size + self.in_band + 1
        points = scipy.fft.next_fast_len(count + 2 * self.in_band + 1)
        return np.conj(scipy.fft.fft(np.conj(self._means(count)), points))

    def _means(self, count: int) -> Complex:
        """Means (count,) of the harmonics of order 0 on over the usable samples."""
        weight = self.usable / max(float(self.usable.sum()), 1.0)
        first = np.exp(1j * np.outer(self.turned, np.arange(_BLOCK)))
        found = np.empty(count, dtype=np.complex128)
        for begin in range(0, count, _BLOCK):
            size = min(_BLOCK, count - begin)
            found[begin : begin + size] = (weight * np.exp(1j * begin * self.turned)) @ first[
                :, :size
            ]
        return found

    def folded(self, harmonics: Complex) -> Complex:
        """Harmonics (c, K) that a record shows of a signal of harmonics (c, M).

        Those above the band and their conjugates have shares in it by the mean products over the
        usable samples, a correlation.
        """
        band, means = self.in_band, self._spectrum_of_means
        above = np.zeros((len(harmonics), means.size), dtype=np.complex128)
        above[:, band + 1 : self.orders.size + 1] = harmonics[:, band:]
        shares = scipy.fft.ifft(scipy.fft.fft(above) * means)
        direct, mirrored = shares[:, 1 : band + 1], shares[:, : -band - 1 : -1]
        return harmonics[:, :band] + direct + np.conj(mirrored)

    @cached_property
    def scan(self) -> tuple[Array, Complex]:
        """Angles (a,) at which the record may begin, rad, and waves (a, K) turned back by them."""
        share = np.arange(_SCANNED) / _SCANNED
        angles = share * 2.0 * math.pi
        if self.expected is not None:
            angles = self.expected + self.pitch * (share - 0.5)
        return angles, np.exp(-1j * np.outer(angles, self.orders[: self.in_band]))

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

    @property
    def frequency(self) -> Array:
        """Frequency (M,) of the harmonics, Hz."""
        return self.orders * self.speed / (2.0 * math.pi)

    def filtered(self, corner_ratio: float) -> Complex:
        """Anti-alias filter (M,) at the harmonics."""
        return low_pass(self.frequency, corner_ratio, self.sampling, self.order)

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
    misfit: float  # sum of squares of the harmonics that differ, over the deviations


def _damped(order: int) -> Array:
    """Twice the damping ratios (order / 2,) of the poles of a Butterworth filter of even order."""
    return 2.0 * np.sin((2.0 * np.arange(order // 2) + 1.0) * math.pi / (2.0 * order))


def low_pass(
    frequency: Array, corner_ratio: float, sampling: float, order: int = USUAL_ORDER
) -> Complex:
    """Butterworth filter at frequencies, Hz, by the sampling over the corner frequency."""
    s = 1j * frequency * corner_ratio / sampling
    found = np.ones(s.shape, dtype=np.complex128)
    for damped in _damped(order):
        found *= s * s + damped * s + 1.0
    return 1.0 / found


def _slope_of_low_pass(
    frequency: Array, corner_ratio: float, sampling: float, order: int
) -> Complex:
    """Change of the logarithm of the low pass with the sampling over the corner frequency."""
    rate = 1j * frequency / sampling
    s = rate * corner_ratio
    return -rate * sum((2.0 * s + one) / (s * s + one * s + 1.0) for one in _damped(order))


def aligned(harmonics: Complex, recorded: Recorded) -> Alignment:
    """Lay harmonics (c, M) of channels over the angle, from the first order on, beside a record."""
    found = _found(harmonics, recorded)
    filtered = recorded.filtered(found.ratio)
    predicted = recorded.at(harmonics * filtered, found.start)
    predicted += recorded.drift(recorded.signals - predicted)
    corner = recorded.sampling / found.ratio if found.ratio > 0.0 else math.inf
    angle = recorded.turned + found.start
    return Alignment(predicted, angle, found.start, corner, found.cost)


class _Laid(NamedTuple):
    """Harmonics laid beside a record."""

    cost: float  # sum of squares of what differs
    start: float  # angle, rad
    ratio: float  # sampling over corner frequency


def _found(harmonics: Complex, recorded: Recorded) -> _Laid:
    """Start angle and filter at which harmonics (c, M) fit best.

    By Gauss-Newton steps, shorter ones where the fit gets no better. A filter delays, as the angle
    does: the angle is counted as delayed, so that one hardly moves the other.
    """
    scaled = harmonics / recorded.deviation[:, None]
    start, delay = 0.0, 0.0
    if recorded.angle is None:
        start = _scanned(scaled * recorded.filtered(USUAL_FILTER), recorded)
        delay = float(_damped(recorded.order).sum()) * recorded.speed
        delay /= 2.0 * math.pi * recorded.sampling
    best, step = _step_from(scaled, recorded, _Laid(0.0, start, USUAL_FILTER), delay)
    for _ in range(_MOST_STEPS):
        ratio = min(max(best.ratio + step[1], 0.0), _LOWEST_FILTER)
        turned = step[0] + delay * (ratio - best.ratio)
        if max(abs(turned), abs(ratio - best.ratio)) < _CONVERGED:
            break
        there = _Laid(0.0, best.start + turned, ratio)
        trial, further = _step_from(scaled, recorded, there, delay)
        if trial.cost > best.cost:
            step = 0.5 * step  # too far: half the way
        else:
            best, step = trial, further
    return best


def _step_from(scaled: Complex, recorded: Recorded, at: _Laid, delay: float) -> tuple[_Laid, Array]:
    """Cost of scaled harmonics (c, M), and the Gauss-Newton step in angle and filter from there."""
    turn = np.exp(1j * recorded.orders * at.start)
    now = scaled * recorded.filtered(at.ratio) * turn
    turned = 1j * recorded.orders
    by_filter = _slope_of_low_pass(recorded.frequency, at.ratio, recorded.sampling, recorded.order)
    rows = np.concatenate([now, now * turned, now * (by_filter + delay * turned)])
    shown, *slopes = np.split(recorded.folded(rows), 3)
    matrix = np.array([one.ravel() for one in slopes])
    matrix[0] *= recorded.angle is None
    residual = (recorded.content - shown).ravel()
    normal = np.real(np.conj(matrix) @ matrix.T)
    normal += _DAMPING * (np.trace(normal) + 1e-300) * np.eye(2)
    step = np.linalg.solve(normal, np.real(np.conj(matrix) @ residual))
    limits = np.array([_WIDEST_TURN * recorded.pitch, _WIDEST_FILTER])
    return at._replace(cost=float(np.sum(np.abs(residual) ** 2))), np.clip(step, -limits, limits)


def _scanned(scaled: Complex, recorded: Recorded) -> float:
    """Angle in the middle of the record at which scaled harmonics (c, M) fit best."""
    product = np.sum(np.conj(scaled[:, : recorded.in_band]) * recorded.content, axis=0)
    angles, waves = recorded.scan
    return float(angles[int(np.argmax(np.real(waves @ product)))])
