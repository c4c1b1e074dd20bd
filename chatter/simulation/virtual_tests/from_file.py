"""FRFs and moves as a machine file asks for them."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from chatter.compile.linearised_friction import (
    clamping_frictions,
    closed_backlashes,
    linearised_frictions,
)
from chatter.compile.machine_along_axes import StateOfMachine, machine_along_axes, machine_at_start
from chatter.compile.machine_parts import assembled_machine
from chatter.description.errors import InputError
from chatter.description.given_values import text_given, texts_given
from chatter.description.machine.frequency_response import (
    TORQUE_KINDS,
    FrfSection,
    StateSection,
    parse_tested_point,
)
from chatter.description.machine.machine_file import MachineFile
from chatter.description.machine.machine_or_path import takes_machine_or_path
from chatter.description.machine.move import AT_SPEED, MoveSection
from chatter.description.progress import Progress, no_progress
from chatter.engine.loop_stability import refuse_unstable_control
from chatter.simulation.virtual_tests.courses import course_of
from chatter.simulation.virtual_tests.frf import FrfCurve, FrfResult
from chatter.simulation.virtual_tests.move import MovePlan, MoveResult, move_axes
from chatter.simulation.virtual_tests.virtual_tests import FrfTest, frf_by_test
from dynamics.frf.container import Frf
from dynamics.machine.description import Machine
from dynamics.machine.harmonic import receptance
from dynamics.machine.moving_structure import MachinesAlong
from dynamics.structure.linear_structure import StructureError
from dynamics.trajectory.motion import TrajectoryError
from dynamics.trajectory.set_points import interpolation_cycle

Section = TypeVar("Section", FrfSection, MoveSection)

_AXES = ("x", "y", "z", "rx", "ry", "rz")
#: velocity below which an axis rests, m/s
_RESTING = 1e-12
#: steps of a move in time: what its signals take up fits no memory beyond
_MOST_STEPS = 1e9
#: s, from blow to blow where no period is stated
_LONGEST_PERIOD = 16.0
#: instants at which a move is looked at for how far it goes
_SAMPLES = 2000


def in_state(file: MachineFile, state: StateSection) -> Machine:
    """Machine of a file in the state of a test.

    InputError if it cannot be brought into that state.
    """
    machine = assembled_machine(file, state.condition, state.position, state.in_cut)
    return machine if state.friction else machine.without_friction()


def default_frfs(file: MachineFile) -> dict[str, FrfSection]:
    """Tests of a file that names none: blows on the tool point in x, y, z.

    InputError if the file has no tool point.
    """
    if file.tool_point is None:
        raise InputError(
            f"{file.name}: frf: there is no [frf.NAME] and no tool_point; say what is excited, "
            'such as [frf.table] excite = "table:y", or --excite "table:y"'
        )
    against = f"/{file.workpiece}" if file.workpiece else ""
    return {
        f"{file.tool_point} {direction}": FrfSection(
            excite=f"{file.tool_point}{against}:{direction}", band=(5.0, 500.0)
        )
        for direction in "xyz"
    }


def frfs(
    file: MachineFile, sections: dict[str, FrfSection], progress: Progress = no_progress
) -> FrfResult:
    """FRFs of a machine, one a section, all shown as the quantity of the first.

    InputError if a section does not fit the machine, RunError if the machine runs away in a test.
    """
    quantity = next(iter(sections.values())).kind
    curves = []
    for place, (name, section) in enumerate(sections.items()):
        share = _share_of(progress, place, len(sections))
        curves.append(one_frf(file, name, section, share).as_quantity(quantity))
    return FrfResult(file.title or file.name, curves)


@takes_machine_or_path
def frf(
    file: MachineFile, names: Sequence[str] | None = None, progress: Progress = no_progress
) -> FrfResult:
    """FRFs that a machine file asks for, by name, or all of them.

    Raises
    ------
    InputError
        If a name is unknown or a section does not fit the machine.
    RunError
        If the machine runs away in a test.
    """
    wanted = texts_given(names or (), "names of [frf.NAME]") or tuple(file.frf)
    if not wanted:
        return frfs(file, default_frfs(file), progress)
    return frfs(file, {name: _named(file, "frf", file.frf, name) for name in wanted}, progress)


@takes_machine_or_path
def move(file: MachineFile, name: str, progress: Progress = no_progress) -> MoveResult:
    """Move that a machine file asks for, by name.

    Raises
    ------
    InputError
        If the name is unknown or the section does not fit the machine.
    RunError
        If the machine runs away.
    """
    return file_move(file, name, _named(file, "move", file.move, name), progress)


def one_frf(
    file: MachineFile, name: str, section: FrfSection, progress: Progress = no_progress
) -> FrfCurve:
    """One FRF of a machine, linearised and by its test in time; receptance."""
    where = f"{file.name}: frf.{name}"
    with _told_with(where, file.name):
        return _one_frf(file, where, name, section, progress)


def _one_frf(
    file: MachineFile, where: str, name: str, section: FrfSection, progress: Progress
) -> FrfCurve:
    machine = in_state(file, section)
    if section.by != "linearised" and section.band[1] >= 0.5 / file.step:
        raise InputError(
            f"{where}.band: {section.band[1]:g} Hz cannot be tested with a step of "
            f"{file.step:g} s; below {0.5 / file.step:g} Hz is required, or a shorter step"
        )
    velocity = {axis: speed for axis, speed in section.moving.items() if abs(speed) > _RESTING}
    _refuse_unmovable(where, machine, velocity)
    refuse_unstable_control(machine, file.step)
    excited, read = _rows(where, machine, section)
    frequency = np.linspace(*section.band, section.lines)
    motor = parse_tested_point(section.excite).motor
    # what is identified is what the motors of an axis feel together, the loop of their sum open
    opened = motor if section.by == "torque multisine" else None
    # the axis moves as its loop lets it, though the response is taken with the loop open
    frictions = linearised_frictions(machine, velocity, section.amplitude)
    rows = np.array([read, excited])
    values = receptance(machine, frequency, rows, file.step, frictions, opened)[:, 0, 1]
    harmonic = Frf(frequency, values, "receptance", source=f"{where}, linearised")
    tested = None
    if section.by != "linearised":
        test = FrfTest(
            name,
            section.by,
            motor if section.by in TORQUE_KINDS else excited,
            read,
            section.level,
            section.band,
            section.period,
            section.averages,
            section.settling,
            velocity,
            section.seed,
            section.spindle_speed or 0.0,
            section.at_angle,
        )
        chosen = "period" not in section.model_fields_set
        tested = frf_by_test(machine, file.step, test, progress, _LONGEST_PERIOD * chosen)
    return FrfCurve(
        name,
        in_words(section),
        harmonic,
        tested,
        "torque" if is_rotation(file, section.excite) else "force",
        "rotation" if is_rotation(file, section.read or section.excite) else "displacement",
        (
            *file.questions_of_positions(section.position),
            *closed_backlashes(machine),
            *clamping_frictions(machine, frictions),
        ),
    )


def is_rotation(file: MachineFile, text: str) -> bool:
    """Whether a place of a test is a motor that turns, or a rotation."""
    place = parse_tested_point(text)
    if place.motor is not None:
        return not file.axis[place.motor].drive.motor_is_linear
    return place.direction.startswith("r")


def in_words(section: FrfSection) -> str:
    """State of a test in words."""
    parts = [f"{axis} moving at {speed * 60e3:g} mm/min" for axis, speed in section.moving.items()]
    parts += [f"{axis}: {condition}" for axis, condition in section.condition.items()]
    parts += [f"{axis} at {place * 1e3:g} mm" for axis, place in section.position.items()]
    if section.in_cut:
        parts.append("in the cut")
    if not section.friction:
        parts.append("no friction")
    return ", ".join(parts)


def file_move(
    file: MachineFile, name: str, section: MoveSection, progress: Progress = no_progress
) -> MoveResult:
    """Move of a machine as a section asks for it.

    InputError if the section does not fit the machine, RunError if the machine runs away.
    """
    where = f"{file.name}: move.{name}"
    for axis in section.axes:
        drive = file.axis[axis].drive if axis in file.axis else None
        if drive is not None and drive.is_rotary:
            raise InputError(f"{where}.axes: axis {axis} turns; a move is along axes that travel")
    machine = in_state(file, section)
    try:
        course = course_of(section)
    except TrajectoryError as error:
        raise InputError(f"{where}: {error}") from error
    cycle = section.cycle
    if cycle is None:
        loops = (drive.controller.position for drive in machine.drives)
        cycle = interpolation_cycle((loop.timing.sample_time for loop in loops), file.step)
    plan = MovePlan(
        course.trajectory,
        section.axes,
        cycle,
        section.standstill,
        section.afterwards,
        course.path,
        course.part,
    )
    steps = (section.standstill + course.trajectory.duration + section.afterwards) / file.step
    if not steps <= _MOST_STEPS:
        raise InputError(
            f"{where}: the move lasts {steps * file.step:.3g} s, {steps:.2g} steps of "
            f"{1e6 * file.step:g} us (step); at most {_MOST_STEPS:.0e} are allowed"
        )
    title = file.title or file.name
    with _told_with(where, file.name):
        along = _along(file, section, machine, plan)
        if along is not None:
            machine = machine_at_start(along)
        result = move_axes(
            f"{title}: {name}",
            machine,
            file.step,
            plan,
            _tool_rows(file, machine) if file.tool_point is not None else None,
            progress,
            along,
        )
    units = ("N" if file.axis[one].drive.motor_is_linear else "N*m" for one in section.axes)
    notes = _steps_of_velocity(name, section, plan)
    return replace(result, effort_units=tuple(units), notes=notes)


def _steps_of_velocity(name: str, section: MoveSection, plan: MovePlan) -> tuple[str, ...]:
    """Note where the set points begin at speed, with the machine at rest."""
    speed = float(np.linalg.norm(plan.trajectory.at(0.0).velocity))
    if speed <= _RESTING:
        return ()
    text = f"the set points begin with a step of the velocity, from rest to {1e3 * speed:.4g} mm/s"
    if section.kind in AT_SPEED:
        text += f"; acceleration and jerk of [move.{name}] make a run-in"
    return (text,)


def _along(
    file: MachineFile, section: MoveSection, machine: Machine, plan: MovePlan
) -> MachinesAlong | None:
    """Machine along the axes that the move sends far enough to change its structure."""
    controlled = {drive.axis for drive in machine.drives}
    if not set(plan.axes) <= controlled:
        return None  # refused where the move begins
    wanted = plan.trajectory.at(np.linspace(0.0, plan.trajectory.duration, _SAMPLES)).position
    travel = wanted - wanted[0]
    ranges = {
        axis: (float(travel[:, column].min()), float(travel[:, column].max()))
        for column, axis in enumerate(plan.axes)
    }
    return machine_along_axes(
        file,
        ranges,
        lambda one, _: {} if file.tool_point is None else _named_rows(_tool_rows(file, one)),
        section.travel_positions,
        StateOfMachine(section.condition, section.position, section.friction, section.in_cut),
        machine,
    )


def _tool_rows(file: MachineFile, machine: Machine) -> NDArray[np.float64]:
    """Rows (3, n) of the tool against the workpiece."""
    return np.array(
        [
            machine.structure.port(file.tool_point, direction, file.workpiece)
            for direction in np.eye(3)
        ]
    )


def _named_rows(rows: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    return {f"tool {direction}": row for direction, row in zip("xyz", rows, strict=True)}


@contextmanager
def _told_with(where: str, file: str) -> Iterator[None]:
    """Name file and section in what is refused, where it does not yet."""
    try:
        yield
    except InputError as error:
        raise InputError(
            [text if text.startswith(file) else f"{where}: {text}" for text in error.messages]
        ) from error


def _named(file: MachineFile, kind: str, sections: Mapping[str, Section], name: str) -> Section:
    if text_given(name, f"the name of [{kind}.NAME]") not in sections:
        known = ", ".join(sections) or "none"
        raise InputError(f"{file.name}: there is no [{kind}.{name}]; there are {known}")
    return sections[name]


def _rows(
    where: str, machine: Machine, section: FrfSection
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    return (
        row_of_point(f"{where}.excite", machine, section.excite),
        row_of_point(f"{where}.read", machine, section.read or section.excite),
    )


def row_of_point(where: str, machine: Machine, text: str) -> NDArray[np.float64]:
    """Row over the coordinates of a machine that gives the motion of a point such as "table:y"."""
    place = parse_tested_point(text)
    if place.motor is not None:
        rows = [drive.row for drive in machine.drives if drive.axis == place.motor]
        if not rows:
            raise InputError(f'{where}: axis "{place.motor}" is not under control')
        return np.mean(rows, axis=0)
    direction = np.eye(6)[_AXES.index(place.direction)]
    try:
        return machine.structure.port(place.point, direction, place.against)
    except StructureError as error:
        raise InputError(f"{where}: {error}") from error


def _refuse_unmovable(where: str, machine: Machine, velocity: dict[str, float]) -> None:
    known: Sequence[str] = [drive.axis for drive in machine.drives]
    for axis in velocity:
        if axis not in known:
            there = ", ".join(dict.fromkeys(known)) or "none"
            raise InputError(
                f'{where}.moving: axis "{axis}" is not under control; there are {there}'
            )


def _share_of(progress: Progress, place: int, count: int) -> Progress:
    return lambda done, total: progress(place * total + done, count * total)
