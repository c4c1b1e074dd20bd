"""Terms that holdout runs ask for, learnt from what known effects leave."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from chatter.description.case import Case
from chatter.explain.criteria import LEARNT_IN_FULL, MOST_TERMS
from chatter.explain.empirical.candidates import terms_of
from chatter.explain.empirical.term import EmpiricalTerm
from chatter.explain.fitting import Fit
from chatter.explain.residuals.residual import residual_of
from chatter.explain.selection.candidates import Candidate, Progress, fitted, stage_with
from chatter.explain.selection.linearised_step import linearised
from chatter.explain.selection.problem import Problem
from chatter.explain.selection.significance import is_significant
from chatter.explain.selection.split import Split


@dataclass(frozen=True, eq=False)
class Learnt:
    """Terms that were learnt, in the order in which they were.

    Parameters
    ----------
    terms : tuple of EmpiricalTerm
    case : Case
        Fitted to all runs.
    of_fitted : Case
        Fitted to the runs for fitting alone.
    over_noise : (float, float)
        Rms of the normalised residual of holdout runs before and after.
    """

    terms: tuple[EmpiricalTerm, ...]
    case: Case
    of_fitted: Case
    over_noise: tuple[float, float]

    def summary(self) -> list[dict[str, Any]]:
        """Entries of explanation.json: variable and table of each term."""
        return [self._entry(term) for term in self.terms]

    def _entry(self, term: EmpiricalTerm) -> dict[str, Any]:
        table = self.case.empirical_over(term.over)
        quantity, values = ("factor", table.factor) if table.factor else ("force", table.force)
        unit = {"angle": "rad", "length": "m", "velocity": "m/s"}[table.DIMENSION[table.over]]
        heading = quantity if quantity == "factor" else "force [N]"
        rows = [[float(x), float(y)] for x, y in zip(table.at, values, strict=True)]
        return {
            "over": table.over,
            "periodic": table.repeats,
            "table": {"columns": [f"{table.over} [{unit}]", heading], "rows": rows},
        }


def learnt(problem: Problem, now: Fit, split: Split, progress: Progress) -> Learnt | None:
    """Learn terms beside the effects of a problem, fitted so far; None where none repeats.

    A term is added where it is significant by the same criteria as an effect: the evidence gains,
    and runs that were held out do. Of finer tables over a variable the evidence chooses.
    """
    before = _over_noise(problem, now.by_name, split)
    terms: list[EmpiricalTerm] = []
    while len(terms) < MOST_TERMS:
        best = _next_term(problem, now, split, progress, {one.over for one in terms})
        if best is None:
            break
        terms.append(best.effect)
        problem, now = problem.with_effect(best.effect), best.fit
    if not terms:
        return None
    progress("fitting the empirical terms to all runs", 0.95)
    final = problem.final_fit(problem.measurement.runs, now.by_name)
    return Learnt(
        tuple(terms),
        problem.case(final.by_name),
        problem.case(now.by_name),
        (before, _over_noise(problem, now.by_name, split)),
    )


def _next_term(
    problem: Problem, now: Fit, split: Split, progress: Progress, known: set[str]
) -> Candidate | None:
    residual = residual_of(
        problem.measurement, problem.predictions, problem.case(now.by_name), problem.noise
    )
    steps = []
    screened, runs = problem.screened(now, split.fitted)
    for term in terms_of(residual):
        if term.over not in known:
            progress(f"learning over the {term.over}", 0.92)
            steps.append((term, linearised(screened, term, now, runs)))
    count = math.log(max(now.residuals.size, 2))
    steps.sort(key=lambda entry: entry[1].cost + entry[0].shapes * count)
    tried = [fitted(problem, term, split, step.values) for term, step in steps[:LEARNT_IN_FULL]]
    if not tried:
        return None
    stage = stage_with(problem, now, split, tried)
    return stage.best if is_significant(stage, stage.best, problem, split) else None


def _over_noise(problem: Problem, values: Mapping[str, float], split: Split) -> float:
    return math.sqrt(problem.cost(values, split.holdout) / problem.count(split.holdout))
