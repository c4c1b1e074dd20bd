"""Receptance and modes at the tool point of an assembly, for one stick-out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from chatter.assembly.assembly_file import AssemblyFile, Joint
from chatter.assembly.library import HolderEntry, ToolEntry
from chatter.assembly.line import holder_segments, tool_segments
from chatter.description.errors import RunError
from dynamics.frf.container import Frf, MeasurementError, Point
from dynamics.identification.fit import identify_modes
from dynamics.identification.result import ModalFit
from dynamics.receptance.timoshenko import line_receptance


@dataclass(frozen=True, eq=False)
class Base:
    """What the holder is on: dynamic stiffness (m, 2, 2) at frequencies (m,), N/m and kin."""

    frequency: NDArray[np.float64]
    stiffness: NDArray[np.complex128]


def tool_point_receptance(
    file: AssemblyFile, base: Base, tool: ToolEntry, holder: HolderEntry | None, stick_out: float
) -> NDArray[np.complex128]:
    """Receptance (m,) at the tip, m/N, of a tool that is out by `stick_out`, m."""
    stiffness = base.stiffness
    if holder is not None:
        segments = holder_segments(holder, tool, stick_out)
        face = line_receptance(base.frequency, segments, stiffness, file.loss_factor)
        stiffness = np.linalg.inv(face)
    if file.joint is not None:
        flexible = np.linalg.inv(_joint(file.joint, base.frequency))
        stiffness = np.linalg.inv(np.linalg.inv(stiffness) + flexible)
    segments = tool_segments(tool, stick_out)
    return line_receptance(base.frequency, segments, stiffness, file.loss_factor)[:, 0, 0]


def _joint(joint: Joint, frequency: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Dynamic stiffness (m, 2, 2) of a joint."""
    omega = 2.0 * np.pi * frequency
    found = np.zeros((frequency.size, 2, 2), dtype=np.complex128)
    found[:, 0, 0] = joint.stiffness + 1j * omega * joint.damping
    found[:, 1, 1] = joint.rotational_stiffness + 1j * omega * joint.rotational_damping
    return found


def tool_point_frf(base: Base, receptance: NDArray[np.complex128], source: str) -> Frf:
    """FRF of the tool point along x."""
    tip = Point("tip", "x")
    return Frf(base.frequency, receptance, "receptance", tip, tip, source=source)


def tool_point_modes(frf: Frf) -> ModalFit:
    """Modes of a computed response; RunError where it shows none."""
    try:
        fit = identify_modes([frf])
    except MeasurementError as error:
        raise RunError(f"{frf.source}: no modes: {error}") from error
    if not fit.modes:
        raise RunError(f"{frf.source}: no modes: {fit.no_mass_reason}")
    return fit
