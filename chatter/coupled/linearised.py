"""The machine of a case as the stability methods see it: FRFs at the tool point, linearised."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from chatter.case import Case
from chatter.coupled.machine_cut import MachineCut, machine_cut
from chatter.errors import InputError
from chatter.measured_frf import MeasuredSide
from chatter.structure import MeasuredStructure
from chatter.virtual_machine.frf import linearised_frictions
from chatter.virtual_machine.loop_stability import refuse_unstable_control
from dynamics.frf import Frf, Point
from dynamics.machine.harmonic import receptance

#: lines of the FRFs, and how far they reach above the highest mode that matters at the tool point
_LINES = 1600
_ABOVE = 1.5
#: flexibility at the tool point, as a share of the largest, above which a mode matters
_MATTERS = 0.01
_LOWEST = 1.0


def machine_structure(case: Case) -> MeasuredStructure:
    """Structure of a case whose dynamics come from a machine.

    The machine moves at the feed of the case, so that frictions on moving axes slide and others
    stick; the control loops are closed. Modes are fitted to its FRFs when they are asked for.

    Raises
    ------
    InputError
        If the machine cannot make the cut, or its control is unstable.
    """
    cut = machine_cut(case)
    refuse_unstable_control(cut.machine, cut.file.step)
    lines = _lines(case, cut)
    values = tool_receptance(case, cut, lines)
    source = f"{cut.file.name}, linearised"
    frfs = tuple(
        Frf(lines, values[:, i, j], "receptance", Point("tool", a), Point("tool", b), source=source)
        for i, a in enumerate("xyz")
        for j, b in enumerate("xyz")
        if np.any(np.abs(values[:, i, j]) > 0.0)
    )
    return MeasuredStructure((MeasuredSide("tool", frfs, "tool"),), _notes(cut))


def tool_receptance(
    case: Case, cut: MachineCut, frequency: NDArray[np.float64], amplitude: float | None = None
) -> NDArray[np.complex128]:
    """Receptance (m, 3, 3) of the tool against the workpiece in the directions of the cut, m/N.

    Parameters
    ----------
    case : Case
    cut : MachineCut
    frequency : (m,) array of float
        Hz, above 0.
    amplitude : float, optional
        Of the motion at frictions that do not slide, m (rad), for their describing functions.
    """
    moving = _moving(case, cut)
    frictions = linearised_frictions(cut.machine, moving, amplitude)
    return receptance(cut.machine, frequency, cut.tool, cut.file.step, frictions)


def _moving(case: Case, cut: MachineCut) -> dict[str, float]:
    teeth, speed = case.tool.teeth, case.cut.spindle_speed
    feed = case.cut.feed_per_tooth * teeth * speed / (2.0 * math.pi)
    return cut.velocities(feed, speed)


def _lines(case: Case, cut: MachineCut) -> NDArray[np.float64]:
    modes = cut.modes()
    if not modes:
        raise InputError(f"{case.name}: structure.machine: {cut.file.name} is rigid at the tool")
    compliance = np.array([1.0 / mode.stiffness for mode in modes])
    frequency = np.array([mode.frequency for mode in modes])
    matters = compliance > _MATTERS * compliance.max()
    return np.linspace(_LOWEST, _ABOVE * float(frequency[matters].max()), _LINES)


def _notes(cut: MachineCut) -> tuple[str, ...]:
    notes = [f"dynamics of {cut.file.name}, linearised, its control loops closed"]
    if cut.machine.frictions:
        notes.append("frictions of axes that move slide, those of others stick")
    return tuple(notes)
