"""Prediction of a settled cut laid beside a record: what the record does not tell is estimated.

Over whole revolutions the harmonics of the revolution are orthogonal, so that start angle and band
of the anti-alias filter are found from the harmonics of the record alone, by Gauss-Newton steps;
offset and drift of every channel drop out linearly (variable projection, Golub and Pereyra 1973).
None of them asks for another simulation. What the filter lets pass above half the sampling
frequency is folded back by the sampling, and is predicted as such.
"""

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
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
#: the same with which a step is the last where it is less than a share of the one before: Newton's
#: steps that close converge quadratically
_NEAR, _QUADRATIC = 1e-5, 0.1
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
    filter_ratio: float = USUAL_FILTER  # sampling over corner frequency of its filter, if about it

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
        """Spectrum of the mean products of two harmonics, which depend on their distance.

        From those above the band to those of the band, mirrored and direct, as one correlation of
        as few points as keep its ends apart.
        """
        band, above = self.in_band, self.orders.size - self.in_band
        means = self._means(self.orders.size + band + 1)
        lags = np.arange(1 - above, 2 * band + 1)
        kernel = np.zeros(scipy.fft.next_fast_len(lags.size), dtype=np.complex128)
        kernel[lags] = means[2 * band + 1 - lags]
        return scipy.fft.fft(kernel)

    @cached_property
    def _spectrum_of_means_turned(self) -> Complex:
        """The same of the correlation turned round."""
        return np.roll(self._spectrum_of_means[::-1], 1)

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
        """Harmonics (..., K) that a record shows of signals of harmonics (..., M).

        Those above the band and their conjugates have shares in it by the mean products over the
        usable samples, a correlation.
        """
        band, means = self.in_band, self._spectrum_of_means
        shares = scipy.fft.ifft(scipy.fft.fft(harmonics[..., band:], means.size) * means)
        direct, mirrored = shares[..., band + 1 : 2 * band + 1], shares[..., :band][..., ::-1]
        return harmonics[..., :band] + direct + np.conj(mirrored)

    def unfolded(self, weights: Complex) -> Complex:
        """Weights (c, M) of harmonics by which they sum up as some (c, K) of them folded.

        In the real part of the sum of products: the adjoint of `folded`.
        """
        band, means = self.in_band, self._spectrum_of_means
        rows = np.zeros((len(weights), 2 * band + 1), dtype=np.complex128)
        rows[:, band + 1 :] = weights
        rows[:, :band] = np.conj(weights[:, ::-1])
        shares = scipy.fft.ifft(scipy.fft.fft(rows, means.size) * self._spectrum_of_means_turned)
        return np.hstack([weights, shares[:, : self.orders.size - band]])

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

    @cached_property
    def _lines(self) -> tuple[Array, Array]:
        """Offset and drift (2, n) of size one, and weights (n, 2) by which values tell both."""
        basis = np.stack([np.ones(self.time.size), self.middle / self.middle[-1]])
        weighted = basis * self.usable
        return basis, np.linalg.solve(weighted @ basis.T, weighted).T

    def drift(self, values: Array) -> Array:
        """Offset and drift (c, n) of values (c, n), from the usable samples."""
        basis, weights = self._lines
        return values @ weights @ basis

    def at(self, harmonics: Complex, start: float) -> Array:
        """Channels (c, n) of harmonics (c, M) where the angle begins at a start angle."""
        points = 1 << math.ceil(math.log2(_POINTS_AN_ORDER * self.orders.size))
        padded = np.zeros((len(harmonics), points // 2 + 1), dtype=np.complex128)
        padded[:, 1 : self.orders.size + 1] = 0.5 * points * harmonics
        rows = np.fft.irfft(padded, points, axis=1)
        place = (self.turned + start) * (points / (2.0 * math.pi))
        before = np.floor(place)
        share = place - before
        index = before.astype(np.int64) & (points - 1)
        here, after = rows[:, index], rows[:, (index + 1) & (points - 1)]
        return here + share * (after - here)


@dataclass(frozen=True, eq=False)
class Alignment:
    """How a prediction lies beside a record."""

    predicted: Array  # (c, n), with offset and drift, SI
    angle: Array  # (n,) of the spindle, zero where the first tooth is at +y, rad
    start: float  # angle in the middle of the record, rad
    corner: float  # frequency of the anti-alias filter, Hz; inf for none
    misfit: float  # sum of squares of the harmonics that differ, over the deviations


@lru_cache
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
    damped = _damped(order)[:, None]
    inverse = 1.0 / (s * s + 1.0 + damped * s)  # of the pairs of poles
    slopes = (2.0 * s + damped) * inverse
    bend = np.sum(2.0 * inverse - slopes * slopes, axis=0)
    return LowPass(np.prod(inverse, axis=0), -rate * slopes.sum(axis=0), -rate * rate * bend)


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


class _Symmetric(NamedTuple):
    """Matrix (2, 2) of the angle and the ratio: plain numbers, as arrays so small cost more."""

    angle: float
    both: float
    ratio: float

    @property
    def determinant(self) -> float:
        """Determinant."""
        return self.angle * self.ratio - self.both * self.both


class _Laid(NamedTuple):
    """Harmonics laid beside a record, and what Newton's steps from there hang on."""

    start: float  # angle, rad
    ratio: float  # sampling over corner frequency
    cost: float  # sum of squares of what differs
    normal: _Symmetric
    gradient: tuple[float, float]  # by angle and ratio, with its sign turned
    curved: _Symmetric  # the normal matrix with what curves the harmonics


class _Search:
    """Start angle and filter at which scaled harmonics (c, M) fit a record best.

    By Newton's steps, of Gauss and Newton where the curvature is no minimum's, and narrower ones
    where the fit gets no better. A filter delays, as the angle does: the angle is counted as
    delayed, so that one hardly moves the other.
    """

    def __init__(self, scaled: Complex, recorded: Recorded, filter_order: int) -> None:
        self._scaled, self._recorded, self._order = scaled, recorded, filter_order
        self._turned = 1j * recorded.orders
        self._turned_twice = self._turned**2
        self._factors = np.ones((3, self._turned.size), dtype=np.complex128)
        self._factors[1] = self._turned
        self._delay = 0.0
        if recorded.angle is None:
            damped = float(_damped(filter_order).sum())
            self._delay = damped * recorded.speed / (2.0 * math.pi * recorded.sampling)
        self._widest = (_WIDEST_TURN * recorded.pitch, _WIDEST_FILTER)

    def filter_at(self, ratio: float) -> LowPass:
        """Anti-alias filter (M,) at the harmonics."""
        return low_pass(self._recorded.frequency, ratio, self._recorded.sampling, self._order)

    def found(self) -> _Laid:
        """Return the best that steps from the best angle of the scan and a likely filter reach."""
        best, width, last = self._begun(), 1.0, math.inf
        for _ in range(_MOST_STEPS):
            turn, ratio = self._step(best, width)
            normal = best.normal
            moved = normal.angle * turn**2 + 2.0 * normal.both * turn * ratio
            change = math.sqrt(max(moved + normal.ratio * ratio**2, 0.0)) / self._recorded.size
            if change <= _CONVERGED:
                break
            there = best.start + turn + self._delay * ratio, best.ratio + ratio
            if change <= min(_NEAR, _QUADRATIC * last):
                # what the next step would change is of the order of the square
                return best._replace(start=there[0], ratio=there[1])
            trial = self._at(*there)
            if trial.cost > best.cost:
                size = max(abs(turn) / self._widest[0], abs(ratio) / self._widest[1])
                width, last = _NARROWER * size, math.inf
            else:
                best, width, last = trial, min(_WIDER * width, 1.0), change
        return best

    def _begun(self) -> _Laid:
        """Best angle of the scan, behind the usual filter or that of the record if this fits."""
        usual = self._at(self._scanned(), USUAL_FILTER)
        apart = self._recorded.filter_ratio - USUAL_FILTER
        if abs(apart) < 0.5 * _WIDEST_FILTER:
            return usual
        own = self._at(usual.start + self._delay * apart, self._recorded.filter_ratio)
        return min(usual, own, key=lambda laid: laid.cost)

    def _at(self, start: float, ratio: float) -> _Laid:
        recorded, low = self._recorded, self.filter_at(ratio)
        now = self._scaled * (low.gain * np.exp(self._turned * start))
        of_ratio = low.slope + self._delay * self._turned
        factors = self._factors.copy()
        factors[2] = of_ratio
        shown = recorded.folded(now * factors[:, None])
        residual = recorded.content - shown[0]
        # real and imaginary parts side by side
        slopes = shown[1:].reshape(2, -1).view(np.float64)
        slopes[0] *= recorded.angle is None
        flat = residual.ravel().view(np.float64)
        (of_angle, of_both), (_, of_filter) = (slopes @ slopes.T).tolist()
        damping = _DAMPING * (of_angle + of_filter + 1e-300)
        normal = _Symmetric(of_angle + damping, of_both, of_filter + damping)
        curved = self._curved(normal, now, residual, of_ratio, low.bend)
        gradient = tuple((slopes @ flat).tolist())
        return _Laid(start, ratio, float(flat @ flat), normal, gradient, curved)

    def _curved(
        self, normal: _Symmetric, now: Complex, residual: Complex, of_ratio: Complex, bend: Complex
    ) -> _Symmetric:
        """Normal matrix less the second changes of the harmonics along the residual."""
        along = np.sum(self._recorded.unfolded(np.conj(residual)) * now, axis=0)
        seconds = [self._turned_twice, self._turned * of_ratio, of_ratio * of_ratio + bend]
        of_angle, of_both, of_filter = (np.array(seconds) @ along).real.tolist()
        if self._recorded.angle is not None:
            of_angle = of_both = 0.0
        return _Symmetric(normal.angle - of_angle, normal.both - of_both, normal.ratio - of_filter)

    def _step(self, at: _Laid, width: float) -> tuple[float, float]:
        """Step in angle and ratio, no wider than some: the angle by what the ratio is held to."""
        widest_turn, widest_ratio = width * self._widest[0], width * self._widest[1]
        lowest = max(-at.ratio, -widest_ratio)
        highest = min(_LOWEST_FILTER - at.ratio, widest_ratio)
        is_minimum = at.curved.angle > 0.0 and at.curved.determinant > 0.0
        curved = at.curved if is_minimum else at.normal
        by_angle, by_ratio = at.gradient
        ratio = (curved.angle * by_ratio - curved.both * by_angle) / curved.determinant
        ratio = min(max(ratio, lowest), highest)
        if ratio == 0.0 and at.curved.angle > 0.0:
            curved = at.curved  # at a bound the angle alone has its minimum
        turn = (by_angle - curved.both * ratio) / curved.angle
        return min(max(turn, -widest_turn), widest_turn), ratio

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
