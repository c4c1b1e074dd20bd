"""Compile a Case into what the stability methods see: flat arrays, receptances, mean matrices."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from chatter.case import Case
from chatter.errors import InputError
from chatter.plausibility import check_plausible
from chatter.simulation.cutter import force_law, helix_angles
from chatter.stability.arrays import MillingArrays
from chatter.structure import Structure, structure_of
from cutting.directional import DirectionalTable, directional_table, mean_over_turn
from cutting.engagement import engagement
from cutting.process_damping import ViscousProcessDamping

#: directions of motion weaker than this, relative to the strongest, do not count
_RANK_TOLERANCE = 1e-9


@dataclass(frozen=True)
class MillingModel:
    """A case compiled for stability, spindle speed and axial depth left open.

    Parameters
    ----------
    case : Case
        That it was compiled from.
    structure : Structure
    basis : (3, r) array of float
        Orthonormal columns that span the motion of the tool point.
    table : DirectionalTable
    teeth : int
    lag_per_depth : float
        tan(helix)/R, rad/m.
    radius : float
        m.
    notes : tuple of str
        Assumptions and limits that the user should know of.
    """

    case: Case
    structure: Structure
    basis: NDArray[np.float64]
    table: DirectionalTable
    teeth: int
    lag_per_depth: float
    radius: float
    notes: tuple[str, ...]

    @property
    def mean_directional(self) -> NDArray[np.float64]:
        """Mean directional matrix over a revolution (r, r), N/m^2."""
        return mean_over_turn(self.table, self.teeth)[0]

    @cached_property
    def arrays(self) -> MillingArrays:
        """What semi-discretization sees; fits modes where the structure is measured."""
        modes = self.structure.modes
        shape = np.array([mode.direction for mode in modes]) @ self.basis
        mass = np.array([mode.mass for mode in modes])
        return MillingArrays(
            natural_frequency=np.array([mode.natural_frequency for mode in modes]),
            damping=np.array([mode.damping for mode in modes]),
            shape=np.ascontiguousarray(shape),
            force_gain=np.ascontiguousarray(shape / mass[:, None]),
            table=self.table,
            tooth_pitch=2.0 * np.pi / self.teeth,
            lag_per_depth=self.lag_per_depth,
            radius=self.radius,
        )

    @cached_property
    def receptance(self) -> tuple[NDArray[np.float64], NDArray[np.complex128]]:
        """Lines (m,) in Hz and relative receptance (m, r, r) in the directions of motion, m/N.

        As measured, with no fit, where the case names FRFs; else that of the modes.
        """
        lines, full = self.structure.receptance()
        return lines, np.einsum("ai,nab,bj->nij", self.basis, full, self.basis)


def milling_model(case: Case) -> MillingModel:
    """Compile a case for the stability methods.

    Raises
    ------
    InputError
        If a section is missing, or the case holds what no stability method can treat yet.
    """
    case.require("tool", "material", "cut", "structure")
    check_plausible(case)
    _refuse_unsupported(case)
    structure = structure_of(case)
    basis = _motion_basis(structure.directions)
    damping = _process_damping(case)
    arc = engagement(case.cut.mode, case.width_of_cut, case.tool.diameter)
    table = directional_table(
        arc, force_law(case, helix_angles(case)[0]), case.cut.feed_per_tooth, basis, damping
    )
    if not np.any(table.first_integral[0, -1]):
        raise InputError(
            f"{case.name}: structure: the modes move along the tool axis alone; with a 90 degree "
            "cutting edge that motion does not change the chip, so there is no stability limit"
        )
    notes = list(structure.notes)
    if damping is not None:
        notes.append("the zeroth-order solution leaves process damping out")
    if case.process_damping is not None and case.process_damping.indentation_force is not None:
        notes.append(
            "ploughing (process_damping.indentation_force) acts in the time domain alone; the "
            "other methods leave it out"
        )
    if case.contact is not None:
        notes.append("the contact of tool and work acts in the time domain alone")
    if case.structure is not None and any(mode.friction for mode in case.structure.mode):
        notes.append("the friction of modes acts in the time domain alone")
    radius = 0.5 * case.tool.diameter
    return MillingModel(
        case=case,
        structure=structure,
        basis=basis,
        table=table,
        teeth=case.tool.teeth,
        lag_per_depth=abs(math.tan(helix_angles(case)[0])) / radius,
        radius=radius,
        notes=tuple(notes),
    )


def _refuse_unsupported(case: Case) -> None:
    problems = []
    if case.tool.kind not in ("end mill", "inserted"):
        problems.append(
            f'{case.name}: tool.kind: stability of a "{case.tool.kind}" tool is not available '
            'yet; "end mill" and "inserted" (90 degree) are'
        )
    if case.tool.pitch is not None and not np.allclose(
        case.tool.pitch, 2.0 * np.pi / case.tool.teeth, rtol=0.0, atol=1e-9
    ):
        problems.append(
            f"{case.name}: tool.pitch: stability of unequal pitch is not available yet; "
            "remove the key for equal pitch"
        )
    if len(set(helix_angles(case))) > 1:
        problems.append(
            f"{case.name}: tool.helix: stability of flutes with different helix is not "
            "available yet; give one angle"
        )
    if case.tool.cutting_edge_angle - case.tool.taper_angle < 0.5 * math.pi - 1e-9:
        problems.append(
            f"{case.name}: tool: stability of edges that do not stand at 90 deg "
            "is not available yet; chatter simulate takes them"
        )
    if case.tool.serration is not None:
        problems.append(
            f"{case.name}: tool.serration: stability of serrated edges is not available yet; "
            "chatter simulate takes them"
        )
    if case.cut.speed_variation is not None:
        problems.append(
            f"{case.name}: cut.speed_variation: stability under a varying speed is not available "
            "yet; chatter simulate takes it"
        )
    if problems:
        raise InputError(problems)


def _process_damping(case: Case) -> ViscousProcessDamping | None:
    section = case.process_damping
    if section is None or not section.coefficient:
        return None
    return ViscousProcessDamping(section.coefficient, section.friction)


def _motion_basis(directions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Orthonormal basis (3, r) of the directions (n, 3) in which the tool point can move."""
    moving = np.abs(directions).max(axis=0) > _RANK_TOLERANCE
    _, size, rows = np.linalg.svd(directions)
    rank = int(np.sum(size > _RANK_TOLERANCE * size[0]))
    # the axes themselves where they span the motion: then a one-axis structure stays exact
    if moving.sum() == rank:
        return np.ascontiguousarray(np.eye(3)[:, moving])
    return np.ascontiguousarray(rows[:rank].T)
