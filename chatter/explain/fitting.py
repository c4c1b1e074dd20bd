"""Least squares with priors: a trust region, with a Jacobian that costs few simulations.

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

from chatter.explain.parameters import FREE_SIZES, Parameter

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Residuals = Callable[[Vector], Vector]

#: threads; the simulations leave the interpreter alone
WORKERS = 2
#: of a finite difference, in units of a parameter's size
_STEP = 1e-3
#: fall of the sum of squares that a step must promise, over the mean square, so that a fit goes on:
#: a sixth of a standard deviation of a parameter, and one where effects are compared, which asks
#: for eight; share of what is above the noise on top, as the last digits of a model that misfits
#: tell nothing; share of all of it where rough will do
_SMALLEST_GAIN, _SMALLEST_OF_NEAR = 0.03, 1.0
_SMALLEST_OF_MISFIT, _SMALLEST_OF_ROUGH = 1e-4, 3e-3
#: step, in sizes, below which a fit has converged
_SMALLEST_STEP = 1e-5
#: widest step, in sizes, at first; shares of what was promised below and above which it narrows and
#: widens, and by how much (Nocedal and Wright 2006, algorithm 4.1)
_FIRST_REGION = 100.0
_NARROWS, _WIDENS, _NARROWER, _WIDER = 0.25, 0.75, 0.25, 2.0
#: share of the widest step from which on a step is at the edge of the region, and room, in sizes,
#: that a step has at a bound
_AT_EDGE, _LEAST_ROOM = 0.99, 1e-12
#: of the largest eigenvalue of the normal matrix, below which a direction is not determined
_UNDETERMINED = 1e-14
#: share of what the Jacobian promised below which a step asks for new differences, where it is
#: a fall of the sum of squares that matters
_LEAST_OF_PROMISE, _LEAST_HOPED = 0.5, 1.0
#: steps tried at the most, without those of finite differences; where rough will do; those that
#: fail one after the other, by new differences
_MOST_STEPS, _MOST_ROUGH_STEPS, _MOST_FAILED = 30, 8, 6
#: groups from which a scatter between them can be told
_LEAST_GROUPS = 4


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
    def slopes(self) -> Vector:
        """Changes (p,) of the values with a size of each, SI."""
        return _slopes(self.parameters, self.values)

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
            one.weight * one.counted(float(value))
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
        widths *= self.slopes
        spread = np.linalg.eigvalsh(self.covariance * larger / np.outer(widths, widths))
        return 0.5 * float(np.sum(np.log(np.clip(spread, 1e-12, 1.0))))

    def interval(self, index: int) -> tuple[float, float]:
        """95 % confidence interval of a parameter, within its bounds."""
        parameter = self.parameters[index]
        half = 1.96 * float(np.sqrt(max(self.covariance[index, index], 0.0)))
        middle = float(self.values[index])
        return max(middle - half, parameter.lower), min(middle + half, parameter.upper)


@dataclass(frozen=True)
class LeastSquares:
    """Parameters (p,), and residuals (n,) of them that are scaled to a standard deviation of one.

    Coarse residuals differ from value to value nearly as the residuals do, for less; finite
    differences are theirs. A fit begins at values (p,) in SI, with a Jacobian (n, p) near them, per
    size of a parameter, where it is known.
    """

    parameters: Sequence[Parameter]
    residuals: Residuals
    coarse: Residuals | None = None

    def fit(self, start: Vector, jacobian: Matrix | None = None) -> Fit:
        """Fit to within a sixth of a standard deviation of the best."""
        return self._fit_within(_SMALLEST_GAIN, start, jacobian)

    def near_fit(self, start: Vector, jacobian: Matrix | None = None) -> Fit:
        """Fit to within a standard deviation: near enough to compare effects.

        Where the sum of squares is rough, most steps of a fit are for less.
        """
        return self._fit_within(_SMALLEST_OF_NEAR, start, jacobian)

    def rough_fit(self, start: Vector, jacobian: Matrix | None = None) -> Fit:
        """Fit as far as the Jacobian near the start leads when brought up to date.

        Near enough to rank candidates by, at a fraction of the simulations.
        """
        search = _Scaled(self, jacobian)
        search.begin(search.scaled(start))
        _followed(search, _MOST_ROUGH_STEPS, lambda: _SMALLEST_OF_ROUGH * search.cost)
        return _fit_at(search)

    def _fit_within(self, smallest: float, start: Vector, jacobian: Matrix | None) -> Fit:
        """Fit until a step promises no more than so much over the mean square."""
        search = _Scaled(self, jacobian)

        def negligible() -> float:
            return search.negligible(smallest)

        search.begin(search.scaled(start))
        most = _followed(search, _MOST_STEPS, negligible)
        while search.updates > 1 and most > 0:
            # what no longer gains by a Jacobian brought up to date may by differences
            search.take_differences()
            most = _followed(search, most, negligible)
        return _fit_at(search)


class _Scaled:
    """Residuals and priors over scaled parameters, and their Jacobian.

    Between finite differences the Jacobian is brought up to date by Broyden's (1965) rank-one
    formula: one simulation a step in place of one a parameter. Differences are taken anew where a
    step gained less than most of what the Jacobian promised.
    """

    def __init__(self, problem: LeastSquares, jacobian: Matrix | None) -> None:
        self.residuals_of = problem.residuals
        self.coarse_of = problem.coarse or problem.residuals
        self.parameters = parameters = problem.parameters
        self.lower = self.scaled(np.array([one.lower for one in parameters]))
        self.upper = self.scaled(np.array([one.upper for one in parameters]))
        self.held = np.array([one.weight for one in parameters]) ** 2
        self.at, self.now, self.cost = np.empty(0), np.empty(0), math.inf
        #: Jacobian of the residuals, and updates of it since differences
        self.known, self.updates = jacobian, 0 if jacobian is None else 1

    def scaled(self, values: Vector) -> Vector:
        """Parameters as counted in the search."""
        return np.array(
            [one.counted(float(v)) for one, v in zip(self.parameters, values, strict=True)]
        )

    def values(self, scaled: Vector) -> Vector:
        """Parameters in SI."""
        return np.array(
            [one.value(float(v)) for one, v in zip(self.parameters, scaled, strict=True)]
        )

    def begin(self, scaled: Vector) -> None:
        """Go to where a search begins."""
        self.at = np.clip(scaled, self.lower, self.upper)
        self.now = self.residuals_of(self.values(self.at))
        self.cost = self._cost(self.at, self.now)
        if self.known is None:
            self.take_differences()

    def _cost(self, scaled: Vector, residuals: Vector) -> float:
        """Sum of squares of the residuals, and of what the priors add."""
        return float(residuals @ residuals + self.held @ scaled**2)

    def negligible(self, smallest: float) -> float:
        """Fall of the sum of squares for which a further step does not pay.

        The smallest is that over the mean square where no misfit is on top.
        """
        count = max(self.now.size, 1)
        above = max(self.cost - count, 0.0)
        return smallest * self.cost / count + _SMALLEST_OF_MISFIT * above

    @property
    def normal(self) -> Matrix:
        """Normal matrix (p, p), priors counted."""
        return self.known.T @ self.known + np.diag(self.held)

    def step(self, region: float) -> tuple[Vector, float]:
        """Best step within bounds and so many sizes by the Jacobian, and the fall it promises."""
        normal = self.normal
        gradient = self.known.T @ self.now + self.held * self.at
        size, vectors = np.linalg.eigh(normal)
        root = np.sqrt(np.maximum(size, _UNDETERMINED * size[-1] + 1e-300))
        low = np.maximum(self.lower - self.at, -region)
        high = np.minimum(self.upper - self.at, region)
        found = scipy.optimize.lsq_linear(
            root[:, None] * vectors.T,
            -(vectors.T @ gradient) / root,
            # rounding may leave a point on its bound a bit beyond it
            (np.minimum(low, -_LEAST_ROOM), np.maximum(high, _LEAST_ROOM)),
            method="bvls",
        )
        step = np.clip(found.x, np.minimum(low, 0.0), np.maximum(high, 0.0))
        return step, -float(2.0 * gradient @ step + step @ normal @ step)

    def tried(self, step: Vector, promised: float) -> float:
        """Fall of the sum of squares by a step, which is taken if there is any."""
        there = np.clip(self.at + step, self.lower, self.upper)
        residuals = self.residuals_of(self.values(there))
        cost = self._cost(there, residuals)
        gained = self.cost - cost
        if gained > 0.0:
            moved, before = there - self.at, self.now
            self.at, self.now, self.cost = there, residuals, cost
            if promised > _LEAST_HOPED and gained < _LEAST_OF_PROMISE * promised:
                self.take_differences()
            else:
                change = residuals - before - self.known @ moved
                self.known = self.known + np.outer(change, moved / float(moved @ moved))
                self.updates += 1
        return gained

    def take_differences(self) -> None:
        """Make the Jacobian (n, p) anew by forward differences, in threads."""
        coarse = self.coarse_of is not self.residuals_of
        now = self.coarse_of(self.values(self.at)) if coarse else self.now

        def column(index: int) -> Vector:
            moved = self.at.copy()
            step = _STEP if moved[index] + _STEP <= self.upper[index] else -_STEP
            moved[index] += step
            return (self.coarse_of(self.values(moved)) - now) / step

        known = np.empty((now.size, self.at.size), order="F")
        with ThreadPoolExecutor(WORKERS) as pool:
            for index, found in enumerate(pool.map(column, range(self.at.size))):
                known[:, index] = found
        self.known, self.updates = known, 0


def _followed(search: _Scaled, most: int, negligible: Callable[[], float]) -> int:
    """Follow the trust region for so many steps at the most, and return how many are left.

    It ends where a step promises no more than what is negligible, or new differences do not help.
    """
    region, failed = _FIRST_REGION, 0
    while most > 0 and search.at.size:
        step, promised = search.step(region)
        if promised <= negligible():
            break
        fresh = not search.updates
        gained = search.tried(step, promised)
        most -= 1
        size = float(np.max(np.abs(step)))
        failed = failed + 1 if gained <= 0.0 and fresh else 0
        if size < _SMALLEST_STEP or failed == _MOST_FAILED:
            break
        if gained < _NARROWS * promised:
            region = _NARROWER * size
        elif gained > _WIDENS * promised and size > _AT_EDGE * region:
            region *= _WIDER
        if gained <= 0.0 and search.updates:
            search.take_differences()
    return most


def _fit_at(search: _Scaled) -> Fit:
    """Fit with the covariance by the Jacobian that is known."""
    inverse = np.linalg.pinv(search.normal, hermitian=True)
    values = search.values(search.at)
    slopes = _slopes(search.parameters, values)
    return Fit(
        tuple(search.parameters),
        values,
        inverse * np.outer(slopes, slopes),
        search.known,
        search.now,
    )


def _slopes(parameters: Sequence[Parameter], values: Vector) -> Vector:
    """Changes (p,) of values with a size of each."""
    return np.array([one.slope(float(v)) for one, v in zip(parameters, values, strict=True)])


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
    inverse = fit.covariance / np.outer(fit.slopes, fit.slopes)
    spread = inverse @ (pulls.T @ pulls) @ inverse * groups / (groups - 1)
    wider = scipy.stats.t.ppf(0.975, groups - 1) / 1.96
    own = np.maximum(np.diag(inverse), 1e-300)
    factor = np.maximum(1.0, wider * np.sqrt(np.maximum(np.diag(spread), 0.0) / own))
    return replace(fit, covariance=fit.covariance * np.outer(factor, factor))
