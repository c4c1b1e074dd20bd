"""Declared values of cutting tests: tolerances that a clear contradiction widens.

A declared value scatters by its tolerance as a rule and by much more now and then: Student's t in
place of a normal distribution (Lange, Little and Taylor 1989, J. Am. Stat. Assoc. 84:881). What is
pulled far out of its tolerance is reported, see `refitted`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from chatter.explain.fitting import Fit
from chatter.explain.parameters import Parameter
from chatter.explain.selection.problem import Problem

Array = NDArray[np.float64]

#: degrees of freedom of Student's t
FREEDOM = 4.0


def declared(problem: Problem) -> list[Parameter]:
    """Declared values with their own tolerances."""
    return problem.kind.nuisance_parameters(problem.measurement)


def pulls(parameters: Sequence[Parameter], values: Mapping[str, float]) -> Array:
    """Deviations (p,) of values from the declared ones, in their tolerances."""
    return np.array([one.counted(values[one.name]) for one in parameters])


class Priors:
    """Priors of parameters that are counted in their sizes from where they start."""

    def __init__(self, problem: Problem, parameters: Sequence[Parameter]) -> None:
        names = {one.name for one in declared(problem)}
        self.heavy = np.array([one.prior and one.name in names for one in parameters], dtype=bool)
        self.normal = np.array([one.prior and one.name not in names for one in parameters], bool)

    def cost(self, scaled: Array) -> float:
        """Twice the lost logarithm of the density at (p,) scaled parameters."""
        heavy = (FREEDOM + 1.0) * np.log1p(scaled[self.heavy] ** 2 / FREEDOM)
        return float(np.sum(heavy) + np.sum(scaled[self.normal] ** 2))

    def weight(self, scaled: Array) -> Array:
        """Weight (p,) with which the square of each counts as if the density were normal."""
        heavy = (FREEDOM + 1.0) / (FREEDOM + scaled**2)
        return np.where(self.heavy, heavy, np.where(self.normal, 1.0, 0.0))


def prior_cost(problem: Problem, fit: Fit) -> float:
    """Twice the lost logarithm of the prior density of what was fitted."""
    return Priors(problem, fit.parameters).cost(pulls(fit.parameters, fit.by_name))
