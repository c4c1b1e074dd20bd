"""A case compiled to law groups, modes and record."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from chatter.compile.cutter import cutter_of, edge_law, flank_table, force_law, helix_angles
from chatter.compile.empirical import force_factor
from chatter.compile.inclined_axis import check_inclined_axis, hint_of_tilt, is_inclined, tool_axis
from chatter.compile.teeth_on_the_tool import refuse_teeth_off_the_tool
from chatter.compile.worn_flank import notes_on_worn_flank
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.plausibility import check_plausible
from chatter.description.questioned import questions
from chatter.description.stated_engagement import ENGAGEMENT_KEYS
from chatter.description.unit_system import units_of
from chatter.description.units import rpm
from chatter.simulation.resolution import Resolution, slices_of_inclined
from chatter.simulation.spindle import (
    ProgrammedSpindle,
    Spindle,
    ToolPath,
    path_of,
    path_of_last_revolution,
    spindle_of,
)
from chatter.simulation.start_in_stock import clear_start
from chatter.simulation.structure_in_time import StructureInTime, modes_in_time, modes_of
from chatter.simulation.tool_course import ToolCourse, tool_course
from chatter.simulation.workpiece import REVOLUTIONS_BEFORE, discrete_cut, reading_notes
from cutting.chip.delayed_chip import DelayedCut
from cutting.chip.discrete_chip import DiscreteCut
from cutting.chip.inclined_chip import InclinedCut, inclined_cut
from cutting.chip.regeneration import delayed_cut
from cutting.engagement.immersion import slice_arcs, slice_engagement
from cutting.process_damping.contact import ToolContact
from cutting.tool.cutter import Cutter, EdgeSlices, slices_between
from dynamics.modal.modes import Mode

if TYPE_CHECKING:
    from chatter.compile.machine_cut import MachineCut

#: the model of the chip holds while the tool moves by less than this share of its radius
_FURTHEST = 0.2


@dataclass(frozen=True)
class Setup:
    """What the time loop needs to run a case, once."""

    case: Case
    cutter: Cutter
    slices: EdgeSlices
    structure: StructureInTime  # it holds the state of one run
    spindle: Spindle | ProgrammedSpindle
    path: ToolPath | ToolCourse
    groups: tuple  # laws at the tool point; the cut comes first. They hold the state of one run
    furthest: float  # displacement at which the run stops, m
    notes: tuple[str, ...]
    left_behind: tuple = ()  # walls of what is no longer held of the stock, along x, after a run

    @property
    def revolutions_before(self) -> int:
        """Turns before the start in which the tool, at rest, carves what it finds at the start."""
        carved = isinstance(self.groups[0], DiscreteCut) and self.case.stock is None
        return REVOLUTIONS_BEFORE if carved else 0

    @property
    def modes(self) -> tuple[Mode, ...]:
        """Modes of the structure; none for a rigid tool."""
        return self.structure.modes

    @property
    def resolution(self) -> Resolution:
        """Steps and slices of the run."""
        return self.structure.resolution

    @property
    def step(self) -> float:
        """Time step, s."""
        return self.structure.step

    @property
    def steps(self) -> int:
        """Steps of the cut."""
        return self.structure.steps

    @property
    def on_machine(self) -> MachineCut | None:
        """Machine that makes the cut, where there is one."""
        return self.structure.on_machine

    @property
    def turned_by_port(self) -> bool:
        """Whether a spindle of the machine turns the tool, which else turns as prescribed."""
        return self.on_machine is not None and self.on_machine.spindle is not None


def set_up(case: Case, modes: tuple[Mode, ...] | None = None) -> Setup:
    """Compile a case for the time domain.

    Modes are those of the structure, where they are known already; a machine has its own.
    InputError if a section is missing, or the case holds what cannot be simulated.
    """
    return with_start_cleared(set_up_in_stock(case, modes))


def set_up_in_stock(case: Case, modes: tuple[Mode, ...] | None = None) -> Setup:
    """Compile a case as `set_up` does, but leave the stock whole where the tool begins."""
    check_case(case)
    course = tool_course(case)
    if course is not None:
        case = course.fitted(case)
    cutter = cutter_of(case)
    return _compiled(case, cutter, _structure_in_time(case, cutter, modes, course), course)


def _structure_in_time(
    case: Case,
    cutter: Cutter,
    modes: tuple[Mode, ...] | None = None,
    course: ToolCourse | None = None,
) -> StructureInTime:
    """Compile the structure of a case for the time domain.

    Modes where they are known already; a machine has its own, and moves its axes along the course
    of the tool, where there is one. InputError if the structure cannot be
    read or the machine cannot make the cut.
    """
    if case.structure is not None and case.structure.machine is not None:
        from chatter.simulation.machine_in_time import machine_in_time

        return machine_in_time(case, cutter, course)
    notes: tuple[str, ...] = ()
    if modes is None:
        modes, notes = modes_of(case)
    spread = 1.0 if course is None else course.fastest / course.slowest
    return modes_in_time(case, cutter, modes, notes, spread)


def with_start_cleared(setup: Setup) -> Setup:
    """Setup without what of its stock lies within the tool at the start, and a note of that."""
    cut = setup.groups[0]
    if not isinstance(cut, DiscreteCut) or setup.case.stock is None:
        return setup
    notes = clear_start(setup.case, cut, setup.slices, setup.path)
    return replace(setup, notes=(*setup.notes, *notes))


def set_up_on_modes(case: Case, modes: tuple[Mode, ...]) -> Setup:
    """Compile a case with the delayed chip on modes, as small vibration of it is followed.

    A machine is then taken by the modes of its linearised dynamics.
    """
    case = delayed(case)
    check_case(case)
    cutter = cutter_of(case)
    return _compiled(case, cutter, modes_in_time(case, cutter, modes))


def delayed(case: Case) -> Case:
    """Return the case with the delayed chip and the steady engagement of [cut]."""
    settings = case.simulation
    if settings is not None:
        settings = settings.model_copy(update={"chip": "delay", "path": None, "program": None})
    return case.model_copy(update={"simulation": settings, "stock": None})


def check_case(case: Case) -> None:
    """Refuse a case that lacks what a simulation needs, or whose numbers cannot be meant."""
    case.require("tool", "material", "cut")
    check_plausible(case)
    check_inclined_axis(case)
    refuse_teeth_off_the_tool(case)


def _compiled(
    case: Case, cutter: Cutter, structure: StructureInTime, course: ToolCourse | None = None
) -> Setup:
    """Compile tool, chip and contact on a structure, along the course of a program if given."""
    resolution = structure.resolution
    slices = _slices(case, cutter, resolution)
    _refuse_crossing_flutes(case, slices)
    _refuse_out_of_reach(case, slices)
    spindle, path = spindle_of(case), path_of(case)
    if course is not None:
        spindle, path = course.spindle, course
    bent = case.simulation is not None and case.simulation.path is not None
    if bent and case.stock is None and case.simulation.chip != "delay":
        raise InputError(
            f"{case.name}: simulation.path: a path of its own needs a [stock] to lead through"
        )
    notes = (*questions(case), *structure.notes)
    if case.tool.axial_error and np.all(slices.immersion > 0.5 * math.pi - 1e-9):
        notes += ("tool.axial_error changes no force: the edge is parallel to the tool axis",)
    if course is not None:
        notes += _notes_on(course, case)
    if case.stock is not None and course is None:
        notes += ("the engagement changes along the path; the verdict is that of the whole record",)
    notes += tuple(notes_on_worn_flank(case, force_law(case, helix_angles(case)[0])))
    chip = "inclined" if is_inclined(case) else "delay"
    if case.simulation is not None and case.simulation.chip != "delay":
        chip = case.simulation.chip
    groups: tuple = (CHIPS[chip](case, cutter, slices, structure.modes, resolution, spindle, path),)
    if isinstance(groups[0], DiscreteCut):
        notes += reading_notes(case, cutter, groups[0])
    factor = force_factor(case, resolution.steps_per_revolution)
    groups += () if factor is None else (factor,)
    if case.contact is not None:
        contact = case.contact
        groups += (ToolContact(contact.stiffness, contact.damping, contact.full_engagement_share),)
    return Setup(
        case=case,
        cutter=cutter,
        slices=slices,
        structure=structure,
        spindle=spindle,
        path=path,
        groups=groups,
        furthest=_furthest(cutter, structure, course),
        notes=notes,
    )


def _slices(case: Case, cutter: Cutter, resolution: Resolution) -> EdgeSlices:
    """Slices of the edges; of an inclined tool those that are in the cut."""
    if is_inclined(case):
        return slices_of_inclined(case, cutter).slices
    return slices_between(cutter, resolution.bounds)


def _furthest(cutter: Cutter, structure: StructureInTime, course: ToolCourse | None) -> float:
    """Displacement of the tool at which a run stops, m.

    Axes that follow a program lag behind it, which is no vibration.
    """
    if course is not None and structure.on_machine is not None:
        return cutter.radius
    return _FURTHEST * cutter.radius


def _notes_on(course: ToolCourse, case: Case) -> tuple[str, ...]:
    """What is taken from a program, and what of it does not cut."""
    file = case.simulation.program.file.name
    speeds = sorted({rpm(course.slowest), rpm(course.fastest)})
    told = " to ".join(f"{speed:.6g}" for speed in speeds)
    notes = [
        f"{file}: {course.duration:.4g} s at {told} rpm, up to "
        f"{units_of(case).length.text(course.feed_per_tooth)} a tooth; the verdict is that of its "
        "parts at a constant feed"
    ]
    if course.in_air.size:
        spent = float(np.diff(course.in_air, axis=1).sum())
        above = "above its lowest height"
        where = f"in rapid traverse or {above}" if case.simulation.chip == "delay" else above
        notes.append(f"{file}: the tool is in the air for {spent:.4g} s, {where}; no plunge cuts")
    return tuple(notes)


def _refuse_crossing_flutes(case: Case, slices: EdgeSlices) -> None:
    """Flutes of different helix must keep their distance along the edge."""
    first_again = slices.angle[:1] + 2.0 * math.pi
    gap = np.diff(np.concatenate([slices.angle, first_again]), axis=0)
    touching = np.any(gap <= 0.0, axis=0)
    if touching.any():
        height = slices.height[int(np.argmax(touching))]
        raise InputError(
            f"{case.name}: tool.helix: flutes of these angles run into each other "
            f"{height * 1e3:.3g} mm above the tip"
        )


def _refuse_out_of_reach(case: Case, slices: EdgeSlices) -> None:
    """Refuse a cut that no slice of the edge reaches."""
    if is_inclined(case):
        if slices.height.size == 0:
            raise InputError(
                f"{case.name}: cut.{_stated(case)}: down to an axial depth of "
                f"{case.cut.axial_depth * 1e3:g} mm no edge of the inclined tool reaches the work"
                f"{hint_of_tilt(case)}"
            )
        return
    entry, leave = slice_engagement(case.uncut_band, slices.radius)
    if np.all(entry >= leave):
        raise InputError(
            f"{case.name}: cut.{_stated(case)}: down to an axial depth of "
            f"{case.cut.axial_depth * 1e3:g} mm the edge is nowhere wider than "
            f"{slices.radius.max() * 2e3:.4g} mm; the work is not reached. A radial depth counts "
            "from the full radius of the tool; a step from pass to pass is stated by stepover"
        )


def _stated(case: Case) -> str:
    """Key that states the engagement."""
    return next((key for key in ENGAGEMENT_KEYS if getattr(case.cut, key) is not None), "mode")


def _delayed(
    case: Case,
    cutter: Cutter,  # noqa: ARG001  (every chip has the same signature)
    slices: EdgeSlices,
    modes: tuple[Mode, ...],  # noqa: ARG001
    resolution: Resolution,
    spindle: Spindle | ProgrammedSpindle,
    path: ToolPath | ToolCourse,
) -> DelayedCut:
    if case.stock is not None or (case.simulation and case.simulation.path):
        raise InputError(
            f'{case.name}: simulation.chip: "delay" knows the engagement of [cut] alone, along a '
            'straight line; [stock] and simulation.path need chip = "dexel" or "voxel"'
        )
    bins = resolution.steps_per_revolution
    return delayed_cut(
        slices,
        slice_arcs(case.uncut_band, np.stack([slices.lower_radius, slices.upper_radius], axis=1)),
        edge_law(case),
        flank_table(case, slices.radius, 2.0 * math.pi / bins),
        bins,
        path_of_last_revolution(spindle, path, bins),
    )


def _inclined(
    case: Case,
    cutter: Cutter,
    slices: EdgeSlices,
    modes: tuple[Mode, ...],  # noqa: ARG001
    resolution: Resolution,
    spindle: Spindle | ProgrammedSpindle,
    path: ToolPath | ToolCourse,
) -> InclinedCut:
    """Delayed chip of a tool with an inclined axis, set up in the axes of the tool."""
    bins, frame = resolution.steps_per_revolution, tool_axis(case).frame
    engaged = slices_of_inclined(case, cutter)
    before = path_of_last_revolution(spindle, path, bins)
    cut = delayed_cut(
        slices,
        (engaged.entry, engaged.exit),
        edge_law(case),
        flank_table(case, slices.radius, 2.0 * math.pi / bins),
        bins,
        frame[:2].T @ before,
    )
    return inclined_cut(cut, frame)


#: name in a case file -> group of the cutting force; "inclined" where the axis is, for "delay"
CHIPS = {"delay": _delayed, "inclined": _inclined, "dexel": discrete_cut, "voxel": discrete_cut}
