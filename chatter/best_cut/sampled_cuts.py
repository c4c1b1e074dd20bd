"""A cut at every sample of what is uncertain: stability, and what its limits allow.

The samples of a cut are asked one after the other whether it is stable and keeps its limits; those
that have refused others are asked first, and a cut that so many refuse that it cannot have the
wanted probability is left. What remains is counted in full: nothing is estimated from a part.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.best_cut.limits import LIMITED, Limits
from chatter.best_cut.steady_cut import SteadyCuts, SteadyModel
from chatter.case import Case
from chatter.errors import InputError
from chatter.model import MillingModel, milling_model
from chatter.monte_carlo.parameters import UncertainParameter, correlation_of, parameters_of
from chatter.monte_carlo.sampling import samples
from chatter.stability import collocation
from chatter.stability.sweep import one_thread, sweep
from chatter.what_if.subject import deviations_of, patched

Array = NDArray[np.float64]

#: beginnings of paths that the structure depends on
_OF_STRUCTURE = ("structure", "machine", "friction", "cut.spindle_speed")
#: cuts, and samples, that are looked at together; cuts that are then counted in full together
_CUTS_AT_ONCE, _SAMPLES_AT_ONCE, _COUNTED_AT_ONCE = 16, 24, 4


@dataclass(frozen=True, eq=False)
class Samples:
    """Values of what is uncertain.

    Parameters
    ----------
    parameters : tuple of p UncertainParameter
    values : (n, p) array of float
        SI.
    """

    parameters: tuple[UncertainParameter, ...]
    values: Array

    def __len__(self) -> int:
        return len(self.values)

    def patch(self, number: int) -> dict[str, float]:
        """Values of a sample by their path."""
        paths = [one.path for one in self.parameters]
        return dict(zip(paths, self.values[number].tolist(), strict=True))

    def ratios(self, number: int, path: str) -> float:
        """Share of its mean that a sample gives a value; 1 where that is not uncertain."""
        means = {one.path: one.mean for one in self.parameters}
        return self.patch(number)[path] / means[path] if path in means else 1.0


def samples_of(case: Case, count: int, seed: int) -> Samples | None:
    """Draw samples of what a case is uncertain of; None where nothing is.

    Raises
    ------
    InputError
        If correlations contradict one another.
    """
    if not deviations_of(case):
        return None
    parameters = parameters_of(case)
    return Samples(parameters, samples(parameters, count, seed, correlation_of(case, parameters)))


class Outcome(NamedTuple):
    """What s samples make of n cuts."""

    stable: NDArray[np.bool_]  # (s, n)
    cuts: SteadyCuts  # (s, n) each; nan where not stable, and where no limit asks for them

    def within(self, limits: Limits) -> NDArray[np.bool_]:
        """Whether (s, n) the cut is stable and keeps all limits."""
        held = [values <= 1.0 for values in limits.usage(self.cuts).values()]
        return np.logical_and.reduce([self.stable, *held])


class SampledCuts:
    """The samples of a case at one width and feed.

    Parameters
    ----------
    model : MillingModel
        At this width and feed.
    limits : Limits
    drawn : Samples
    deepest : float
        Largest depth that will be asked for, m.
    """

    def __init__(self, model: MillingModel, limits: Limits, drawn: Samples, deepest: float) -> None:
        self.case, self.limits, self.drawn, self.deepest = model.case, limits, drawn, deepest
        # fitted or linearised anew only where it is not the same for all
        varied = any(one.path.startswith(_OF_STRUCTURE) for one in drawn.parameters)
        self.structure = None if varied else model.structure
        everyone = np.arange(len(drawn))
        self.models = self._each(self._compiled, everyone)
        self.cuts = self._each(self._cut, everyone)
        self.refused = np.zeros(len(drawn), dtype=np.int64)

    def _compiled(self, number: int) -> MillingModel:
        # what is uncertain of the cut itself goes with the cut that is chosen
        values = self.drawn.patch(number)
        for path in ("cut.spindle_speed", "cut.axial_depth"):
            values.pop(path, None)
        for path in ("cut.radial_depth", "cut.feed_per_tooth"):
            if path in values:
                values[path] = self.case.get(path) * self.drawn.ratios(number, path)
        try:
            return milling_model(patched(self.case, values), self.structure)
        except InputError as error:
            told = [f"sample {number + 1}: {text}" for text in error.messages]
            raise InputError(told) from None

    def _cut(self, number: int) -> object:
        depth = self.deepest * self.drawn.ratios(number, "cut.axial_depth")
        return self.models[number].cut(depth * 1.001, waves=self.limits.waves)

    def outcome(self, numbers: NDArray[np.int64], speeds: Array, depths: Array) -> Outcome:
        """What some samples make of cuts at speeds (n,), rad/s, and depths (n,), m."""

        def of_sample(number: int) -> Outcome:
            speed = speeds * self.drawn.ratios(number, "cut.spindle_speed")
            depth = depths * self.drawn.ratios(number, "cut.axial_depth")
            stable = np.abs(collocation.multipliers(self.cuts[number], speed, depth)) < 1.0
            return Outcome(stable, self._steady(number, speed, depth, stable))

        found = self._each(of_sample, numbers)
        cuts = (np.stack(values) for values in zip(*(one.cuts for one in found), strict=True))
        return Outcome(np.stack([one.stable for one in found]), SteadyCuts(*cuts))

    def _steady(
        self, number: int, speeds: Array, depths: Array, stable: NDArray[np.bool_]
    ) -> SteadyCuts:
        found = SteadyCuts(*np.full((len(SteadyCuts._fields), speeds.size), np.nan))
        if not self.limits.most or not stable.any():
            return found
        model = SteadyModel(self.models[number], float(speeds.min()))
        moves = any(key in self.limits.most for key in ("max_deflection", "max_surface_error"))
        for depth in np.unique(depths[stable]):
            k = np.flatnonzero(stable & (depths == depth))
            if moves:
                for values, computed in zip(found, model.cuts(speeds[k], depth), strict=True):
                    values[k] = computed
            else:
                found.torque[k] = model.torques(np.array([depth]))[0]
                found.power[k] = found.torque[k] * speeds[k]
        return found

    def first_sure(self, speeds: Array, depths: Array) -> int | None:
        """First of n cuts that is stable and keeps its limits with the wanted probability.

        Parameters
        ----------
        speeds, depths : (n,) array of float
            rad/s, m, the cut that is wanted most first.
        """
        for first in range(0, speeds.size, _CUTS_AT_ONCE):
            group = np.arange(first, min(first + _CUTS_AT_ONCE, speeds.size))
            order = np.argsort(-self.refused, kind="stable")
            hard, others = order[:_SAMPLES_AT_ONCE], order[_SAMPLES_AT_ONCE:]
            lost = np.zeros(speeds.size, dtype=np.int64)
            left = self._unrefused(hard, group, speeds, depths, lost)
            for start in range(0, left.size, _COUNTED_AT_ONCE):
                few = left[start : start + _COUNTED_AT_ONCE]
                for number in range(0, others.size, _SAMPLES_AT_ONCE):
                    some = others[number : number + _SAMPLES_AT_ONCE]
                    few = self._unrefused(some, few, speeds, depths, lost)
                if few.size:
                    return int(few[0])
        return None

    def _unrefused(
        self,
        numbers: NDArray[np.int64],
        group: NDArray[np.int64],
        speeds: Array,
        depths: Array,
        lost: NDArray[np.int64],
    ) -> NDArray[np.int64]:
        """Of a group of cuts those that samples leave a chance; counts who refused, and what."""
        if group.size == 0 or numbers.size == 0:
            return group
        within = self.outcome(numbers, speeds[group], depths[group]).within(self.limits)
        self.refused[numbers] += (~within).sum(axis=1)
        lost[group] += (~within).sum(axis=0)
        return group[lost[group] <= self._may_refuse]

    @property
    def _may_refuse(self) -> int:
        count = len(self.drawn)
        return count - math.ceil(self.limits.confidence * count - 1e-9)

    def quantiles(self, cuts: SteadyCuts) -> dict[str, float]:
        """What stable samples of a cut (s,) do not exceed with the confidence, by limit, SI."""
        found = {}
        for key in self.limits.most:
            values = np.abs(getattr(cuts, LIMITED[key]))
            known = values[np.isfinite(values)]
            found[key] = (
                float(np.quantile(known, self.limits.confidence)) if known.size else math.nan
            )
        return found

    def _each(self, function: Callable[[int], object], numbers: NDArray[np.int64]) -> list:
        def at(places: NDArray[np.int64]) -> list:
            with one_thread():
                return [function(int(numbers[place])) for place in places]

        return [found for chunk in sweep(at, len(numbers), points_a_chunk=4) for found in chunk]
