"""Compile a Case into what the stability methods see: flat arrays, receptances, mean matrices."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from chatter.compile.cutter import cutter_of, force_law, helix_angles, ploughing_of
from chatter.compile.structure import Structure, depends_on_speed, structure_at, structure_of
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.plausibility import check_plausible
from chatter.description.units import rpm
from chatter.simulation.setup import refuse_teeth_off_the_tool
from chatter.stability.methods.collocation.cut_arrays import RESOLUTION, CutArrays, cut_arrays
from chatter.stability.methods.matrix_free.method import stepped_cut
from chatter.stability.methods.matrix_free.steps import SteppedCut
from chatter.stability.methods.semi_discretization.arrays import MillingArrays
from chatter.stability.methods.zeroth_order.averaged_coefficients import mean_couplings
from chatter.stability.spindle_rotation import SpeedVariation
from cutting.edge_segments.edge_profile import crossing_heights
from cutting.edge_segments.segments import (
    EdgePieces,
    edge_pieces,
    period_angle,
    small_vibration_coefficient,
)
from cutting.engagement.immersion import engagement
from cutting.force.directional_coefficients import (
    DirectionalTable,
    directional_table,
    mean_over_turn,
)
from cutting.force.force_law import ForceLaw
from cutting.process_damping.ploughing import Ploughing
from cutting.process_damping.viscous import ViscousProcessDamping
from cutting.tool.cutter import Cutter

#: directions of motion weaker than this, relative to the strongest, do not count
_RANK_TOLERANCE = 1e-9
#: share by which the frequency of a varying speed may be moved, to fit into a period
_TUNING = 1e-3
#: tools and cuts whose edges are kept in pieces
_KEPT_PIECES = 64


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
    cutter : Cutter
    laws : tuple of ForceLaw
        One for each tooth.
    flank : ViscousProcessDamping, Ploughing or None
    notes : tuple of str
        Assumptions and limits that the user should know of.
    """

    case: Case
    structure: Structure
    basis: NDArray[np.float64]
    cutter: Cutter
    laws: tuple[ForceLaw, ...]
    flank: ViscousProcessDamping | Ploughing | None
    notes: tuple[str, ...]

    @property
    def teeth(self) -> int:
        """Number of teeth."""
        return self.cutter.teeth

    @property
    def depends_on_speed(self) -> bool:
        """True where the structure is another one at another spindle speed."""
        return depends_on_speed(self.case)

    def at_speed(self, spindle_speed: float) -> MillingModel:
        """Return the model with the structure of a spindle speed (rad/s).

        Raises
        ------
        InputError
            If the structure moves in other directions there.
        """
        structure = structure_at(self.case, spindle_speed)
        basis = _motion_basis(structure.directions)
        if basis.shape != self.basis.shape or not np.allclose(basis, self.basis, atol=1e-9):
            raise InputError(
                f"{self.case.name}: structure: at {rpm(spindle_speed):.0f} rpm the "
                "tool point moves in other directions than at the speed of the cut; the same are "
                "wanted at all speeds"
            )
        own = replace(self, structure=structure)
        # what the structure has no part in is computed once
        shared = ("table", "mean_couplings")
        own.__dict__.update({key: self.__dict__[key] for key in shared if key in self.__dict__})
        return own

    @property
    def lag_per_depth(self) -> float:
        """tan(helix)/R of the first tooth, rad/m."""
        return abs(math.tan(self.cutter.helix[0])) / self.cutter.radius

    @cached_property
    def table(self) -> DirectionalTable:
        """Directional matrix of an upright edge over the engaged arc."""
        case = self.case
        arc = engagement(case.cut.mode, case.width_of_cut, case.tool.diameter)
        return directional_table(
            arc, self.laws[0], case.cut.feed_per_tooth, self.basis, viscous(self.flank)
        )

    @cached_property
    def mean_couplings(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Delays (g,), rad, and mean directional matrices (g, r, r), N/m^2, over a turn."""
        if self.is_uniform:
            return np.array([2.0 * np.pi / self.teeth]), mean_over_turn(self.table, self.teeth)[:1]
        return self.mean_couplings_at(self.case.cut.axial_depth)

    def mean_couplings_at(self, depth: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The same where it is not in proportion to the depth (m): an average over that depth."""
        delays, means = mean_couplings(self.cut(depth), depth)
        return delays, means / depth

    @property
    def mean_directional(self) -> NDArray[np.float64]:
        """Mean directional matrix over a turn (r, r), N/m^2, of all delays together."""
        return self.mean_couplings[1].sum(axis=0)

    @property
    def is_uniform(self) -> bool:
        """True where all teeth are alike, evenly spaced, upright, and the speed is constant."""
        cutter = self.cutter
        return (
            np.allclose(cutter.pitch, 2.0 * np.pi / cutter.teeth, rtol=0.0, atol=1e-9)
            and len(set(cutter.helix)) == 1
            and cutter.corner_radius == 0.0
            and cutter.edge_angle >= 0.5 * math.pi - 1e-9
            and np.ptp(cutter.radial_offsets) == 0.0
            and cutter.serration is None
            and self.case.cut.speed_variation is None
        )

    @cached_property
    def _modes(self) -> tuple[NDArray[np.float64], ...]:
        modes = self.structure.modes
        shape = np.ascontiguousarray(np.array([mode.direction for mode in modes]) @ self.basis)
        mass = np.array([mode.mass for mode in modes])
        return (
            np.array([mode.natural_frequency for mode in modes]),
            np.array([mode.damping for mode in modes]),
            shape,
            np.ascontiguousarray(shape / mass[:, None]),
        )

    @cached_property
    def arrays(self) -> MillingArrays:
        """What semi-discretization sees; fits modes where the structure is measured.

        Raises
        ------
        InputError
            If the teeth are not all alike.
        """
        if not self.is_uniform:
            raise InputError(
                f"{self.case.name}: tool: this method takes teeth that are all alike, evenly "
                'spaced and upright, at a constant speed; "collocation" takes any tool'
            )
        frequency, damping, shape, gain = self._modes
        return MillingArrays(
            natural_frequency=frequency,
            damping=damping,
            shape=shape,
            force_gain=gain,
            table=self.table,
            tooth_pitch=2.0 * np.pi / self.teeth,
            lag_per_depth=self.lag_per_depth,
            radius=self.cutter.radius,
        )

    def cut(
        self, deepest: float, points: int = RESOLUTION[0], waves: float = RESOLUTION[1]
    ) -> CutArrays:
        """What collocation sees of it, down to a depth (m), at a resolution of the elements."""
        case = self.case
        pieces = _pieces_of(
            self.cutter,
            self.laws,
            case.cut.mode,
            case.width_of_cut,
            case.cut.feed_per_tooth * self.teeth,
            deepest,
            self.flank,
            waves,
        )
        varied = case.cut.speed_variation
        variation = SpeedVariation(0.0, 1.0, 0, 0.0, 0, 0)
        if varied is not None:
            variation = SpeedVariation(
                varied.amplitude, varied.frequency, int(varied.shape == "triangle"), _TUNING, 0, 0
            )
        period = period_angle(self.cutter)
        return cut_arrays(self._modes, self.basis, pieces, period, variation, points, waves)

    def stepped_cut(self, deepest: float, fineness: float = 1.0) -> SteppedCut:
        """What the matrix-free method sees of it, down to a depth (m), with the contact.

        The pieces of the edges are shorter by the factor `fineness`.
        """
        contact, cut = self.case.contact, self.cut(deepest, waves=fineness)
        if contact is None:
            return stepped_cut(cut)
        return stepped_cut(cut, (contact.stiffness, contact.damping, contact.full_engagement_share))

    @cached_property
    def receptance(self) -> tuple[NDArray[np.float64], NDArray[np.complex128]]:
        """Lines (m,) in Hz and relative receptance (m, r, r) in the directions of motion, m/N.

        As measured, with no fit, where the case names FRFs; else that of the modes.
        """
        lines, full = self.structure.receptance()
        return lines, np.ascontiguousarray(self.basis.T @ full @ self.basis)


@lru_cache(maxsize=_KEPT_PIECES)
def _pieces_of(cutter: Cutter, laws: tuple[ForceLaw, ...], *cut: object) -> EdgePieces:
    """Pieces of the edges, kept: structures and resolutions change where a tool stays the same."""
    return edge_pieces(cutter, list(laws), *cut)


def viscous(flank: ViscousProcessDamping | Ploughing | None) -> ViscousProcessDamping | None:
    """Dashpot that a flank makes for small vibration (see `cutting.edge_segments.segments`)."""
    if isinstance(flank, Ploughing):
        return ViscousProcessDamping(small_vibration_coefficient(flank), flank.friction)
    return flank


def milling_model(case: Case, structure: Structure | None = None) -> MillingModel:
    """Compile a case for the stability methods.

    Parameters
    ----------
    case : Case
    structure : Structure, optional
        That of the case, where it is known already; it is then not looked at again.

    Raises
    ------
    InputError
        If a section is missing, or the case holds what no stability method can treat.
    """
    case.require("tool", "material", "cut", "structure")
    check_plausible(case)
    refuse_teeth_off_the_tool(case)
    structure = structure_of(case) if structure is None else structure
    cutter = cutter_of(case)
    notes = list(structure.notes)
    flank = _flank(case)
    if flank is not None:
        notes.append("the zeroth-order solution leaves process damping out")
    if isinstance(flank, Ploughing):
        notes.append(
            "ploughing is taken for small vibration, as a dashpot; chatter simulate has it in full"
        )
    if case.contact is not None:
        notes.append(
            "the contact of tool and work is part of the matrix-free and time methods alone"
        )
    if case.structure is not None and any(mode.friction for mode in case.structure.mode):
        notes.append("the friction of modes acts in the time domain alone")
    model = MillingModel(
        case=case,
        structure=structure,
        basis=_motion_basis(structure.directions),
        cutter=cutter,
        laws=tuple(force_law(case, helix) for helix in helix_angles(case)),
        flank=flank,
        notes=tuple(notes),
    )
    _refuse_crossing_flutes(case, cutter)
    if not np.any(np.abs(model.mean_couplings[1]) > 0.0):
        raise InputError(_no_limit(case, cutter))
    return model


def _no_limit(case: Case, cutter: Cutter) -> str:
    if cutter.corner_radius > 0.0 or cutter.edge_angle < 0.5 * math.pi - 1e-9:
        return (
            f"{case.name}: cut.radial_depth: down to an axial depth of "
            f"{case.cut.axial_depth * 1e3:g} mm the edge does not reach the work, or the modes "
            "move along it; there is no stability limit"
        )
    return (
        f"{case.name}: structure: the modes move along the tool axis alone; with a 90 degree "
        "cutting edge that motion does not change the chip, so there is no stability limit"
    )


def _refuse_crossing_flutes(case: Case, cutter: Cutter) -> None:
    heights = crossing_heights(cutter, case.cut.axial_depth)
    if heights:
        raise InputError(
            f"{case.name}: tool.helix: flutes of these angles run into each other "
            f"{min(heights) * 1e3:.3g} mm above the tip"
        )


def _flank(case: Case) -> ViscousProcessDamping | Ploughing | None:
    section = case.process_damping
    if section is None:
        return None
    if section.indentation_force is not None:
        return ploughing_of(case)
    if not section.coefficient:
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
