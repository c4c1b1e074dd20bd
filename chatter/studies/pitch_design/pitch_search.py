"""Search for pitch angles by the limits of collocation: one-parameter families, then all angles."""

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from chatter.description.arrays import Array
from chatter.description.brief_repr import BriefRepr
from chatter.description.case import Case
from chatter.stability.lowest_limit import LowestLimit, lowest_between
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.model import MillingModel, milling_model
from chatter.stability.pockets import DEPTH_MARGIN, lowest_within_margin
from chatter.studies.optimisation.stable_depths import first_limits
from chatter.studies.pitch_design.families import Family
from chatter.studies.result_cache import ResultCache

#: angles are whole multiples of this, deg
RESOLUTION = 0.1
#: differences of a family that are evaluated
DIFFERENCES = 16
#: what is moved from one pitch to another, deg, and evaluations at most
_STEPS = (6.0, 3.0, 1.5, 0.7, 0.3)
MAX_MOVES = 60
#: a gain below this share is none
_LEAST_GAIN = 1e-3
#: weight of the mean limit against the lowest, where that is alike
_MEAN_WEIGHT = 1e-3


@dataclass(frozen=True, repr=False)
class Design(BriefRepr):
    """Pitch angles and the limits that they give."""

    name: str
    pitch: tuple[float, ...]  # deg, multiples of 0.1
    limits: Array  # first limit at every speed, m; the end of the search where none was found (n,)
    score: float  # what the goal makes of them
    lowest_speed: float = math.nan  # of the lowest limit, where it was sought between the speeds
    lowest_between: float = math.inf  # that limit, m
    kept: float = 1.0  # factor of it that edge forces and frictions at rest leave at least
    taken_by: tuple[str, ...] = ()  # which of them take the rest

    @property
    def lowest_limit(self) -> float:
        """Lowest limit over all speeds, m, between them too where it was sought there."""
        return min(float(self.limits.min()), self.lowest_between)

    @property
    def stable_below(self) -> float:
        """Depth, m, below which any of the speeds is stable for certain."""
        return self.kept * self.lowest_limit

    @property
    def max_pitch_ratio(self) -> float:
        """Chip of the tooth that takes most, in units of the mean."""
        return max(self.pitch) * len(self.pitch) / 360.0


def lowest_limit(speeds: Array, limits: Array) -> float:
    """Goal: the lowest limit, and a little of the mean."""
    del speeds
    return float(limits.min() + _MEAN_WEIGHT * limits.mean())


def highest_removal(speeds: Array, limits: Array) -> float:
    """Goal: the highest depth times speed that keeps the usual margins of depth and speed."""
    return float((1.0 - DEPTH_MARGIN) * np.max(lowest_within_margin(speeds, limits) * speeds))


#: name in a case file -> goal
GOALS: dict[str, Callable[[Array, Array], float]] = {
    "lowest limit": lowest_limit,
    "removal rate": highest_removal,
}


def rounded_pitch(pitch: Sequence[float]) -> tuple[float, ...]:
    """Angles (deg) as multiples of the resolution that make a revolution."""
    parts = np.asarray(pitch) / RESOLUTION
    whole = np.floor(parts + 1e-6).astype(int)
    missing = round(360.0 / RESOLUTION) - int(whole.sum())
    order = np.argsort(-(parts - whole), kind="stable")
    whole[order[:missing]] += 1
    return tuple(round(float(part) * RESOLUTION, 6) for part in whole)


class PitchSearch:
    """Limits of a case by its pitch angles, at speeds (rad/s), on a grid of depths (m).

    `goal` is a key of `GOALS`. The largest pitch is `max_pitch_ratio` in units of the mean, the
    smallest 2 less this. `evaluated` is called after every evaluation; the cache holds limits that
    are known.
    """

    def __init__(
        self,
        case: Case,
        speeds: Array,
        depths: Array,
        goal: str,
        max_pitch_ratio: float,
        evaluated: Callable[[], None],
        cache: ResultCache,
    ) -> None:
        self.case, self.speeds, self.depths = case, speeds, depths
        self.goal, self.max_pitch_ratio, self.evaluated = GOALS[goal], max_pitch_ratio, evaluated
        self.teeth, self._cache = case.tool.teeth, cache
        self._known: dict[tuple[float, ...], Array] = {}

    def refined(self, one: Design, speeds: Array) -> Design:
        """Design with limits at other speeds (n,), and the lowest of them and between them."""
        limits = self.limits(one.pitch, speeds)
        samples = [
            LowestLimit(*pair, math.nan)
            for pair in zip(speeds.tolist(), limits.tolist(), strict=True)
        ]

        def between(tried: Array, highest: float, number: int) -> list[LowestLimit]:
            del highest, number
            found = self.limits(one.pitch, tried).tolist()
            return [LowestLimit(*pair, math.nan) for pair in zip(tried, found, strict=True)]

        lowest = lowest_between(samples, between)
        place = int(np.searchsorted(speeds, lowest.spindle_speed))
        score = self.goal(
            np.insert(speeds, place, lowest.spindle_speed),
            np.insert(limits, place, lowest.critical_depth),
        )
        return replace(
            one, limits=limits, score=score, lowest_speed=float(lowest.spindle_speed),
            lowest_between=float(lowest.critical_depth),
        )  # fmt: skip

    def model_of(self, pitch: Sequence[float]) -> MillingModel:
        """Model of the case with pitch angles in deg."""
        angles = [f"{angle:.6g} deg" for angle in pitch]
        return milling_model(self.case.patch({"tool.pitch": angles}))

    def limits(self, pitch: Sequence[float], speeds: Array) -> Array:
        """First limits at speeds (n,), m, of pitch angles in deg."""
        angles = [f"{angle:.6g} deg" for angle in pitch]

        def compute() -> list[float]:
            model = self.model_of(pitch)
            max_depth = float(self.depths[-1])
            found = first_limits(element_cut(model, max_depth), speeds, self.depths)
            return np.minimum(found, max_depth).tolist()

        inputs = (angles, speeds.tolist())
        return np.array(self._cache.record("limits", inputs, compute), dtype=np.float64)

    def design(self, name: str, pitch: Sequence[float]) -> Design:
        """Design of pitch angles (deg), computed once."""
        angles = rounded_pitch(pitch)
        if angles not in self._known:
            self._known[angles] = self.limits(angles, self.speeds)
        self.evaluated()
        limits = self._known[angles]
        return Design(name, angles, limits, self.goal(self.speeds, limits))

    def may_be(self, pitch: Sequence[float]) -> bool:
        """Whether all pitch angles (deg) are within the bounds of the chip."""
        shares = np.asarray(pitch) * self.teeth / 360.0
        allowed = self.max_pitch_ratio + 1e-9
        return bool(shares.max() <= allowed and shares.min() >= 2.0 - allowed)

    def of_family(self, family: Family) -> tuple[Array, list[Design]]:
        """Differences, rad, and designs of a family up to the bounds of the chip."""
        widest = (self.max_pitch_ratio - 1.0) * 2.0 * math.pi / self.teeth
        differences = np.linspace(0.0, widest / family.widest(self.teeth), DIFFERENCES)
        designs = [
            self.design(family.name, np.degrees(family.angles(self.teeth, float(difference))))
            for difference in differences
        ]
        return differences, designs

    def improved(self, start: Design) -> Design:
        """Best design on the way from a start, moving angle from one pitch to another."""
        best, left = start, MAX_MOVES
        for step in _STEPS:
            pairs = list(itertools.permutations(range(self.teeth), 2))
            unsuccessful = 0
            for source, target in itertools.cycle(pairs):
                if left <= 0 or unsuccessful >= len(pairs):
                    break
                unsuccessful += 1
                pitch = list(best.pitch)
                pitch[source] -= step
                pitch[target] += step
                if not self.may_be(pitch):
                    continue
                left -= 1
                found = self.design("free", pitch)
                if found.score > best.score * (1.0 + _LEAST_GAIN):
                    best, unsuccessful = found, 0
        return best
