"""The best cut around a place that holds with a wanted probability where values are uncertain."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from chatter.stability.model import MillingModel
from chatter.studies.optimisation.candidate import DEEPER, Candidate, Probability, candidate_at
from chatter.studies.optimisation.limits import Limits
from chatter.studies.optimisation.sampled_cuts import SampledCuts, Samples
from chatter.studies.optimisation.search import Place
from chatter.studies.optimisation.speed_depth_slice import Sheet, sheet_of
from chatter.studies.optimisation.steady_cut import SteadyCuts
from chatter.studies.optimisation.width_and_feed import model_at

Array = NDArray[np.float64]

#: speeds and depths looked at around a candidate, then around the best of them, then depths alone:
#: share to either side, and points
_SPEEDS = ((0.04, 13), (0.006, 5), (0.0, 1))
_DEPTHS = ((0.2, 1.1, 19), (0.94, 1.06, 9), (0.99, 1.09, 21))
CONFIDENCE = "confidence"
#: shares of the depth that are tried where round numbers cost a sample
_GIVEN_BACK = (1.0, 0.995, 0.99, 0.98)


def robust_candidate(
    model: MillingModel, limits: Limits, place: Place, drawn: Samples
) -> Candidate | None:
    """Best cut around a place that holds with the wanted probability; None if none does.

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
    sampled = SampledCuts(here, limits, drawn, deepest)
    for (beside, speed_count), (low, high, depth_count) in zip(_SPEEDS, _DEPTHS, strict=True):
        speeds = place.spindle_speed * np.linspace(1.0 - beside, 1.0 + beside, speed_count)
        depths = place.axial_depth * np.linspace(low, high, depth_count)
        speeds, depths = _inside(speeds, limits.speeds), _inside(depths, limits.depths)
        if depths.size == 0:
            return None
        found = _best(sheet_of(here, limits, speeds, depths, limits.looked_at(speeds)), sampled)
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
    """Candidate with its own probability; None where that does not suffice."""
    place = candidate.place
    here = model_at(model, place.radial_depth, place.feed_per_tooth)
    deepest = place.axial_depth * (1.0 + DEEPER)
    return _judged(candidate, limits, SampledCuts(here, limits, drawn, deepest))


def _judged(candidate: Candidate, limits: Limits, sampled: SampledCuts) -> Candidate | None:
    place: Place = candidate.place
    depths = place.axial_depth * np.array([1.0, 1.0 + DEEPER])
    speeds, count = np.full(2, place.spindle_speed), len(sampled.drawn)
    everyone = np.arange(count)
    stable = sampled.stable(everyone, speeds, depths)
    cuts = sampled.steady(everyone, speeds, depths, stable)
    sure, deeper = sampled.within(cuts, stable).mean(axis=0)
    if sure < limits.confidence:
        return None
    from scipy.stats import binomtest

    low, high = binomtest(round(sure * count), count).proportion_ci(method="wilson")
    found = Probability(
        float(stable[:, 0].mean()),
        float(sure),
        (float(low), float(high)),
        sampled.quantiles(SteadyCuts(*(values[:, 0] for values in cuts))),
    )
    risk = (1.0 - float(sure)) / (1.0 - limits.confidence)
    active = candidate.active + ((CONFIDENCE,) if deeper < limits.confidence else ())
    usage = {**candidate.usage, CONFIDENCE: risk}
    return replace(candidate, probability=found, usage=usage, active=active)


def _inside(values: Array, net: Array) -> Array:
    return values[(values >= net[0] * (1.0 - 1e-9)) & (values <= net[-1] * (1.0 + 1e-9))]


def _best(sheet: Sheet, sampled: SampledCuts) -> tuple[float, float] | None:
    """Speed and depth of a sheet that removes most of what holds, and is sure to."""
    row, column = np.nonzero(sheet.feasible)
    order = np.argsort(-sheet.removal_rate[row, column], kind="stable")
    speeds, depths = sheet.speeds[column[order]], sheet.depths[row[order]]
    found = sampled.first_sure(speeds, depths)
    return None if found is None else (float(speeds[found]), float(depths[found]))
