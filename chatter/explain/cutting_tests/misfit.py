"""What cutting tests lose beside a model more than by scatter, and what an effect can gain."""

from __future__ import annotations

import math
from typing import NamedTuple

from chatter.explain.cutting_tests.priors import prior_cost
from chatter.explain.cutting_tests.reliability import MOST_LOST_BY_SCATTER, lost_by_scatter
from chatter.explain.fitting import Fit
from chatter.explain.kinds.stability import likely_stable
from chatter.explain.selection.problem import Problem

#: standard deviations by which scatter loses less than its mean in nearly every series of tests
_LUCK = 2.0


class Misfit(NamedTuple):
    """Twice the lost logarithm of likelihood and prior above that of scatter."""

    excess: float
    deviation: float  # standard deviation of it, where nothing is missing
    verdicts: int

    @property
    def is_scatter(self) -> bool:
        """Whether no more is lost than scatter loses."""
        return self.excess < MOST_LOST_BY_SCATTER * self.deviation

    def may_fall_by(self, least: float, numbers: int) -> bool:
        """Whether an effect with so many numbers without a prior can gain so much.

        The right model may lose less than the mean by chance; its numbers are charged for.
        """
        most = self.excess + _LUCK * self.deviation
        return most >= least + numbers * math.log(max(self.verdicts, 2))


def misfit_of(problem: Problem, fit: Fit) -> Misfit:
    """Misfit of a fit to tests."""
    case = problem.case(fit.by_name)
    expected, variance, count = 0.0, 0.0, 0
    for run in problem.measurement.runs:
        predicted = problem.predictions.of(case, run)
        if run.record != "stable":
            readings = predicted[str(run.record)].size
            expected, variance = expected + readings, variance + 2.0 * readings
            continue
        likely = likely_stable(predicted["margin"], problem.noise[run.name]["stable"])
        own = lost_by_scatter(likely)
        expected, variance = expected + own.mean, variance + own.variance
        count += likely.size
    excess = fit.cost - expected + prior_cost(problem, fit)
    return Misfit(excess, math.sqrt(variance), count)
