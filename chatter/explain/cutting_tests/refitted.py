"""Declared values that were refitted to cutting tests, and by how much."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy

from chatter.explain.cutting_tests.priors import declared, pulls
from chatter.explain.fitting import Fit
from chatter.explain.parameters import Parameter
from chatter.explain.selection.problem import Problem

#: tolerances by which a single declared value may be off
_MOST = 3.0
#: probability below which declared values are not off together by chance
_CHANCE = 0.05
#: change of a value, as a share and in tolerances, from which it is told in words
_TOLD, _TOLD_TOLERANCES = 0.02, 0.5
#: of the tolerances, below which the tests alone determine a value
_DETERMINED = 0.7


class Refitted(NamedTuple):
    """A declared value, and what the tests make of it."""

    parameter: Parameter
    refitted: float  # SI
    deviation: float  # standard deviation of the refitted value, SI

    @property
    def name(self) -> str:
        """Path in the case."""
        return self.parameter.name

    @property
    def declared(self) -> float:
        """Declared value, SI."""
        return self.parameter.start

    @property
    def change(self) -> float:
        """Change as a share of the declared value."""
        return self.refitted / self.declared - 1.0

    @property
    def pull(self) -> float:
        """Change in tolerances."""
        return self.parameter.counted(self.refitted)

    @property
    def is_determined(self) -> bool:
        """Whether the tests alone determine the value."""
        return bool(self.deviation < _DETERMINED * self.parameter.per_size(self.pull))

    @property
    def is_doubtful(self) -> bool:
        """Whether the value left its tolerance."""
        return bool(abs(self.pull) > _MOST)

    def summary(self) -> dict[str, float | str | bool]:
        """Entry of explanation.json."""
        return {
            "name": self.name,
            "declared": self.declared,
            "refitted": self.refitted,
            "change": self.change,
            "tolerances": self.pull,
            "standard_deviation": self.deviation,
            "determined_by_tests": self.is_determined,
            "outside_tolerance": self.is_doubtful,
        }


def refitted_values(problem: Problem, fit: Fit) -> list[Refitted]:
    """Declared values and what became of them, the furthest moved first."""
    index = {one.name: k for k, one in enumerate(fit.parameters)}
    found = [
        Refitted(
            one,
            float(fit.values[index[one.name]]),
            float(np.sqrt(max(fit.covariance[index[one.name], index[one.name]], 0.0))),
        )
        for one in declared(problem)
    ]
    return sorted(found, key=lambda one: -abs(one.pull))


def are_off_together(problem: Problem, fit: Fit) -> bool:
    """Whether the declared values had to move further than their tolerances make likely.

    Of p values the tests determine some combinations only, the trace of the share that the data
    have in the curvature; the sum of squares of the pulls is compared with as many squares.
    """
    names = [one.name for one in fit.parameters]
    parameters = declared(problem)
    chosen = [names.index(one.name) for one in parameters]
    data = fit.jacobian.T @ fit.jacobian
    whole = data + np.eye(len(names))
    share = np.diag(np.linalg.solve(whole, data))[chosen]
    freedom = max(float(np.sum(np.clip(share, 0.0, 1.0))), 1.0)
    squares = float(np.sum(pulls(parameters, fit.by_name) ** 2))
    return bool(scipy.stats.chi2.sf(squares, freedom) < _CHANCE)


def in_words(values: list[Refitted]) -> str:
    """Sentence on the values that were moved by more than a little."""
    told = [one for one in values if abs(one.change) > _TOLD and abs(one.pull) > _TOLD_TOLERANCES]
    if not told:
        return "The declared values stay as they are, within half of their tolerances."
    listed = ", ".join(
        f"{one.name} by {100.0 * one.change:+.3g} % ({abs(one.pull):.1f} tolerances)"
        for one in told
    )
    return f"Refitted to the tests: {listed}."
