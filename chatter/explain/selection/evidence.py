"""Evidence of a model: what its residual, with the autocorrelation that it has, says for it.

Neighbours in a residual of a model that lacks something are not independent: a count of samples
would make every candidate certain. Whittle's (1953) likelihood takes the residual as noise of the
spectrum that it has itself: what it loses at frequencies where much is left anyway counts little.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from chatter.explain.criteria import SMOOTHED_LINES
from chatter.explain.fitting import Fit
from chatter.explain.measurement import Run
from chatter.explain.selection.problem import Problem
from chatter.explain.selection.split import Split

#: power of a normalised residual below which a line is at its noise: less is chance, or numerics
_LEAST_POWER = 1.0


def log_evidence(problem: Problem, found: Fit, split: Split) -> float:
    """Logarithm of the evidence of a model that was fitted to some runs.

    That of the runs fitted by Laplace's approximation, and the likelihood of the holdout runs.
    """
    own = log_likelihood(problem, found.residuals, split.fitted)
    evidence = own + found.log_prior + found.log_volume
    if split.holdout is split.fitted or split.holdout == split.fitted:
        return evidence
    residuals = problem.residuals(found.by_name, split.holdout)
    return evidence + log_likelihood(problem, residuals, split.holdout)


def log_likelihood(problem: Problem, residuals: NDArray[np.float64], runs: Sequence[Run]) -> float:
    """Logarithm of the likelihood of normalised residuals (n,) of runs, one after the other."""
    if not problem.kind.has_autocorrelation:
        return -0.5 * float(residuals @ residuals)
    sizes = [run.signals[name].size for run in runs for name in problem.kind.channels(run)]
    return sum(whittle(series) for series in np.split(residuals, np.cumsum(sizes)[:-1]))


def whittle(residual: NDArray[np.float64]) -> float:
    """Logarithm of the likelihood of a normalised residual (n,), as noise of its own spectrum.

    The power of each line is the mean over its neighbours, and 1 at the least: of white noise of
    standard deviation one the result is about -n/2, as it would be without any autocorrelation.
    """
    lines = np.abs(np.fft.rfft(residual)) ** 2 / max(residual.size, 1)
    width = min(SMOOTHED_LINES, lines.size)
    padded = np.pad(lines, (width // 2, width - 1 - width // 2), mode="reflect")
    power = np.lib.stride_tricks.sliding_window_view(padded, width).mean(axis=1)
    known = np.maximum(power, _LEAST_POWER)
    return -float(np.sum(np.log(known) + lines / known))


def probabilities(evidence: Sequence[float]) -> list[float]:
    """Probabilities of models that are the only ones, from the logarithms of their evidence."""
    best = max(evidence)
    weights = [math.exp(max(one - best, -700.0)) for one in evidence]
    return [weight / sum(weights) for weight in weights]
