"""The laws of friction that are tried on records: how each is fitted, and what it predicts.

They come in the order of what they can say: viscous, Coulomb, the Stribeck curve, presliding.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from chatter.description.arrays import Array
from dynamics.frf.container import MeasurementError
from dynamics.friction.coulomb_stribeck import CoulombStribeck
from dynamics.friction.identification.dynamic_fit import AxisModel, fit_axis, friction_along
from dynamics.friction.identification.filtering import LowPass
from dynamics.friction.identification.first_guess import guess_lugre, reversal_distance
from dynamics.friction.identification.intervals import Estimate
from dynamics.friction.identification.linear_fit import LinearFriction, fit_linear
from dynamics.friction.identification.record import DriveRecord
from dynamics.friction.law import FrictionLaw

#: first guess of static over Coulomb friction, and of the Stribeck velocity over the minimum speed
_STATIC, _STRIBECK = 1.2, 2.0
#: first guess of the damping ratio of the moved mass on the bristles
_BRISTLE_DAMPING = 0.3


@dataclass(frozen=True)
class FitSettings:
    """How records are fitted."""

    low_pass: LowPass
    minimum_speed: float  # m/s or rad/s, below which sliding laws are not judged
    inertia: float | None = None  # known, kg or kg m^2
    starts: int = 3  # of the search for laws that are not linear in their parameters


@dataclass(frozen=True)
class FittedFriction:
    """A law fitted to records."""

    name: str  # "viscous", "coulomb", "stribeck" or "lugre"
    law: FrictionLaw
    estimates: Mapping[str, Estimate]  # SI, by parameter; what is given is not among them
    inertia: float
    offset: float
    undecided: tuple[str, ...] = ()  # parameters that the records do not decide
    linear: LinearFriction | None = None  # of a law that is linear in its parameters

    def effort(self, record: DriveRecord, low_pass: LowPass) -> Array:
        """Low-passed effort (n,) that the measured motion of a record needs, N or N m."""
        acceleration = np.gradient(record.velocity, record.sample_time)
        friction = self.friction(record)
        effort = self.inertia * acceleration + friction + self.offset
        return low_pass.apply(effort, record.sample_time)

    def friction(self, record: DriveRecord) -> Array:
        """Friction (n,) along the measured motion of a record, N or N m."""
        if self.linear is not None:
            value = self.linear.value
            return value("viscous") * record.velocity + value("coulomb") * np.sign(record.velocity)
        return friction_along(self.law, record.position, record.sample_time)


def both_directions(records: Sequence[DriveRecord], minimum_speed: float) -> bool:
    """Whether the records move either way, so that an offset can be told from Coulomb friction."""
    fastest = max(float(record.velocity.max()) for record in records)
    slowest = min(float(record.velocity.min()) for record in records)
    return fastest > minimum_speed and slowest < -minimum_speed


def fit_viscous(records: Sequence[DriveRecord], settings: FitSettings) -> FittedFriction:
    """Viscous friction alone; MeasurementError if the records do not determine it."""
    return _linear("viscous", ("viscous",), records, settings)


def fit_coulomb(records: Sequence[DriveRecord], settings: FitSettings) -> FittedFriction:
    """Viscous and Coulomb friction; MeasurementError if the records do not determine them."""
    return _linear("coulomb", ("viscous", "coulomb"), records, settings)


def fit_stribeck(records: Sequence[DriveRecord], settings: FitSettings) -> FittedFriction:
    """Viscous, Coulomb and static friction, and the Stribeck velocity.

    MeasurementError if the records do not determine them, or friction has the sign of a drive.
    """
    first = _sliding(records, settings)
    coulomb, speed = first.value("coulomb"), settings.minimum_speed
    guess = CoulombStribeck(coulomb, _STATIC * coulomb, _STRIBECK * speed, _viscous(first))
    free = ["coulomb", "static", "stribeck_velocity", "viscous"]
    return _along_motion("stribeck", guess, free, first, records, settings, 0.25 * speed)


def fit_lugre(records: Sequence[DriveRecord], settings: FitSettings) -> FittedFriction:
    """Sliding friction and presliding of the LuGre law.

    MeasurementError if no reversal shows presliding, or friction has the sign of a drive.
    """
    if not both_directions(records, settings.minimum_speed):
        raise MeasurementError("no reversal of the motion shows presliding")
    first = _sliding(records, settings)
    distances = []
    for record in records:
        try:
            distances.append(reversal_distance(record, first, settings.low_pass))
        except MeasurementError:
            continue
    if not distances:
        raise MeasurementError("no reversal of the motion shows presliding")
    speed = _STRIBECK * settings.minimum_speed
    guess = guess_lugre(first, float(np.median(distances)), speed)
    inertia = max(first.value("inertia"), np.finfo(float).tiny)
    damping = 2.0 * _BRISTLE_DAMPING * math.sqrt(guess.bristle_stiffness * inertia)
    guess = type(guess)(
        guess.bristle_stiffness,
        damping,
        guess.viscous,
        guess.coulomb,
        guess.static,
        guess.stribeck_velocity,
    )
    free = ["bristle_stiffness", "bristle_damping", "viscous", "coulomb", "static"]
    free.append("stribeck_velocity")
    return _along_motion("lugre", guess, free, first, records, settings, 0.0)


#: the laws in the order of what they can say
LAWS: Mapping[str, Callable[[Sequence[DriveRecord], FitSettings], FittedFriction]] = {
    "viscous": fit_viscous,
    "coulomb": fit_coulomb,
    "stribeck": fit_stribeck,
    "lugre": fit_lugre,
}


def _linear(
    name: str, terms: tuple[str, ...], records: Sequence[DriveRecord], settings: FitSettings
) -> FittedFriction:
    found = _fit_terms(terms, records, settings)
    coulomb, viscous = (max(found.value(term), 0.0) for term in ("coulomb", "viscous"))
    law = CoulombStribeck(coulomb, coulomb, 1.0, viscous)
    return FittedFriction(
        name, law, found.estimates, found.value("inertia"), found.value("offset"), (), found
    )


def _fit_terms(
    terms: tuple[str, ...], records: Sequence[DriveRecord], settings: FitSettings
) -> LinearFriction:
    if both_directions(records, settings.minimum_speed):
        terms = (*terms, "offset")
    known = settings.inertia
    return fit_linear(
        records,
        terms if known is not None else ("inertia", *terms),
        low_pass=settings.low_pass,
        minimum_speed=settings.minimum_speed,
        fixed={} if known is None else {"inertia": known},
    )


def _sliding(records: Sequence[DriveRecord], settings: FitSettings) -> LinearFriction:
    found = _fit_terms(("viscous", "coulomb"), records, settings)
    if not found.value("coulomb") > 0.0:
        raise MeasurementError("no Coulomb friction to build on")
    return found


def _viscous(found: LinearFriction) -> float:
    # a search in logarithms needs a positive start
    return max(found.value("viscous"), 1e-3 * found.value("coulomb"))


def _along_motion(
    name: str,
    guess: FrictionLaw,
    free: list[str],
    first: LinearFriction,
    records: Sequence[DriveRecord],
    settings: FitSettings,
    minimum_speed: float,
) -> FittedFriction:
    free = [*free, *(one for one in ("inertia", "offset") if one in first.estimates)]
    fit = fit_axis(
        records,
        AxisModel(guess, first.value("inertia"), first.value("offset")),
        free,
        low_pass=settings.low_pass,
        minimum_speed=minimum_speed,
        starts=settings.starts,
    )
    model = fit.model
    return FittedFriction(
        name, model.law, fit.estimates, model.inertia, model.offset, fit.unsupported
    )
