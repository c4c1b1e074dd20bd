"""Least squares with priors: scipy's trust region, with a Jacobian that costs few simulations.

Parameters are counted in standard deviations of their priors (or in a typical size where they
have none) from where they start, so that one step fits all. A prior is one more row of residuals.
"""

import math
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import NDArray

from chatter.explain.measurement import Measurement

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Residuals = Callable[[Vector], Vector]

#: threads; the simulations leave the interpreter alone
WORKERS = 2
#: of a finite difference, in units of a parameter's size
_STEP = 1e-3
#: change of the sum of squares, and step over the sizes, below which a fit has converged
_SMALLEST_GAIN, _SMALLEST_STEP = 1e-7, 1e-7
#: scipy's first trust region is as large as the start is far from zero, which starts are moved to
_FIRST_REGION = 100.0
#: share of what the Jacobian promised below which a step asks for new differences, where it is
#: a fall of the sum of squares that matters
_LEAST_OF_PROMISE, _LEAST_HOPED = 0.8, 1.0
#: steps tried at the most, without those of finite differences
_MOST_STEPS = 30
#: standard deviation, in sizes, of a parameter that has no declared value and begins at nothing:
#: of values that the data do not tell apart, the smallest
FREE_SIZES = 30.0
#: groups from which a scatter between them can be told
_LEAST_GROUPS = 4


@dataclass(frozen=True)
class Parameter:
    """A number that is fitted."""

    name: str  # path in the case, or name within an effect
    start: float  # SI
    size: float  # standard deviation of the prior, or a typical size where there is none
    lower: float = -np.inf
    upper: float = np.inf
    prior: bool = True  # whether the start is a declared value with a standard deviation
    unit: str = ""  # SI unit, for reports

    @property
    def weight(self) -> float:
        """Weight of the row that holds it near its start; 0 where nothing does."""
        if self.prior:
            return 1.0
        return 1.0 / FREE_SIZES if self.start == 0.0 else 0.0

    def counted(self, value: float) -> float:
        """Distance of a value from the start, in sizes."""
        return (value - self.start) / self.size

    def value(self, counted: float) -> float:
        """Value at a distance from the start that is counted in sizes."""
        return self.start + counted * self.size

    def per_size(self, counted: float) -> float:  # noqa: ARG002
        """Change of the value with a size, at a distance from the start."""
        return self.size


@dataclass(frozen=True)
class KnownByFactor(Parameter):
    """A positive number that is known by a factor, 1 + size/start, up or down.

    Its logarithm scatters: twice as much as declared is as far as half of it.
    """

    @property
    def _unit_of_logarithm(self) -> float:
        return math.log1p(self.size / self.start)

    def counted(self, value: float) -> float:
        """Logarithm of the factor, in that of the declared one."""
        if value <= 0.0:
            return -math.inf
        return math.log(value / self.start) / self._unit_of_logarithm

    def value(self, counted: float) -> float:
        """Value at so many factors."""
        return self.start * np.exp(counted * self._unit_of_logarithm)

    def per_size(self, counted: float) -> float:
        """Change of the value with a factor more."""
        return self.value(counted) * self._unit_of_logarithm


def by_factor(one: Parameter) -> KnownByFactor:
    """Return a positive parameter as known by a factor."""
    return KnownByFactor(one.name, one.start, one.size, one.lower, one.upper, one.prior, one.unit)


@dataclass(frozen=True, eq=False)
class Fit:
    """Result of a fit of p parameters to n residuals."""

    parameters: tuple[Parameter, ...]
    values: Vector  # (p,), SI
    covariance: Matrix  # (p, p), SI, from the residuals' own standard deviations and the priors
    jacobian: Matrix  # (n, p), at the solution, per size of a parameter
    residuals: Vector  # (n,)

    @property
    def cost(self) -> float:
        """Sum of squares of the residuals, without priors."""
        return float(self.residuals @ self.residuals)

    @property
    def by_name(self) -> dict[str, float]:
        """Values by name."""
        return {one.name: float(v) for one, v in zip(self.parameters, self.values, strict=True)}

    @property
    def pulls(self) -> dict[str, float]:
        """Standard deviations by which declared values have moved, by name."""
        return {
            one.name: one.counted(float(value))
            for one, value in zip(self.parameters, self.values, strict=True)
            if one.prior
        }

    @property
    def log_prior(self) -> float:
        """Logarithm of the prior at the solution, over that at the start."""
        moved = [
            one.weight * (value - one.start) / one.size
            for one, value in zip(self.parameters, self.values, strict=True)
        ]
        return -0.5 * float(np.dot(moved, moved))

    @property
    def log_volume(self) -> float:
        """Logarithm of the volume of the posterior over that of the prior.

        The noise is taken for as large as the residual is, where that is larger.
        """
        if not self.parameters:
            return 0.0
        larger = max(1.0, self.cost / max(self.residuals.size, 1))
        widths = np.array([1.0 if one.prior else FREE_SIZES for one in self.parameters])
        widths *= np.array([one.size for one in self.parameters])
        spread = np.linalg.eigvalsh(self.covariance * larger / np.outer(widths, widths))
        return 0.5 * float(np.sum(np.log(np.clip(spread, 1e-12, 1.0))))

    def interval(self, index: int) -> tuple[float, float]:
        """95 % confidence interval of a parameter, within its bounds."""
        parameter = self.parameters[index]
        half = 1.96 * float(np.sqrt(max(self.covariance[index, index], 0.0)))
        middle = float(self.values[index])
        return max(middle - half, parameter.lower), min(middle + half, parameter.upper)


class _Scaled:
    """Residuals and priors over scaled parameters, and their Jacobian.

    Between finite differences the Jacobian is brought up to date by Broyden's (1965) rank-one
    formula: one simulation a step in place of one a parameter. Differences are taken anew where a
    step gained less than most of what the Jacobian promised.
    """

    def __init__(
        self, parameters: Sequence[Parameter], residuals: Residuals, jacobian: Matrix | None
    ) -> None:
        self.residuals_of = residuals
        self.size = np.array([one.size for one in parameters])
        self.origin = np.array([one.start for one in parameters])
        self.lower = self.scaled(np.array([one.lower for one in parameters]))
        self.upper = self.scaled(np.array([one.upper for one in parameters]))
        weight = np.array([one.weight for one in parameters])
        self.priors = np.diag(weight)[weight > 0.0]
        self.latest: tuple[Vector, Vector] | None = None
        #: Jacobian of the residuals, where it is from, the rows there, updates since differences
        self.known, self.at, self.then = jacobian, None, np.empty(0)
        self.updates = 0 if jacobian is None else 1

    def scaled(self, values: Vector) -> Vector:
        """Parameters as counted in the search."""
        return (values - self.origin) / self.size + _FIRST_REGION

    def values(self, scaled: Vector) -> Vector:
        """Parameters in SI."""
        return self.origin + (scaled - _FIRST_REGION) * self.size

    def residuals(self, scaled: Vector) -> Vector:
        """Residuals (n,), those of the point before kept."""
        if self.latest is None or not np.array_equal(scaled, self.latest[0]):
            self.latest = scaled.copy(), self.residuals_of(self.values(scaled))
        return self.latest[1]

    def rows(self, scaled: Vector) -> Vector:
        """Residuals, then what the priors add."""
        return np.concatenate([self.residuals(scaled), self.priors @ (scaled - _FIRST_REGION)])

    def jacobian(self, scaled: Vector) -> Matrix:
        """Rows by parameters, at the last point that was accepted."""
        now = self.rows(scaled)
        if self.at is not None and not np.array_equal(scaled, self.at):
            moved = scaled - self.at
            promised = self.then + np.vstack([self.known, self.priors]) @ moved
            before = self.then @ self.then
            hoped = before - promised @ promised
            if hoped > _LEAST_HOPED and before - now @ now < _LEAST_OF_PROMISE * hoped:
                self.known = None
            else:
                change = (now - promised)[: len(self.known)]
                self.known = self.known + np.outer(change, moved) / float(moved @ moved)
                self.updates += 1
        if self.known is None:
            self.known, self.updates = self.differences(scaled), 0
        self.at, self.then = scaled.copy(), now
        return np.vstack([self.known, self.priors])

    def differences(self, scaled: Vector) -> Matrix:
        """Forward differences (n, p), in threads."""
        now = self.residuals(scaled)

        def column(index: int) -> Vector:
            moved = scaled.copy()
            step = _STEP if moved[index] + _STEP <= self.upper[index] else -_STEP
            moved[index] += step
            return (self.residuals_of(self.values(moved)) - now) / step

        with ThreadPoolExecutor(WORKERS) as pool:
            return np.array(list(pool.map(column, range(scaled.size)))).T.reshape(now.size, -1)

    def forget_jacobian(self) -> None:
        """Have differences taken next, where the point does not change."""
        self.known, self.at = None, None


def fit(
    parameters: Sequence[Parameter],
    residuals: Residuals,
    start: Vector,
    jacobian: Matrix | None = None,
) -> Fit:
    """Fit parameters to residuals that are scaled to a standard deviation of one.

    Residuals make (n,) of the values (p,) in SI, as the start is. The Jacobian (n, p), near the
    start, per size of a parameter, is given where it is known.
    """
    problem = _Scaled(parameters, residuals, jacobian)
    scaled, most = _followed(problem, problem.scaled(start), _MOST_STEPS)
    while problem.updates > 1 and most > 0:
        # what no longer gains by a Jacobian brought up to date may by differences
        problem.forget_jacobian()
        scaled, most = _followed(problem, scaled, most)
    return _fit_at(problem, parameters, scaled)


def rough_fit(
    parameters: Sequence[Parameter],
    residuals: Residuals,
    start: Vector,
    jacobian: Matrix | None = None,
) -> Fit:
    """Fit as `fit` does, as far as the Jacobian near the start leads when brought up to date.

    Near enough to rank candidates by, at a fraction of the simulations.
    """
    problem = _Scaled(parameters, residuals, jacobian)
    scaled, _ = _followed(problem, problem.scaled(start), _MOST_STEPS)
    return _fit_at(problem, parameters, scaled)


def _followed(problem: _Scaled, scaled: Vector, most: int) -> tuple[Vector, int]:
    """Where the trust region leads within so many steps, and how many are left."""
    scaled = np.clip(scaled, problem.lower, problem.upper)
    if not scaled.size:
        return scaled, most
    found = scipy.optimize.least_squares(
        problem.rows,
        scaled,
        problem.jacobian,
        bounds=(problem.lower, problem.upper),
        # bounds as active sets: many effects start at a bound, zero
        method="dogbox",
        ftol=_SMALLEST_GAIN,
        xtol=_SMALLEST_STEP,
        gtol=None,
        max_nfev=most + 1,
    )
    return found.x, most - (found.nfev - 1)


def _fit_at(problem: _Scaled, parameters: Sequence[Parameter], scaled: Vector) -> Fit:
    """Fit with the covariance by the Jacobian that is known."""
    rows = problem.jacobian(scaled)
    inverse = np.linalg.pinv(rows.T @ rows, hermitian=True)
    return Fit(
        tuple(parameters),
        problem.values(scaled),
        inverse * np.outer(problem.size, problem.size),
        problem.known,
        problem.residuals(scaled),
    )


def over_groups(fit: Fit, sizes: Sequence[int]) -> Fit:
    """Fit whose covariance allows for residuals that hang together within groups.

    Sizes are the numbers of residuals in each group, in their order; the groups are independent of
    each other. Where they pull a parameter about by more than white noise would let them, its
    standard deviation is that of the cluster-robust covariance (Liang and Zeger 1986, equation 4),
    with Student's t for the number of groups; elsewhere it stays as it is.
    """
    groups = len(sizes)
    if groups < _LEAST_GROUPS:
        return fit
    ends = np.cumsum(sizes)
    pulls = np.array(
        [
            fit.jacobian[end - size : end].T @ fit.residuals[end - size : end]
            for size, end in zip(sizes, ends, strict=True)
        ]
    )
    pulls -= pulls.mean(axis=0)
    size = np.array([one.size for one in fit.parameters])
    inverse = fit.covariance / np.outer(size, size)
    spread = inverse @ (pulls.T @ pulls) @ inverse * groups / (groups - 1)
    wider = scipy.stats.t.ppf(0.975, groups - 1) / 1.96
    own = np.maximum(np.diag(inverse), 1e-300)
    factor = np.maximum(1.0, wider * np.sqrt(np.maximum(np.diag(spread), 0.0) / own))
    return replace(fit, covariance=fit.covariance * np.outer(factor, factor))


#: last key of a path -> relative standard deviation of a declared value
TOLERANCES = {
    "frequency": 0.02,
    "damping": 0.20,
    "mass": 0.08,
    "stiffness": 0.10,
    "Ktc": 0.10,
    "Krc": 0.10,
    "Kac": 0.10,
    "Kte": 0.15,
    "Kre": 0.15,
    "Kae": 0.15,
    "coefficient": 0.20,
    "offset": 0.20,
    "moving_mass": 0.10,
    "viscous_friction": 0.15,
    "coulomb_friction": 0.10,
}
_OTHERS = 0.05


def with_priors(measurement: Measurement, paths: Sequence[str]) -> list[Parameter]:
    """Declared values as parameters with a prior.

    The standard deviation is that of the measurement's [tolerance], by path or last key, or that
    written in the case ("1650 +- 80 MPa"), or a few percent by the kind of value. A value that is
    named in [tolerance] by its whole path, such as tool.helix, is one of them too.
    """
    declared = measurement.case.deviations()
    found = []
    named = [path for path in measurement.tolerances if "." in path]
    for path in dict.fromkeys([*paths, *named]):
        value = float(measurement.case.get(path))
        key = path.rpartition(".")[2]
        share = measurement.tolerances.get(path, measurement.tolerances.get(key))
        if share is not None:
            deviation = share * abs(value)
        elif path in declared:
            deviation = declared[path]
        else:
            deviation = TOLERANCES.get(key, _OTHERS) * abs(value)
        if deviation > 0.0:
            lowest = 0.02 * value if value > 0.0 else -np.inf
            found.append(Parameter(path, value, deviation, lower=lowest))
    return found
