"""Growth of a small difference along a simulated cut, turn by turn."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from chatter.case import Case
from chatter.simulation.followed_run import FollowedRun, share_held
from dynamics.modal import Mode

Array = NDArray[np.float64]

#: size of the difference after every turn, as a share of the feed
_PUSH = 1e-6
#: push after every turn while the cut takes hold, as a share of it: no shape is lost for good
_RENEWED = 1e-3
#: a difference that moves by less than this share of its size, a turn of the lowest mode, is still
_STILL = 1e-7
#: turns of an envelope, and over which growth is looked at, at the least
_ENVELOPE, _LEAST_LAG = 4, 2
#: samples of a cycle of the highest mode that are kept
_SAMPLES = 12
#: parts that the watched turns are cut into for the error of a rate, and the fewest of them
_PARTS, _FEWEST_PARTS = 6, 3
#: share of the watched turns in which what is left of the start dies out
_SETTLING = 1.0 / 3.0
#: difference that is rounding, as a share of the push
_ROUNDING = 1e-12
#: samples that show a frequency, at the least
_LEAST_SAMPLES = 16
#: share of the cutting force from which on the motion tells of that in the full cut
_SHOWN_SHARE = 0.1
#: turns whose motion is looked at for its frequency, at the most
_MOST_TURNS = 100


@dataclass(frozen=True, eq=False)
class Exponents:
    """What two runs beside a leading one tell, turn by turn.

    Parameters
    ----------
    hold : int
        Turns in which the cut took hold.
    period : float
        Of the variation, turns.
    cycle : float
        Of the lowest mode, turns.
    size : (n,) array of float
        Logarithm of the speed of the difference, as if it had never been brought back.
    from_rest : (n,) array of float
        Speed of the difference of the run from rest, over that of the motion itself.
    still : (n,) array of bool
        Where the difference does not move: friction holds it.
    scale : (n,) array of float
        Logarithm of what the difference has been brought back by before every turn.
    motion, rest : list of (m, 3) array of float
        The difference in every turn as it was followed, m, and that of the run from rest.
    step : float
        From sample to sample of them, s.
    swing : (n,) array of float
        Half the range of the motion in every turn, of the axis that moves most, m.
    left : bool
        True where a run has left the range of the model.
    """

    hold: int
    period: float
    cycle: float
    size: Array
    from_rest: Array
    still: NDArray[np.bool_]
    scale: Array
    motion: list[Array]
    rest: list[Array]
    step: float
    swing: Array
    left: bool

    def growth(self, first: int, least: float) -> tuple[int, int] | None:
        """Earliest growth by a logarithm, at the least, over whole periods from a turn on.

        Returns
        -------
        (int, int) or None
            Its first turn and its last; None where nothing grows that much.
        """
        width = max(_ENVELOPE, math.ceil(self.cycle))
        size = self.size[first:]
        if len(size) < width + _LEAST_LAG:
            return None
        # beating must not look like growth
        envelope = np.lib.stride_tricks.sliding_window_view(size, width).max(axis=1)
        found: list[tuple[int, float, int]] = []
        for count in range(1, int(len(envelope) / self.period) + 1):
            lag = round(count * self.period)
            if not _LEAST_LAG <= lag < len(envelope):
                continue
            rise = envelope[lag:] - envelope[:-lag]
            enough = np.flatnonzero(rise >= least)
            if enough.size:
                found.append((int(enough[0]) + lag, -rise[enough[0]] / lag, lag))
        if not found:
            return None
        end, _, lag = min(found)
        return first + end + width - 1 - lag, first + end + width - 1

    @property
    def watched_last(self) -> tuple[int, int]:
        """Turns that are watched when the start has died out: the first, and one past the last."""
        count = len(self.size)
        begin = self.hold + int(_SETTLING * (count - self.hold))
        periods = math.floor((count - 1 - begin) / self.period)
        if periods >= 1:
            begin = count - 1 - round(periods * self.period)
        return begin, count - 1

    def rate(self, begin: int, end: int) -> float:
        """Growth from turn to turn between two turns, logarithm a turn."""
        size = self.size[begin : end + 1]
        if self.period > _ENVELOPE or len(size) < _ENVELOPE:
            return float(size[-1] - size[0]) / max(len(size) - 1, 1)
        return float(np.polyfit(np.arange(len(size)), size, 1)[0])

    def settled_rate(self) -> tuple[float, float]:
        """Growth when the start has died out, logarithm a turn, and its standard error.

        The rate is -inf where nothing moves; the error is inf where it cannot be told.
        """
        begin, end = self.watched_last
        if self.still[begin : end + 1].all():
            return -math.inf, 0.0
        # parts of whole periods, so that what goes up and down within one is no error
        parts = min(_PARTS, math.floor((end - begin) / max(self.period, _LEAST_LAG)))
        error = math.inf
        if parts >= _FEWEST_PARTS:
            length = round(math.floor((end - begin) / parts / self.period) * self.period)
            places = end - np.arange(parts + 1) * length
            error = float(np.std(np.diff(self.size[places]) / length, ddof=1)) / math.sqrt(parts)
        return self.rate(begin, end), error

    def from_rest_alike(self, share: float, slope: float) -> bool:
        """Tell whether the run from rest is at the forced motion, or on its way to it."""
        begin, end = self.watched_last
        apart = self.from_rest[begin : end + 1]
        if apart[-max(_ENVELOPE, math.ceil(self.cycle)) :].max() < share:
            return True
        logarithm = np.log(np.maximum(apart, 1e-300))
        return float(np.polyfit(np.arange(len(apart)), logarithm, 1)[0]) < -slope

    def swing_of_small_motion(self, small: float) -> float:
        """Half the range that the motion would have in the full cut by that of small motion, m.

        Parameters
        ----------
        small : float
            Half the range, m, up to which forced vibration grows with the force alone.

        Returns
        -------
        float
            Largest of all turns while the cut takes hold; nan where none is small.
        """
        turns = min(self.hold, len(self.swing))
        share = share_held((np.arange(turns) + 1.0) / max(self.hold, 1))
        swing = self.swing[:turns]
        shown = (share > _SHOWN_SHARE) & (swing < small)
        return float((swing[shown] / share[shown]).max()) if shown.any() else math.nan

    def frequency(self, begin: int, end: int) -> float:
        """Strongest line of the difference between two turns, Hz."""
        begin = max(0, begin, end - _MOST_TURNS)
        steady = []
        for turn in range(begin, end):
            motion = self.motion[turn]
            place = turn + np.arange(len(motion)) / len(motion)
            size = np.interp(place, np.arange(len(self.size)) + 0.5, self.size)
            steady.append(motion * np.exp(self.scale[turn] - size)[:, None])
        return _strongest(steady, self.step)

    def frequency_of_rest(self, begin: int, end: int) -> float:
        """Strongest line of the difference of the run from rest, Hz."""
        return _strongest(self.rest[max(0, begin, end - _MOST_TURNS) : end], self.step)


def follow(case: Case, modes: tuple[Mode, ...], hold: int, watch: int, period: float) -> Exponents:
    """Follow a cut as it takes hold and after that, with a pushed run and one from rest beside it.

    Parameters
    ----------
    case : Case
    modes : tuple of Mode
        Of its structure.
    hold, watch : int
        Turns in which the cut takes hold, and that are watched after that.
    period : float
        Of the variation, turns.
    """
    leader, pushed, rest = (FollowedRun(case, modes, turns) for turns in (hold, hold, 0))
    push = _PUSH * case.cut.feed_per_tooth
    frequencies = [mode.frequency for mode in leader.setup.modes]
    a_second = leader.setup.spindle.speed / (2.0 * math.pi)
    cycle = a_second / min(frequencies)
    stride = _stride(leader.bins, a_second / max(frequencies))
    least = 2.0 * math.pi * min(frequencies) * leader.setup.step * _STILL
    pushed.push(push)
    found: list[tuple[float, float, bool, float, float, Array, Array]] = []
    scale, left = 0.0, False
    for turn in range(hold + watch):
        motion, beside, other = leader.turn(), pushed.turn(), rest.turn()
        if motion is None or beside is None:
            left = True
            break
        difference = beside - motion
        other = np.full_like(motion, math.inf) if other is None else other - motion
        apart = max(_rms(difference), _ROUNDING * push)
        moving = _moving(difference)
        still = moving < least * apart
        size = math.log(max(moving, least * apart)) + scale
        with np.errstate(invalid="ignore", divide="ignore"):
            away = float(np.nan_to_num(_moving(other) / _moving(motion), nan=math.inf))
        swing = 0.5 * float(np.ptp(motion, axis=0).max())
        found.append((size, scale, still, away, swing, difference[::stride], other[::stride]))
        pushed.come_closer(leader, push / apart)
        scale += math.log(apart / push)
        if turn < hold:
            pushed.push((-1.0) ** turn * _RENEWED * push)
    size, scales, still, away, swing, motions, others = (
        zip(*found, strict=True) if found else ((),) * 7
    )
    return Exponents(
        hold=hold,
        period=period,
        cycle=cycle,
        size=np.array(size),
        from_rest=np.array(away),
        still=np.array(still, dtype=bool),
        scale=np.array(scales),
        motion=list(motions),
        rest=list(others),
        step=stride * leader.setup.step,
        swing=np.array(swing),
        left=left,
    )


def _rms(motion: Array) -> float:
    return math.sqrt(float(np.mean(np.sum(motion**2, axis=1))))


def _moving(motion: Array) -> float:
    """Root mean square of the change from sample to sample."""
    return _rms(np.diff(motion, axis=0))


def _stride(bins: int, cycle: float) -> int:
    """Divisor of the steps of a turn that keeps enough samples of a cycle, given in turns."""
    most = max(1, int(bins * cycle / _SAMPLES))
    return next(stride for stride in range(min(most, bins // 2), 0, -1) if bins % stride == 0)


def _strongest(parts: list[Array], step: float) -> float:
    """Frequency of the strongest line of (n, 3) samples, Hz, between the lines of the FFT."""
    signal = np.concatenate(parts) if parts else np.zeros((0, 3))
    if len(signal) < _LEAST_SAMPLES or not np.isfinite(signal).all():
        return math.nan
    window = np.hanning(len(signal))[:, None]
    amplitude = np.linalg.norm(np.fft.rfft(signal * window, axis=0), axis=1)
    peak = int(np.clip(np.argmax(amplitude[1:]) + 1, 1, len(amplitude) - 2))
    low, middle, high = np.log(np.maximum(amplitude[peak - 1 : peak + 2], 1e-300))
    bend = low - 2.0 * middle + high
    shift = 0.5 * (low - high) / bend if bend < 0.0 else 0.0
    return float((peak + shift) / (len(signal) * step))
