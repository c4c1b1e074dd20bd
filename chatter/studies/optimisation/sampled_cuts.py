"""A cut at every sample of what is uncertain: stability, and what its limits allow.

The samples of a cut are asked one after the other whether it is stable and keeps its limits; those
that have refused others are asked first, and a cut that so many refuse that it cannot have the
wanted probability is left. What remains is counted in full: nothing is estimated from a part.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np

from chatter.description.arrays import Array, BooleanArray, IntegerArray
from chatter.description.errors import InputError
from chatter.engine.parallel import each, one_thread
from chatter.stability.methods.collocation import multipliers as collocation
from chatter.stability.methods.collocation.element_cut import ElementCut, element_cut
from chatter.stability.model import MillingModel, milling_model
from chatter.studies.model import patched, standard_deviations
from chatter.studies.optimisation.limits import LIMITED, Limits
from chatter.studies.optimisation.operating_point import model_with
from chatter.studies.optimisation.steady_cut import SteadyCuts, SteadyModel
from chatter.studies.uncertainty.latin_hypercube import samples
from chatter.studies.uncertainty.uncertain_parameters import (
    UncertainParameter,
    correlation_of,
    parameters_of,
)

Result = TypeVar("Result")

#: beginnings of paths that the structure depends on
_OF_STRUCTURE = ("structure", "machine", "friction", "cut.spindle_speed")
#: of the cut itself
_OF_CUT = ("cut.spindle_speed", "cut.axial_depth", "cut.radial_depth", "cut.feed_per_tooth")
#: limits that need the motion
_BY_MOTION = ("max_deflection", "max_surface_error")
#: cuts, and samples, that are evaluated together; cuts that are then counted in full together
_CUTS_AT_ONCE, _SAMPLES_AT_ONCE, _COUNTED_AT_ONCE = 16, 24, 4


@dataclass(frozen=True, eq=False)
class Samples:
    """Values of what is uncertain."""

    model: MillingModel  # of the case as it is
    parameters: tuple[UncertainParameter, ...]
    values: Array  # SI (n, p)

    def __len__(self) -> int:
        return len(self.values)

    def patch(self, number: int) -> dict[str, float]:
        """Values of a sample by their path."""
        paths = [one.path for one in self.parameters]
        return dict(zip(paths, self.values[number].tolist(), strict=True))

    def ratio(self, number: int, path: str) -> float:
        """Share of its mean that a sample gives a value; 1 where that is not uncertain."""
        means = {one.path: one.mean for one in self.parameters}
        return self.patch(number)[path] / means[path] if path in means else 1.0

    @cached_property
    def models(self) -> list[MillingModel]:
        """Model of every sample; what is uncertain of the cut itself goes with the cut chosen."""
        # fitted or linearised anew only where it is not the same for all
        varied = any(one.path.startswith(_OF_STRUCTURE) for one in self.parameters)
        structure = None if varied else self.model.structure

        def compiled(number: int) -> MillingModel:
            values = self.patch(number)
            for path in _OF_CUT:
                values.pop(path, None)
            try:
                return milling_model(patched(self.model.case, values), structure)
            except InputError as error:
                report = [f"sample {number + 1}: {text}" for text in error.messages]
                raise InputError(report) from None

        return _of_samples(compiled, np.arange(len(self)))


def samples_of(model: MillingModel, count: int, seed: int) -> Samples | None:
    """Draw samples of what the case of a model is uncertain of; None where nothing is."""
    case = model.case
    if not standard_deviations(case):
        return None
    parameters = parameters_of(case)
    drawn = samples(parameters, count, seed, correlation_of(case, parameters))
    return Samples(model, parameters, drawn)


def _of_samples(function: Callable[[int], Result], numbers: IntegerArray) -> list[Result]:
    """What a function makes of the numbers of samples, in threads."""

    def at(index: int) -> Result:
        with one_thread():
            return function(int(numbers[index]))

    return each(at, len(numbers), points_a_chunk=4)


class SampledCuts:
    """Cuts at one radial depth and feed as the samples of a case have them.

    The model is at this radial depth and feed; `max_depth` is the largest depth that will be asked
    for, m.
    """

    def __init__(
        self, model: MillingModel, limits: Limits, drawn: Samples, max_depth: float
    ) -> None:
        self.limits, self.drawn = limits, drawn
        radial_depth, feed = model.case.width_of_cut, model.case.cut.feed_per_tooth

        def at_this_cut(number: int) -> MillingModel:
            wider = drawn.ratio(number, "cut.radial_depth")
            faster = drawn.ratio(number, "cut.feed_per_tooth")
            return model_with(drawn.models[number], radial_depth * wider, feed * faster)

        def compiled(number: int) -> ElementCut:
            depth = max_depth * drawn.ratio(number, "cut.axial_depth")
            return element_cut(self.models[number], depth * 1.001, wavelengths=limits.wavelengths)

        self.models = [at_this_cut(number) for number in range(len(drawn))]
        self.cuts = _of_samples(compiled, np.arange(len(drawn)))
        #: how often each sample has refused a cut
        self.refused = np.zeros(len(drawn), dtype=np.int64)

    def _own(self, number: int, speeds: Array, depths: Array) -> tuple[Array, Array]:
        """Speeds and depths as a sample has them."""
        faster = self.drawn.ratio(number, "cut.spindle_speed")
        return speeds * faster, depths * self.drawn.ratio(number, "cut.axial_depth")

    def stable(self, numbers: IntegerArray, speeds: Array, depths: Array) -> BooleanArray:
        """Whether (s, n) samples find cuts stable at speeds (n,), rad/s, and depths (n,), m."""

        def of_sample(number: int) -> BooleanArray:
            own = self._own(number, speeds, depths)
            return np.abs(collocation.multipliers(self.cuts[number], *own)) < 1.0

        return np.stack(_of_samples(of_sample, numbers))

    def steady(
        self, numbers: IntegerArray, speeds: Array, depths: Array, stable: BooleanArray
    ) -> SteadyCuts:
        """Steady cuts (s, n) of samples; nan where not stable, and what no limit asks for."""
        row = {int(number): index for index, number in enumerate(numbers)}
        moves = any(key in self.limits.most for key in _BY_MOTION)

        def of_sample(number: int) -> SteadyCuts:
            found = SteadyCuts(*np.full((len(SteadyCuts._fields), speeds.size), np.nan))
            speed, depth = self._own(number, speeds, depths)
            wanted = stable[row[number]] & bool(self.limits.most)
            model = SteadyModel(self.models[number], float(speed.min()))
            for level in np.unique(depth[wanted]):
                k = np.flatnonzero(wanted & (depth == level))
                if not moves:
                    found.torque[k] = model.torques(np.array([level]))[0]
                    found.power[k] = found.torque[k] * speed[k]
                    continue
                for values, computed in zip(found, model.cuts(speed[k], level), strict=True):
                    values[k] = computed
            return found

        found = _of_samples(of_sample, numbers)
        return SteadyCuts(*(np.stack(values) for values in zip(*found, strict=True)))

    def within(self, cuts: SteadyCuts, stable: BooleanArray) -> BooleanArray:
        """Whether cuts are stable and keep all limits."""
        held = [values <= 1.0 for values in self.limits.usage(cuts).values()]
        return np.logical_and.reduce([stable, *held])

    def first_sure(self, speeds: Array, depths: Array) -> int | None:
        """First of n cuts that is stable and keeps its limits with the wanted probability.

        Speeds (n,), rad/s, and depths (n,), m: the cut that is wanted most first.
        """
        for first in range(0, speeds.size, _CUTS_AT_ONCE):
            group = np.arange(first, min(first + _CUTS_AT_ONCE, speeds.size))
            order = np.argsort(-self.refused, kind="stable")
            hard, others = order[:_SAMPLES_AT_ONCE], order[_SAMPLES_AT_ONCE:]
            lost = np.zeros(speeds.size, dtype=np.int64)
            left = self._not_lost(hard, group, speeds, depths, lost)
            for start in range(0, left.size, _COUNTED_AT_ONCE):
                few = left[start : start + _COUNTED_AT_ONCE]
                for number in range(0, others.size, _SAMPLES_AT_ONCE):
                    some = others[number : number + _SAMPLES_AT_ONCE]
                    few = self._not_lost(some, few, speeds, depths, lost)
                if few.size:
                    return int(few[0])
        return None

    def _not_lost(
        self,
        numbers: IntegerArray,
        group: IntegerArray,
        speeds: Array,
        depths: Array,
        lost: IntegerArray,
    ) -> IntegerArray:
        """Of a group of cuts those to which samples leave a chance; counts who refused what."""
        if group.size == 0 or numbers.size == 0:
            return group
        stable = self.stable(numbers, speeds[group], depths[group])
        left = self._counted(~stable, numbers, group, lost)
        group, stable = group[left], stable[:, left]
        if group.size == 0 or not self.limits.most:
            return group
        cuts = self.steady(numbers, speeds[group], depths[group], stable)
        return group[self._counted(stable & ~self.within(cuts, stable), numbers, group, lost)]

    def _counted(
        self, refusals: BooleanArray, numbers: IntegerArray, group: IntegerArray, lost: IntegerArray
    ) -> BooleanArray:
        """Add refusals (s, n) up; whether each of the group still has a chance."""
        self.refused[numbers] += refusals.sum(axis=1)
        lost[group] += refusals.sum(axis=0)
        count = len(self.drawn)
        return lost[group] <= count - math.ceil(self.limits.confidence * count - 1e-9)

    def quantiles(self, cuts: SteadyCuts) -> dict[str, float]:
        """What stable samples of a cut (s,) do not exceed with the confidence, by limit, SI."""
        values = {key: np.abs(getattr(cuts, LIMITED[key])) for key in self.limits.most}
        known = {key: one[np.isfinite(one)] for key, one in values.items()}
        return {
            key: float(np.quantile(one, self.limits.confidence)) if one.size else math.nan
            for key, one in known.items()
        }
