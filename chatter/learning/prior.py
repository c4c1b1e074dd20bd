"""Values that are uncertain before any cut: Student's t about what is declared, within bounds.

A declared value scatters by its standard deviation as a rule and by much more now and then (Lange,
Little and Taylor 1989, J. Am. Stat. Assoc. 84:881). How far the modes of a turning tool are from
those at rest differs from machine to machine and is much the same for all modes of one: their
deviations have a scale in common, which is learnt with them (Gelman et al. 2013, Bayesian Data
Analysis, chapter 5).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import NDArray

from chatter.explain.cutting_tests.priors import FREEDOM
from chatter.explain.cutting_tests.wear import GradualWear, cut_times
from chatter.explain.kinds.milling import structural_paths
from chatter.explain.kinds.stability import SCATTER
from chatter.explain.measurement import Measurement
from chatter.explain.parameters import KnownByFactor, Parameter
from chatter.explain.selection.problem import Problem
from chatter.learning.idle_power import idle_power

Array = NDArray[np.float64]

#: name of the scatter of limits from test to test, which is learnt as well
SCATTER_OF_LIMITS = "scatter of limits"
#: a factor of two either way
_SCATTER_SIZE = SCATTER
#: tolerances, as shares, of modes that were found at rest
_OF_A_TURNING_TOOL = {"frequency": 0.02, "damping": 0.4}
#: scales that the deviations of such modes may have in common, each as likely as the others
_SCALES = np.geomspace(0.25, 2.0, 4)
#: growth by wear that would be a gain of sharpness, as a share
_LEAST_GROWTH = -0.1
#: probability next to the open ends of a distribution
_SMALLEST = 1e-9


@dataclass(frozen=True, eq=False)
class Prior:
    """Distributions of p parameters, counted in their sizes from where they start.

    They are independent, but for those that have an unknown scale in common. Those of an effect
    that may be absent are at `nothing`, all of them, in half of the particles.
    """

    parameters: tuple[Parameter, ...]
    lower: Array  # (p,), counted
    upper: Array  # (p,), counted
    optional: NDArray[np.bool_]  # (p,), of an effect that may be absent
    nothing: Array  # (p,), counted: where it is absent
    together: NDArray[np.bool_]  # (p,), of deviations that have a scale in common

    @property
    def names(self) -> list[str]:
        """Names of the parameters."""
        return [one.name for one in self.parameters]

    def draws(self, count: int, generator: np.random.Generator) -> Array:
        """Particles (n, p), counted: a Latin hypercube (McKay, Beckman and Conover 1979)."""
        cube = scipy.stats.qmc.LatinHypercube(len(self.parameters), seed=generator).random(count)
        scale = (
            generator.permutation(np.resize(_SCALES, count))[:, None]
            if self.together.any()
            else 1.0
        )
        scale = np.where(self.together, scale, 1.0)
        low, high = (scipy.stats.t.cdf(end / scale, FREEDOM) for end in (self.lower, self.upper))
        probability = np.clip(low + cube * (high - low), _SMALLEST, 1.0 - _SMALLEST)
        found = scale * scipy.stats.t.ppf(probability, FREEDOM)
        if self.optional.any():
            absent = np.arange(count) % 2 == 1
            found[np.ix_(absent, self.optional)] = self.nothing[self.optional]
        return found

    def fixed(self, counted: Array) -> NDArray[np.bool_]:
        """What of particles (n, p) is not to be moved: parameters of an effect that is absent."""
        if not self.optional.any():
            return np.zeros(counted.shape, dtype=bool)
        absent = np.all(counted[:, self.optional] == self.nothing[self.optional], axis=1)
        return absent[:, None] & self.optional

    def log_density(self, counted: Array) -> Array:
        """Logarithm (n,) of the density of particles (n, p), but for a constant."""
        fixed = self.fixed(counted)
        inside = np.all(fixed | ((counted >= self.lower) & (counted <= self.upper)), axis=1)
        each = np.where(fixed | self.together, 0.0, np.log1p(counted**2 / FREEDOM))
        log = -0.5 * (FREEDOM + 1.0) * each.sum(axis=1) + self._log_density_together(counted)
        return np.where(inside, log, -np.inf)

    def _log_density_together(self, counted: Array) -> Array:
        """Logarithm (n,) of the density of what has a scale in common, the mean over all scales."""
        if not self.together.any():
            return np.zeros(len(counted))
        lower, upper = self.lower[self.together], self.upper[self.together]
        scale = _SCALES[:, None]
        within = np.diff(scipy.stats.t.cdf([lower / scale, upper / scale], FREEDOM), axis=0)[0]
        each = scipy.stats.t.logpdf(counted[:, self.together] / scale[:, None], FREEDOM)
        of_scale = (each - np.log(scale * within)[:, None]).sum(axis=2)
        return scipy.special.logsumexp(of_scale, axis=0) - np.log(len(_SCALES))

    def values(self, counted: Array) -> dict[str, float]:
        """Values of one particle (p,) by name, SI."""
        return {
            one.name: float(one.value(number))
            for one, number in zip(self.parameters, counted, strict=True)
        }


def of_a_turning_tool(measurement: Measurement) -> Measurement:
    """Measurement with the tolerances of modes that were found at rest, where none is declared.

    A spindle that turns and cuts has other modes than at rest: frequencies by a percent or two,
    damping by much more.
    """
    declared, tolerances = measurement.case.deviations(), dict(measurement.tolerances)
    for path in structural_paths(measurement.case):
        key = path.rpartition(".")[2]
        if key in _OF_A_TURNING_TOOL and path not in declared and key not in tolerances:
            tolerances.setdefault(path, _OF_A_TURNING_TOOL[key])
    return replace(measurement, tolerances=tolerances)


def _assumed_of_modes(measurement: Measurement) -> list[str]:
    """Paths of modes that have the tolerance of those found at rest."""
    return [
        path
        for path in structural_paths(measurement.case)
        if measurement.tolerances.get(path)
        == _OF_A_TURNING_TOOL.get(path.rpartition(".")[2], np.nan)
    ]


def with_wear(problem: Problem) -> Problem:
    """Problem with wear where tests are at several cutting times and the case declares none."""
    times = cut_times(problem.measurement)
    if not times.size:
        return problem
    wear = GradualWear(times)
    return problem.with_effect(wear) if wear.applies(problem.measurement) else problem


def prior_of(problem: Problem) -> Prior:
    """Prior of the declared values of a problem, of its effects, scatter of limits and idle power.

    An effect may be absent: what wear does to process damping is told by few tests, and would be
    found where there is none.
    """
    parameters = [_with_prior(one) for one in problem.parameters()]
    parameters.append(KnownByFactor(SCATTER_OF_LIMITS, SCATTER, _SCATTER_SIZE, unit="1"))
    parameters += idle_power(problem.measurement)
    lower = np.array([_counted(one, one.lower, -np.inf) for one in parameters])
    upper = np.array([_counted(one, one.upper, np.inf) for one in parameters])
    names = tuple(f"{effect.name}." for effect in problem.effects)
    optional = np.array([bool(names) and one.name.startswith(names) for one in parameters])
    nothing = np.array(
        [one.counted(0.0) if own else 0.0 for one, own in zip(parameters, optional, strict=True)]
    )
    assumed = _assumed_of_modes(problem.measurement)
    together = np.array([one.name in assumed for one in parameters])
    return Prior(tuple(parameters), lower, upper, optional, nothing, together)


def _with_prior(one: Parameter) -> Parameter:
    """Parameter of wear with its typical growth as what is known before; others as they are."""
    return one if one.prior else replace(one, prior=True, lower=max(one.lower, _LEAST_GROWTH))


def _counted(one: Parameter, bound: float, unbounded: float) -> float:
    return one.counted(bound) if np.isfinite(bound) else unbounded
