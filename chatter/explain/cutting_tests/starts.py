"""Where fits to cutting tests begin: values drawn from their tolerances, the best followed."""

from __future__ import annotations

import math

import numpy as np

from chatter.explain.cutting_tests.fit_to_tests import SearchOverTests, scattered
from chatter.explain.cutting_tests.priors import FREEDOM, declared
from chatter.explain.selection.problem import Problem

#: scatters of limits that fits begin with
ANNEALED = (0.25, 0.12)
#: starts drawn and followed: the most, the least, and the square of vibrations that may be computed
_DRAWN, _FOLLOWED, _VIBRATIONS = (150, 15), (10, 1), 400_000.0
#: least of a drawn value, as a share of that declared
_LEAST_DRAWN = 0.2


def starts_of_tests(problem: Problem) -> list[dict[str, float]]:
    """Values drawn from their tolerances whose verdicts are the likeliest, limits widely scattered.

    Fewer where predictions cost more: with the square of the vibrations that a period of the tool
    holds, summed over the tests.
    """
    verdicts = [run for run in problem.measurement.runs if run.record == "stable"]
    share = min(1.0, _VIBRATIONS / (_DRAWN[0] * _vibrations(problem)))
    drawn, followed = (max(least, round(share * most)) for most, least in (_DRAWN, _FOLLOWED))
    random, parameters = np.random.default_rng(1), declared(problem)
    starts = [
        {
            one.name: one.value(max(pull, one.counted(_LEAST_DRAWN * one.start)))
            for one, pull in zip(parameters, pulls.tolist(), strict=True)
        }
        for pulls in random.standard_t(FREEDOM, (drawn, len(parameters)))
    ]
    noise = scattered(problem.noise, ANNEALED[0])

    def cost(start: dict[str, float]) -> float:
        search = SearchOverTests(problem, verdicts, start)
        search.noise = noise
        return search.cost(search.predicted, search.x)

    return sorted(starts, key=cost)[:followed]


def _vibrations(problem: Problem) -> float:
    """Square of the vibrations in a revolution, summed over the tests."""
    case = problem.measurement.case
    fastest = max((mode.frequency for mode in case.structure.mode), default=0.0)
    speeds = problem.kind.cuts(problem.measurement).speed
    return float(np.sum((2.0 * math.pi * fastest / speeds) ** 2)) or 1.0
