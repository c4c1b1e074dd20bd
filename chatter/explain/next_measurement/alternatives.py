"""Models that a search leaves possible, each with values drawn from its fit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.explain.fitting import Fit, Matrix, Vector
from chatter.explain.selection.candidates import Stage
from chatter.explain.selection.evidence import probabilities
from chatter.explain.selection.problem import Problem
from chatter.explain.selection.search import Search

#: models that are compared at the most, and the least probability of one
_MOST, _LEAST_PROBABILITY = 3, 0.01
#: values drawn of each
_DRAWS = 4
_SEED = 5
#: standard deviation, over a parameter's typical size, below which the data do not see it
_SEEN = 1e-9


@dataclass(frozen=True, eq=False)
class Alternative:
    """A model that may be true.

    Parameters
    ----------
    names : tuple of str
        Of the effects that it has beside the declared case.
    probability : float
        Among the alternatives.
    cases : tuple of Case
        Equally likely, with values drawn from the fit.
    """

    names: tuple[str, ...]
    probability: float
    cases: tuple[Case, ...]

    @property
    def label(self) -> str:
        """Words for the model."""
        return " and ".join(self.names) or "no effect more"


def alternatives(found: Search) -> list[Alternative]:
    """Models that a search leaves possible, the likeliest first.

    What was tried last: beside the effects accepted where there are some, else beside none.
    """
    stage = found.accepted[-1] if found.accepted else found.first
    if not stage.tried:
        return [_drawn(found.problem, found.final, (), 1.0)]
    problem = found.problem
    if found.accepted:
        problem = problem.without_effect(stage.best.effect)
    models = [(problem, _beside(found, stage), stage.evidence)]
    named = set()
    for one in stage.tried:
        if one.effect.name not in named:
            named.add(one.effect.name)
            models.append((problem.with_effect(one.effect), one.fit, one.evidence))
    models.sort(key=lambda entry: -entry[2])
    shares = probabilities([entry[2] for entry in models[:_MOST]])
    return [
        _drawn(own, fit, tuple(effect.name for effect in own.effects), share)
        for (own, fit, _), share in zip(models, shares, strict=False)
        if share >= _LEAST_PROBABILITY
    ]


def _beside(found: Search, stage: Stage) -> Fit:
    return stage.before if found.accepted else found.base


def _drawn(problem: Problem, fit: Fit, names: tuple[str, ...], probability: float) -> Alternative:
    """Model with values from the normal distribution about its fit, within bounds."""
    spread = np.sqrt(np.clip(np.diag(fit.covariance), 0.0, None))
    sizes = np.array([one.size for one in fit.parameters])
    steps = _standard_steps(fit.covariance, spread, seen=spread > _SEEN * sizes)
    lower = np.array([one.lower for one in fit.parameters])
    upper = np.array([one.upper for one in fit.parameters])
    cases = []
    for step in np.vstack([np.zeros((1, spread.size)), steps]):
        values = np.clip(fit.values + step * spread, lower, upper)
        given = {one.name: float(v) for one, v in zip(fit.parameters, values, strict=True)}
        for one in problem.parameters():
            given.setdefault(one.name, one.start)
        try:
            cases.append(problem.case(given))
        except InputError:
            # values that no case has
            continue
    return Alternative(names, probability, tuple(cases))


def _standard_steps(covariance: Matrix, spread: Vector, seen: NDArray[np.bool_]) -> Matrix:
    """Return steps from the normal distribution, in standard deviations; shape (draws, p).

    A parameter that the data do not see has no variance in the pseudo-inverse and stays.
    """
    steps = np.zeros((_DRAWS, spread.size))
    if seen.any():
        correlation = covariance[np.ix_(seen, seen)] / np.outer(spread[seen], spread[seen])
        steps[:, seen] = np.random.default_rng(_SEED).multivariate_normal(
            np.zeros(correlation.shape[0]), correlation, _DRAWS, check_valid="ignore", method="eigh"
        )
    return steps
