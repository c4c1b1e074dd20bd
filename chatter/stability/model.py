"""Compile a case into what all stability methods see: flat arrays, receptances, averages."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np

from chatter.compile.cutter import cutter_of, force_law, helix_angles, process_damping_of
from chatter.compile.inclined_axis import (
    check_inclined_axis,
    hint_of_tilt,
    inclined_engagement,
    is_inclined,
    tool_axis,
)
from chatter.compile.structure import Structure, depends_on_speed, structure_at, structure_of
from chatter.compile.teeth_on_the_tool import refuse_teeth_off_the_tool
from chatter.compile.worn_flank import notes_on_limits, notes_on_worn_flank
from chatter.description.arrays import Array, ComplexArray
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.plausibility import check_plausible
from chatter.description.questioned import questions
from chatter.description.unit_system import units_of
from chatter.description.units import rpm
from chatter.stability.averaged_coefficients import AveragedCoefficients, averaged_coefficients
from chatter.stability.cut_arrays import CutArrays, cut_arrays
from chatter.stability.spindle_rotation import CONSTANT_SPEED, SpeedVariation
from cutting.edge_segments.edge_profile import crossing_heights
from cutting.edge_segments.segments import (
    EdgeSegments,
    edge_segments,
    inclined_edge_segments,
    period_angle,
)
from cutting.engagement.immersion import engagement
from cutting.force.directional_coefficients import (
    DirectionalTable,
    directional_table,
    mean_over_revolution,
)
from cutting.force.law import ForceLaw
from cutting.process_damping.flank import ProcessDampingLaw
from cutting.process_damping.linear_flank import LinearFlank
from cutting.process_damping.viscous import ViscousProcessDamping
from cutting.tool.cutter import Cutter

#: directions of motion weaker than this, relative to the strongest, do not count
_RANK_TOLERANCE = 1e-9
#: cuts whose edge segments are kept
_KEPT_SEGMENTS = 64
#: heights over which a table of a straight edge takes the mean of its flank
_HEIGHTS = 12
#: largest estimated error of critical depths, relative, where the case gives none
LIMIT_ERROR = 1e-3


class SteadyPath(NamedTuple):
    """Steady motion that a flank ploughs along, and what it presses beside it."""

    path: Array  # m/rad over a period (M, 3)
    period: float  # rad
    pressed: Array  # describing dA/dq over the slope, m^2 (S,)
    steepest: float  # slope at the end of that table
    slope: float  # steepest of the motion
    depth: float  # that it is of, m
    stiffening: float  # stiffness of the vibrating flank over its dashpot, 1/rad
    speed: float  # of the spindle, rad/s


@dataclass(frozen=True)
class MillingModel:
    """A case compiled for stability, spindle speed and axial depth left open."""

    case: Case  # that it was compiled from
    structure: Structure
    basis: Array  # orthonormal columns that span the motion of the tool point (3, r)
    cutter: Cutter
    laws: tuple[ForceLaw, ...]  # one for each tooth
    flank: ProcessDampingLaw | None
    notes: tuple[str, ...]  # assumptions and limits that the user should know of
    steady_path: SteadyPath | None = None  # where the flank ploughs beside a steady motion
    limit_tolerance: float | None = None  # of critical depths, where it is not that of the case

    @property
    def teeth(self) -> int:
        """Number of teeth."""
        return self.cutter.teeth

    @property
    def dashpot(self) -> ViscousProcessDamping | None:
        """Process damping as it is for small vibration."""
        return None if self.flank is None else self.flank.small_vibration

    @property
    def depends_on_speed(self) -> bool:
        """True where the structure is another one at another spindle speed."""
        return depends_on_speed(self.case)

    def at_speed(self, spindle_speed: float) -> MillingModel:
        """The model at a spindle speed (rad/s); InputError if it moves otherwise there."""
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
        shared = ("table", "averaged_coefficients")
        own.__dict__.update({key: self.__dict__[key] for key in shared if key in self.__dict__})
        return own

    @property
    def is_inclined(self) -> bool:
        """True where the tool axis is inclined: the arcs of its edges change with the depth."""
        return is_inclined(self.case)

    @cached_property
    def basis_on_tool(self) -> Array:
        """Directions of motion (3, r) in the axes of the tool, in which its edges are described."""
        if not self.is_inclined:
            return self.basis
        return np.ascontiguousarray(tool_axis(self.case).frame.T @ self.basis)

    def at_cut(self, speed: float, depth: float) -> MillingModel:
        """The model with another cut as its operating point: speed in rad/s, depth in m."""
        changed = {"spindle_speed": speed, "axial_depth": depth}
        cut = self.case.cut.model_copy(update=changed)
        return replace(self, case=self.case.model_copy(update={"cut": cut}))

    @property
    def lag_per_depth(self) -> float:
        """tan(helix)/R of the first tooth, rad/m."""
        return abs(math.tan(self.cutter.helix[0])) / self.cutter.radius

    @cached_property
    def table(self) -> DirectionalTable:
        """Directional matrix of a straight cylindrical edge over the engaged arc."""
        case = self.case
        arc = engagement(case.uncut_band, self.cutter.radius)
        return directional_table(
            arc, self.laws[0], case.cut.feed_per_tooth, self.basis, self.dashpot,
            None if self.steady_path is None else self._pressed_over_angle,
        )  # fmt: skip

    def _pressed_over_angle(self, angle: Array) -> Array:
        """Dashpot of the flank at immersion angles (n,) over that of a still tool.

        A straight cylindrical edge; the mean over its height, which the table does not know.
        """
        steady, radius = self.steady_path, self.cutter.radius
        lag = self.lag_per_depth * steady.depth * (np.arange(_HEIGHTS) + 0.5) / _HEIGHTS
        at = np.mod(angle[:, None] + lag, steady.period)
        places = steady.period * np.arange(len(steady.path) + 1) / len(steady.path)
        x, y = (np.interp(at, places, np.append(column, column[0])) for column in steady.path.T[:2])
        slope = (np.sin(angle)[:, None] * x + np.cos(angle)[:, None] * y) / radius
        flank = self._linear_flank
        return flank.at_slope(slope).mean(axis=1) * flank.radial / self.dashpot.coefficient

    @property
    def _linear_flank(self) -> LinearFlank:
        flank = self.flank.linear(self.cutter.radius)
        steady = self.steady_path
        if steady is None:
            return flank
        return flank._replace(
            pressed=steady.pressed,
            steepest=steady.steepest,
            path=np.ascontiguousarray(steady.path),
            period=steady.period,
            stiffening=steady.stiffening,
        )

    @property
    def flank_stiffening(self) -> float:
        """Stiffness of a flank that vibrates in the wave it ploughs over its dashpot, 1/s."""
        steady = self.steady_path
        return 0.0 if steady is None else steady.stiffening * steady.speed

    @cached_property
    def averaged_coefficients(self) -> AveragedCoefficients:
        """Directional coefficients of every delay averaged over a revolution, per axial depth."""
        if self.is_uniform:
            mean = mean_over_revolution(self.table, self.teeth)[:1]
            return AveragedCoefficients(np.array([2.0 * np.pi / self.teeth]), mean)
        return self.averaged_coefficients_at(self.case.cut.axial_depth)

    def averaged_coefficients_at(self, depth: float) -> AveragedCoefficients:
        """The same where they are not in proportion to the depth (m): the average to that depth."""
        found = averaged_coefficients(self.cut(depth), depth)
        return found._replace(mean=found.mean / depth)

    @property
    def averaged_directional(self) -> Array:
        """Mean directional matrix over a revolution (r, r), N/m^2, of all delays together."""
        return self.averaged_coefficients.mean.sum(axis=0)

    @property
    def is_uniform(self) -> bool:
        """True for a uniform-pitch cylindrical end mill of one helix at a constant speed."""
        cutter = self.cutter
        return (
            np.allclose(cutter.pitch, 2.0 * np.pi / cutter.teeth, rtol=0.0, atol=1e-9)
            and len(set(cutter.helix)) == 1
            and cutter.is_cylindrical
            and np.ptp(cutter.radial_offsets) == 0.0
            and cutter.serration is None
            and not self.is_inclined
            and self.case.cut.speed_variation is None
        )

    @property
    def operating_point(self) -> tuple[float, float]:
        """Spindle speed (rad/s) and axial depth (m) of the cut of the case."""
        return self.case.cut.spindle_speed, self.case.cut.axial_depth

    @property
    def tolerance(self) -> float:
        """Largest estimated error of critical depths that the case allows, relative."""
        if self.limit_tolerance is not None:
            return self.limit_tolerance
        return self.case.lobes.tolerance if self.case.lobes else LIMIT_ERROR

    @cached_property
    def modal_arrays(self) -> tuple[Array, ...]:
        """Natural frequency (n,), rad/s, damping ratio (n,), shape (n, r), force gain (n, r)."""
        modes = self.structure.modes
        shape = np.ascontiguousarray(np.array([mode.direction for mode in modes]) @ self.basis)
        mass = np.array([mode.mass for mode in modes])
        return (
            np.array([mode.natural_frequency for mode in modes]),
            np.array([mode.damping for mode in modes]),
            shape,
            np.ascontiguousarray(shape / mass[:, None]),
        )

    def cut(self, max_depth: float, relative_length: float = 1.0) -> CutArrays:
        """The cut down to a depth (m), speed and depth left open.

        Of an inclined tool it is the cut at that depth alone. `relative_length` is a factor on the
        length of the edge segments.
        """
        case = self.case
        segments = self._segments(max_depth, relative_length)
        if self.steady_path is not None:
            segments = segments._replace(flank=self._linear_flank)
        varied = case.cut.speed_variation
        variation = CONSTANT_SPEED
        if varied is not None:
            variation = SpeedVariation(
                varied.amplitude, varied.frequency, int(varied.shape == "triangle")
            )
        period = period_angle(self.cutter)
        return cut_arrays(self.modal_arrays, self.basis_on_tool, segments, period, variation)

    def _segments(self, depth: float, relative_length: float) -> EdgeSegments:
        case, feed = self.case, self.case.cut.feed_per_tooth * self.teeth
        if self.is_inclined:
            engaged = inclined_engagement(case, self.cutter, depth)
            return inclined_edge_segments(
                engaged, list(self.laws), feed, self.flank, relative_length
            )
        return _segments_of(
            self.cutter, self.laws, case.uncut_band, feed, depth, self.flank, relative_length
        )

    @cached_property
    def receptance(self) -> tuple[Array, ComplexArray]:
        """Lines (m,) in Hz and relative receptance (m, r, r) in the directions of motion, m/N.

        As measured, with no fit, where the case names FRFs; else that of the modes.
        """
        lines, full = self.structure.receptance()
        return lines, np.ascontiguousarray(self.basis.T @ full @ self.basis)


@lru_cache(maxsize=_KEPT_SEGMENTS)
def _segments_of(cutter: Cutter, laws: tuple[ForceLaw, ...], *cut: object) -> EdgeSegments:
    """Edge segments, kept: structures and resolutions change where a tool stays the same."""
    return edge_segments(cutter, list(laws), *cut)


def milling_model(case: Case, structure: Structure | None = None) -> MillingModel:
    """Compile a case for the stability methods.

    The structure is that of the case, where it is known already. InputError if a section is
    missing, or the case holds what no stability method can treat.
    """
    case.require("tool", "material", "cut", "structure")
    check_plausible(case)
    check_inclined_axis(case)
    refuse_teeth_off_the_tool(case)
    if structure is None:
        structure = structure_of(case)
        if case.structure.machine is not None:
            from chatter.engine.loop_stability import refuse_unstable_structure

            refuse_unstable_structure(structure)
    cutter = cutter_of(case)
    notes = [*questions(case), *structure.notes]
    flank = process_damping_of(case)
    if flank is not None:
        notes.append("the zeroth-order solution leaves out process damping")
    if flank is not None and flank is not flank.small_vibration:
        notes.append(
            "ploughing is linearised as a dashpot: by check and lobes beside the steady forced "
            "vibration of each cut, in studies of pitch and optimum about a still tool; chatter "
            "simulate includes it in full"
        )
    if case.contact is not None:
        notes.append(
            "only the matrix-free and time-domain methods include the contact of tool and work"
        )
    laws = tuple(force_law(case, helix) for helix in helix_angles(case))
    notes += [*empirical_notes(case), *notes_on_worn_flank(case, laws[0]), *notes_on_limits(case)]
    if case.structure is not None and any(mode.friction for mode in case.structure.mode):
        notes.append("friction of modes is included in the time domain only")
    model = MillingModel(
        case=case,
        structure=structure,
        basis=_motion_basis(structure.directions),
        cutter=cutter,
        laws=laws,
        flank=flank,
        notes=tuple(notes),
    )
    _refuse_crossing_flutes(case, cutter)
    if not np.any(np.abs(model.averaged_coefficients.mean) > 0.0):
        raise InputError(_no_limit(case, cutter))
    return model


def empirical_notes(case: Case) -> list[str]:
    """How linear methods take terms that were learnt from measurements."""
    notes = []
    if case.empirical_over("cutting speed") is not None:
        notes.append(
            "the empirical factor of the force is that at the cutting speed of [cut], at all speeds"
        )
    if any(case.empirical_over(name) for name in ("spindle angle", "feed distance")):
        notes.append("empirical factors over angle or feed distance count in the time domain only")
    return notes


def _no_limit(case: Case, cutter: Cutter) -> str:
    depth = units_of(case).length.text(case.cut.axial_depth, "g")
    if is_inclined(case):
        return (
            f"{case.name}: cut: down to an axial depth of {depth} no edge of the "
            "inclined tool reaches the work, or the modes move without changing the "
            "chip; there is no stability limit" + (hint_of_tilt(case) or _hint_of_stepover(case))
        )
    if not cutter.is_cylindrical:
        return (
            f"{case.name}: cut.radial_depth: down to an axial depth of "
            f"{depth} the edge does not reach the work, or the modes "
            "move along it; there is no stability limit" + _hint_of_stepover(case)
        )
    return (
        f"{case.name}: structure: the modes move along the tool axis alone; with a 90 degree "
        "cutting edge that motion does not change the chip, so there is no stability limit"
    )


def _hint_of_stepover(case: Case) -> str:
    """Say how a step from pass to pass is stated, where it was hardly a radial depth."""
    step = case.cut.radial_depth
    if step is None:
        return ""
    return (
        ". The radial depth counts from the full radius of the tool; a step from pass to pass is "
        f'stated by stepover = "{units_of(case).length.text(step)}" in its place'
    )


def _refuse_crossing_flutes(case: Case, cutter: Cutter) -> None:
    depth = case.cut.axial_depth
    if is_inclined(case):
        depth = inclined_engagement(case, cutter).top
    heights = crossing_heights(cutter, depth)
    if heights:
        raise InputError(
            f"{case.name}: tool.helix: flutes of these angles run into each other "
            f"{units_of(case).length.text(min(heights), '.3g')} above the tip"
        )


def _motion_basis(directions: Array) -> Array:
    """Orthonormal basis (3, r) of the directions (n, 3) in which the tool point can move."""
    moving = np.abs(directions).max(axis=0) > _RANK_TOLERANCE
    _, size, rows = np.linalg.svd(directions)
    rank = int(np.sum(size > _RANK_TOLERANCE * size[0]))
    # the axes themselves where they span the motion: then a one-axis structure stays exact
    if moving.sum() == rank:
        return np.ascontiguousarray(np.eye(3)[:, moving])
    return np.ascontiguousarray(rows[:rank].T)
