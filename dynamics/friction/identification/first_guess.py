"""Starting values of a friction law from the linear fit and the distance a reversal takes."""

import math

import numpy as np

from dynamics.frf.container import MeasurementError
from dynamics.friction.identification.dynamic_fit import friction_over_position
from dynamics.friction.identification.filtering import LowPass
from dynamics.friction.identification.linear_fit import LinearFriction
from dynamics.friction.identification.record import DriveRecord
from dynamics.friction.lugre import LuGre

#: first guess of static over Coulomb friction
_STATIC = 1.2


def reversal_distance(record: DriveRecord, linear: LinearFriction, low_pass: LowPass) -> float:
    """Median distance after a reversal at which friction changes its sign, m or rad.

    MeasurementError if the record has no reversal after which friction turns.
    """
    position, friction = friction_over_position(record, linear.value("inertia"), low_pass)
    friction = friction - linear.value("offset")
    velocity = low_pass.apply(record.velocity, record.sample_time)
    turns = np.flatnonzero(velocity[1:] * velocity[:-1] < 0.0) + 1
    distances = []
    for k, start in enumerate(turns):
        stop = turns[k + 1] if k + 1 < len(turns) else len(velocity)
        against = friction[start:stop] * np.sign(velocity[start]) > 0.0
        if not against[0] and against.any():
            distances.append(abs(position[start + int(np.argmax(against))] - position[start]))
    distances = [distance for distance in distances if distance > 0.0]
    if not distances:
        raise MeasurementError(
            f"{record.name}: no reversal shows the presliding of friction; record a slow reversal"
        )
    return float(np.median(distances))


def guess_lugre(linear: LinearFriction, distance: float, speed: float) -> LuGre:
    """LuGre friction with the sliding force of a linear fit.

    The distance is of `reversal_distance`: a Dahl curve crosses zero at g ln 2. The speed is the
    order of magnitude of the Stribeck velocity, m/s or rad/s.
    """
    coulomb = _coulomb(linear)
    stiffness = coulomb * math.log(2.0) / distance
    return LuGre(stiffness, 0.0, _viscous(linear), coulomb, _STATIC * coulomb, speed)


def _coulomb(linear: LinearFriction) -> float:
    found = linear.value("coulomb")
    if not found > 0.0:
        raise MeasurementError(
            f"drive records: the linear fit has a Coulomb friction of {found:g}; friction "
            "opposes motion, check the sign of the effort"
        )
    return found


def _viscous(linear: LinearFriction) -> float:
    # a small negative value is noise; a search in logarithms needs a positive start
    return max(linear.value("viscous"), 1e-3 * _coulomb(linear))
