"""A case on a machine compiled for the time loop."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from chatter.compile.cutter import cutter_of
from chatter.compile.machine_cut import MachineCut, machine_cut
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.engine.machine_cut_loop import ToolSide
from chatter.simulation.resolution import LARGEST_LAG, Resolution, turns_of
from chatter.simulation.setup import Setup, check_case, compiled, shortest_arc
from chatter.simulation.virtual_tests.loop_stability import refuse_unstable_control
from cutting.tool.cutter import Cutter, slice_counts
from dynamics.control.sampling import ControlError
from dynamics.machine.tables import MachineTables, machine_tables
from dynamics.structure.linear_structure import StructureError
from dynamics.trajectory.set_points import SetPoints

#: steps of the time that a tooth is in the cut, and between teeth, at the least
_STEPS_A_CUT = 40
_STEPS_A_PITCH = 16
#: time that the machine runs before the cut, over which its axes come to speed, and in which they
#: can at all, s
_SETTLING, _SPEEDING_UP, _LEAST_SPEEDING_UP = 1.0, 0.3, 0.05
#: rows of the record, at the most
_MOST_ROWS = 200_000


@dataclass(frozen=True, kw_only=True)
class MachineSetup(Setup):
    """What the loop of machine and cut needs.

    Parameters
    ----------
    on_machine : MachineCut
    tables : MachineTables
    machine_step : float
        Time step, s.
    settling : int
        Steps of the machine before the cut.
    """

    on_machine: MachineCut
    tables: MachineTables
    machine_step: float
    settling: int

    @property
    def step(self) -> float:
        """Time step, s."""
        return self.machine_step

    @property
    def steps(self) -> int:
        """Steps of the cut."""
        a_turn = 2.0 * math.pi / self.spindle.speed
        return max(1, round(self.resolution.turns * a_turn / self.machine_step))


def set_up_machine(case: Case, on_machine: MachineCut | None = None) -> MachineSetup:
    """Compile a case whose structure is a machine.

    Parameters
    ----------
    case : Case
    on_machine : MachineCut, optional
        Where it is known already.

    Raises
    ------
    InputError
        If the case cannot be simulated or the machine cannot make the cut.
    """
    check_case(case)
    if case.cut.speed_variation is not None:
        raise InputError(
            f"{case.name}: cut.speed_variation: the spindle of a machine turns as its drive lets it"
        )
    if case.simulation is not None and case.simulation.path is not None:
        raise InputError(f"{case.name}: simulation.path: a machine is fed along a straight line")
    cut = machine_cut(case) if on_machine is None else on_machine
    cutter = cutter_of(case)
    step = _step(case, cut, cutter)
    refuse_unstable_control(cut.machine, step)
    modes = cut.modes()
    resolution = _resolution(case, cutter, modes, step)
    notes = _notes(cut)
    base = compiled(case, cutter, modes, resolution, notes)
    before = round(_time_before(case, cut) / step)
    feed = base.path.feed
    duration = before * step + _length(base, step)
    points = _set_points(cut, feed, case.cut.spindle_speed, duration, before * step)
    tables = _tables(cut, case, step, points)
    known = {field.name: getattr(base, field.name) for field in fields(Setup)}
    return MachineSetup(**known, on_machine=cut, tables=tables, machine_step=step, settling=before)


def tool_side(setup: MachineSetup) -> ToolSide:
    """Where the cut meets the machine as it stands, at the beginning of the cut."""
    port, s = setup.tables.port, setup.tables.steps
    places = np.array([port[f"tool {axis}"] for axis in "xyz"], dtype=np.int64)
    turning = [port["tool turn"]] if setup.on_machine.spindle is not None else []
    feed = np.array([setup.path.feed, 0.0, 0.0])
    return ToolSide(
        port=places,
        spindle=np.array(turning, dtype=np.int64),
        origin=s.u[places].copy(),
        feed=feed,
        carried=feed if setup.on_machine.feeds else np.zeros(3),
        speed=setup.spindle.speed,
        angle=float(s.u[turning[0]]) if turning else 0.0,
        bins=setup.resolution.steps_a_turn,
        force=np.zeros(3),
        torque=np.zeros(1),
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
            f"{_LEAST_SPEEDING_UP:g} s or more is wanted"
        )
    return settling


def _step(case: Case, cut: MachineCut, cutter: Cutter) -> float:
    """Step of the machine file, or a whole part of it that resolves the cut."""
    a_turn = 2.0 * math.pi / case.cut.spindle_speed
    section = case.simulation
    wanted = section.steps if section and section.steps else None
    if wanted is None:
        wanted = max(
            _STEPS_A_CUT * 2.0 * math.pi / shortest_arc(case, cutter),
            _STEPS_A_PITCH * 2.0 * math.pi / min(cutter.pitch),
        )
    parts = max(1, math.ceil(cut.file.step * wanted / a_turn - 1e-9))
    return cut.file.step / parts


def _resolution(case: Case, cutter: Cutter, modes: tuple, step: float) -> Resolution:
    a_turn = 2.0 * math.pi / case.cut.spindle_speed
    by = math.lcm(4, case.tool.teeth)
    bins = math.ceil(a_turn / step / by) * by
    section = case.simulation
    chip = section.chip if section else "delay"
    corner, straight = slice_counts(cutter, case.cut.axial_depth, LARGEST_LAG[chip])
    if section and section.slices and straight:
        straight = section.slices
    turns = turns_of(case, modes)
    steps = turns * a_turn / step
    return Resolution(bins, (corner, straight), turns, max(1, math.ceil(steps / _MOST_ROWS)))


def _length(base: Setup, step: float) -> float:
    return base.resolution.turns * 2.0 * math.pi / base.spindle.speed + 10.0 * step


def _set_points(
    cut: MachineCut, feed: float, speed: float, duration: float, before: float
) -> SetPoints:
    """Axes that come to speed smoothly before the cut, the spindle at speed from the start."""
    machine = cut.machine
    cycle = max(
        (drive.controller.position.timing.sample_time for drive in machine.drives),
        default=cut.file.step,
    )
    time = cycle * np.arange(math.ceil(duration / cycle) + 2)
    ramp = max(min(_SPEEDING_UP, before), _LEAST_SPEEDING_UP)
    share = np.clip(time / ramp, 0.0, 1.0)
    # half a cosine of velocity
    rising = 0.5 * (1.0 - np.cos(np.pi * share))
    way = np.where(
        share < 1.0,
        0.5 * ramp * (share - np.sin(np.pi * share) / np.pi),
        time - 0.5 * ramp,
    )
    gain = np.where(share < 1.0, 0.5 * np.pi / ramp * np.sin(np.pi * share), 0.0)
    columns = [np.zeros((time.size, max(len(machine.axes), 1))) for _ in range(3)]
    for axis, velocity in cut.velocities(feed, speed).items():
        place = machine.axes.index(axis)
        turning = axis == cut.spindle_axis
        columns[0][:, place] = velocity * (time if turning else way)
        columns[1][:, place] = velocity * (1.0 if turning else rising)
        columns[2][:, place] = 0.0 if turning else velocity * gain
    return SetPoints(*columns, round(cycle / cut.file.step))


def _tables(cut: MachineCut, case: Case, step: float, points: SetPoints) -> MachineTables:
    outputs = {f"tool {axis}": row for axis, row in zip("xyz", cut.tool, strict=True)}
    if cut.spindle is not None:
        outputs["tool turn"] = cut.spindle
    parts = round(cut.file.step / step)
    points = points._replace(steps=points.steps * parts)
    try:
        return machine_tables(
            cut.machine, step, points, {}, outputs, _start(cut, case.cut.spindle_speed)
        )
    except (StructureError, ControlError) as error:
        raise InputError(f"{cut.file.name}: {error}") from error


def _start(cut: MachineCut, speed: float) -> NDArray[np.float64]:
    """Velocity of the freedoms with the spindle at speed and all else at rest."""
    from chatter.compile.rigid_motion import rigid_motion

    if cut.spindle_axis is None:
        return np.zeros(cut.machine.structure.size)
    return rigid_motion(cut.machine, {cut.spindle_axis: cut.sense * speed})


def _notes(cut: MachineCut) -> tuple[str, ...]:
    notes = []
    if not cut.feeds:
        notes.append("no axis under control feeds the tool: its path is prescribed")
    if cut.spindle is None:
        notes.append("no spindle under control turns the tool: its speed is prescribed")
    return tuple(notes)
