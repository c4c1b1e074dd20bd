"""Particles of the posterior: sequential Monte Carlo with tempering and Markov chains.

From the prior, or from what earlier tests left, the likelihood of new tests is brought in by steps
that keep a share of the particles alive (Del Moral, Doucet and Jasra 2006, J. R. Stat. Soc. B
68:411). After each, particles are drawn by their weights and moved. What costs is the prediction of
the tests, which is smooth in the parameters: chains of many steps over a regression propose, and
one prediction decides (surrogate transition, Liu 2001, Monte Carlo Strategies in Scientific
Computing, section 9.4.3). A chain forgets where it began, so that a particle that moved once is a
new one. An effect that may be absent is so in some of the particles (a spike beside a slab,
Mitchell and Beauchamp 1988, J. Am. Stat. Assoc. 83:1023): weights deal out between both.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import NDArray

from chatter.learning.likelihood import Likelihood
from chatter.learning.prior import Prior

Array = NDArray[np.float64]
Progress = Callable[[str, float], None]

#: effective share of the particles that a step leaves
_EFFECTIVE = 0.35
#: moves that every particle should have accepted after a step, on average, after the last step,
#: and tries at the most
_ACCEPTED, _ACCEPTED_LAST, _MOST_TRIES = 0.5, 1.0, 4
#: steps of a chain over the regression, and their length over the spread of the particles
_CHAIN, _LENGTH = 60, 1.2
#: ridge of the regression, as a share of the particles; particles that it takes for a column, at
#: the least and at the most, and clouds of particles that are kept for it
_RIDGE, _FOR_A_COLUMN, _MOST_FOR_A_COLUMN, _CLOUDS = 1e-4, 1.5, 3.0, 4
#: standard deviations from the middle within which the regression bends
_FURTHEST = 3.0


@dataclass(frozen=True, eq=False)
class Particles:
    """Equally likely particles.

    Parameters
    ----------
    prior : Prior
    counted : (n, p) array of float
        Values, in sizes of the parameters from where they start.
    tests : int
        That they have learnt from, in the order of the table.
    log_evidence : float
        Logarithm of the probability of what was read in the tests, by the model of the particles.
    """

    prior: Prior
    counted: Array
    tests: int = 0
    log_evidence: float = 0.0

    def values(self) -> list[dict[str, float]]:
        """Values of every particle by name, SI."""
        return [self.prior.values(row) for row in self.counted]

    def some(self, most: int) -> Particles:
        """As many as given, of all alike."""
        chosen = np.unique(np.linspace(0, len(self.counted) - 1, most).round().astype(np.intp))
        return replace(self, counted=self.counted[chosen])

    def columns(self) -> dict[str, Array]:
        """Values (n,) of every parameter by name, SI."""
        rows = self.values()
        return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def prior_particles(prior: Prior, count: int, generator: np.random.Generator) -> Particles:
    """Particles before any test."""
    return Particles(prior, prior.draws(count, generator))


def updated(
    before: Particles,
    likelihood: Likelihood,
    generator: np.random.Generator,
    progress: Progress = lambda *_: None,
) -> Particles:
    """Particles after all tests of a likelihood, from those that its first tests left."""
    chains = _Chains(before, likelihood, generator)
    while chains.share < 1.0:
        chains.step()
        progress("learning from the tests", chains.share)
    evidence = before.log_evidence + chains.log_evidence
    return Particles(before.prior, chains.counted, 1 + int(likelihood.test.max()), evidence)


class _Chains:
    """Particles on their way from the likelihood of the first tests to that of all."""

    def __init__(
        self, before: Particles, likelihood: Likelihood, generator: np.random.Generator
    ) -> None:
        self.prior, self.likelihood, self.generator = before.prior, likelihood, generator
        self.first = likelihood.test < before.tests
        self.share, self.log_evidence = 0.0, 0.0
        self.counted = before.counted
        self.predictions = likelihood.predictions(self.counted)
        #: particles predicted lately, and their predictions
        self.known = [(self.counted, self.predictions)]

    def step(self) -> None:
        """Bring in as much of the likelihood as leaves half of the particles alive; move them."""
        each = self.likelihood.of(self.predictions, self.counted)
        change, rest = each[:, ~self.first].sum(axis=1), 1.0 - self.share
        part = rest
        if _effective(rest * change) < _EFFECTIVE:
            part = float(
                scipy.optimize.brentq(lambda b: _effective(b * change) - _EFFECTIVE, 0.0, rest)
            )
        self.share = 1.0 if part == rest else self.share + part
        self.log_evidence += _log_mean(part * change)
        chosen = self._drawn(part * change)
        self.counted, self.predictions = self.counted[chosen], self.predictions[chosen]
        wanted = _ACCEPTED_LAST if self.share == 1.0 else _ACCEPTED
        accepted = 0.0
        for _ in range(_MOST_TRIES):
            accepted += self._move()
            if accepted >= wanted:
                return

    def _drawn(self, log_weight: Array) -> NDArray[np.intp]:
        """Systematic resampling (Kitagawa 1996, J. Comput. Graph. Stat. 5:1)."""
        weight = np.exp(log_weight - log_weight.max())
        count = weight.size
        ends = np.cumsum(weight / weight.sum())
        at = (np.arange(count) + self.generator.random()) / count
        return np.minimum(np.searchsorted(ends, at), count - 1)

    def _density(self, predictions: Array, counted: Array) -> Array:
        """Logarithm (n,) of what is sampled now: prior, first tests, a share of the others."""
        prior = self.prior.log_density(counted)
        each = self.likelihood.of(predictions, counted)
        tempered = np.where(self.first, 1.0, self.share)
        return np.where(np.isfinite(prior), prior + each @ tempered, -np.inf)

    def _move(self) -> float:
        """Move every particle along a chain over the regression; the share that went."""
        nearly = self._regression()
        trial = self._along_chain(nearly)
        predictions = self.likelihood.predictions(trial)
        self.known = [*self.known[1 - _CLOUDS :], (trial, predictions)]
        gain = self._density(predictions, trial) - self._density(self.predictions, self.counted)
        hoped = self._density(nearly(trial), trial) - self._density(
            nearly(self.counted), self.counted
        )
        goes = np.log(self.generator.random(gain.size)) < gain - hoped
        self.counted = np.where(goes[:, None], trial, self.counted)
        self.predictions = np.where(goes[:, None], predictions, self.predictions)
        return float(goes.mean())

    def _regression(self) -> _Regression:
        """Regression by the particles predicted lately that are the likeliest now."""
        counted, predictions = (
            np.concatenate([cloud[k] for cloud in self.known]) for k in range(2)
        )
        usable = np.flatnonzero(np.all(np.isfinite(predictions), axis=1))
        counted, predictions = counted[usable], predictions[usable]
        density = self._density(predictions, counted)
        columns = _Regression.columns(counted.shape[1])
        best = np.argsort(-density)[: max(len(self.counted), round(_MOST_FOR_A_COLUMN * columns))]
        return _Regression(counted[best], predictions[best])

    def _along_chain(self, nearly: _Regression) -> Array:
        """Particles moved by Metropolis' rule as if the regression were true."""
        now = self.counted
        free = ~self.prior.fixed(now)
        steps = _Steps(now, free)
        density = self._density(nearly(now), now)
        count = len(now)
        for _ in range(_CHAIN):
            trial = now + steps.drawn(self.generator)
            then = self._density(nearly(trial), trial)
            goes = np.log(self.generator.random(count)) < then - density
            now, density = np.where(goes[:, None], trial, now), np.where(goes, then, density)
        return now


class _Steps:
    """Steps (n, p) of particles, as long as these spread; of none in what is held."""

    def __init__(self, counted: Array, free: NDArray[np.bool_]) -> None:
        self.shape = counted.shape
        self.kinds: list[tuple[NDArray[np.bool_], NDArray[np.intp], Array]] = []
        for pattern in np.unique(free, axis=0):
            own, columns = np.all(free == pattern, axis=1), np.flatnonzero(pattern)
            if not columns.size:
                continue
            # too few to spread in all directions: as all of them do
            alike = own if own.sum() > 2 * columns.size else np.ones(len(counted), dtype=bool)
            spread = np.cov(counted[np.ix_(alike, columns)], rowvar=False).reshape(
                columns.size, columns.size
            )
            factor = np.linalg.cholesky(spread + 1e-10 * np.eye(columns.size)).T
            self.kinds.append((own, columns, factor * (_LENGTH / math.sqrt(columns.size))))

    def drawn(self, generator: np.random.Generator) -> Array:
        """Draw a step for every particle."""
        found = np.zeros(self.shape)
        for own, columns, factor in self.kinds:
            normal = generator.standard_normal((int(own.sum()), columns.size))
            found[np.ix_(own, columns)] = normal @ factor
        return found


class _Regression:
    """Predictions as polynomials of second order in the parameters, by those of some particles."""

    def __init__(self, counted: Array, predictions: Array) -> None:
        self.middle, count = counted.mean(axis=0), len(counted)
        self.width = counted.std(axis=0) + 1e-12
        size = counted.shape[1]
        self.pairs = np.triu_indices(size)
        # planes only, where particles are too few to tell how they bend
        self.bends = count >= _FOR_A_COLUMN * self.columns(size)
        rows = self._rows(counted)
        ridge = _RIDGE * count * np.eye(rows.shape[1])
        self.slopes = np.linalg.solve(rows.T @ rows + ridge, rows.T @ predictions)

    @staticmethod
    def columns(size: int) -> int:
        """Columns for so many parameters."""
        return 1 + size + size * (size + 1) // 2

    def __call__(self, counted: Array) -> Array:
        """Predictions (n, r) of particles (n, p)."""
        return self._rows(counted) @ self.slopes

    def _rows(self, counted: Array) -> Array:
        scaled = (counted - self.middle) / self.width
        one = np.ones((len(scaled), 1))
        if not self.bends:
            return np.hstack([one, scaled])
        # far out a square would run away
        near = np.clip(scaled, -_FURTHEST, _FURTHEST)
        first, second = self.pairs
        return np.hstack([one, scaled, near[:, first] * near[:, second]])


def _log_mean(log_weight: Array) -> float:
    """Logarithm of the mean of weights."""
    largest = float(log_weight.max())
    return largest + math.log(float(np.mean(np.exp(log_weight - largest))))


def _effective(log_weight: Array) -> float:
    """Effective share of weighted particles (Kong, Liu and Wong 1994, J. Am. Stat. Assoc. 89)."""
    weight = np.exp(log_weight - log_weight.max())
    return float(weight.sum() ** 2 / np.sum(weight**2) / weight.size)
