"""Where fits to cutting tests begin: values drawn from their tolerances, the best followed."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from chatter.explain.cutting_tests.fit_to_tests import SearchOverTests, scattered
from chatter.explain.cutting_tests.priors import FREEDOM, declared
from chatter.explain.effects.effect import Effect
from chatter.explain.measurement import Run
from chatter.explain.selection.problem import Problem

#: scatters of limits that fits begin with
ANNEALED = (0.25, 0.12)
#: starts drawn and followed, most and least; square of vibrations up to which it is the most
_DRAWN, _FOLLOWED, _VIBRATIONS = (300, 12), (10, 1), 8_000.0
#: spreads of the values drawn, in their tolerances, by turns: some values are off by more
_SPREADS = (1.0, 2.0)
#: least of a drawn value, as a share of that declared
_LEAST_DRAWN = 0.2


def starts_of_tests(problem: Problem) -> list[dict[str, float]]:
    """Values drawn from their tolerances whose verdicts are the likeliest."""
    verdicts = [run for run in problem.measurement.runs if run.record == "stable"]
    share = share_of_work(problem)
    drawn, followed = (max(least, round(share * most)) for most, least in (_DRAWN, _FOLLOWED))
    random, parameters = np.random.default_rng(1), declared(problem)
    pulls = random.standard_t(FREEDOM, (drawn, len(parameters)))
    pulls *= np.resize(_SPREADS, drawn)[:, None]
    starts = [
        {
            one.name: one.value(max(pull, one.counted(_LEAST_DRAWN * one.start)))
            for one, pull in zip(parameters, row, strict=True)
        }
        for row in pulls.tolist()
    ]
    return sorted(starts, key=lambda one: wide_cost(problem, verdicts, one))[:followed]


def starts_with(
    problem: Problem, effect: Effect, others: Sequence[Mapping[str, float]]
) -> list[tuple[float, dict[str, float]]]:
    """Starts of an effect beside several values of the others, and their costs, the least first.

    Limits are taken as scattered widely, so that an effect that leads out of a false minimum of the
    others is not measured by where that minimum is.
    """
    trial, runs = problem.with_effect(effect), problem.measurement.runs
    starts = [
        {**values, **{f"{effect.name}.{key}": value for key, value in start.items()}}
        for values in others
        for start in effect.starts(problem.measurement)
    ]
    return sorted(
        ((wide_cost(trial, runs, one), one) for one in starts), key=lambda entry: entry[0]
    )


def wide_cost(problem: Problem, runs: Sequence[Run], values: Mapping[str, float]) -> float:
    """Twice the lost logarithm of likelihood and prior, limits widely scattered."""
    search = SearchOverTests(problem, runs, values)
    search.noise = scattered(problem.noise, ANNEALED[0])
    return search.cost(search.predicted, search.x)


def share_of_work(problem: Problem) -> float:
    """Share of all starts that are worth trying: predictions cost the more, the slower the tool.

    They do with the square of the vibrations that a revolution holds, summed over the tests.
    """
    case = problem.measurement.case
    fastest = max((mode.frequency for mode in case.structure.mode), default=0.0)
    speeds = problem.kind.cuts(problem.measurement).speed
    vibrations = float(np.sum((2.0 * math.pi * fastest / speeds) ** 2))
    return min(1.0, _VIBRATIONS / max(vibrations, 1.0))
