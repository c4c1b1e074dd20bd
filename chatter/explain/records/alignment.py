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
#: angles of the scan, steps of the search, and change of the prediction, over the record, below
#: which it ends
_SCANNED, _MOST_STEPS, _CONVERGED = 720, 20, 1e-7
#: highest order that is predicted, over the highest in the band: a usual filter leaves a hundredth
#: of what is beyond
_FOLDED = 3.0
#: points of a revolution for each order of its highest harmonic
_POINTS_AN_ORDER = 24
#: widest steps, as a part of a pitch, and of the filter
_WIDEST_TURN, _WIDEST_FILTER = 0.1, 0.5
#: factors of the width of the steps after one that failed, of its own, and after one that did not
_NARROWER, _WIDER = 0.25, 2.0
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

    @cached_property
    def frequency(self) -> Array:
        """Frequency (M,) of the harmonics, Hz."""
        return self.orders * self.speed / (2.0 * math.pi)

    @cached_property
    def size(self) -> float:
        """Norm of the harmonics of the channels."""
        return float(np.linalg.norm(self.content))

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


class LowPass(NamedTuple):
    """Butterworth filter at frequencies."""

    gain: Complex
    slope: Complex  # of the logarithm of the gain over the sampling over the corner frequency
    bend: Complex  # change of the slope


def low_pass(
    frequency: Array, corner_ratio: float, sampling: float, order: int = USUAL_ORDER
) -> LowPass:
    """Butterworth filter at frequencies, Hz, by the sampling over the corner frequency."""
    rate = 1j * frequency / sampling
    s = rate * corner_ratio
    squared = s * s + 1.0
    product = np.ones(s.shape, dtype=np.complex128)
    slope, bend = np.zeros((2, *s.shape), dtype=np.complex128)
    for damped in _damped(order):
        pole_pair = squared + damped * s
        one = (2.0 * s + damped) / pole_pair
        product *= pole_pair
        slope += one
        bend += 2.0 / pole_pair - one * one
    return LowPass(1.0 / product, -rate * slope, -rate * rate * bend)


def aligned(harmonics: Complex, recorded: Recorded, filter_order: int = USUAL_ORDER) -> Alignment:
    """Lay harmonics (c, M) of channels over the angle, from the first order on, beside a record.

    The record is behind an anti-alias filter, a Butterworth filter, of an even order.
    """
    search = _Search(harmonics / recorded.deviation[:, None], recorded, filter_order)
    found = search.found()
    predicted = recorded.at(harmonics * search.filter_at(found.ratio).gain, found.start)
    predicted += recorded.drift(recorded.signals - predicted)
    corner = recorded.sampling / found.ratio if found.ratio > 0.0 else math.inf
    angle = recorded.turned + found.start
    return Alignment(predicted, angle, found.start, corner, found.cost)


class _Laid(NamedTuple):
    """Harmonics laid beside a record, and what Gauss-Newton steps from there hang on."""

    start: float  # angle, rad
    ratio: float  # sampling over corner frequency
    cost: float  # sum of squares of what differs
    normal: Array  # (2, 2), of the angle and the ratio
    gradient: Array  # (2,), with its sign turned
    curved: Array  # (2, 2), the same with what curves the harmonics


class _Search:
    """Start angle and filter at which scaled harmonics (c, M) fit a record best.

    By Newton's steps, of Gauss and Newton where the curvature is no minimum's, and narrower ones
    where the fit gets no better. A filter delays, as the angle does: the angle is counted as
    delayed, so that one hardly moves the other.
    """

    def __init__(self, scaled: Complex, recorded: Recorded, filter_order: int) -> None:
        self._scaled, self._recorded, self._order = scaled, recorded, filter_order
        self._turned = 1j * recorded.orders
        self._delay = 0.0
        if recorded.angle is None:
            damped = float(_damped(filter_order).sum())
            self._delay = damped * recorded.speed / (2.0 * math.pi * recorded.sampling)
        self._widest = np.array([_WIDEST_TURN * recorded.pitch, _WIDEST_FILTER])

    def filter_at(self, ratio: float) -> LowPass:
        """Anti-alias filter (M,) at the harmonics."""
        return low_pass(self._recorded.frequency, ratio, self._recorded.sampling, self._order)

    def found(self) -> _Laid:
        """Return the best that steps from the best angle of the scan and the usual filter reach."""
        best, width = self._at(self._scanned(), USUAL_FILTER), 1.0
        for _ in range(_MOST_STEPS):
            step = self._step(best, width * self._widest)
            if math.sqrt(step @ best.normal @ step) <= _CONVERGED * self._recorded.size:
                break
            turned = step[0] + self._delay * step[1]
            trial = self._at(best.start + turned, best.ratio + step[1])
            if trial.cost > best.cost:
                width = _NARROWER * float(np.max(np.abs(step) / self._widest))
            else:
                best, width = trial, min(_WIDER * width, 1.0)
        return best

    def _at(self, start: float, ratio: float) -> _Laid:
        recorded, low = self._recorded, self.filter_at(ratio)
        now = self._scaled * (low.gain * np.exp(self._turned * start))
        of_ratio = low.slope + self._delay * self._turned
        rows = np.concatenate([now, now * self._turned, now * of_ratio])
        shown, *slopes = np.split(recorded.folded(rows), 3)
        matrix = np.array([one.ravel() for one in slopes])
        matrix[0] *= recorded.angle is None
        residual = recorded.content - shown
        normal = np.real(np.conj(matrix) @ matrix.T)
        normal += _DAMPING * (np.trace(normal) + 1e-300) * np.eye(2)
        gradient = np.real(np.conj(matrix) @ residual.ravel())
        curved = normal - self._bent(now, residual, of_ratio, low.bend)
        return _Laid(start, ratio, float(np.sum(np.abs(residual) ** 2)), normal, gradient, curved)

    def _bent(self, now: Complex, residual: Complex, of_ratio: Complex, bend: Complex) -> Array:
        """Second changes (2, 2) of harmonics with angle and ratio along the residual.

        Of those in the band: of the others they are small, and the steps end where they would.
        """
        band = residual.shape[1]
        along = np.sum(np.conj(residual) * now[:, :band], axis=0)
        turned, of_ratio, bend = self._turned[:band], of_ratio[:band], bend[:band]
        of_both = np.real((turned * of_ratio) @ along)
        of_angle, of_filter = np.real((turned**2) @ along), np.real((of_ratio**2 + bend) @ along)
        if self._recorded.angle is not None:
            of_angle = of_both = 0.0
        return np.array([[of_angle, of_both], [of_both, of_filter]])

    @staticmethod
    def _step(at: _Laid, widest: Array) -> Array:
        """Step in angle and ratio, no wider than some: the angle by what the ratio is held to."""
        lowest, highest = max(-at.ratio, -widest[1]), min(_LOWEST_FILTER - at.ratio, widest[1])
        is_minimum = at.curved[0, 0] > 0.0 and np.linalg.det(at.curved) > 0.0
        curved = at.curved if is_minimum else at.normal
        ratio = np.clip(np.linalg.solve(curved, at.gradient)[1], lowest, highest)
        turn = (at.gradient[0] - curved[0, 1] * ratio) / curved[0, 0]
        return np.array([np.clip(turn, -widest[0], widest[0]), ratio])

    def _scanned(self) -> float:
        """Angle in the middle of the record at which the harmonics fit best."""
        recorded = self._recorded
        if recorded.angle is not None:
            return 0.0
        band = slice(recorded.in_band)
        filtered = self._scaled[:, band] * self.filter_at(USUAL_FILTER).gain[band]
        product = np.sum(np.conj(filtered) * recorded.content, axis=0)
        angles, waves = recorded.scan
        return float(angles[int(np.argmax(np.real(waves @ product)))])
