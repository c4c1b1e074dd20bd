"""Least squares with priors: Levenberg-Marquardt with bounds, Jacobian in parallel.

Parameters are counted in standard deviations of their priors (or in a typical size where they
have none) from where they start, so that one step fits all.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np
import scipy.stats
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Residuals = Callable[[Vector], Vector]

#: threads; the simulations leave the interpreter alone
WORKERS = 2
#: of a finite difference, in units of a parameter's size
_STEP = 1e-3
_MOST_ROUNDS = 12
_ENOUGH = 1e-4
#: groups from which a scatter between them can be told
_LEAST_GROUPS = 4


@dataclass(frozen=True)
class Parameter:
    """A number that is fitted.

    Parameters
    ----------
    name : str
        Path in the case, or name within an effect.
    start : float
        SI.
    size : float
        Standard deviation of the prior, or a typical size where there is none.
    lower, upper : float
    prior : bool
        Whether the start is a declared value with a standard deviation.
    unit : str
        SI unit, for reports.
    """

    name: str
    start: float
    size: float
    lower: float = -np.inf
    upper: float = np.inf
    prior: bool = True
    unit: str = ""


@dataclass(frozen=True, eq=False)
class Fit:
    """Result of a fit.

    Parameters
    ----------
    parameters : tuple of Parameter
    values : (p,) array of float
        SI.
    covariance : (p, p) array of float
        SI, from the residuals' own standard deviations and the priors.
    cost : float
        Sum of squares of the residuals, without priors.
    count : int
        Residuals.
    jacobian : (n, p) array of float
        At the solution, per size of a parameter.
    residuals : (n,) array of float
    """

    parameters: tuple[Parameter, ...]
    values: Vector
    covariance: NDArray[np.float64]
    cost: float
    count: int
    jacobian: NDArray[np.float64]
    residuals: Vector

    def interval(self, place: int) -> tuple[float, float]:
        """95 % confidence interval of a parameter, within its bounds."""
        parameter = self.parameters[place]
        half = 1.96 * float(np.sqrt(max(self.covariance[place, place], 0.0)))
        middle = float(self.values[place])
        return max(middle - half, parameter.lower), min(middle + half, parameter.upper)

    @property
    def by_name(self) -> dict[str, float]:
        """Values by name."""
        return {one.name: float(v) for one, v in zip(self.parameters, self.values, strict=True)}


def fit(
    parameters: Sequence[Parameter],
    residuals: Residuals,
    start: Vector | None = None,
    rounds: int = _MOST_ROUNDS,
    jacobian: NDArray[np.float64] | None = None,
) -> Fit:
    """Fit parameters to residuals that are scaled to a standard deviation of one.

    Parameters
    ----------
    parameters : sequence of Parameter
    residuals : callable
        (p,) values in SI -> (n,) residuals.
    start : (p,) array of float, optional
        SI; that of the parameters by default.
    rounds : int
        Steps at the most.
    jacobian : (n, p) array of float, optional
        Near the start, per size of a parameter, where it is known.

    Notes
    -----
    Between differences the Jacobian is brought up to date by Broyden's (1965) rank-one formula;
    differences are taken anew where a step gains less than half of what it promised.
    """
    chosen = tuple(parameters)
    size = np.array([one.size for one in chosen])
    origin = np.array([one.start for one in chosen])
    lower = np.array([one.lower for one in chosen])
    upper = np.array([one.upper for one in chosen])
    weight = np.array([1.0 if one.prior else 0.0 for one in chosen])
    values = np.clip(origin if start is None else start, lower, upper)
    now = residuals(values)
    damping = 1e-3

    def merit(r: Vector, v: Vector) -> float:
        return float(r @ r + weight @ ((v - origin) / size) ** 2)

    best, exact = merit(now, values), jacobian is None
    if jacobian is None:
        jacobian = differences(residuals, values, now, size, lower, upper)
    else:
        jacobian = jacobian.copy()
    for _ in range(rounds):
        normal = jacobian.T @ jacobian + np.diag(weight)
        slope = jacobian.T @ now + weight * (values - origin) / size
        gained = promised = 0.0
        for _ in range(8 if exact else 3):
            bent = normal + damping * np.diag(np.maximum(np.diag(normal), 1e-12))
            step = -np.linalg.solve(bent, slope) * size
            tried = np.clip(values + step, lower, upper)
            after = residuals(tried)
            reached = merit(after, tried)
            moved = (tried - values) / size
            if np.isfinite(reached) and reached < best:
                gained = best - reached
                promised = -float(2.0 * slope @ moved + moved @ normal @ moved)
                change = after - now - jacobian @ moved
                values, now, best = tried, after, reached
                damping = max(damping / 5.0, 1e-9)
                break
            damping *= 6.0
        enough = gained <= _ENOUGH * max(1.0, 1e-3 * best)
        if enough and exact:
            break
        if gained > 0.0:
            jacobian += np.outer(change, moved) / max(float(moved @ moved), 1e-300)
        exact = enough or gained < 0.5 * promised
        if exact:
            jacobian = differences(residuals, values, now, size, lower, upper)
            damping = min(damping, 1e-3)
    normal = jacobian.T @ jacobian + np.diag(weight)
    inverse = np.linalg.pinv(normal, hermitian=True)
    covariance = inverse * np.outer(size, size)
    return Fit(chosen, values, covariance, float(now @ now), now.size, jacobian, now)


def over_groups(fit: Fit, sizes: Sequence[int]) -> Fit:
    """Fit whose covariance allows for residuals that hang together within groups.

    Parameters
    ----------
    fit : Fit
    sizes : sequence of int
        Residuals in each group, in their order; the groups are independent of each other.

    Notes
    -----
    Where the groups pull a parameter about by more than white noise would let them, its standard
    deviation is that of the cluster-robust covariance (Liang and Zeger 1986, equation 4), with
    Student's t for the number of groups; elsewhere it stays as it is.
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


def differences(
    residuals: Residuals,
    values: Vector,
    now: Vector,
    size: Vector,
    lower: Vector,
    upper: Vector,
) -> NDArray[np.float64]:
    """Jacobian (n, p) per size of each parameter, by forward differences, in threads."""

    def column(place: int) -> Vector:
        moved = values.copy()
        step = _STEP * size[place]
        if moved[place] + step > upper[place]:
            step = -step
        moved[place] += step
        return (residuals(moved) - now) / (step / size[place])

    del lower
    with ThreadPoolExecutor(WORKERS) as pool:
        return np.array(list(pool.map(column, range(values.size)))).T.reshape(now.size, -1)
