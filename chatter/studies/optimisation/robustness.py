"""Candidates of a search in round numbers, with a wanted probability where values are uncertain."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from chatter.description.arrays import Array
from chatter.stability.model import MillingModel
from chatter.studies.optimisation.candidate import DEEPER, Candidate, Probability, candidate_at
from chatter.studies.optimisation.limits import Limits
from chatter.studies.optimisation.operating_point import OperatingPoint, model_with
from chatter.studies.optimisation.sampled_cuts import SampledCuts, Samples
from chatter.studies.optimisation.search_state import OptimumSearch
from chatter.studies.optimisation.speed_depth_slice import SpeedDepthSlice, evaluated_slice
from chatter.studies.optimisation.steady_cut import SteadyCuts
from chatter.studies.uncertainty.sample_limits import confidence_interval

#: speeds and depths evaluated around a candidate, then around the best of them, then depths alone:
#: share to either side, and points
_SPEEDS = ((0.04, 13), (0.006, 5), (0.0, 1))
_DEPTHS = ((0.2, 1.1, 19), (0.94, 1.06, 9), (0.99, 1.09, 21))
CONFIDENCE = "confidence"
#: candidates that are simulated in the time domain; more where these do not hold there
SIMULATED = 3
#: steps over the radial depth of the best robust cut
RADIAL_DEPTH_STEPS = 2
#: size of a robust candidate against the other pieces of work
ROBUST_WORK = 60
#: cuts that are alike within this share are one
_SAME = 0.02
#: shares of the depth that are tried where round numbers cost a sample
_GIVEN_BACK = (1.0, 0.995, 0.99, 0.98)


def candidates_of(search: OptimumSearch, points: Sequence[OperatingPoint]) -> list[Candidate]:
    """Candidates in round numbers, best first, robust where something is uncertain."""
    found = [search.at(point) for point in points]
    found.sort(key=lambda one: -one.removal_rate)
    if search.drawn is not None:
        found = _robust(search, found)
    return _apart(sorted(found, key=lambda one: -one.removal_rate))


def _robust_at(search: OptimumSearch, point: OperatingPoint) -> Candidate | None:
    model, limits, drawn = search.model, search.limits, search.drawn
    found = search.candidate("robust", point, lambda: robust_candidate(model, limits, point, drawn))
    search.done(ROBUST_WORK)
    return found


def _robust(search: OptimumSearch, candidates: Sequence[Candidate]) -> list[Candidate]:
    """Robust candidates, best first; then the best one at other radial depths."""
    found: list[Candidate] = []
    for one in candidates:
        most = max((other.removal_rate for other in found), default=0.0)
        # what is robust of it cannot be more than all of it
        if len(found) < SIMULATED or one.removal_rate > most:
            robust = _robust_at(search, one.point)
            found += [] if robust is None else [robust]
    if found and search.limits.radial_depths.size > 1:
        found += _at_other_radial_depths(search, max(found, key=lambda one: one.removal_rate))
    return found


def _at_other_radial_depths(search: OptimumSearch, best: Candidate) -> list[Candidate]:
    """Robust candidates that remove more than the best one, at radial depths around its own."""
    better: list[Candidate] = []
    radial_depths = search.limits.radial_depths
    step = float(radial_depths[1] - radial_depths[0]) / 3.0
    for _ in range(RADIAL_DEPTH_STEPS):
        point = best.point
        beside = np.clip(
            point.radial_depth + np.array([-step, step]), radial_depths[0], radial_depths[-1]
        )
        tried = [
            _robust_at(search, _at_radial_depth(point, float(radial_depth)))
            for radial_depth in beside
            if abs(radial_depth - point.radial_depth) > 0.1 * step
        ]
        known = [one for one in tried if one is not None and one.removal_rate > best.removal_rate]
        if known:
            best = max(known, key=lambda one: one.removal_rate)
            better.append(best)
        else:
            step /= 3.0
    return better


def _at_radial_depth(point: OperatingPoint, radial_depth: float) -> OperatingPoint:
    """Operating point of another radial depth that removes as much."""
    return point._replace(
        radial_depth=radial_depth, axial_depth=point.axial_depth * point.radial_depth / radial_depth
    )


def _apart(candidates: Sequence[Candidate]) -> list[Candidate]:
    """Candidates without those that are nearly the same as a better one."""
    kept: list[Candidate] = []
    for one in candidates:
        cut = np.array(one.point[:4])
        if not any(np.allclose(cut, other.point[:4], rtol=_SAME) for other in kept):
            kept.append(one)
    return kept


def robust_candidate(
    model: MillingModel, limits: Limits, point: OperatingPoint, drawn: Samples
) -> Candidate | None:
    """Best cut around a point that holds with the wanted probability; None if none does.

    The radial depth and the feed of the point are kept.
    """
    here = model_with(model, point.radial_depth, point.feed_per_tooth)
    max_depth = math.prod(high for _, high, _ in _DEPTHS) * point.axial_depth * (1.0 + DEEPER)
    sampled = SampledCuts(here, limits, drawn, max_depth)
    for (beside, speed_count), (low, high, depth_count) in zip(_SPEEDS, _DEPTHS, strict=True):
        speeds = point.spindle_speed * np.linspace(1.0 - beside, 1.0 + beside, speed_count)
        depths = point.axial_depth * np.linspace(low, high, depth_count)
        speeds, depths = _inside(speeds, limits.speeds), _inside(depths, limits.depths)
        if depths.size == 0:
            return None
        found = _best(
            evaluated_slice(here, limits, speeds, depths, limits.evaluation_speeds(speeds)), sampled
        )
        if found is None:
            return None
        point = point._replace(spindle_speed=found[0], axial_depth=found[1])
    for share in _GIVEN_BACK:
        eased = point._replace(axial_depth=point.axial_depth * share)
        found = _with_probability(candidate_at(model, limits, eased), limits, sampled)
        if found is not None:
            return found
    return None


def with_probability(
    model: MillingModel, limits: Limits, candidate: Candidate, drawn: Samples
) -> Candidate | None:
    """Candidate with its own probability; None where that does not suffice."""
    point = candidate.point
    here = model_with(model, point.radial_depth, point.feed_per_tooth)
    max_depth = point.axial_depth * (1.0 + DEEPER)
    return _with_probability(candidate, limits, SampledCuts(here, limits, drawn, max_depth))


def _with_probability(
    candidate: Candidate, limits: Limits, sampled: SampledCuts
) -> Candidate | None:
    point: OperatingPoint = candidate.point
    depths = point.axial_depth * np.array([1.0, 1.0 + DEEPER])
    speeds, count = np.full(2, point.spindle_speed), len(sampled.drawn)
    everyone = np.arange(count)
    stable = sampled.stable(everyone, speeds, depths)
    cuts = sampled.steady(everyone, speeds, depths, stable)
    sure, deeper = sampled.within(cuts, stable).mean(axis=0)
    if sure < limits.confidence:
        return None
    found = Probability(
        float(stable[:, 0].mean()),
        float(sure),
        confidence_interval(round(sure * count), count),
        sampled.quantiles(SteadyCuts(*(values[:, 0] for values in cuts))),
    )
    risk = (1.0 - float(sure)) / (1.0 - limits.confidence)
    active = candidate.active + ((CONFIDENCE,) if deeper < limits.confidence else ())
    usage = {**candidate.usage, CONFIDENCE: risk}
    return replace(candidate, probability=found, usage=usage, active=active)


def _inside(values: Array, grid: Array) -> Array:
    return values[(values >= grid[0] * (1.0 - 1e-9)) & (values <= grid[-1] * (1.0 + 1e-9))]


def _best(grid_slice: SpeedDepthSlice, sampled: SampledCuts) -> tuple[float, float] | None:
    """Speed and depth of a slice that removes most of what holds, and is sure to."""
    row, column = np.nonzero(grid_slice.feasible)
    order = np.argsort(-grid_slice.removal_rate[row, column], kind="stable")
    speeds, depths = grid_slice.speeds[column[order]], grid_slice.depths[row[order]]
    found = sampled.first_sure(speeds, depths)
    return None if found is None else (float(speeds[found]), float(depths[found]))
