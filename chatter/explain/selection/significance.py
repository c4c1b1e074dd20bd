"""Whether a candidate gains more than chance gives, or stands for something else."""

from __future__ import annotations

from typing import TYPE_CHECKING

from chatter.explain.criteria import LEAST_EVIDENCE, LEAST_GAIN_SHARE_BESIDE, LEAST_SHARE, MOST_LOST
from chatter.explain.selection.problem import Problem
from chatter.explain.selection.split import Split

if TYPE_CHECKING:
    from chatter.explain.selection.candidates import Candidate, Stage


def is_significant(stage: Stage, one: Candidate, problem: Problem, split: Split) -> bool:
    """Whether the evidence and all runs gain by a candidate, and holdout runs do not lose."""
    if one.evidence - stage.evidence < LEAST_EVIDENCE or one.holdout > MOST_LOST * stage.holdout:
        return False
    least, share = problem.kind.least_gain
    if problem.effects:
        share = max(share, LEAST_GAIN_SHARE_BESIDE)
    gain = _cost_before(stage, split) - _cost_after(one, split)
    return gain > max(
        least + share * _count(problem, split), LEAST_SHARE * misfit(stage, problem, split)
    )


def share_removed(stage: Stage, one: Candidate, problem: Problem, split: Split) -> float:
    """Share of the misfit of all runs above the noise that a candidate takes away."""
    gain = _cost_before(stage, split) - _cost_after(one, split)
    return gain / max(misfit(stage, problem, split), 1e-300)


def misfit(stage: Stage, problem: Problem, split: Split) -> float:
    """Sum of squares of all runs above that of noise."""
    return _cost_before(stage, split) - _count(problem, split)


def _cost_before(stage: Stage, split: Split) -> float:
    own = stage.before.cost
    return own if split.holdout == split.fitted else own + stage.holdout


def _cost_after(one: Candidate, split: Split) -> float:
    return one.fit.cost if split.holdout == split.fitted else one.fit.cost + one.holdout


def _count(problem: Problem, split: Split) -> int:
    runs = split.fitted if split.holdout == split.fitted else (*split.fitted, *split.holdout)
    return problem.count(runs)
