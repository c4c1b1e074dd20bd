"""Inertia, viscous and Coulomb friction by linear least squares.

tau = J w' + mu w + tau_st sgn(w) + offset: the model of "Towards digital twins through
object-oriented modelling: a machine tool case study", eq. 1, which solves it "in the minimum
square sense". It has no presliding, so samples about zero speed are left out.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dynamics.frf.container import MeasurementError
from dynamics.friction.identification.filtering import LowPass
from dynamics.friction.identification.intervals import Estimate, covariance, estimate
from dynamics.friction.identification.record import DriveRecord

_SINGULAR = 1e-6


def _forward(v: NDArray[np.float64]) -> NDArray[np.float64]:
    return (v > 0.0).astype(np.float64)


#: column of each term, from velocity and acceleration
_COLUMNS = {
    "inertia": lambda v, a: a,  # noqa: ARG005
    "viscous": lambda v, a: v,  # noqa: ARG005
    "coulomb": lambda v, a: np.sign(v),  # noqa: ARG005
    "offset": lambda v, a: np.ones_like(v),  # noqa: ARG005
    "viscous_forward": lambda v, a: v * _forward(v),  # noqa: ARG005
    "viscous_backward": lambda v, a: v * _forward(-v),  # noqa: ARG005
    "coulomb_forward": lambda v, a: _forward(v),  # noqa: ARG005
    "coulomb_backward": lambda v, a: -_forward(-v),  # noqa: ARG005
}

#: names of the terms a linear model may have
TERMS = tuple(_COLUMNS)


@dataclass(frozen=True)
class LinearFriction:
    """Terms found by `fit_linear`."""

    #: fitted terms: inertia (kg or kg m^2), viscous (N s/m or N m s), coulomb, offset (N, N m)
    estimates: dict[str, Estimate]
    fixed: dict[str, float]  # terms that were given
    residual: float  # rms of the residual of the low-passed effort, N or N m
    relative_residual: float  # over the standard deviation of the low-passed effort
    #: share of noise in the variance of the derived acceleration: about the fraction by which the
    #: inertia comes out too small; 0 where acceleration was measured
    attenuation: float
    #: condition number of the columns scaled to length 1; large where terms resemble each other
    conditioning: float
    samples: int  # that took part

    def value(self, term: str) -> float:
        """Value of a term, fitted or given; 0 where the model has none."""
        if term in self.estimates:
            return self.estimates[term].value
        return self.fixed.get(term, 0.0)

    def effort(
        self, velocity: NDArray[np.float64], acceleration: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Effort (n,) of a motion with velocity and acceleration (n,)."""
        return sum(
            self.value(term) * column(velocity, acceleration)
            for term, column in _COLUMNS.items()
            if term in self.estimates or term in self.fixed
        ) + np.zeros_like(velocity)


def fit_linear(
    records: Sequence[DriveRecord],
    terms: Sequence[str] = ("inertia", "viscous", "coulomb", "offset"),
    *,
    low_pass: LowPass,
    minimum_speed: float,
    fixed: Mapping[str, float] | None = None,
) -> LinearFriction:
    """Fit the terms of eq. 1 to drive records, in the same units.

    Terms to be found are of `TERMS`; a law of its own for each direction is asked for by
    ``coulomb_forward``, ``coulomb_backward`` and the like. Fixed are terms that are known, e.g. a
    weighed mass. The low-pass acts alike on the effort and on every column. Samples slower than the
    minimum speed, m/s or rad/s, and those the filter mixes with them are left out: presliding and
    Stribeck effects are not in the model. MeasurementError if too few samples move fast enough, or
    the motion cannot tell terms apart; ValueError if a term is unknown or both wanted and given.
    """
    fixed = dict(fixed or {})
    _check_terms(terms, fixed)
    if not records:
        raise MeasurementError("drive records: none given")
    columns, efforts, noise, moving = [], [], [], []
    for record in records:
        made = _filtered(record, (*terms, *fixed), low_pass)
        slow = np.abs(record.velocity) < minimum_speed
        kept = ~record.near(slow, low_pass.settling) & ~record.near_excluded(low_pass.settling)
        columns.append(made[kept, 1:])
        efforts.append(made[kept, 0])
        noise.append(_acceleration_noise(record, low_pass))
        moving.append(np.count_nonzero(kept))
    table = np.concatenate(columns)
    full = np.concatenate(efforts)
    count = len(terms)
    if len(full) < 10 * max(count, 1):
        raise MeasurementError(
            f"{records[0].name}: {len(full)} samples move faster than {minimum_speed:g} away from "
            f"rest; {count} terms need at least {10 * count}"
        )
    known = table[:, count:] @ np.array([fixed[name] for name in fixed])
    matrix = table[:, :count]
    wanted = full - known
    size, conditioning = _conditioning(matrix, terms, records[0].name)
    values = np.linalg.lstsq(matrix / size, wanted, rcond=None)[0] / size
    left = matrix @ values - wanted
    spread, freedom = covariance(matrix, left)
    attenuation = 0.0
    if "inertia" in terms:
        power = float(np.average(np.square(noise), weights=moving))
        attenuation = power / float(np.mean(np.square(matrix[:, list(terms).index("inertia")])))
    residual = float(np.sqrt(np.mean(left**2)))
    return LinearFriction(
        {name: estimate(values[k], spread[k, k], freedom) for k, name in enumerate(terms)},
        fixed,
        residual,
        residual / max(float(np.std(full)), np.finfo(float).tiny),
        attenuation,
        conditioning,
        len(full),
    )


def _check_terms(terms: Sequence[str], fixed: Mapping[str, float]) -> None:
    for name in (*terms, *fixed):
        if name not in _COLUMNS:
            raise ValueError(f"linear friction: no term {name!r}; there are {', '.join(TERMS)}")
    if not terms:
        raise ValueError("linear friction: no term is to be found")
    twice = sorted(set(terms) & set(fixed))
    if twice or len(set(terms)) != len(terms):
        raise ValueError(f"linear friction: each term once, not {[*terms, *fixed]}")


def _filtered(record: DriveRecord, terms: Sequence[str], low_pass: LowPass) -> NDArray[np.float64]:
    """Effort and columns (n, 1 + p) after the filter."""
    acceleration = record.acceleration
    if acceleration is None:
        acceleration = np.gradient(record.velocity, record.sample_time)
    made = [record.effort]
    made += [_COLUMNS[name](record.velocity, acceleration) for name in terms]
    return low_pass.apply(np.column_stack(made), record.sample_time)


def _acceleration_noise(record: DriveRecord, low_pass: LowPass) -> float:
    """Standard deviation of the noise in the low-passed derivative of the velocity.

    White noise of variance s^2 has a density 2 s^2 T; its derivative below the cutoff fc then has
    (2 pi)^2 2 s^2 T fc^3 / 3. s comes from what lies above the cutoff.
    """
    if record.acceleration is not None:
        return 0.0
    step = record.sample_time
    above = record.velocity - low_pass.apply(record.velocity, step)
    share = 1.0 - 2.0 * low_pass.cutoff * step
    white = float(np.var(above)) / share if share > 0.0 else 0.0
    return float(2.0 * np.pi * np.sqrt(2.0 * white * step * low_pass.cutoff**3 / 3.0))


def _conditioning(
    matrix: NDArray[np.float64], terms: Sequence[str], name: str
) -> tuple[NDArray[np.float64], float]:
    size = np.linalg.norm(matrix, axis=0)
    if not np.all(size > 0.0):
        missing = [term for term, length in zip(terms, size, strict=True) if not length > 0.0]
        raise MeasurementError(f"{name}: the motion says nothing about {', '.join(missing)}")
    _, singular, rows = np.linalg.svd(matrix / size, full_matrices=False)
    if singular[-1] < _SINGULAR * singular[0]:
        mixed = [term for term, part in zip(terms, rows[-1], strict=True) if abs(part) > 0.1]
        raise MeasurementError(
            f"{name}: the motion cannot tell {' and '.join(mixed)} apart; move in both directions "
            "at several speeds, or give one of them"
        )
    return size, float(singular[0] / singular[-1])
