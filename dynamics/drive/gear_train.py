"""Rotors in a row, from the motor to what pushes the axis, tied by springs.

All angles are scaled to the travel of the axis that they would give if nothing gave way, so that
springs in a row add their compliances whatever gears lie between them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from dynamics.structure.linear_structure import StructureError
from dynamics.structure.rotor import Rotor
from dynamics.structure.spring_coupling import Coupling, Term, reversed_terms


class Spring(NamedTuple):
    """Spring and damper between stages, as if it were at the axis."""

    name: str
    stiffness: float  # N/m of travel; infinite if rigid
    damping: float = 0.0  # N s/m
    backlash: float = 0.0  # gap in which it does not act, from flank to flank, m of travel


RIGID = Spring("rigid", np.inf)


class Stage(NamedTuple):
    """What turns, and the spring behind it."""

    name: str
    inertia: float  # kg m^2; 0 if negligible
    travel: float  # of the axis per angle, m/rad, above 0
    spring: Spring


@dataclass(frozen=True, eq=False)
class Housing:
    """What the rotors' angles count against."""

    part: str
    at: ArrayLike  # (3,), m
    axis: ArrayLike  # (3,), unit vector that the rotors turn about

    def turning(self, factor: float) -> Term:
        """Rotation about the axis, times a factor."""
        return turning(self.part, self.at, np.asarray(self.axis), factor)


class GearTrain(NamedTuple):
    """Rotors and couplings, and the angle of the first against the housing."""

    rotors: tuple[Rotor, ...]
    couplings: tuple[Coupling, ...]
    motor_angle: tuple[Term, ...]


def turning(part: str, at: ArrayLike, axis: ArrayLike, factor: float = 1.0) -> Term:
    """Rotation of a part about an axis (3,), times a factor."""
    return Term(part, factor * np.concatenate([np.zeros(3), np.asarray(axis)]), at)


def in_series(springs: Sequence[Spring]) -> Spring:
    """One spring for several in a row, named as the last of them that gives way.

    The damping takes as much energy in slow motion as the dampers of all do at their share of
    the stretch. Gaps add up.
    """
    stiffness = series_stiffness([spring.stiffness for spring in springs])
    if np.isinf(stiffness):
        return springs[-1]
    name = [spring.name for spring in springs if np.isfinite(spring.stiffness)][-1]
    damping = sum(one.damping * (stiffness / one.stiffness) ** 2 for one in springs)
    return Spring(name, stiffness, damping, sum(spring.backlash for spring in springs))


def series_stiffness(stiffness: Sequence[float]) -> float:
    """Stiffness of springs in a row; infinite if all are rigid."""
    compliance = sum(1.0 / one for one in stiffness)
    return 1.0 / compliance if compliance > 0.0 else np.inf


def reflected_inertia(stages: Sequence[Stage]) -> float:
    """Moment of inertia of all stages at the first, kg m^2."""
    return sum(stage.inertia * (stages[0].travel / stage.travel) ** 2 for stage in stages)


def gear_train(
    where: str, stages: Sequence[Stage], end: Sequence[Term], housing: Housing
) -> GearTrain:
    """Rotors and couplings of stages in a row.

    Stages that a rigid spring joins turn as one: as the first if that is the motor, else as the
    last of them. Across a stage without inertia the springs act in a row.

    Stages from the motor on; `end` is the motion behind the last spring: the travel that the last
    stage, turning against its housing, would give if nothing gave way. StructureError, whose
    message begins with `where`, if every spring is rigid, so that nothing ties the motor's inertia
    to the axis, the motor in front of a spring has no inertia, or a rigid spring has damping.
    """
    for stage in stages:
        if np.isinf(stage.spring.stiffness) and stage.spring.damping > 0.0:
            raise StructureError(
                f'{where}: "{stage.spring.name}" has damping but is rigid; '
                "give its stiffness, or no damping"
            )
    lumps = _lumps(stages)
    if len(lumps) == 1 and lumps[0].inertia == 0.0 and np.isinf(lumps[0].spring.stiffness):
        angle = tuple(term.times(1.0 / lumps[0].travel) for term in end)
        return GearTrain((), (), angle)
    for lump in lumps:
        if lump.inertia == 0.0:
            raise StructureError(f'{where}: "{lump.name}" has no inertia in front of a spring')
        if np.isinf(lump.spring.stiffness):
            raise StructureError(
                f'{where}: "{lump.name}" has inertia, and all behind it is rigid; give the '
                "stiffness of a spring there, or put the inertia into the part that it drives"
            )
    rotors = tuple(Rotor(lump.name, lump.inertia, housing.axis) for lump in lumps)
    motions = [_motion(lump, housing, lump.travel) for lump in lumps] + [tuple(end)]
    couplings = tuple(
        Coupling(
            lump.spring.name,
            (*ahead, *reversed_terms(behind)),
            lump.spring.stiffness,
            lump.spring.damping,
            lump.spring.backlash,
        )
        for lump, ahead, behind in zip(lumps, motions[:-1], motions[1:], strict=True)
    )
    return GearTrain(rotors, couplings, _motion(lumps[0], housing, 1.0))


def _lumps(stages: Sequence[Stage]) -> list[Stage]:
    lumps = [stages[0]]
    for stage in stages[1:]:
        last = lumps[-1]
        if np.isfinite(last.spring.stiffness) and stage.inertia == 0.0:
            lumps[-1] = last._replace(spring=in_series([last.spring, stage.spring]))
        elif np.isfinite(last.spring.stiffness):
            lumps.append(stage)
        elif len(lumps) == 1:
            lumps[-1] = last._replace(inertia=reflected_inertia([last, stage]), spring=stage.spring)
        else:
            lumps[-1] = stage._replace(inertia=reflected_inertia([stage, last]))
    return lumps


def _motion(stage: Stage, housing: Housing, factor: float) -> tuple[Term, ...]:
    rotor = Term(stage.name, factor * np.concatenate([np.zeros(3), np.asarray(housing.axis)]))
    return rotor, housing.turning(-factor)
