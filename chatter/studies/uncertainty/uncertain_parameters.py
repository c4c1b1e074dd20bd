"""Values that a case or machine gives with a standard deviation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from chatter.description.arrays import Array
from chatter.description.errors import InputError
from chatter.studies.model import field_of, standard_deviations, value_of

if TYPE_CHECKING:
    from chatter.description.case import Case
    from chatter.studies.model import Model

#: of the open ends, where the quantile function is infinite or a bound itself
_SMALLEST = 1e-12


@dataclass(frozen=True)
class UncertainParameter:
    """A normal distribution, truncated to what the key allows and to the sign of its mean."""

    path: str
    mean: float  # of the normal distribution before it is truncated, SI
    deviation: float  # of the same, SI
    low: float = -np.inf  # bound, SI; infinite where there is none
    high: float = np.inf  # bound, SI; infinite where there is none

    def at(self, probability: Array) -> Array:
        """Quantiles (n,), SI, at probabilities between 0 and 1."""
        from scipy.stats import truncnorm

        ends = ((end - self.mean) / self.deviation for end in (self.low, self.high))
        inside = np.clip(probability, _SMALLEST, 1.0 - _SMALLEST)
        return truncnorm.ppf(inside, *ends, loc=self.mean, scale=self.deviation)


def parameters_of(model: Model) -> tuple[UncertainParameter, ...]:
    """Uncertain values of a case with its machine; InputError if there are none.

    `correlation_of` says how they go together.
    """
    found = []
    for path, deviation in standard_deviations(model).items():
        mean = float(value_of(model, path))
        found.append(UncertainParameter(path, mean, deviation, *_bounds(model, path, mean)))
    if not found:
        raise InputError(
            f"{model.name}: no value is uncertain; write its standard deviation, such as "
            'Ktc = "1650 +- 80 MPa", or --set material.Ktc="1650 +- 80 MPa"'
        )
    return tuple(found)


def correlation_of(case: Case, parameters: Sequence[UncertainParameter]) -> Array | None:
    """Correlation (p, p) of the normal distributions that [uncertainty] gives; None without.

    InputError if a path is not that of an uncertain value, or the coefficients contradict one
    another.
    """
    pairs = case.uncertainty.correlation if case.uncertainty else ()
    if not pairs:
        return None
    known = [one.path for one in parameters]
    matrix = np.eye(len(known))
    for index, pair in enumerate(pairs):
        where = f"{case.name}: uncertainty.correlation[{index}]"
        for number, path in enumerate(pair.between):
            if path not in known:
                raise InputError(
                    f"{where}.between[{number}]: {path} has no standard deviation; those that "
                    f"have are {', '.join(known)}"
                )
        i, j = (known.index(path) for path in pair.between)
        if i == j:
            raise InputError(f"{where}.between: {pair.between[0]} is there twice")
        matrix[i, j] = matrix[j, i] = pair.coefficient
    if np.linalg.eigvalsh(matrix)[0] < _SMALLEST:
        raise InputError(
            f"{case.name}: uncertainty.correlation: no distribution has all these coefficients "
            "together; make them smaller"
        )
    return matrix


def _bounds(model: Model, path: str, mean: float) -> tuple[float, float]:
    kind = field_of(model, path)
    low = [0.0 if mean > 0.0 else -np.inf]
    high = [0.0 if mean < 0.0 else np.inf]
    low += [end for end in (kind.above, kind.at_least) if end is not None]
    high += [end for end in (kind.below, kind.at_most) if end is not None]
    return max(low), min(high)
