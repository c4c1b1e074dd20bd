"""What a small difference along a simulated cut, followed turn by turn, tells of its growth."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from chatter.simulation.perturbation.followed_run import force_share

Array = NDArray[np.float64]

#: turns of an envelope, and over which growth is looked at, at the least
_ENVELOPE, _LEAST_LAG = 4, 2
#: parts that the watched turns are cut into for the error of a rate, and the fewest of them
_PARTS, _FEWEST_PARTS = 6, 3
#: share of the watched turns in which what is left of the start dies out
_SETTLING = 1.0 / 3.0
#: a period is a whole number of turns within this share
_WHOLE = 1e-6
#: cosine of the angle between shapes that are one
_SAME_SHAPE = 0.99
#: samples that show a frequency, at the least
_LEAST_SAMPLES = 16
#: share of the cutting force from which on the motion tells of that in the full cut
_SHOWN_SHARE = 0.1
#: turns whose motion is looked at for its frequency, at the most
_MOST_TURNS = 100


@dataclass(frozen=True, eq=False)
class LyapunovRecord:
    """What two runs beside a leading one tell, turn by turn."""

    hold: int  # turns in which the cut took hold
    period: float  # of the variation, turns
    cycle: float  # of the lowest mode, turns
    #: (n,), logarithm of the speed of the difference, over the perturbation a second, as if it had
    #: never been brought back
    size: Array
    distance: Array  # (n,), the same of the difference itself, over the perturbation
    #: (n,), speed of the difference of the run from rest, over that of the motion itself
    from_rest: Array
    still: NDArray[np.bool_]  # (n,), where the difference does not move: friction holds it
    #: (n,), logarithm of what the difference has been brought back by before every turn
    scale: Array
    motion: list[Array]  # the difference in every turn as it was followed, (m, 3), m
    rest: list[Array]  # that of the run from rest, (m, 3), m
    step: float  # from sample to sample of them, s
    swing: Array  # (n,), half the range of the motion in every turn, of the axis that moves most, m
    left: bool  # a run has left the range of the model
    rubs: bool = False  # there is friction on modes

    def rise(self, first: int, least: float) -> tuple[int, int] | None:
        """Earliest growth by a logarithm, at the least, over whole periods from a turn on.

        What friction held and lets go only begins to move: with it the distance must grow as well.
        Returns its first turn and its last; None where nothing grows that much.
        """
        width = max(_ENVELOPE, math.ceil(self.cycle))
        sizes = (self.size, self.distance) if self.rubs else (self.size,)
        grown = np.stack([size[first:] for size in sizes])
        if grown.shape[1] < width + _LEAST_LAG:
            return None
        # beating must not look like growth
        envelope = np.lib.stride_tricks.sliding_window_view(grown, width, axis=1).max(axis=2)
        count = envelope.shape[1]
        found: list[tuple[int, float, int]] = []
        for periods in range(1, int(count / self.period) + 1):
            lag = round(periods * self.period)
            if not _LEAST_LAG <= lag < count:
                continue
            rise = (envelope[:, lag:] - envelope[:, :-lag]).min(axis=0)
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
            positions = end - np.arange(parts + 1) * length
            error = float(np.std(np.diff(self.size[positions]) / length, ddof=1)) / math.sqrt(parts)
        return self.rate(begin, end), error

    def from_rest_converges(self, share: float, slope: float) -> bool:
        """Tell whether the run from rest is at the forced motion, or on its way to it."""
        begin, end = self.watched_last
        apart = self.from_rest[begin : end + 1]
        if apart[-max(_ENVELOPE, math.ceil(self.cycle)) :].max() < share:
            return True
        logarithm = np.log(np.maximum(apart, 1e-300))
        return float(np.polyfit(np.arange(len(apart)), logarithm, 1)[0]) < -slope

    def creeps(self) -> bool:
        """Whether friction lets what is left of a perturbation creep: it keeps its shape then.

        Vibration that does not repeat turns from shape to shape.
        """
        if not self.rubs:
            return False
        begin, end = self.watched_last
        lag = max(round(self.period), 1)
        shapes = [
            np.diff(self.motion[turn], axis=0).ravel() for turn in range(end, begin - 1, -lag)
        ]
        sizes = [float(np.linalg.norm(shape)) for shape in shapes]
        alike = [
            float(shape @ shapes[0]) > _SAME_SHAPE * size * sizes[0]
            for shape, size in zip(shapes, sizes, strict=True)
        ]
        return len(alike) > 1 and all(alike)

    def repeats(self, share: float) -> bool:
        """Whether the motion repeats with the variation, as far as its range in every turn tells.

        A share of the range counts as none. It tells where a period is a whole number of turns.
        """
        lag = round(self.period)
        if lag < 1 or abs(self.period - lag) > _WHOLE * lag or len(self.swing) < 2 * lag:
            return True
        last, before = self.swing[-lag:], self.swing[-2 * lag : -lag]
        return bool(np.abs(last - before).max() <= share * last.max())

    def swing_of_small_motion(self, small: float) -> float:
        """Half the range that the motion would have in the full cut by that of small motion, m.

        Up to half a range `small`, m, forced vibration grows with the force alone. Largest of all
        revolutions of the force ramp; nan where none is small.
        """
        turns = min(self.hold, len(self.swing))
        share = force_share((np.arange(turns) + 1.0) / max(self.hold, 1))
        swing = self.swing[:turns]
        shown = (share > _SHOWN_SHARE) & (swing < small)
        return float((swing[shown] / share[shown]).max()) if shown.any() else math.nan

    def frequency(self, begin: int, end: int) -> float:
        """Strongest line of the difference between two turns, Hz."""
        begin = max(0, begin, end - _MOST_TURNS)
        steady = []
        for turn in range(begin, end):
            motion = self.motion[turn]
            position = turn + np.arange(len(motion)) / len(motion)
            size = np.interp(position, np.arange(len(self.size)) + 0.5, self.size)
            steady.append(motion * np.exp(self.scale[turn] - size)[:, None])
        return _strongest(steady, self.step)

    def frequency_of_rest(self, begin: int, end: int) -> float:
        """Strongest line of the difference of the run from rest, Hz."""
        return _strongest(self.rest[max(0, begin, end - _MOST_TURNS) : end], self.step)


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
