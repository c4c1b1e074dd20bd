"""Particles of a tool that wears and of one that does not, in proportion to their evidence."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from chatter.explain.selection.evidence import probabilities
from chatter.explain.selection.problem import Problem
from chatter.learning.likelihood import Likelihood
from chatter.learning.posterior import Particles, Progress, prior_particles, updated
from chatter.learning.prior import Prior, prior_of


def learnt_particles(
    problem: Problem,
    prior: Prior,
    count: int,
    generator: np.random.Generator,
    progress: Progress = lambda *_: None,
) -> Particles:
    """Particles (count) after all tests of a problem, from its prior.

    Where the problem has wear beside the declared values, a tool without wear is learnt as well:
    what wear does to process damping is told by few tests, and would be found where there is none.
    Both models are as likely before, and particles are dealt out by their evidence.
    """
    worn = updated(
        prior_particles(prior, count, generator), Likelihood(problem, prior), generator, progress
    )
    if not problem.effects:
        return worn
    plain = replace(problem, effects=())
    simple = prior_of(plain)
    sharp = updated(
        prior_particles(simple, count, generator), Likelihood(plain, simple), generator, progress
    )
    share = probabilities([worn.log_evidence, sharp.log_evidence])[0]
    kept = round(share * count)
    # the same places in the list of parameters, those of wear at none
    nothing = np.array([one.counted(0.0) if one.start == 0.0 else 0.0 for one in prior.parameters])
    others = np.tile(nothing, (count - kept, 1))
    for index, name in enumerate(simple.names):
        others[:, prior.names.index(name)] = sharp.counted[: count - kept, index]
    evidence = float(np.logaddexp(worn.log_evidence, sharp.log_evidence) - np.log(2.0))
    counted = np.concatenate([worn.counted[:kept], others])
    return Particles(prior, counted, worn.tests, evidence)
