"""Least squares of a force law to the mean forces of all cuts."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from chatter.cutting_coefficients.laws import TriedLaw, unit_forces
from chatter.cutting_coefficients.mean_forces import MeanForce, channels_of
from chatter.description.arrays import Array
from chatter.description.case import Case

#: exponents that a chip of metal has
_EXPONENTS, _FIRST_EXPONENT = (0.05, 1.0), 0.7
#: probability that a law that holds leaves more
_HOLDS = 0.01
#: change of an exponent for a difference
_STEP = 1e-4
#: singular value, over the largest, below which the cuts do not determine the coefficients
_RANK = 1e-6


@dataclass(frozen=True, eq=False)
class FittedLaw:
    """A law and how it fits the mean forces."""

    law: TriedLaw
    values: Array  # (n,), SI, as the keys of the law
    exponents: Array  # (p,)
    covariance: Array  # (n + p, n + p), coefficients and exponents
    signs: dict[str, float]  # of channels whose sense was unknown
    predicted: Array  # (m,) mean forces in the order of the measured ones, N
    chi_square: float

    def criterion(self, count: int) -> float:
        """Akaike's criterion for few data and a noise of unknown size; inf with too few data."""
        k = self.law.parameters + 1
        if count <= k + 1:
            return math.inf
        scatter = count * math.log(max(self.chi_square, 1e-12) / count)
        return scatter + 2.0 * k + 2.0 * k * (k + 1) / (count - k - 1)

    def leaves_more_than_scatter(self, count: int) -> bool | None:
        """Whether the law leaves more of so many readings than they scatter; None: none is free."""
        freedom = count - self.law.parameters
        if freedom <= 0:
            return None
        return bool(scipy.stats.chi2.sf(self.chi_square, freedom) <= _HOLDS)

    def mean_forces_of(self, means: Sequence[MeanForce], case: Case) -> Array:
        """Mean forces (m,) of readings of one cut, N."""
        cases = dict.fromkeys((one.run for one in means), case)
        return _rows(self.law, means, cases, self.signs, self.exponents) @ self.values

    @property
    def deviations(self) -> Array:
        """Standard deviation of each coefficient, and of the exponents."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))


def fitted_law(
    law: TriedLaw, means: Sequence[MeanForce], cases: dict[str, Case]
) -> FittedLaw | None:
    """Fit a law to mean forces of cuts by name; None where the cuts do not determine it."""
    unsigned = [name for name in channels_of(means) if _is_unsigned(means, name)]
    found = [
        one
        for choice in itertools.product((1.0, -1.0), repeat=len(unsigned))
        if (one := _of_signs(law, means, cases, dict(zip(unsigned, choice, strict=True))))
    ]
    if not found:
        return None
    # a turned channel fits as well, by coefficients that no metal has
    return min(found, key=lambda one: (_implausible(one), one.chi_square))


def _implausible(fit: FittedLaw) -> int:
    """How many of the coefficients are below zero, or radial ones above the tangential one."""
    cutting = fit.values[fit.law.cutting]
    return int(np.sum(cutting < 0.0)) + int(cutting[1] > cutting[0])


def _is_unsigned(means: Sequence[MeanForce], channel: str) -> bool:
    return any(not one.has_sign for one in means if one.channel == channel)


def _of_signs(
    law: TriedLaw, means: Sequence[MeanForce], cases: dict[str, Case], signs: dict[str, float]
) -> FittedLaw | None:
    def rows_at(exponents: Sequence[float]) -> Array:
        return _rows(law, means, cases, signs, exponents)

    exponents = np.full(law.exponent_count, _FIRST_EXPONENT)
    if len(means) < law.parameters or _solved(rows_at(exponents), means) is None:
        return None
    if exponents.size:
        exponents = scipy.optimize.least_squares(
            lambda p: _solved(rows_at(p), means).left, exponents, bounds=_EXPONENTS, x_scale=0.1
        ).x
    rows = rows_at(exponents)
    solution = _solved(rows, means)
    slopes = [
        (rows_at(exponents + step) - rows) @ solution.values / _STEP
        for step in -_STEP * np.eye(exponents.size)
    ]
    jacobian = np.column_stack([rows, *(-slope for slope in slopes)])
    return FittedLaw(
        law, solution.values, exponents, _covariance(jacobian, means, solution.chi_square), signs,
        rows @ solution.values, solution.chi_square,
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class _Solution:
    values: Array
    left: Array  # (m,), over the standard deviations

    @property
    def chi_square(self) -> float:
        return float(self.left @ self.left)


def _rows(
    law: TriedLaw, means: Sequence[MeanForce], cases: dict[str, Case], signs: dict[str, float],
    exponents: Sequence[float],
) -> Array:  # fmt: skip
    """Mean force of every reading (m, n) for coefficients of 1."""
    of_run = {name: unit_forces(law, case, exponents) for name, case in cases.items()}
    return np.array(
        [signs.get(one.channel, 1.0) * np.asarray(one.direction) @ of_run[one.run] for one in means]
    )


def _solved(rows: Array, means: Sequence[MeanForce]) -> _Solution | None:
    deviation = np.array([one.deviation for one in means])
    measured = np.array([one.value for one in means])
    scale = np.linalg.norm(rows, axis=0)
    if np.any(scale == 0.0):
        return None
    weighted = rows / scale / deviation[:, None]
    singular = np.linalg.svd(rows / scale, compute_uv=False)
    if singular[-1] < _RANK * singular[0]:
        return None
    values = np.linalg.lstsq(weighted, measured / deviation, rcond=None)[0] / scale
    return _Solution(values, (rows @ values - measured) / deviation)


def _covariance(jacobian: Array, means: Sequence[MeanForce], chi_square: float) -> Array:
    """Covariance, widened where the law leaves more than the readings scatter."""
    deviation = np.array([one.deviation for one in means])
    scale = np.linalg.norm(jacobian, axis=0)
    weighted = jacobian / scale / deviation[:, None]
    freedom = len(means) - jacobian.shape[1]
    wider = max(1.0, chi_square / freedom) if freedom > 0 else 1.0
    return np.linalg.pinv(weighted.T @ weighted) * wider / np.outer(scale, scale)
