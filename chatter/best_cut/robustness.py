"""Cuts that stay stable, with a wanted probability, where values of the case are uncertain."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from chatter.best_cut.candidate import DEEPER, Candidate, Probability, candidate_at
from chatter.best_cut.limits import Limits
from chatter.best_cut.search import Place
from chatter.best_cut.sheet import Sheet, sheet_of
from chatter.best_cut.width_and_feed import model_at
from chatter.case import Case
from chatter.errors import InputError
from chatter.model import MillingModel, milling_model
from chatter.monte_carlo.confidence import wilson_interval
from chatter.monte_carlo.parameters import UncertainParameter, correlation_of, parameters_of
from chatter.monte_carlo.sampling import samples
from chatter.stability import collocation
from chatter.stability.cut_arrays import CutArrays
from chatter.stability.sweep import one_thread, sweep
from chatter.what_if.subject import deviations_of, patched

Array = NDArray[np.float64]

#: speeds and depths looked at around a candidate, then around the best of them, then depths alone:
#: share to either side, and points
_SPEEDS = ((0.04, 13), (0.006, 5), (0.0, 1))
_DEPTHS = ((0.2, 1.1, 19), (0.94, 1.06, 9), (0.99, 1.09, 21))
CONFIDENCE = "confidence"
#: beginnings of paths that the structure depends on
_OF_STRUCTURE = ("structure", "machine", "friction", "cut.spindle_speed")
#: shares of the depth that are tried where round numbers cost a sample
_GIVEN_BACK = (1.0, 0.995, 0.99, 0.98)


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


class SampledCuts:
    """Stability of the samples of a case at one width and feed.

    Parameters
    ----------
    model : MillingModel
        At this width and feed.
    drawn : Samples
    deepest : float
        Depth down to which stability will be asked for, m.
    """

    def __init__(self, model: MillingModel, drawn: Samples, deepest: float) -> None:
        self.case, self.drawn, self.deepest = model.case, drawn, deepest
        # fitted or linearised anew only where it is not the same for all
        varied = any(one.path.startswith(_OF_STRUCTURE) for one in drawn.parameters)
        self.structure = None if varied else model.structure
        self.cuts = self._each(self._compiled)

    def _compiled(self, number: int) -> CutArrays:
        # what is uncertain of the cut itself goes with the cut that is chosen
        values = self.drawn.patch(number)
        for path in ("cut.spindle_speed", "cut.axial_depth"):
            values.pop(path, None)
        for path in ("cut.radial_depth", "cut.feed_per_tooth"):
            if path in values:
                values[path] = self.case.get(path) * self.drawn.ratios(number, path)
        depth = self.deepest * self.drawn.ratios(number, "cut.axial_depth")
        try:
            return milling_model(patched(self.case, values), self.structure).cut(depth * 1.001)
        except InputError as error:
            told = [f"sample {number + 1}: {text}" for text in error.messages]
            raise InputError(told) from None

    def probability(self, speeds: Array, depths: Array) -> Array:
        """Share (m, n) of the samples that are stable at depths (m) and speeds (n)."""
        depth, speed = (part.ravel() for part in np.meshgrid(depths, speeds, indexing="ij"))

        def stable(number: int) -> NDArray[np.bool_]:
            faster = self.drawn.ratios(number, "cut.spindle_speed")
            deeper = self.drawn.ratios(number, "cut.axial_depth")
            found = collocation.multipliers(self.cuts[number], speed * faster, depth * deeper)
            return np.abs(found) < 1.0

        share = np.mean(self._each(stable), axis=0)
        return share.reshape(depths.size, speeds.size)

    def _each(self, function: Callable[[int], object]) -> list:
        def at(numbers: NDArray[np.int64]) -> list:
            with one_thread():
                return [function(int(number)) for number in numbers]

        return [found for chunk in sweep(at, len(self.drawn), points_a_chunk=4) for found in chunk]


def robust_candidate(
    model: MillingModel, limits: Limits, place: Place, drawn: Samples
) -> Candidate | None:
    """Best cut around a place that is stable with the wanted probability; None if none is.

    Parameters
    ----------
    model : MillingModel
    limits : Limits
    place : Place
        Its width and feed are kept.
    drawn : Samples
    """
    here = model_at(model, place.radial_depth, place.feed_per_tooth)
    deepest = math.prod(high for _, high, _ in _DEPTHS) * place.axial_depth * (1.0 + DEEPER)
    sampled = SampledCuts(here, drawn, deepest)
    for (beside, speed_count), (low, high, depth_count) in zip(_SPEEDS, _DEPTHS, strict=True):
        speeds = place.spindle_speed * np.linspace(1.0 - beside, 1.0 + beside, speed_count)
        depths = place.axial_depth * np.linspace(low, high, depth_count)
        speeds, depths = _inside(speeds, limits.speeds), _inside(depths, limits.depths)
        if depths.size == 0:
            return None
        sheet = sheet_of(here, limits, speeds, depths, limits.looked_at(speeds))
        found = _best(sheet, sampled.probability(speeds, depths) >= limits.confidence)
        if found is None:
            return None
        place = place._replace(spindle_speed=found[0], axial_depth=found[1])
    for share in _GIVEN_BACK:
        eased = place._replace(axial_depth=place.axial_depth * share)
        found = _judged(candidate_at(model, limits, eased), limits, sampled)
        if found is not None:
            return found
    return None


def with_probability(
    model: MillingModel, limits: Limits, candidate: Candidate, drawn: Samples
) -> Candidate | None:
    """Candidate with its own probability of stability; None where that does not suffice."""
    place = candidate.place
    here = model_at(model, place.radial_depth, place.feed_per_tooth)
    return _judged(candidate, limits, SampledCuts(here, drawn, place.axial_depth * (1.0 + DEEPER)))


def _judged(candidate: Candidate, limits: Limits, sampled: SampledCuts) -> Candidate | None:
    place: Place = candidate.place
    depths = place.axial_depth * np.array([1.0, 1.0 + DEEPER])
    sure, deeper = sampled.probability(np.array([place.spindle_speed]), depths)[:, 0]
    if sure < limits.confidence:
        return None
    count = len(sampled.drawn)
    found = Probability(float(sure), wilson_interval(round(sure * count), count))
    risk = (1.0 - float(sure)) / (1.0 - limits.confidence)
    active = candidate.active + ((CONFIDENCE,) if deeper < limits.confidence else ())
    usage = {**candidate.usage, CONFIDENCE: risk}
    return replace(candidate, probability=found, usage=usage, active=active)


def _inside(values: Array, net: Array) -> Array:
    return values[(values >= net[0] * (1.0 - 1e-9)) & (values <= net[-1] * (1.0 + 1e-9))]


def _best(sheet: Sheet, sure: NDArray[np.bool_]) -> tuple[float, float] | None:
    rate = np.where(sheet.feasible & sure, sheet.removal_rate, -1.0)
    row, column = np.unravel_index(rate.argmax(), rate.shape)
    if rate[row, column] <= 0.0:
        return None
    return float(sheet.speeds[column]), float(sheet.depths[row])
