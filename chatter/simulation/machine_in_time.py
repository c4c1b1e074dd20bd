"""The machine of a case in the time domain, with its drives and frictions."""

import math

import numpy as np
from numpy.typing import NDArray

from chatter.compile.linearised_friction import rigid_motion
from chatter.compile.machine_along_axes import StateOfMachine, machine_along_axes, machine_at_start
from chatter.compile.machine_cut import MachineCut, cut_on, machine_cut, named_rows, rows_of_cut
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.engine.loop_stability import refuse_unstable_control
from chatter.simulation.resolution import Resolution, bounds_of, resolved_arc, revolutions_of
from chatter.simulation.spindle import path_of
from chatter.simulation.structure_in_time import StructureInTime
from chatter.simulation.tool_course import ToolCourse
from cutting.tool.cutter import Cutter
from dynamics.control.sampling import ControlError
from dynamics.machine.moving_structure import MachinesAlong
from dynamics.machine.tables import StructureTables, machine_tables
from dynamics.structure.linear_structure import StructureError
from dynamics.trajectory.set_points import SetPoints, interpolation_cycle

#: steps of the time that a tooth is in the cut, and between teeth, at the least
_STEPS_A_CUT = 40
_STEPS_A_PITCH = 16
#: time that the machine runs before the cut, over which its axes come to speed, and in which they
#: can at all, s
_SETTLING, _SPEEDING_UP, _LEAST_SPEEDING_UP = 1.0, 0.3, 0.05
#: rows of the record, at the most
_MOST_ROWS = 200_000
#: instants at which a program is looked at for what it moves, and travel that is none, m
_SAMPLES, _NOTHING = 2000, 1e-9


def machine_in_time(
    case: Case, cutter: Cutter, course: ToolCourse | None = None
) -> StructureInTime:
    """Compile the machine of a case, its axes to be at the feed when the cut begins.

    Along the course of a program they are at rest then.
    """
    if case.cut.speed_variation is not None:
        raise InputError(
            f"{case.name}: cut.speed_variation: the spindle of a machine turns as its drive lets it"
        )
    if case.simulation is not None and case.simulation.path is not None:
        raise InputError(f"{case.name}: simulation.path: a machine is fed along a straight line")
    cut = machine_cut(case)
    if course is not None:
        _refuse_unmoved(case, cut, course)
    fastest = case.cut.spindle_speed if course is None else course.fastest
    step = _step(case, cut, cutter, fastest)
    refuse_unstable_control(cut.machine, step, cut.file)
    modes = cut.modes()
    resolution = _resolution(case, cutter, modes, step)
    speed = case.cut.spindle_speed
    before = round(_time_before(case, cut) / step)
    duration = resolution.revolutions * 2.0 * math.pi / speed
    if course is None:
        points = _set_points(
            cut, path_of(case).feed, speed, (before + 10) * step + duration, before * step
        )
    else:
        points = _set_points_of(cut, course, (before + 10) * step + duration, before * step)
        speed = float(course.spindle.speed_at(np.zeros(1))[0])
    along = _along(case, cut, points)
    if along is not None:
        cut = cut_on(case, cut.file, machine_at_start(along), case.structure.position or {})
    return StructureInTime(
        modes,
        resolution,
        step,
        max(1, round(duration / step)),
        _tables(cut, speed, step, points, along),
        _notes(cut, along),
        cut,
        before,
    )


def _time_before(case: Case, cut: MachineCut) -> float:
    """Time that the machine runs in the air, s: its axes have their feed at its end."""
    settling = case.structure.settling
    if settling is None:
        return _SETTLING
    if cut.feeds and settling < _LEAST_SPEEDING_UP:
        raise InputError(
            f"{case.name}: structure.settling: {settling:g} s is given, but the axes "
            f"{', '.join(cut.feeds)} of {cut.file.name} have to come to the feed in it; "
            f"{_LEAST_SPEEDING_UP:g} s or more is required"
        )
    return settling


def _step(case: Case, cut: MachineCut, cutter: Cutter, speed: float) -> float:
    """Step of the machine file, or a whole part of it that resolves the cut at a speed, rad/s."""
    a_turn = 2.0 * math.pi / speed
    section = case.simulation
    wanted = section.steps if section and section.steps else None
    if wanted is None:
        wanted = max(
            _STEPS_A_CUT * 2.0 * math.pi / resolved_arc(case, cutter),
            _STEPS_A_PITCH * 2.0 * math.pi / min(cutter.pitch),
        )
    parts = max(1, math.ceil(cut.file.step * wanted / a_turn - 1e-9))
    return cut.file.step / parts


def _resolution(case: Case, cutter: Cutter, modes: tuple, step: float) -> Resolution:
    a_turn = 2.0 * math.pi / case.cut.spindle_speed
    by = math.lcm(4, case.tool.teeth)
    bins = math.ceil(a_turn / step / by) * by
    turns = revolutions_of(case, modes)
    steps = turns * a_turn / step
    return Resolution(bins, bounds_of(case, cutter), turns, max(1, math.ceil(steps / _MOST_ROWS)))


def _set_points(
    cut: MachineCut, feed: float, speed: float, duration: float, before: float
) -> SetPoints:
    """Axes that come to speed smoothly before the cut, the spindle at speed from the start."""
    machine = cut.machine
    cycle = _cycle(cut)
    time = cycle * np.arange(math.ceil(duration / cycle) + 2)
    ramp = max(min(_SPEEDING_UP, before), _LEAST_SPEEDING_UP)
    share = np.clip(time / ramp, 0.0, 1.0)
    # half a cosine of velocity
    rising = 0.5 * (1.0 - np.cos(np.pi * share))
    travel = np.where(
        share < 1.0, 0.5 * ramp * (share - np.sin(np.pi * share) / np.pi), time - 0.5 * ramp
    )
    gain = np.where(share < 1.0, 0.5 * np.pi / ramp * np.sin(np.pi * share), 0.0)
    position, velocity, acceleration = np.zeros((3, time.size, max(len(machine.axes), 1)))
    for axis, full in cut.velocities(feed, speed).items():
        index = machine.axes.index(axis)
        turning = axis == cut.spindle_axis
        position[:, index] = full * (time if turning else travel)
        velocity[:, index] = full * (1.0 if turning else rising)
        acceleration[:, index] = 0.0 if turning else full * gain
    return SetPoints(position, velocity, acceleration, round(cycle / cut.file.step))


def _cycle(cut: MachineCut) -> float:
    """Interpolation cycle, s."""
    drives = cut.machine.drives
    return interpolation_cycle(
        (drive.controller.position.timing.sample_time for drive in drives), cut.file.step
    )


def _refuse_unmoved(case: Case, cut: MachineCut, course: ToolCourse) -> None:
    """Refuse a program along a direction in which no axis moves the tool, while others do."""
    if not cut.travels:
        return
    samples = course.trajectory.at(np.linspace(0.0, course.duration, _SAMPLES)).position
    for number, axis in enumerate("xy"):
        if axis not in cut.travels and np.ptp(samples[:, number]) > _NOTHING:
            raise InputError(
                f"{case.name}: simulation.program: it moves along {axis}, in which no axis of "
                f"{cut.file.name} under control moves the tool"
            )


def _set_points_of(
    cut: MachineCut, course: ToolCourse, duration: float, before: float
) -> SetPoints:
    """Axes that follow a program from rest, and the spindle at its speeds."""
    machine, cycle = cut.machine, _cycle(cut)
    time = cycle * np.arange(math.ceil(duration / cycle) + 2) - before
    motion = course.trajectory.at(time)
    start = course.trajectory.at(np.zeros(1)).position
    position, velocity, acceleration = np.zeros((3, time.size, max(len(machine.axes), 1)))
    for way, shares in cut.travels.items():
        number = "xyz".index(way)
        for axis, share in shares.items():
            index = machine.axes.index(axis)
            position[:, index] += share * (motion.position - start)[:, number]
            velocity[:, index] += share * motion.velocity[:, number]
            acceleration[:, index] += share * motion.acceleration[:, number]
    if cut.spindle_axis is not None:
        index = machine.axes.index(cut.spindle_axis)
        turned = course.spindle.angle_at(time)
        position[:, index] = cut.sense * (turned - turned[0])
        velocity[:, index] = cut.sense * course.spindle.speed_at(time)
    return SetPoints(position, velocity, acceleration, round(cycle / cut.file.step))


def _along(case: Case, cut: MachineCut, points: SetPoints) -> MachinesAlong | None:
    """Machine along the axes that the cut sends far enough to change its structure."""
    section = case.structure
    moved = {*cut.feeds, *(axis for shares in cut.travels.values() for axis in shares)}
    travelled = {}
    for column, axis in enumerate(cut.machine.axes):
        if axis in moved:
            positions = points.position[:, column]
            travelled[axis] = (float(positions.min()), float(positions.max()))
    return machine_along_axes(
        cut.file,
        travelled,
        lambda machine, places: rows_of_cut(case, cut.file, machine, places),
        section.travel_positions,
        StateOfMachine(section.condition, section.position, section.friction is not False),
        cut.machine,
    )


def _tables(
    cut: MachineCut, speed: float, step: float, points: SetPoints, along: MachinesAlong | None
) -> StructureTables:
    outputs = named_rows(cut.tool, cut.spindle)
    parts = round(cut.file.step / step)
    points = points._replace(steps=points.steps * parts)
    try:
        return machine_tables(cut.machine, step, points, {}, outputs, _start(cut, speed), along)
    except (StructureError, ControlError) as error:
        raise InputError(f"{cut.file.name}: {error}") from error


def _start(cut: MachineCut, speed: float) -> NDArray[np.float64]:
    """Velocity of the freedoms with the spindle at speed and all else at rest."""
    if cut.spindle_axis is None:
        return np.zeros(cut.machine.structure.size)
    return rigid_motion(cut.machine, {cut.spindle_axis: cut.sense * speed})


def _notes(cut: MachineCut, along: MachinesAlong | None) -> tuple[str, ...]:
    notes = list(cut.notes)
    if along is not None:
        travel = "; ".join(
            f"{axis} from {first:g} to {last:g} mm at {len(one)} positions"
            for axis, one in zip(along.axes, along.positions, strict=True)
            for first, last in [1e3 * one[[0, -1]] + 0.0]
        )
        notes.append(f"the structure changes as the axes travel: {travel}")
    if not cut.feeds:
        notes.append("no axis under control feeds the tool: its path is prescribed")
    if cut.spindle is None:
        notes.append("no spindle under control turns the tool: its speed is prescribed")
    return tuple(notes)
