"""What is reported of an effect: numbers with intervals, probability, effects that fit alike."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from chatter.explain.criteria import CONFOUNDED, NUMERICS, UNDETERMINED
from chatter.explain.effects.effect import Effect
from chatter.explain.fitting import Fit
from chatter.explain.parameters import FREE_SIZES, Parameter
from chatter.explain.selection.candidates import Candidate, Stage
from chatter.explain.selection.evidence import probabilities

Vector = NDArray[np.float64]
#: name -> value and SI unit
Numbers = dict[str, tuple[float, str]]

#: points on the line along which parameters are not determined
_POINTS = 41
#: share of an undetermined combination from which on it is one of a parameter
_PART = 0.1
#: share of the size of a parameter that changes what depends on it
_SLIGHT = 1e-3


def probability(stage: Stage, most: float) -> float:
    """Probability of the best candidate among those tried and none, by their evidence.

    It is at most `most`, as the model that is right may not be among them.
    """
    shares = probabilities([stage.evidence, *(one.evidence for one in stage.tried)])
    names = ["", *(one.effect.name for one in stage.tried)]
    own = sum(p for p, name in zip(shares, names, strict=True) if name == stage.best.effect.name)
    return min(own, most)


def confounded(stage: Stage) -> list[Candidate]:
    """Candidates with no more parameters than the best that gain nearly as much."""
    gain = stage.holdout - stage.best.holdout
    most = len(stage.best.fit.parameters)
    found: dict[str, Candidate] = {}
    for other in stage.tried:
        alike = stage.holdout - other.holdout > (1.0 - CONFOUNDED) * gain
        if alike and len(other.fit.parameters) <= most:
            found.setdefault(other.effect.name, other)
    found.pop(stage.best.effect.name, None)
    return list(found.values())


def parameters_of(fit: Fit, effect: Effect) -> dict[str, dict[str, Any]]:
    """Numbers that an effect reports, with their 95 % intervals.

    Where the data do not determine a combination of its parameters, the values are the smallest
    that explain them, intervals reach as far as the bounds allow, and the parameters that are
    determined are reported beside. What was chosen among a few forms, such as a power, has none.
    """
    indices, own = [], {}
    for index, one in enumerate(fit.parameters):
        name, _, key = one.name.partition(".")
        if name == effect.name:
            indices.append(index)
            own[key] = one
    values, keys = fit.values[indices], list(own)

    def numbers(at: Vector) -> Numbers:
        given = dict(zip(keys, (float(v) for v in at), strict=True))
        reported = effect.reported(given)
        if reported is None:
            return {key: (value, own[key].unit) for key, value in given.items()}
        return dict(reported)

    covariance = fit.covariance[np.ix_(indices, indices)]
    free = _undetermined(fit, indices)
    determined = covariance
    for direction in free:
        # the covariance beside a combination that nothing determines
        along = determined @ np.linalg.pinv(determined) @ direction
        spread = float(along @ np.linalg.pinv(determined) @ along)
        if spread > 0.0:
            determined = determined - np.outer(along, along) / spread
    found = _with_intervals(numbers, values, determined)
    for key, entry in found.items():
        if key not in own and _is_chosen(key, numbers, values, fit.slopes[indices]):
            entry["ci95"] = None
    for direction in free:
        _widened(found, numbers, values, direction, list(own.values()))
    if free:
        mixed = np.max(np.abs([d / np.max(np.abs(d)) for d in free]), axis=0) > _PART
        for index, key in enumerate(keys):
            if not mixed[index] and key not in found:
                half = 1.96 * math.sqrt(max(determined[index, index], 0.0))
                interval = [values[index] - half, values[index] + half]
                found[key] = _entry(values[index], own[key].unit, interval)
    return found


def _undetermined(fit: Fit, indices: list[int]) -> list[Vector]:
    """Combinations (SI) of some parameters that are held by nothing but what holds free ones."""
    size = fit.slopes[indices]
    spread = fit.covariance[np.ix_(indices, indices)] / np.outer(size, size)
    squares, directions = np.linalg.eigh(spread)
    found = [
        size * direction
        for square, direction in zip(squares, directions.T, strict=True)
        if math.sqrt(max(square, 0.0)) > UNDETERMINED
    ]
    # a parameter on which nothing depends has no spread in the inverse either
    for place, index in enumerate(indices):
        if np.linalg.norm(fit.jacobian[:, index]) < 1.0 / FREE_SIZES:
            unit = size * (np.arange(len(indices)) == place)
            if not any(abs(unit @ one) > 0.0 for one in found):
                found.append(unit)
    return found


def _with_intervals(
    numbers: Callable[[Vector], Numbers], values: Vector, covariance: NDArray[np.float64]
) -> dict[str, dict[str, Any]]:
    """Numbers with the spread that their slopes over the parameters give."""
    reported = numbers(values)
    slopes = {key: np.zeros(values.size) for key in reported}
    for index, moved in enumerate(1e-3 * np.sqrt(np.maximum(np.diag(covariance), 0.0))):
        if moved > 0.0:
            beside = numbers(values + moved * (np.arange(values.size) == index))
            for key in reported:
                slopes[key][index] = (beside[key][0] - reported[key][0]) / moved
    found = {}
    for key, (value, unit) in reported.items():
        half = 1.96 * math.sqrt(max(slopes[key] @ covariance @ slopes[key], 0.0))
        # the simulation itself is no better than this
        half = math.hypot(half, NUMERICS * abs(value))
        found[key] = _entry(value, unit, [value - half, value + half])
    return found


def _is_chosen(
    key: str, numbers: Callable[[Vector], Numbers], values: Vector, sizes: Vector
) -> bool:
    """Whether a number is the same whatever the parameters are: it comes from the form alone."""
    slight = _SLIGHT * sizes
    moved = [values + step * (np.arange(values.size) == k) for k, step in enumerate(slight)]
    return all(numbers(at)[key] == numbers(values)[key] for at in (*moved, values + slight))


def _entry(value: float, unit: str, interval: list[float]) -> dict[str, Any]:
    return {"value": float(value), "unit": unit, "ci95": [float(end) for end in interval]}


def _widened(
    found: dict[str, dict[str, Any]],
    numbers: Callable[[Vector], Numbers],
    values: Vector,
    direction: Vector,
    parameters: list[Parameter],
) -> None:
    """Widen intervals to what the numbers are along a direction that the data leave open."""
    ends = [-np.inf, np.inf]
    for value, slope, one in zip(values, direction, parameters, strict=True):
        if abs(slope) > 1e-9 * one.size:
            lower = one.lower if np.isfinite(one.lower) else value - FREE_SIZES * one.size
            upper = one.upper if np.isfinite(one.upper) else value + FREE_SIZES * one.size
            reach = sorted(((lower - value) / slope, (upper - value) / slope))
            ends = [max(ends[0], reach[0]), min(ends[1], reach[1])]
    for step in np.linspace(*ends, _POINTS):
        for key, (value, _) in numbers(values + step * direction).items():
            if found[key]["ci95"] is None:
                continue
            low, high = found[key]["ci95"]
            found[key]["ci95"] = [min(low, value), max(high, value)]
