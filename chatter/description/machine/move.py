"""[move.NAME]: a trajectory of some axes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from chatter.description.machine.frequency_response import StateSection
from chatter.description.quantities import QuantityField, quantity
from chatter.description.section import raise_if_any
from chatter.description.wording import key_problems
from dynamics.trajectory.jerk_limited import JerkLimitedMove
from dynamics.trajectory.motion import Trajectory
from dynamics.trajectory.path import Path, circle, polyline, square
from dynamics.trajectory.path_motion import PathMotion
from dynamics.trajectory.periodic import CircleMotion, ConstantSpeedMove, SineMotion

_LENGTH = QuantityField("length")


def _lengths(given: Any) -> tuple[float, ...]:
    if not isinstance(given, (list, tuple)):
        given = [given]
    return tuple(_LENGTH.read(one) for one in given)


def _plane_points(given: Any) -> tuple[tuple[float, float], ...]:
    fits = isinstance(given, (list, tuple)) and len(given) >= 2
    if not fits or not all(isinstance(one, (list, tuple)) and len(one) == 2 for one in given):
        raise ValueError(
            'a list of points is required, such as [["0 mm", "0 mm"], ["50 mm", "0 mm"], ...]'
        )
    return tuple((_LENGTH.read(x), _LENGTH.read(y)) for x, y in given)


Lengths = Annotated[tuple[float, ...], BeforeValidator(_lengths)]
PlanePoints = Annotated[tuple[tuple[float, float], ...], BeforeValidator(_plane_points)]


class Course(NamedTuple):
    """A trajectory, and its path where it has a plane one."""

    trajectory: Trajectory
    path: Path | None = None


class MoveSection(StateSection):
    """Trajectory and its limits."""

    kind: Literal["jerk limited", "constant speed", "sine", "circle", "square", "polyline"]
    axes: tuple[str, ...] = Field(min_length=1, description="in the order of the coordinates")
    travel: Lengths | None = Field(None, description="of each axis, from where it stands")
    velocity: quantity("velocity", above=0.0) | None = None
    acceleration: quantity("acceleration", above=0.0) | None = None
    jerk: quantity("jerk", above=0.0) | None = None
    amplitude: quantity("length", above=0.0) | None = None
    periods: quantity("number", above=0.0) | None = None
    radius: quantity("length", above=0.0) | None = None
    revolutions: quantity("number", above=0.0) | None = None
    side: quantity("length", above=0.0) | None = None
    fillet: quantity("length", at_least=0.0) | None = None
    points: PlanePoints | None = None
    cycle: quantity("time", above=0.0) | None = Field(
        None, description="interpolation cycle; that of the slowest position loop by default"
    )
    standstill: quantity("time", at_least=0.0) = Field(0.0, description="before the move")
    afterwards: quantity("time", at_least=0.0) = Field(0.1, description="simulated behind its end")

    @model_validator(mode="after")
    def _check(self) -> MoveSection:
        always = ("axes", "cycle", "standstill", "afterwards", *StateSection.model_fields)
        needed = COURSES[self.kind].keys
        problems = key_problems(self, "kind", dict.fromkeys(needed, True), always)
        plane = self.kind in ("circle", "square", "polyline")
        if plane and len(self.axes) != 2:
            problems.append(("axes", f'kind = "{self.kind}" moves two axes, not {len(self.axes)}'))
        if len(set(self.axes)) != len(self.axes):
            problems.append(("axes", "an axis is there twice"))
        if self.travel is not None and len(self.travel) != len(self.axes):
            problems.append(
                ("travel", f"{len(self.travel)} lengths for {len(self.axes)} axes; one each")
            )
        raise_if_any(problems)
        return self

    def course(self) -> Course:
        """Trajectory and path.

        Raises TrajectoryError if they make no sense.
        """
        return COURSES[self.kind].make(self)


class CourseKind(NamedTuple):
    """Keys that a kind of move needs, and how it is made."""

    keys: tuple[str, ...]
    make: Callable[[MoveSection], Course]


_LIMITS = ("velocity", "acceleration", "jerk")


def _jerk_limited(section: MoveSection) -> Course:
    nothing = np.zeros(len(section.axes))
    return Course(JerkLimitedMove(nothing, np.array(section.travel), *_limits(section)))


def _constant_speed(section: MoveSection) -> Course:
    nothing = np.zeros(len(section.axes))
    return Course(ConstantSpeedMove(nothing, np.array(section.travel), section.velocity))


def _sine(section: MoveSection) -> Course:
    amplitude = np.full(len(section.axes), section.amplitude)
    # the velocity is that in the middle of the stroke
    frequency = section.velocity / (2.0 * np.pi * section.amplitude)
    motion = SineMotion(
        np.zeros(len(amplitude)), amplitude, frequency, section.periods, 0.5 * np.pi
    )
    return Course(motion)


def _circle(section: MoveSection) -> Course:
    centre = np.array([-section.radius, 0.0])
    motion = CircleMotion(centre, section.radius, section.velocity, section.revolutions)
    return Course(motion, circle(centre, section.radius))


def _square(section: MoveSection) -> Course:
    path = square(section.side, section.fillet)
    return Course(PathMotion(path, *_limits(section)), path)


def _polyline(section: MoveSection) -> Course:
    path = polyline(np.array(section.points), section.fillet)
    return Course(PathMotion(path, *_limits(section)), path)


def _limits(section: MoveSection) -> tuple[float, float, float]:
    return section.velocity, section.acceleration, section.jerk


#: kind of a move -> its keys and how it is made
COURSES: dict[str, CourseKind] = {
    "jerk limited": CourseKind(("travel", *_LIMITS), _jerk_limited),
    "constant speed": CourseKind(("travel", "velocity"), _constant_speed),
    "sine": CourseKind(("amplitude", "velocity", "periods"), _sine),
    "circle": CourseKind(("radius", "velocity", "revolutions"), _circle),
    "square": CourseKind(("side", "fillet", *_LIMITS), _square),
    "polyline": CourseKind(("points", "fillet", *_LIMITS), _polyline),
}
