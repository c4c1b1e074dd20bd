"""Fits that begin elsewhere: values drawn from their tolerances, the best followed.

Beside a large misfit the sum of squares has many minima, and the one next to the declared values
may be none of the deep ones: a frequency that is off by more than the width of its resonance is
drawn to where the residual happens to be least.
"""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np

from chatter.explain.criteria import OUT_OF_TOLERANCE
from chatter.explain.cutting_tests.priors import FREEDOM
from chatter.explain.fitting import WORKERS, Fit
from chatter.explain.selection.problem import Problem
from chatter.explain.selection.split import Split

#: starts drawn and followed, and runs by which they are ranked at the most
_DRAWN, _FOLLOWED, _MOST_RUNS = 60, 3, 3
#: spreads of the values drawn, in their tolerances, by turns: some values are off by more
_SPREADS = (0.5, 1.0, 2.0)
#: mean square of the normalised residual from which on a fit has such a misfit
_LARGE = 9.0
#: sum of squares, priors counted, over that of the fit itself, below which another is better
_BETTER = 0.98


def fit_from_elsewhere(problem: Problem, now: Fit, split: Split) -> Fit:
    """Fit to the runs for fitting that is the best from several starts, where much is left.

    The residual is taken for noise, so that tolerances hold against it. Where little is left but
    declared values are out of their tolerances, the one other start is the declared values. The fit
    itself where no other is clearly better.
    """
    if not now.parameters:
        return now
    level = now.cost / max(now.residuals.size, 1)
    if level < _LARGE:
        return _from_declared(problem, now, split)
    held = _with_noise(problem, np.sqrt(level))
    own = held.fit(split.fitted, now.by_name)
    best = min((*_followed(held, own, split), own), key=objective)
    if objective(best) > _BETTER * objective(own) and own is not best:
        best = own
    if objective(best) > _BETTER * (now.cost / level - 2.0 * now.log_prior):
        return now
    return problem.fit(split.fitted, best.by_name)


def declared_put_back(problem: Problem, now: Fit) -> dict[str, float] | None:
    """Values of a fit with declared ones left out, to begin at; None where all are in tolerance.

    They were drawn out of it when the effects were not in the case, or a flat minimum held them.
    """
    pulls = problem.declared_pulls(now)
    if all(abs(pull) <= OUT_OF_TOLERANCE for pull in pulls.values()):
        return None
    return {name: value for name, value in now.by_name.items() if name not in pulls}


def _from_declared(problem: Problem, now: Fit, split: Split) -> Fit:
    """Fit with declared values put back that are out of tolerance, where that is better."""
    begin = declared_put_back(problem, now)
    if begin is None:
        return now
    back = problem.fit(split.fitted, begin)
    return back if objective(back) < objective(now) else now


def objective(found: Fit) -> float:
    """Sum of squares of residuals and of pulls."""
    return found.cost - 2.0 * found.log_prior


def _with_noise(problem: Problem, factor: float) -> Problem:
    """Problem whose noise is larger by a factor."""
    noise = {
        run: {channel: factor * one for channel, one in channels.items()}
        for run, channels in problem.noise.items()
    }
    return replace(problem, noise=noise)


def _followed(problem: Problem, own: Fit, split: Split) -> list[Fit]:
    """Fits from the starts drawn whose sums of squares are the least."""
    starts = _drawn(problem, own)
    ranked_by = problem.coarse(split.fitted[:: max(1, len(split.fitted) // _MOST_RUNS)])

    def cost(start: Mapping[str, float]) -> float:
        return problem.cost(start, ranked_by)

    with ThreadPoolExecutor(WORKERS) as pool:
        costs = list(pool.map(cost, starts))
    order = np.argsort(costs, kind="stable")[:_FOLLOWED]
    return [problem.fit(split.fitted, starts[index]) for index in order]


def _drawn(problem: Problem, own: Fit) -> list[dict[str, float]]:
    """Declared values drawn from their tolerances, with numbers of effects as found or begun."""
    random = np.random.default_rng(1)
    begun = {
        effect.name: list(effect.starts(problem.measured_by(effect))) for effect in problem.effects
    }
    starts = []
    for number in range(_DRAWN):
        start = dict(own.by_name)
        spread = _SPREADS[number % len(_SPREADS)]
        for one in own.parameters:
            owner = one.name.partition(".")[0]
            if one.prior and owner not in begun:
                pull = spread * float(random.standard_t(FREEDOM))
                start[one.name] = one.moved(one.start, pull)
        for name, entries in begun.items():
            # every other time from where the search for the effect began, elsewhere in its range
            if number % 2 and entries:
                chosen = entries[int(random.integers(len(entries)))]
                start |= {f"{name}.{key}": value for key, value in chosen.items()}
        starts.append(start)
    return starts
