"""Evidence of a model: what its residual, with the autocorrelation that it has, says for it.

Neighbours in a residual of a model that lacks something are not independent: a count of samples
would make every candidate certain. Whittle's (1953) likelihood takes the residual as noise of the
spectrum that it has itself: what it loses at frequencies where much is left anyway counts little.
What repeats with the revolution of a settled record is a line at each of its harmonics, however
long the record is: each counts once, beside a spectrum that neighbouring harmonics share.
"""

import math
from collections.abc import Sequence

import numpy as np
import scipy
from numpy.typing import NDArray

from chatter.explain.criteria import SMOOTHED_HARMONICS, SMOOTHED_LINES
from chatter.explain.fitting import Fit
from chatter.explain.measurement import Run
from chatter.explain.selection.problem import Problem
from chatter.explain.selection.split import Split

#: power of a normalised residual below which a line is at its noise: less is chance, or numerics
_LEAST_POWER = 1.0
#: revolutions from which on lines between harmonics are there to tell what is noise
_LEAST_REVOLUTIONS = 4
#: times that harmonics are taken off: over revolutions of a part of a sample they are orthogonal to
#: each other but for a share of about one over the samples
_PROJECTIONS = 2


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
    series = [(run, name) for run in runs for name in problem.kind.channels(run)]
    ends = np.cumsum([run.signals[name].size for run, name in series])
    found = 0.0
    for (run, _), own in zip(series, np.split(residuals, ends[:-1]), strict=True):
        revolution = problem.kind.revolution(run)
        found += (
            whittle(own) if revolution is None else whittle_of_repeated(own, revolution / run.step)
        )
    return found


def whittle(residual: NDArray[np.float64]) -> float:
    """Logarithm of the likelihood of a normalised residual (n,), as noise of its own spectrum.

    The power of each line is the mean over its neighbours, and 1 at the least: of white noise of
    standard deviation one the result is about -n/2, as it would be without any autocorrelation.
    """
    return _whittle(_powers(residual), SMOOTHED_LINES)


def whittle_of_repeated(residual: NDArray[np.float64], revolution: float) -> float:
    """Whittle's likelihood of a normalised residual (n,) that may repeat itself.

    The revolution is counted in samples and need not be whole: its harmonics are found by chirp z
    transforms (Rabiner, Schafer and Rader 1969). They share their power with neighbouring ones,
    what lies between them with neighbouring lines. Of white noise the result is that of `whittle`.
    """
    revolutions = int(residual.size / revolution)
    if revolutions < _LEAST_REVOLUTIONS:
        return whittle(residual)
    between = residual[: round(revolutions * revolution)]
    between = between - between.mean()
    step, count = 2j * math.pi / revolution, math.ceil(0.5 * revolution)
    harmonics = np.zeros(count, dtype=np.complex128)
    for _ in range(_PROJECTIONS):
        found = scipy.signal.czt(between, count, np.exp(-step)) / between.size
        found[0] = 0.0
        between = between - 2.0 * scipy.signal.czt(found, between.size, np.exp(step)).real
        harmonics += found
    powers = np.abs(harmonics[1:]) ** 2 * between.size
    return _whittle(powers, SMOOTHED_HARMONICS) + whittle(between)


def _powers(residual: NDArray[np.float64]) -> NDArray[np.float64]:
    """Periodogram of a normalised residual (n,): 1 in the mean of white noise."""
    return np.abs(np.fft.rfft(residual)) ** 2 / max(residual.size, 1)


def _whittle(lines: NDArray[np.float64], smoothed: int) -> float:
    """Logarithm of the likelihood of powers, beside their mean over so many neighbours."""
    width = min(smoothed, lines.size)
    padded = np.pad(lines, (width // 2, width - 1 - width // 2), mode="reflect")
    power = np.lib.stride_tricks.sliding_window_view(padded, width).mean(axis=1)
    known = np.maximum(power, _LEAST_POWER)
    return -float(np.sum(np.log(known) + lines / known))


def probabilities(evidence: Sequence[float]) -> list[float]:
    """Probabilities of models that are the only ones, from the logarithms of their evidence."""
    best = max(evidence)
    weights = [math.exp(max(one - best, -700.0)) for one in evidence]
    return [weight / sum(weights) for weight in weights]
