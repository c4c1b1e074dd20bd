"""[move.NAME]: a trajectory of some axes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from chatter.description.file_name import FileName
from chatter.description.machine.frequency_response import StateSection
from chatter.description.quantities import QuantityField, quantity, whole_number
from chatter.description.section import raise_if_any
from chatter.description.wording import key_problems
from dynamics.trajectory.jerk_limited import JerkLimitedMove
from dynamics.trajectory.motion import Trajectory
from dynamics.trajectory.path import Path, circle, polyline, square
from dynamics.trajectory.path_motion import PathMotion
from dynamics.trajectory.periodic import CircleMotion, ConstantSpeedMove, SineMotion
from dynamics.trajectory.run_in import WithRunIn
from dynamics.trajectory.spatial_path import PathInSpace

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
    """A trajectory, and its path where it has one."""

    trajectory: Trajectory
    path: Path | PathInSpace | None = None
    #: s, between which the axes are to be on the path; always by default
    part: tuple[float, float] | None = None


class MoveSection(StateSection):
    """Trajectory and its limits."""

    kind: Literal[
        "jerk limited",
        "constant speed",
        "sine",
        "circle",
        "square",
        "polyline",
        "nc program",
        "recorded",
    ]
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
    file: FileName | None = Field(
        None, description="NC program, or a record of set points", examples=["part.nc"]
    )
    addresses: tuple[Literal["X", "Y", "Z"], ...] | None = Field(
        None, description="letters of an NC program, one an axis; by default the names of the axes"
    )
    start: Lengths | None = Field(
        None, description="where the axes stand in an NC program before it; 0 by default"
    )
    tolerance: quantity("length", above=0.0) | None = Field(
        None, description="by which corners of an NC program may be rounded; exact by default"
    )
    planner: Literal["blocks", "time-optimal"] | None = Field(
        None, description="of an NC program: by blocks (default), or as fast as every axis lets it"
    )
    cycle: quantity("time", above=0.0) | None = Field(
        None,
        description="interpolation cycle, over which set points are held; by default the longest "
        "that gives each position loop a set point at every sample",
    )
    standstill: quantity("time", at_least=0.0) = Field(0.0, description="before the move")
    afterwards: quantity("time", at_least=0.0) = Field(0.1, description="simulated behind its end")
    travel_positions: whole_number(1, 101, "numbers of positions") | None = Field(
        None,
        description="along the travel of each axis at which the structure is assembled, to change "
        "between them; as many as its natural frequencies need by default; 1: it stays as at the "
        "start",
    )

    @model_validator(mode="after")
    def _check(self) -> MoveSection:
        always = ("axes", "cycle", "standstill", "afterwards", "travel_positions")
        always = (*always, *StateSection.model_fields)
        problems = key_problems(self, "kind", _keys_of(self.kind), always)
        if self.kind in AT_SPEED and (self.acceleration is None) != (self.jerk is None):
            missing = "jerk" if self.jerk is None else "acceleration"
            problems.append((missing, "is missing: a run-in needs both acceleration and jerk"))
        plane = self.kind in ("circle", "square", "polyline")
        if plane and len(self.axes) != 2:
            problems.append(("axes", f'kind = "{self.kind}" moves two axes, not {len(self.axes)}'))
        if len(set(self.axes)) != len(self.axes):
            problems.append(("axes", "an axis is there twice"))
        if self.travel is not None and len(self.travel) != len(self.axes):
            problems.append(
                ("travel", f"{len(self.travel)} lengths for {len(self.axes)} axes; one each")
            )
        for key in ("addresses", "start"):
            given = getattr(self, key)
            if given is not None and len(given) != len(self.axes):
                problems.append((key, f"{len(given)} for {len(self.axes)} axes; one each"))
        if self.kind == "nc program" and self.letters is None:
            text = f"is missing; {', '.join(self.axes)} are not all X, Y or Z"
            problems.append(("addresses", text))
        if self.letters is not None and len(set(self.letters)) != len(self.letters):
            problems.append(("addresses", "a letter is there twice"))
        raise_if_any(problems)
        return self

    @property
    def letters(self) -> tuple[str, ...] | None:
        """Letters of an NC program for the axes; None where they are not told."""
        if self.addresses is not None:
            return self.addresses
        named = tuple(axis.upper() for axis in self.axes)
        return named if set(named) <= set("XYZ") else None

    def course(self) -> Course:
        """Trajectory and path of a kind that needs no file.

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
    return _run_in(section, ConstantSpeedMove(nothing, np.array(section.travel), section.velocity))


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
    return _run_in(section, motion, circle(centre, section.radius))


def _run_in(section: MoveSection, motion: Trajectory, path: Path | None = None) -> Course:
    if section.acceleration is None:
        return Course(motion, path)
    led = WithRunIn(motion, section.acceleration, section.jerk)
    return Course(led, path, led.part)


def _square(section: MoveSection) -> Course:
    path = square(section.side, section.fillet)
    return Course(PathMotion(path, *_limits(section)), path)


def _polyline(section: MoveSection) -> Course:
    path = polyline(np.array(section.points), section.fillet)
    return Course(PathMotion(path, *_limits(section)), path)


def _limits(section: MoveSection) -> tuple[float, float, float]:
    return section.velocity, section.acceleration, section.jerk


#: kind of a move that needs no file -> its keys and how it is made
COURSES: dict[str, CourseKind] = {
    "jerk limited": CourseKind(("travel", *_LIMITS), _jerk_limited),
    "constant speed": CourseKind(("travel", "velocity"), _constant_speed),
    "sine": CourseKind(("amplitude", "velocity", "periods"), _sine),
    "circle": CourseKind(("radius", "velocity", "revolutions"), _circle),
    "square": CourseKind(("side", "fillet", *_LIMITS), _square),
    "polyline": CourseKind(("points", "fillet", *_LIMITS), _polyline),
}

#: kinds of moves that begin and end at speed, unless acceleration and jerk of a run-in are given
AT_SPEED = ("constant speed", "circle")
#: kind of a move that is read from a file -> its keys, and whether each is needed
OF_FILES: dict[str, dict[str, bool]] = {
    "nc program": {
        **dict.fromkeys(("file", *_LIMITS), True),
        **dict.fromkeys(("addresses", "start", "tolerance", "planner"), False),
    },
    "recorded": {"file": True, **dict.fromkeys(_LIMITS, False)},
}


def _keys_of(kind: str) -> dict[str, bool]:
    """Keys of a kind, and whether each is needed."""
    if kind in OF_FILES:
        return OF_FILES[kind]
    of_run_in = dict.fromkeys(("acceleration", "jerk") if kind in AT_SPEED else (), False)
    return dict.fromkeys(COURSES[kind].keys, True) | of_run_in
