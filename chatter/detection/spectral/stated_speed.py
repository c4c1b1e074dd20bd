"""Whether the lines of a recording speak for another spindle speed than the one that is stated.

A speed is mistyped, the operator turns the override, the file is of another cut. Near the stated
speed some comb is always found, for every fourth line of a cut lies on the harmonics of three
quarters of its speed. So two things are asked of a comb: that lines lie at its multiples, and that
it leaves none of the lines without a reason, but those of one chatter frequency.
"""

from __future__ import annotations

import itertools
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.detection.spectral.chatter_lines import MOST_TEETH, Comb, strongest_line
from chatter.detection.spectral.revolution_frequency import (
    ABOUT_GIVEN,
    CERTAIN,
    Spacing,
    best_spacing,
    line_autocorrelations,
    slowest_of,
    spacing_scores,
)
from chatter.detection.spectral.spectra import RATIO_AT_REST, Frames, mean_of

Array = NDArray[np.float64]

#: multiples of a spacing, at the least, that the range of frequencies has to hold
_MULTIPLES = 4.0
#: whole parts of a spacing that score as well as it does where it is a multiple of the true one,
#: and the share of its score that they have then
_PARTS, _SCORES_AS_WELL = (2, 3, 4, 5, 6, 7, 8), 0.9
#: multiples of a spacing that are looked at, and the share of the others that those have which are
#: there as well
_ORDERS, _ALIKE = 6, 0.5
#: logarithm above the floor from which a bin counts to a line, and at most
_COUNTS, _AT_MOST = 1.5, 5.0
#: factor by which one speed has to explain the lines better than another
_BETTER = 1.25
#: share of the explanation with a chatter line that one without it has to reach; the stated speed
#: over one of which it is a multiple, at the most
_AS_WELL, _MOST_SLOWER = 0.85, 3
#: share of the lines of the finest harmonics that coarser ones have to hold to be believed
_AS_GOOD = 0.85
#: relative uncertainty of a speed that many lines show; relative difference of one and the same
_READ, _SAME = 3e-4, 5e-3
#: standard deviations from which a spacing near the stated speed, though not the same, is it
_BEYOND_DOUBT = 25.0
#: share of the power from which a line off the harmonics is set aside with its multiples
_LARGE = 0.3
#: harmonics of the teeth, and their logarithm above the others, by which runout is seen
_FEWEST, _STANDS_OUT = 3, 1.0


class Explanation(NamedTuple):
    """How well the harmonics of a speed, and one chatter line beside them, explain the lines."""

    frequency: float  # Hz, of the spindle
    spacing: Spacing  # of the lines, a whole multiple of it
    explained: float  # share of the lines on the harmonics or of the chatter line

    @property
    def quality(self) -> float:
        """Lines lie at the multiples, and no others are there."""
        return self.spacing.score * self.explained


#: what the lines say of the stated speed: another explains them far better; or a whole multiple of
#: it does as well, by which a chatter line on its harmonics may lie between true ones; or a whole
#: part of it, by which what lies between its harmonics may be none but true ones
REFUTED, FASTER, SLOWER = "refuted", "faster", "slower"


class OtherSpeed(NamedTuple):
    """A speed that the lines speak for, and not the one that was stated."""

    frequency: float  # Hz, with as many teeth as were stated
    spacing: float  # Hz, of the lines
    relation: str  # `REFUTED`, `FASTER` or `SLOWER`


class LinesOfRecord:
    """What the lines of a recording say of its speed.

    Parameters
    ----------
    frames : Frames
        Long ones.
    stated : float
        Hz.
    teeth : int or None
    rest : (b,) array of float or None
        Power of what is there without the cut: lines that do not exceed it by far are none.
    """

    def __init__(
        self, frames: Frames, stated: float, teeth: int | None, rest: Array | None = None
    ) -> None:
        self._stated = stated
        self._teeth = teeth
        self._power, self._above = mean_of(frames, slice(None))
        self._frames = frames
        if rest is not None:
            self._leave_out(self._power <= RATIO_AT_REST * rest)
        self._autocorrelation = line_autocorrelations(self._frames).sum(axis=0)
        self._set_chatter_aside()
        self._lines = np.clip(self._above - _COUNTS, 0.0, _AT_MOST)
        self._confirmed = self._confirmed_by_lines()

    def _leave_out(self, bins: NDArray[np.bool_]) -> None:
        """Lines in some bins are none."""
        self._above = np.where(bins, 0.0, self._above)
        self._frames = self._frames._replace(above=np.where(bins, 0.0, self._frames.above))

    def _set_chatter_aside(self) -> None:
        """Leave a large line off the harmonics out, with its multiples, if the others suffice.

        Its multiples are a spacing too, and speeds near the stated one may have them all as
        harmonics. The others suffice where they show the same speed near the stated one.
        """
        whole, before = self._frames, self._above
        found = self._best_about_stated(self._autocorrelation)
        if not found.significance > CERTAIN:
            return
        comb = Comb(found.frequency, found.frequency * (self._teeth or 1), _READ, whole.half_width)
        line = strongest_line(self._power, before, whole.frequency, comb)
        if not line.alone > _LARGE:
            return
        order = np.maximum(np.round(whole.frequency / line.frequency), 1.0)
        self._leave_out(np.abs(whole.frequency - order * line.frequency) < whole.half_width)
        others = line_autocorrelations(self._frames).sum(axis=0)
        again = self._best_about_stated(others)
        if again.significance > CERTAIN and _is_same(again.frequency, found.frequency):
            self._autocorrelation = others
        else:
            self._frames, self._above = whole, before

    def _best_about_stated(self, autocorrelation: Array) -> Spacing:
        """Speed near the stated one by the spacing of lines."""
        bounds = self._stated * (1.0 - ABOUT_GIVEN), self._stated * (1.0 + ABOUT_GIVEN)
        return best_spacing(autocorrelation, self._frames.step, *bounds, self._teeth or 1)

    def _confirmed_by_lines(self) -> float | None:
        """Speed near the stated one that the lines leave no doubt of, Hz."""
        found = self._best_about_stated(self._autocorrelation)
        is_stated = _is_same(found.frequency, self._stated)
        least = CERTAIN if is_stated else _BEYOND_DOUBT
        return found.frequency if found.significance > least else None

    def near(self, frequency: float, within: float = ABOUT_GIVEN) -> Explanation:
        """Best explanation by a speed near one, Hz, of a relative difference at the most."""
        found = []
        for parts in self._divisors():
            low, high = parts * frequency * (1.0 - within), parts * frequency * (1.0 + within)
            spacing = best_spacing(self._autocorrelation, self._frames.step, low, high)
            found.append(self._explanation(spacing, parts))
        return max(found, key=lambda one: one.quality)

    def _own(self) -> Explanation:
        """Explanation by a speed near the stated one: by that which the lines confirm if any."""
        if self._confirmed is None:
            return self.near(self._stated)
        return self.near(self._confirmed, _SAME)

    def corrected(self, frequency: float) -> float:
        """Speed near the stated one that explains the lines far better than this one does, Hz."""
        if self._confirmed is not None and _is_same(frequency, self._confirmed):
            return frequency
        best = self.near(self._stated)
        if _is_same(best.frequency, frequency) or best.spacing.significance < CERTAIN:
            return frequency
        own = self.near(frequency, _SAME)
        return best.frequency if best.quality > _BETTER * own.quality else frequency

    def other_speed(self) -> OtherSpeed | None:
        """Speed that the lines speak for and that is not the stated one; None where none is."""
        spacing = self._spacing()
        if not spacing.significance > CERTAIN:
            return None
        own = self._own()
        parts = self._divisors() if self._teeth is None else [1, self._teeth]
        natural = [spacing.frequency / one for one in parts]
        if any(_is_same(one, own.frequency) for one in natural):
            return None
        each = [self._explanation(spacing, one) for one in self._divisors()]
        best = max(one.explained for one in each)
        coarse = next(one for one in each if one.explained >= _AS_GOOD * best)
        revolutions = self._revolutions(spacing)
        speed = self._nearest(revolutions) if coarse is each[0] else coarse.frequency
        slower = [
            one for one in (*revolutions, speed) if _is_multiple(own.frequency, one, _MOST_SLOWER)
        ]
        if slower and max(one.quality for one in each) > own.quality / _BETTER:
            return OtherSpeed(max(slower), spacing.frequency, SLOWER)
        if self._confirmed is not None and abs(speed / own.frequency - 1.0) < ABOUT_GIVEN:
            return None
        if any(self._is_better(one, own) for one in each):
            return OtherSpeed(speed, spacing.frequency, REFUTED)
        if _is_multiple(spacing.frequency, own.frequency) and speed > own.frequency:
            return OtherSpeed(speed, spacing.frequency, FASTER)
        return None

    def speak_for(self, other: OtherSpeed) -> bool:
        """Whether the lines, as far apart as those of another speed, fit it far better."""
        bounds = other.spacing * (1.0 - _SAME), other.spacing * (1.0 + _SAME)
        spacing = best_spacing(self._autocorrelation, self._frames.step, *bounds)
        own = self._own()
        each = [self._explanation(spacing, parts) for parts in self._divisors()]
        return any(self._is_better(one, own) for one in each)

    def _is_better(self, one: Explanation, other: Explanation) -> bool:
        """Whether one speed explains the lines far better, or without chatter as well."""
        if _is_multiple(other.frequency, one.frequency):
            return False
        if one.quality > _BETTER * other.quality:
            return True
        without = one.spacing.score * self._explained(one.frequency, 0)
        return (
            without > _AS_WELL * other.quality
            and without > _BETTER * other.spacing.score * self._explained(other.frequency, 0)
        )

    def _revolutions(self, spacing: Spacing) -> list[float]:
        """Speeds of which a spacing may be that of the revolution or of the teeth, Hz.

        It is that of the revolution where every so many lines stand out as those of teeth.
        """
        if self._teeth is None:
            parts = self._divisors()
            return [spacing.frequency, self._nearest([spacing.frequency / one for one in parts])]
        if self._teeth_stand_out(spacing):
            return [spacing.frequency]
        return [spacing.frequency, spacing.frequency / self._teeth]

    def _teeth_stand_out(self, spacing: Spacing) -> bool:
        """Whether of lines at the multiples of a spacing those of the teeth are the larger."""
        teeth = self._teeth or 1
        most = int(self._frames.frequency[-1] / spacing.frequency)
        orders = np.arange(1, min(most, _ORDERS * teeth) + 1)
        bins = np.round(orders * spacing.frequency / self._frames.step).astype(np.intp)
        bins = np.clip(bins, 1, self._above.size - 2)
        lines = self._above[bins[:, None] + np.arange(-1, 2)].max(axis=1)
        of_teeth = orders % teeth == 0
        if teeth == 1 or of_teeth.sum() < _FEWEST:
            return False
        others = float(np.median(lines[~of_teeth]))
        return float(np.median(lines[of_teeth])) - others > _STANDS_OUT

    def _nearest(self, speeds: list[float]) -> float:
        """That of some speeds which is less far from the stated one, Hz."""
        return min(speeds, key=lambda one: abs(math.log(one / self._stated)))

    def _spacing(self) -> Spacing:
        """Spacing of the lines, wherever it is: that of which all multiples are there."""
        step, count = self._frames.step, self._autocorrelation.size
        slowest, fastest = slowest_of(self._frames), step * count / _MULTIPLES
        octaves = np.geomspace(slowest, fastest, max(round(math.log2(fastest / slowest)), 1) + 1)
        # each on its own: of few multiples a mean is large by chance
        each = [
            best_spacing(self._autocorrelation, step, low, high)
            for low, high in itertools.pairwise(octaves)
        ]
        found = max(each, key=self._quality)
        for parts in _PARTS:
            at = found.frequency * parts
            if at < fastest and not self._are_alike(found.frequency, parts):
                return found._replace(frequency=at, score=self._score(at))
        for parts in reversed(_PARTS):
            at = found.frequency / parts
            score = self._score(at)
            is_as_good = at > slowest and score > _SCORES_AS_WELL * found.score
            if is_as_good and self._are_alike(at, parts):
                return found._replace(frequency=at, score=score)
        return found

    def _quality(self, spacing: Spacing) -> float:
        if not spacing.significance > CERTAIN:
            return 0.0
        return max(self._explanation(spacing, parts).quality for parts in self._divisors())

    def _score(self, spacing: float) -> float:
        at = np.array([spacing])
        return float(spacing_scores(self._autocorrelation, self._frames.step, at, 1)[0])

    def _are_alike(self, spacing: float, parts: int) -> bool:
        """Whether lines lie apart by all multiples of a spacing, or by every so many alone."""
        orders = np.arange(1, _ORDERS * parts + 1)
        orders = orders[orders * spacing < 0.5 * self._frames.frequency[-1]]
        values = np.interp(
            orders * spacing / self._frames.step,
            np.arange(self._autocorrelation.size),
            self._autocorrelation,
        )
        of_parts = orders % parts == 0
        if not of_parts.any() or of_parts.all():
            return True
        return bool(values[~of_parts].mean() > _ALIKE * values[of_parts].mean())

    def _divisors(self) -> list[int]:
        """Whole parts of a spacing that may be a revolution: teeth, or some, may be alike."""
        if self._teeth is None:
            return list(range(1, MOST_TEETH + 1))
        return [parts for parts in range(1, self._teeth + 1) if self._teeth % parts == 0]

    def _explanation(self, spacing: Spacing, parts: int) -> Explanation:
        frequency = spacing.frequency / parts
        return Explanation(frequency, spacing, self._explained(frequency))

    def _explained(self, revolution: float, chatter_lines: int = 1) -> float:
        """Share of the lines on the harmonics, or of chatter lines, less that by chance."""
        frequency, half_width = self._frames.frequency, self._frames.half_width
        comb = Comb(revolution, revolution * (self._teeth or 1), _READ, half_width)
        on = ~comb.off(frequency)
        line = strongest_line(self._power, self._above, frequency, comb).frequency
        if chatter_lines and math.isfinite(line):
            for first in (line, -line, 2.0 * line):
                beside = frequency - first
                order = np.round(beside / comb.tooth)
                on |= np.abs(beside - order * comb.tooth) < half_width
        chance = float(on.mean())
        share = float(self._lines[on].sum()) / max(float(self._lines.sum()), 1e-300)
        return max(share - chance, 0.0) / max(1.0 - chance, 1e-9)


def _is_same(one: float, other: float) -> bool:
    """Whether two frequencies are those of one speed."""
    return abs(one / other - 1.0) < _SAME


def _is_multiple(one: float, other: float, most: int = 1000) -> bool:
    """Whether a frequency is a whole multiple, from two on, of another."""
    order = round(one / other)
    return 2 <= order <= most and abs(one / (other * order) - 1.0) < _SAME
