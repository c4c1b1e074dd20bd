"""Chatter detection: whether a recorded cut is stable, its bifurcation and chatter frequency."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.description.brief_repr import BriefRepr
from chatter.detection.bifurcation_type import bifurcation_of
from chatter.detection.chatter_frequency import strongest_line
from chatter.detection.cut_record import CutRecord
from chatter.detection.deviations import (
    Deviations,
    deviations_of,
    growth_rate_of,
    slowest_growth_rate,
)
from chatter.detection.poincare_sections import (
    Periods,
    cut_into_periods,
    once_per_revolution,
    once_per_tooth,
    without_drift,
)

#: deviation per relative variation of the speed that may be its doing
_BY_SPEED = 60.0
#: deviations below this share are rounding; a small one counts when it has grown so many e-folds
_ROUNDING = 1e-7
_GROWN = 2.0
#: share of the feed per tooth below which what does not repeat changes no chip, and the e-folds by
#: which it has to grow over the record to be the beginning of chatter all the same
_MATTERS, _GROWN_OF_SMALL = 1e-3, 0.3
#: logarithm of the decay per revolution below which a motion counts as sustained
_SUSTAINED = -0.004
#: standard errors by which a decay has to be certain
_CERTAIN = 3.0
#: a decay at the end has to be a decay of the whole record, at this share of the rate at least
_SHARE_OF_RATE = 0.4
#: share of the deviations that multipliers may leave unpredicted if they are to be relied on
_GOOD_MAP = 0.05
#: drift over the later half that counts as slow, rad: no more can be told from a swell
_SLOW = 4.0
#: part of the mean that counts as motion: a slot with three or more teeth leaves little else
_PART_OF_MEAN = 0.3

#: change of a deviation in a revolution that is none to a reader
_NO_CHANGE = 5e-4


@dataclass(frozen=True, eq=False, repr=False)
class Detection(BriefRepr):
    """Result of chatter detection.

    Attributes
    ----------
    verdict : {"stable", "chatter"}
    confidence : float
        0 to 1; below about 0.6 a longer record is worth having.
    reason : str
        One sentence.
    bifurcation : {"none", "hopf", "flip", "period-n"}
    period : int
        Of the motion, in units of `period_unit`: 1 if stable, 0 if it never repeats.
    period_unit : {"revolution", "tooth"}
        Interval over which the motion was compared: teeth only if the tool is symmetric.
    chatter_frequency : float
        Hz, of the strongest line that is no harmonic; nan if stable.
    growth_rate : float
        1/s, of the deviation from period to period; negative: decays; nan if it drowns in noise.
    once_per_revolution, once_per_tooth : (m, k) array of float
        Signals where the first tooth, or any tooth, is at zero angle; m or N.
    metrics : dict of str to float
    """

    verdict: str
    confidence: float
    reason: str
    bifurcation: str
    period: int
    period_unit: str
    chatter_frequency: float
    growth_rate: float
    once_per_revolution: NDArray[np.float64]
    once_per_tooth: NDArray[np.float64]
    metrics: dict[str, float]

    @property
    def stable(self) -> bool:
        """Whether the verdict is "stable"."""
        return self.verdict == "stable"


class _Trend(NamedTuple):
    """Deviation in the last quarter and how it changes, in periods."""

    level: float  # share of the rms of the signal
    floor: float  # below it the deviation counts as none
    slope: float  # logarithm a period
    error: float
    whole: float  # logarithm a period from the first to the last quarter
    slowest: float  # logarithm a period of the multiplier that decays least
    misfit: float  # share of the deviations that multipliers do not predict
    spread: float  # rms of the signal, in units of the scale of the periods


class _Motion(NamedTuple):
    """What repeats, and the chatter line of what does not."""

    bifurcation: str
    period: int  # periods after which it repeats; 0 if never
    frequency: float  # Hz
    share: float  # of the variance from period to period that the chatter line explains
    per_revolution: int  # periods per revolution


def detect_chatter(record: CutRecord) -> Detection:
    """Detect whether a cut is stable or chatters.

    A stable cut repeats with every revolution of the spindle: runout and unequal pitch put lines
    at every multiple of the spindle frequency, none of which is chatter. So each revolution is
    compared with the next, noise is removed by the singular values that it alone would reach, and
    the cut is stable where the deviation has vanished or decays steadily. What stays or grows is
    chatter; the rotation of the deviation per revolution gives the bifurcation and the frequency.
    If the tool is declared symmetric (equal pitch, runout of zeros), tooth is compared with tooth,
    which also shows a period doubled within a revolution. If runout is not known and the number of
    teeth is even, such doubling is taken for chatter only where the record shows it growing.

    Parameters
    ----------
    record : CutRecord
        From rest or from an established cut; 20 revolutions or more are wanted.
    """
    per_revolution = record.teeth if record.is_symmetric else 1
    periods = cut_into_periods(record, per_revolution)
    deviations = deviations_of(periods.values)
    trend = _trend_of(deviations, periods, record.negligible)
    verdict, confidence, reason = _decide(trend, periods)
    if verdict == "chatter" and _is_drift(record, periods, trend):
        periods = without_drift(periods, record.lowest_frequency)
        deviations = deviations_of(periods.values)
        trend = _trend_of(deviations, periods, record.negligible)
        verdict, confidence, reason = _decide(trend, periods)
        if verdict == "chatter" and _is_drift(record, periods, trend):
            verdict, confidence = "stable", 0.6
        reason += (
            f"; a drift below {record.lowest_frequency:.3g} Hz, where the structure has no "
            "resonance, is taken off"
        )
    if verdict == "chatter" and _is_too_small(record, periods, trend):
        verdict, confidence = "stable", 0.6
        reason = (
            f"what does not repeat, {_size_of(periods, trend) * 1e6:.2g} um, is less than "
            f"{_MATTERS:.1%} of the feed per tooth and does not grow"
        )
    motion = _Motion("none", 1, math.nan, math.nan, per_revolution)
    if verdict == "stable" and _may_hide_doubling(record):
        doubling = doubling_within_revolution(record)
        if doubling.grew:
            verdict, confidence = "chatter", 0.6
            reason = "the motion grew until it repeats with every second tooth"
            motion = _motion(cut_into_periods(record, record.teeth), deviations.noise, 0.0)
        elif doubling.is_there:
            confidence = min(confidence, 0.6)
            reason += (
                "; every second tooth is alike, by the tool (runout, unlike flutes) or by a flip "
                "that grew at once"
            )
    elif verdict == "chatter":
        motion = _motion(periods, deviations.noise, max(trend.slope, 0.0))
        could_be_flip = motion.bifurcation == "hopf" and per_revolution == 1
        if could_be_flip and record.has_equal_pitch and _is_slow(periods):
            # a motion that nearly repeats with the revolution is a flip if two teeth repeat it
            by_tooth = _motion(cut_into_periods(record, record.teeth), deviations.noise, 0.0)
            motion = by_tooth if by_tooth.bifurcation == "flip" else motion
    return Detection(
        verdict=verdict,
        confidence=confidence,
        reason=reason,
        bifurcation=motion.bifurcation,
        period=motion.period,
        period_unit=_unit(motion.per_revolution),
        chatter_frequency=motion.frequency,
        growth_rate=trend.slope / periods.period if deviations.rank else math.nan,
        once_per_revolution=once_per_revolution(record),
        once_per_tooth=once_per_tooth(record),
        metrics=_metrics(record, periods, deviations, trend, motion.share),
    )


def _is_drift(record: CutRecord, periods: Periods, trend: _Trend) -> bool:
    """Whether what does not repeat moves more slowly than the structure can chatter."""
    if record.lowest_frequency <= 0.0:
        return False
    line = strongest_line(periods.values[len(periods.values) // 2 :], max(trend.slope, 0.0))
    return line.cycles / periods.period < record.lowest_frequency


def _is_too_small(record: CutRecord, periods: Periods, trend: _Trend) -> bool:
    """Whether what does not repeat changes no chip, and does not grow either."""
    if record.displacements is None:
        return False
    small = _size_of(periods, trend) < _MATTERS * record.feed_per_tooth
    return small and not _grows(trend, len(periods.values), _GROWN_OF_SMALL)


def _size_of(periods: Periods, trend: _Trend) -> float:
    """Rms of the deviation in the last quarter, m."""
    return trend.level * trend.spread * periods.scale


def _motion(periods: Periods, noise: float, growth_rate: float) -> _Motion:
    """Fit the chatter motion in the later half of the record."""
    later = periods.values[len(periods.values) // 2 :]
    line = strongest_line(later, growth_rate)
    bifurcation, period = bifurcation_of(later, line, growth_rate, noise)
    if period > 0:
        # a closed orbit has its lines exactly at multiples of 1/period
        order = max(round(line.rotation * period / (2.0 * math.pi)), 1)
        line = strongest_line(later, growth_rate, 2.0 * math.pi * order / period)
    frequency = line.cycles / periods.period
    return _Motion(bifurcation, period, frequency, line.share, periods.per_revolution)


def _is_slow(periods: Periods) -> bool:
    """Whether the motion drifts less than a fifth of a cycle or so over the later half."""
    later = periods.values[len(periods.values) // 2 :]
    return strongest_line(later).rotation * len(later) < _SLOW


def _unit(per_revolution: int) -> str:
    return "revolution" if per_revolution == 1 else "tooth"


def _may_hide_doubling(record: CutRecord) -> bool:
    return record.runout is None and record.has_equal_pitch and record.teeth % 2 == 0


def _trend_of(deviations: Deviations, periods: Periods, negligible: float) -> _Trend:
    """Level and slope of the deviations in the later half of the record."""
    sizes = deviations.sizes
    later = periods.values[len(periods.values) // 2 :]
    mean = later.mean(axis=(0, 1))
    spread = math.sqrt(np.mean(np.sum((later - mean) ** 2, axis=2)))
    spread = math.hypot(spread, _PART_OF_MEAN * float(np.linalg.norm(mean))) or 1.0
    by_speed = _BY_SPEED * periods.speed_variation
    by_sampling = math.sqrt(max(periods.roughness**2 - (1.2 * deviations.noise) ** 2, 0.0)) / spread
    floor = math.hypot(negligible, by_speed, by_sampling, deviations.noise_size / spread)
    quarter = max(len(sizes) // 4, 2)
    level = float(np.sqrt(np.mean(sizes[-quarter:] ** 2))) / spread
    if deviations.rank == 0:
        return _Trend(0.0, floor, -math.inf, 0.0, -math.inf, -math.inf, 0.0, spread)
    slope, error = growth_rate_of(sizes[len(sizes) // 2 :])
    first = float(np.sqrt(np.mean(sizes[:quarter] ** 2))) / spread
    whole = math.log(max(level, 1e-300) / max(first, 1e-300)) / (len(sizes) - quarter)
    slowest, misfit = slowest_growth_rate(deviations.rows[len(sizes) // 2 :])
    return _Trend(level, floor, slope, error, whole, slowest, misfit, spread)


def _decide(trend: _Trend, periods: Periods) -> tuple[str, float, str]:
    growth_rate, error = trend.slope * periods.per_revolution, trend.error * periods.per_revolution
    of_what = _unit(periods.per_revolution)
    if trend.level < trend.floor and _grows(trend, len(periods.values), _GROWN):
        return (
            "chatter", 0.7,
            f"the motion differs from {of_what} to {of_what} by {trend.level:.2%} of its rms only, "
            f"but that grows by {math.expm1(growth_rate):.1%} per revolution",
        )  # fmt: skip
    if trend.level < trend.floor:
        sure = 1.0 - 0.4 * trend.level / trend.floor
        return (
            "stable", sure,
            f"the motion repeats from {of_what} to {of_what} within {trend.level:.2%} of its rms",
        )  # fmt: skip
    decays = _decays(trend, periods.per_revolution)
    away = abs(growth_rate - _SUSTAINED) / (0.01 + 2.0 * error)
    sure = 0.5 + 0.5 * min(1.0, max(away, 0.0 if decays else trend.level))
    if decays:
        return (
            "stable", sure,
            f"what differs in the motion from {of_what} to {of_what} decays by "
            f"{-math.expm1(growth_rate):.1%} per revolution",
        )  # fmt: skip
    return (
        "chatter", sure,
        f"the motion differs from {of_what} to {of_what} by {trend.level:.0%} of its rms, "
        f"{_trend_in_words(math.expm1(growth_rate))}",
    )  # fmt: skip


def _trend_in_words(change: float) -> str:
    """How a deviation goes on, by its change in a revolution."""
    if abs(change) < _NO_CHANGE:
        return "revolution after revolution"
    return f"{abs(change):.1%} {'more' if change > 0.0 else 'less'} with every revolution"


def _grows(trend: _Trend, count: int, e_folds: float) -> bool:
    """Whether a small deviation grows steadily, by e-folds over the record, above rounding."""
    steady = trend.slope > _CERTAIN * trend.error and trend.whole > _SHARE_OF_RATE * trend.slope
    return trend.level > _ROUNDING and steady and trend.whole * count > e_folds


def _decays(trend: _Trend, per_revolution: int) -> bool:
    """Whether the deviation decays, by its multipliers and by its size or the quality of those."""
    if trend.slowest * per_revolution >= _SUSTAINED:
        return False
    by_size = (
        trend.slope * per_revolution < min(_SUSTAINED, -_CERTAIN * trend.error * per_revolution)
        and trend.whole < _SHARE_OF_RATE * trend.slope
    )
    by_multipliers = trend.misfit < _GOOD_MAP and trend.whole < _SHARE_OF_RATE * trend.slowest
    return by_size or by_multipliers


def _metrics(
    record: CutRecord, periods: Periods, deviations: Deviations, trend: _Trend, share: float
) -> dict[str, float]:
    sections = once_per_revolution(record)
    later = sections[len(sections) // 2 :]
    values = periods.values[len(periods.values) // 2 :]
    about_mean = np.sum((values - values.mean(axis=(0, 1))) ** 2)
    off = np.sum((values - values.mean(axis=0)) ** 2)
    metrics = {
        "once_per_revolution_variance": float(np.sum(np.var(later, axis=0))),
        "off_harmonic_share": float(off / about_mean) if about_mean > 0.0 else 0.0,
        "deviation": trend.level,
        "deviation_floor": trend.floor,
        "growth_rate_per_revolution": trend.slope * periods.per_revolution,
        "growth_rate_error_per_revolution": trend.error * periods.per_revolution,
        "noise": deviations.noise * periods.scale,
        "slowest_growth_rate_per_revolution": trend.slowest * periods.per_revolution,
        "whole_growth_rate_per_revolution": trend.whole * periods.per_revolution,
        "misfit": trend.misfit,
        "rank": float(deviations.rank),
        "line_share": share,
    }
    # where nothing stands out of the noise there is no rate
    return {name: value if math.isfinite(value) else math.nan for name, value in metrics.items()}


#: difference of neighbouring teeth, share of the rms of the motion, from which they differ
_DIFFER = 0.1
#: difference of every second tooth, as a share of that of neighbours, up to which they are alike
_ALIKE = 0.1
#: factor by which the change from one pair of teeth to the next has to grow
_GROWTH = 1.7
#: share of the final difference of neighbours that the change has to reach
_NOTABLE = 0.1
#: share of the final difference up to which neighbours differ before it grows
_SMALL = 0.5


class Doubling(NamedTuple):
    """How neighbouring teeth came to differ."""

    is_there: bool  # neighbours differ, every second tooth is alike
    grew: bool  # and the difference grew from little


def doubling_within_revolution(record: CutRecord) -> Doubling:
    """Whether neighbouring teeth differ with every second one alike, and came to it by growth.

    Of a record from rest with equal pitch and an even number of teeth. Both runout and a flip make
    neighbouring teeth differ. A forced motion is there from the first revolution on and only
    settles: its changes shrink. A flip starts from the little that the transient leaves of it, and
    its changes grow before it saturates; one that grew within the first revolution looks like
    runout.
    """
    teeth = cut_into_periods(record, record.teeth).values
    last = teeth[-4 * record.teeth :]
    # averages over revolutions, to keep noise out
    mean = last.reshape(4, record.teeth, *last.shape[1:]).mean(axis=0)
    neighbours = _rms(mean - np.roll(mean, 1, axis=0))
    seconds = _rms(mean - np.roll(mean, 2, axis=0))
    spread = _rms(mean - mean.mean(axis=(0, 1)))
    if neighbours < _DIFFER * spread or seconds > _ALIKE * neighbours:
        return Doubling(False, False)
    pairs = teeth[len(teeth) % 2 :]
    return Doubling(True, _grew(0.5 * (pairs[0::2] - pairs[1::2])))


def _rms(values: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean(np.sum(values**2, axis=2))))


def _grew(alternation: NDArray[np.float64]) -> bool:
    """Whether the half difference of neighbours, (pairs, points, k), grew from little."""
    changes = deviations_of(alternation)
    if changes.rank == 0:
        return False
    sizes = np.sqrt(np.mean(np.sum(alternation**2, axis=2), axis=1))
    final = float(np.median(sizes[-max(len(sizes) // 4, 1) :]))
    lowest = np.hypot(np.minimum.accumulate(changes.sizes), changes.noise_size)
    largest = int(np.argmax(changes.sizes / lowest))
    return bool(
        changes.sizes[largest] > max(_GROWTH * lowest[largest], _NOTABLE * final)
        and sizes[: largest + 1].min() < _SMALL * final
    )
