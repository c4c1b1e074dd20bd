"""Nonlinear least squares over named parameters of a friction law.

Parameters of a law are positive and span decades, so the search and the intervals run in their
logarithms; an offset of the effort may have either sign and is searched as it is. Several starts
guard against local minima, of which the Stribeck curve and presliding have plenty.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np
import scipy
from numpy.typing import NDArray

from dynamics.friction.identification.intervals import (
    Estimate,
    covariance,
    estimate,
    positive_estimate,
)

#: search range of a positive parameter about its guess, either way
_RANGE = 1e4
#: spread of the further starts about the guess (standard deviation of the logarithm)
_SPREAD = 0.7
#: interval beyond which the record says little about a parameter: upper over lower end
_VAGUE = 10.0


@dataclass(frozen=True)
class Search:
    """Result of `search`."""

    values: dict[str, float]  # of the free parameters
    estimates: dict[str, Estimate]  # the same with 95 % intervals
    residual: NDArray[np.float64]  # (n,), at the optimum
    #: positive parameters that ended at their bound or whose interval spans more than a decade: the
    #: records do not decide them
    unsupported: tuple[str, ...]
    agreeing_starts: int  # starts that reached the optimum (within 1 % of its sum of squares)


def search(
    residual: Callable[[dict[str, float]], NDArray[np.float64]],
    guess: Mapping[str, float],
    *,
    signed: Mapping[str, float],
    starts: int,
    seed: int,
    fewest: int = 2,
) -> Search:
    """Find the parameters with the least sum of squares.

    From the guess, the free parameters and their first values, and random starts about it. `signed`
    are those that may have either sign, with their order of magnitude; `fewest` are the samples
    needed for each parameter. ValueError if nothing is free, or a positive parameter starts at 0 or
    below.
    """
    names = tuple(guess)
    if not names:
        raise ValueError("friction fit: no parameter is free")
    if starts < 1:
        raise ValueError(f"friction fit: starts must be 1 or more, not {starts}")
    for name in names:
        if name not in signed and not 0.0 < guess[name] < math.inf:
            raise ValueError(
                f"friction fit: {name} is to be fitted and needs a guess above 0, not {guess[name]}"
            )

    def values(x: NDArray[np.float64]) -> dict[str, float]:
        return {
            name: float(x[k] * signed[name] if name in signed else math.exp(x[k]))
            for k, name in enumerate(names)
        }

    first = np.array([guess[n] / signed[n] if n in signed else math.log(guess[n]) for n in names])
    wide = np.array([np.inf if n in signed else math.log(_RANGE) for n in names])
    random = np.random.default_rng(seed)
    outcomes = []
    for k in range(starts):
        shift = np.array([0.1 if n in signed else _SPREAD for n in names])
        x = first + (shift * random.standard_normal(len(names)) if k else 0.0)
        outcomes.append(
            scipy.optimize.least_squares(
                lambda x: residual(values(x)), x, bounds=(first - wide, first + wide)
            )
        )
    best = min(outcomes, key=lambda outcome: outcome.cost)
    if len(best.fun) < fewest * len(names):
        raise ValueError(
            f"friction fit: {len(best.fun)} samples for {len(names)} parameters; at least "
            f"{fewest * len(names)} are needed"
        )
    agreeing = sum(outcome.cost <= 1.01 * best.cost + 1e-300 for outcome in outcomes)
    estimates, unsupported = _estimates(best, names, signed, values(best.x))
    return Search(values(best.x), estimates, best.fun, unsupported, agreeing)


def _estimates(
    best: scipy.optimize.OptimizeResult,
    names: Sequence[str],
    signed: Mapping[str, float],
    found: Mapping[str, float],
) -> tuple[dict[str, Estimate], tuple[str, ...]]:
    # a parameter without any effect has an unbounded interval and must not spoil the others
    size = np.linalg.norm(best.jac, axis=0)
    felt = size > 1e-12 * max(float(size.max()), 1e-300)
    variances = np.full(len(names), np.inf)
    freedom = 1.0
    if felt.any():
        spread, freedom = covariance(best.jac[:, felt], best.fun)
        variances[felt] = np.diag(spread)
    estimates, unsupported = {}, []
    for k, name in enumerate(names):
        if name in signed:
            estimates[name] = estimate(found[name], variances[k] * signed[name] ** 2, freedom)
            continue
        estimates[name] = positive_estimate(found[name], variances[k], freedom)
        ratio = (
            estimates[name].upper / estimates[name].lower
            if estimates[name].lower > 0.0
            else math.inf
        )
        if best.active_mask[k] != 0 or not ratio < _VAGUE:
            unsupported.append(name)
    return estimates, tuple(unsupported)


def law_parameters(law: object, free: Sequence[str]) -> dict[str, float]:
    """Values of the parameters of a law to be fitted.

    ValueError if the law has no such parameter, or one is named twice.
    """
    known = [field.name for field in fields(law)]
    for name in free:
        if name not in known:
            raise ValueError(
                f"friction fit: {type(law).__name__} has no parameter {name!r}; it has "
                f"{', '.join(known)}"
            )
    if len(set(free)) != len(free):
        raise ValueError(f"friction fit: a parameter is named twice in {list(free)}")
    return {name: getattr(law, name) for name in free}
