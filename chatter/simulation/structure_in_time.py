"""The structure of a case in the time domain: modes, or a machine with its drives and frictions."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from chatter.compile.structure import MeasuredStructure, structure_of
from chatter.description.case import Case
from chatter.simulation.resolution import Resolution, resolution_of
from cutting.tool.cutter import Cutter
from dynamics.machine.tables import StructureTables, modal_tables
from dynamics.modal.modes import Mode

if TYPE_CHECKING:
    from chatter.compile.machine_cut import MachineCut


@dataclass(frozen=True, eq=False)
class StructureInTime:
    """What stands behind the ports of the time loop, at rest, and its steps."""

    #: empty for a rigid tool; of a machine those of its structure, for resolution and pictures
    modes: tuple[Mode, ...]
    resolution: Resolution
    step: float  # time step, s
    steps: int  # of the cut
    tables: StructureTables  # they hold the state of one run
    notes: tuple[str, ...] = ()
    on_machine: MachineCut | None = None  # where a machine makes the cut
    settling: int = 0  # steps that it runs in the air before

    @property
    def rubs(self) -> bool:
        """Whether there is friction on modes."""
        return self.on_machine is None and len(self.tables.implicit) > 1


def modes_of(case: Case) -> tuple[tuple[Mode, ...], tuple[str, ...]]:
    """Modes of the structure of a case, and what was assumed of it; none for a rigid tool."""
    if case.structure is None:
        return (), ("no [structure]: tool and workpiece are rigid",)
    structure = structure_of(case)
    further = structure.notes_on_modes if isinstance(structure, MeasuredStructure) else ()
    return structure.modes, (*structure.notes, *further)


def modes_in_time(
    case: Case,
    cutter: Cutter,
    modes: tuple[Mode, ...],
    notes: tuple[str, ...] = (),
    speed_spread: float = 1.0,
) -> StructureInTime:
    """Compile modes with the frictions on them.

    The spread is the fastest spindle speed of a run over that of [cut], its slowest.
    """
    resolution = resolution_of(case, cutter, modes)
    if speed_spread > 1.0:
        finer = math.ceil(resolution.steps_per_revolution * speed_spread)
        settings = case.simulation.model_copy(update={"steps": finer})
        finer_case = case.model_copy(update={"simulation": settings})
        resolution = resolution_of(finer_case, cutter, modes)
    step = 2.0 * math.pi / (case.cut.spindle_speed * resolution.steps_per_revolution)
    given = case.structure.mode if case.structure is not None else ()
    frictions = {
        index: case.friction[mode.friction].spec()
        for index, mode in enumerate(given)
        if mode.friction
    }
    tables = modal_tables(modes, step, tuple(frictions.values()), tuple(frictions))
    return StructureInTime(tuple(modes), resolution, step, resolution.steps, tables, notes)
