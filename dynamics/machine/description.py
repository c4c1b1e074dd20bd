"""A machine as it stands: structure, drives with their controllers, frictions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.control.cascade import DriveController
from dynamics.drive.backlash import Backlash
from dynamics.drive.parts import DrivenAxis, DriveParts, Motor
from dynamics.friction.laws import FrictionLaw
from dynamics.reduction.modal_truncation import Modes, undamped_modes, with_static_shapes
from dynamics.structure.assembly import Assembly, assembly, with_nodes_where_joined
from dynamics.structure.bodies import Connector, MeshedPart, Part, Point
from dynamics.structure.linear_structure import LinearStructure, StructureError
from dynamics.structure.spring_coupling import Coupling, Term

#: what holds an axis: its controller, its brake, or nothing
Condition = Literal["control", "brake", "free"]
CONDITIONS: tuple[Condition, ...] = ("control", "brake", "free")


class FeedDrive(Protocol):
    """Drive of an axis: what it adds to the structure."""

    @property
    def transmission(self) -> float:
        """Travel of the axis per angle of the motor, m/rad; 1 for a linear motor."""

    def parts(self, axis: DrivenAxis) -> DriveParts:
        """Rotors, springs and motors of the drive on an axis."""


@dataclass(frozen=True, eq=False)
class MachineAxis:
    """Axis with its drive and control."""

    geometry: DrivenAxis
    drive: FeedDrive
    #: none (no control), one for all motors (they share its torque, and it measures the mean of
    #: their encoders), or one a motor
    controllers: Sequence[DriveController] = ()
    #: (3,), of the direct measuring system, m; where the drive pushes by default
    scale_at: ArrayLike | None = None
    #: stiffness, N m/rad, and damping, N m s/rad, of the brake of each motor (N/m and N s/m of a
    #: linear one)
    brake: tuple[float, float] = (1e5, 0.0)

    @property
    def name(self) -> str:
        """Name of the axis."""
        return self.geometry.name


@dataclass(frozen=True, eq=False)
class FrictionAt:
    """Friction along a motion."""

    name: str
    law: FrictionLaw
    #: motion that it resists, as the sum of these; none if `mode` is given
    terms: Sequence[Term] = ()
    #: number, from 0, of the undamped mode whose coordinate (mass-normalised) it resists
    mode: int | None = None


class ModeDamping(NamedTuple):
    """Damping ratio of the modes whose undamped frequencies lie in a band."""

    lowest: float  # Hz
    highest: float  # Hz
    ratio: float  # 1


@dataclass(frozen=True, eq=False)
class MachineParts:
    """Everything a machine is made of, at one position of its axes.

    Parameters
    ----------
    bodies, beams, connectors, couplings, points
        As for `dynamics.structure.assembly.assembly`.
    axes : sequence of MachineAxis
    frictions : sequence of FrictionAt
    damping_ratio : float
        Of every elastic mode, on top of the dampers; 1.
    mode_damping : sequence of ModeDamping
        Damping ratios of the modes in bands of frequency, in place of that.
    allowed_rigid_motions : int
        Free motions that are meant, besides those of free or controlled axes.
    highest_frequency : float, optional
        Hz: modes above it are left out, and their static answer kept at drives, frictions and
        `kept_points`.
    kept_points : sequence of str
        Points whose static answer is kept; all by default.
    """

    bodies: Sequence[Part]
    connectors: Sequence[Connector]
    points: Sequence[Point]
    beams: Sequence[MeshedPart] = ()
    couplings: Sequence[Coupling] = ()
    axes: Sequence[MachineAxis] = ()
    frictions: Sequence[FrictionAt] = ()
    damping_ratio: float = 0.0
    mode_damping: Sequence[ModeDamping] = ()
    allowed_rigid_motions: int = 0
    highest_frequency: float | None = None
    kept_points: Sequence[str] | None = None


class Drive(NamedTuple):
    """Drive under control: torque acts along `row`, where the encoder measures too."""

    name: str
    axis: str
    row: NDArray[np.float64]  # (n,)
    scale: NDArray[np.float64]  # (n,)
    controller: DriveController


class Friction(NamedTuple):
    """Friction along a row of the structure."""

    name: str
    law: FrictionLaw
    row: NDArray[np.float64]  # (n,)


class BacklashAt(NamedTuple):
    """Backlash of a spring, whose stretch is a row of the structure."""

    name: str
    law: Backlash
    row: NDArray[np.float64]  # (n,)
    axis: str  # whose travel changes the stiffness of the spring


class ConstantForce(NamedTuple):
    """Force that never changes along a row of the structure."""

    name: str
    row: NDArray[np.float64]  # (n,)
    value: float  # N (N m)


@dataclass(frozen=True, eq=False)
class Machine:
    """Machine in one condition, ready to be run or linearised."""

    structure: LinearStructure
    drives: tuple[Drive, ...]  # those under control
    frictions: tuple[Friction, ...]
    preloads: tuple[ConstantForce, ...]
    axes: tuple[str, ...]  # names of all axes, in the order of set points
    assembly: Assembly  # parts, for further rows
    #: (full, n), motion of the assembly's freedoms per coordinate
    basis: NDArray[np.float64] | None = None
    #: undamped modes of the structure, where they were needed to assemble it
    modes: Modes | None = None
    #: the structure holds their springs as closed: so does all that is linear
    backlashes: tuple[BacklashAt, ...] = ()
    #: machine that it was reduced from
    unreduced: Machine | None = None

    def row(self, who: str, terms: Sequence[Term]) -> NDArray[np.float64]:
        """Row (n,) of the sum of motions of parts, as a port of the structure."""
        row = self.assembly.row(who, terms)
        return row if self.basis is None else row @ self.basis

    def without_friction(self) -> Machine:
        """Same machine without its frictions."""
        return replace(self, frictions=())


def machine(parts: MachineParts, conditions: Mapping[str, Condition] | None = None) -> Machine:
    """Assemble a machine.

    Parameters
    ----------
    parts : MachineParts
    conditions : mapping of str to {"control", "brake", "free"}, optional
        Of axes by name; "control" by default where there is a controller, else "free".

    Raises
    ------
    StructureError
        If an axis is unknown, asked to be controlled without controller, or the structure makes
        no sense.
    """
    full = full_machine(parts, conditions)
    if parts.highest_frequency is None:
        return full
    return reduced(full, parts.highest_frequency, parts.kept_points)


def full_machine(
    parts: MachineParts,
    conditions: Mapping[str, Condition] | None = None,
    whole: Assembly | None = None,
    neighbour: Machine | None = None,
) -> Machine:
    """Assemble a machine as `machine` does, with all of its modes.

    What was assembled of the same parts already, in the same conditions, may be given, and the
    machine of some of them, at another position, the `neighbour`.
    """
    held = _conditions(parts.axes, conditions or {})
    driven = {axis.name: axis.drive.parts(axis.geometry) for axis in parts.axes}
    if whole is None:
        whole = _assembled(parts, held, driven, None if neighbour is None else neighbour.assembly)
    structure, modes = whole.structure, None
    if parts.damping_ratio != 0.0 or parts.mode_damping:
        modes = undamped_modes(structure, near=_modes_of_same_mass(structure, neighbour))
        structure = with_modal_damping(structure, parts.damping_ratio, parts.mode_damping, modes)
    return Machine(
        structure,
        tuple(
            drive
            for axis in parts.axes
            if held[axis.name] == "control"
            for drive in _controlled(axis, driven[axis.name].motors, whole)
        ),
        tuple(
            Friction(one.name, one.law, _friction_row(one, whole, structure))
            for one in parts.frictions
        ),
        tuple(
            ConstantForce(f"preload of {motor.name}", whole.row(motor.name, motor.angle), preload)
            for drive in driven.values()
            for motor in drive.motors
            if (preload := getattr(motor, "preload", 0.0)) != 0.0
        ),
        tuple(axis.name for axis in parts.axes),
        whole,
        modes=modes,
        backlashes=_backlashes(driven, whole),
    )


def _modes_of_same_mass(structure: LinearStructure, neighbour: Machine | None) -> Modes | None:
    """All modes of a machine at another position, where they are orthonormal over the mass here."""
    if neighbour is None or neighbour.assembly.structure.mass is not structure.mass:
        return None
    return neighbour.modes


def _assembled(
    parts: MachineParts,
    held: Mapping[str, Condition],
    driven: Mapping[str, DriveParts],
    neighbour: Assembly | None,
) -> Assembly:
    """Assembly of parts and drives, whose axes are held by something or nothing."""
    connectors, couplings = _links(parts, held, driven)
    moving = sum(condition != "brake" for condition in held.values())
    return assembly(
        parts.bodies,
        connectors,
        parts.points,
        parts.beams,
        parts.allowed_rigid_motions + moving,
        [rotor for drive in driven.values() for rotor in drive.rotors],
        couplings,
        neighbour,
    )


def meshed_beams(
    parts: MachineParts, conditions: Mapping[str, Condition] | None = None
) -> list[MeshedPart]:
    """Beams of a machine with nodes wherever something is joined to them."""
    driven = {axis.name: axis.drive.parts(axis.geometry) for axis in parts.axes}
    links = _links(parts, _conditions(parts.axes, conditions or {}), driven)
    return with_nodes_where_joined(parts.beams, *links, parts.points)


def _links(
    parts: MachineParts, held: Mapping[str, Condition], driven: Mapping[str, DriveParts]
) -> tuple[list[Connector], list[Coupling]]:
    """Connectors and couplings of a machine with those of its drives and brakes."""
    brakes = [
        Coupling(f"{axis.name}: brake of {motor.name}", motor.angle, *axis.brake)
        for axis in parts.axes
        if held[axis.name] == "brake"
        for motor in driven[axis.name].motors
    ]
    drives = driven.values()
    connectors = [*parts.connectors, *(one for drive in drives for one in drive.connectors)]
    couplings = [*parts.couplings, *(one for drive in drives for one in drive.couplings), *brakes]
    return connectors, couplings


def reduced(full: Machine, highest: float, kept_points: Sequence[str] | None = None) -> Machine:
    """Machine of the modes up to a frequency, with the static answer of the others.

    The frequency is in Hz. The static answer to forces is kept at drives, frictions, backlashes and
    the points named; all points by default.
    """
    return reduced_to(full, _modes_up_to(full, highest), kept_points)


def reduced_to(full: Machine, modes: Modes, kept_points: Sequence[str] | None = None) -> Machine:
    """Machine of its lowest modes, with the static answer of the others as in `reduced`."""
    structure = full.structure
    names = structure.points if kept_points is None else kept_points
    forces = [structure.port(name, direction) for name in names for direction in np.eye(3)]
    points = [
        *(drive.row for drive in full.drives),
        *(friction.row for friction in full.frictions),
        *(preload.row for preload in full.preloads),
        *(backlash.row for backlash in full.backlashes),
    ]
    loads = np.array([*points, *forces]).reshape(-1, structure.size)
    compact, basis = with_static_shapes(structure, modes, loads, full.modes)
    return in_coordinates(full, compact, basis)


def _modes_up_to(full: Machine, highest: float) -> Modes:
    """Undamped modes of a machine up to a frequency, Hz."""
    if full.modes is None:
        return undamped_modes(full.structure, highest)
    kept = int(np.searchsorted(full.modes.frequency, highest, side="right"))
    return Modes(full.modes.frequency[:kept], full.modes.shapes[:, :kept])


def in_coordinates(full: Machine, structure: LinearStructure, basis: NDArray) -> Machine:
    """Machine whose structure is given in other coordinates; basis (n, m), motion of each."""
    return replace(
        full,
        structure=structure,
        modes=None,
        drives=tuple(
            one._replace(row=one.row @ basis, scale=one.scale @ basis) for one in full.drives
        ),
        frictions=tuple(one._replace(row=one.row @ basis) for one in full.frictions),
        preloads=tuple(one._replace(row=one.row @ basis) for one in full.preloads),
        backlashes=tuple(one._replace(row=one.row @ basis) for one in full.backlashes),
        basis=basis,
        unreduced=full,
    )


def with_modal_damping(
    structure: LinearStructure,
    ratio: float,
    bands: Sequence[ModeDamping] = (),
    modes: Modes | None = None,
) -> LinearStructure:
    """Structure with damping ratios of its elastic modes on top of its dampers.

    The ratio holds for all modes but those in bands, which have their own; of bands that overlap
    the last one holds. All undamped modes are found, unless they are given.
    StructureError if a ratio is negative or not finite.
    """
    for one in (ratio, *(band.ratio for band in bands)):
        if not (np.isfinite(one) and one >= 0.0):
            raise StructureError(f"damping ratio is {one}; it must be 0 or more")
    if ratio == 0.0 and not bands:
        return structure
    modes = undamped_modes(structure) if modes is None else modes
    ratios = np.full(len(modes.frequency), ratio)
    for band in bands:
        inside = (modes.frequency >= band.lowest) & (modes.frequency <= band.highest)
        ratios[inside] = band.ratio
    moved = (structure.mass @ modes.shapes) * np.sqrt(4.0 * np.pi * ratios * modes.frequency)
    added = moved @ moved.T
    return replace(structure, damping=structure.damping + added)


def _conditions(
    axes: Sequence[MachineAxis], asked: Mapping[str, Condition]
) -> dict[str, Condition]:
    known = {axis.name: axis for axis in axes}
    for name, condition in asked.items():
        if name not in known:
            there = ", ".join(f'"{one}"' for one in known)
            raise StructureError(f'there is no axis "{name}"; there are {there or "none"}')
        if condition not in CONDITIONS:
            raise StructureError(f'axis "{name}": {condition!r} is none of {", ".join(CONDITIONS)}')
        if condition == "control" and not known[name].controllers:
            raise StructureError(f'axis "{name}" has no controller')
    return {
        axis.name: asked.get(axis.name, "control" if axis.controllers else "free") for axis in axes
    }


def _controlled(axis: MachineAxis, motors: Sequence[Motor], whole: Assembly) -> list[Drive]:
    who = f'axis "{axis.name}"'
    scale = whole.row(who, axis.geometry.travel(axis.scale_at))
    rows = [whole.row(who, motor.angle) for motor in motors]
    if len(axis.controllers) == 1:
        return [Drive(axis.name, axis.name, sum(rows) / len(rows), scale, axis.controllers[0])]
    if len(axis.controllers) != len(motors):
        raise StructureError(
            f"{who}: {len(axis.controllers)} controllers for {len(motors)} motors; one for all, "
            "or one each"
        )
    return [
        Drive(motor.name, axis.name, row, scale, controller)
        for motor, row, controller in zip(motors, rows, axis.controllers, strict=True)
    ]


def _backlashes(driven: Mapping[str, DriveParts], whole: Assembly) -> tuple[BacklashAt, ...]:
    return tuple(
        BacklashAt(
            one.name,
            Backlash(one.stiffness, one.damping, one.backlash),
            whole.row(one.name, one.terms),
            axis,
        )
        for axis, drive in driven.items()
        for one in drive.couplings
        if one.backlash > 0.0
    )


def _friction_row(one: FrictionAt, whole: Assembly, structure: LinearStructure) -> NDArray:
    who = f'friction "{one.name}"'
    if one.mode is None:
        if not one.terms:
            raise StructureError(f"{who} resists nothing: it has neither terms nor a mode")
        return whole.row(who, one.terms)
    shapes = undamped_modes(structure).shapes
    if not 0 <= one.mode < shapes.shape[1]:
        raise StructureError(f"{who}: mode {one.mode} of {shapes.shape[1]}, counted from 0")
    return structure.mass @ shapes[:, one.mode]
