"""Rigid bodies, the connectors that hold them, and named points on them.

A column, a table or a headstock is a rigid body; guides, joints, feet and bushings are
connectors with six stiffnesses at a position. Displacements and rotations are small.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from copy import copy
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.structure.linear_structure import StructureError
from dynamics.structure.rigid_body_motion import DIRECTIONS

GROUND = "ground"


class Part(Protocol):
    """What `dynamics.structure.assembly` joins: a rigid body, a line of beam elements."""

    @property
    def name(self) -> str:
        """Name that connectors and points refer to."""

    @property
    def mass_matrix(self) -> NDArray[np.float64]:
        """(n, n), kg and kin."""

    @property
    def damping_matrix(self) -> NDArray[np.float64]:
        """(n, n), N s/m and kin."""

    @property
    def stiffness_matrix(self) -> NDArray[np.float64]:
        """(n, n), N/m and kin."""

    @property
    def rigid_motions(self) -> NDArray[np.float64]:
        """(n, 6): motions without strain: along and about x, y, z of a position of the part's own.

        (n, 1) for what only turns.
        """

    def motion_at(self, position: ArrayLike) -> NDArray[np.float64]:
        """(6, n): displacements and rotations of the material at a position, per freedom."""


class MeshedPart(Part, Protocol):
    """Part whose nodes may be put where something is joined, and that brings bearings."""

    @property
    def connectors(self) -> Sequence[Connector]:
        """The part's own bearings."""

    @property
    def origin(self) -> ArrayLike:
        """The part's own beginning (3,), m."""

    @property
    def stations(self) -> Sequence[float]:
        """Where nodes are asked for, from the part's own beginning, m."""

    def with_nodes_at(self, positions: Iterable[ArrayLike]) -> MeshedPart:
        """Same part with nodes at positions (3,) in m."""

    def with_stations(self, stations: Iterable[float]) -> MeshedPart:
        """Same part with nodes at stations, m."""

    def begun_at(self, origin: ArrayLike) -> MeshedPart:
        """Same part elsewhere, beginning at (3,), m."""


@dataclass(frozen=True, eq=False)
class Body:
    """Rigid body: translation of its centre of gravity and small rotations.

    StructureError if the mass or a principal moment of inertia is not positive, or an entry not
    finite.
    """

    name: str
    mass: float  # kg
    # (3,) or (3, 3), about the centre of gravity, kg m^2: principal moments along x, y, z, or the
    # tensor (products of inertia with a minus sign, as in a tensor)
    inertia: ArrayLike
    centre: ArrayLike  # (3,), of gravity, m

    def __post_init__(self) -> None:
        where = f'body "{self.name}"'
        refuse_ground(where, self.name)
        if not (np.isfinite(self.mass) and self.mass > 0.0):
            raise StructureError(f"{where}: mass is {self.mass}; it must be positive, in kg")
        inertia = np.array(self.inertia, dtype=np.float64)
        if inertia.shape == (3,):
            inertia = np.diag(inertia)
        if inertia.shape != (3, 3) or not np.all(np.isfinite(inertia)):
            raise StructureError(f"{where}: inertia must be 3 or 3 x 3 finite numbers")
        if np.max(np.abs(inertia - inertia.T)) > 1e-9 * np.max(np.abs(inertia)):
            raise StructureError(f"{where}: the inertia tensor is not symmetric")
        principal = np.linalg.eigvalsh(inertia)
        if principal[0] <= 0.0:
            raise StructureError(
                f"{where}: a principal moment of inertia is {principal[0]:g} kg m^2; "
                "all three must be positive"
            )
        object.__setattr__(self, "inertia", 0.5 * (inertia + inertia.T))
        object.__setattr__(self, "centre", finite(where, "centre", self.centre, (3,)))

    @property
    def mass_matrix(self) -> NDArray[np.float64]:
        """(6, 6), kg and kg m^2."""
        matrix = np.zeros((6, 6))
        matrix[:3, :3] = self.mass * np.eye(3)
        matrix[3:, 3:] = self.inertia
        return matrix

    @property
    def damping_matrix(self) -> NDArray[np.float64]:
        """(6, 6) of zeros: a rigid body dissipates nothing."""
        return np.zeros((6, 6))

    @property
    def stiffness_matrix(self) -> NDArray[np.float64]:
        """(6, 6) of zeros."""
        return np.zeros((6, 6))

    @property
    def rigid_motions(self) -> NDArray[np.float64]:
        """(6, 6): about the centre of gravity, the body's own freedoms."""
        return np.eye(6)

    def motion_at(self, position: ArrayLike) -> NDArray[np.float64]:
        """(6, 6): displacements and rotations at a position per freedom of the body."""
        return rigid_motion(np.asarray(position, dtype=np.float64) - self.centre)

    def shifted(self, shift: NDArray[np.float64]) -> Body:
        """Same body elsewhere, shifted by (3,) in m."""
        elsewhere = copy(self)  # its numbers were checked once
        object.__setattr__(elsewhere, "centre", self.centre + shift)
        return elsewhere


@dataclass(frozen=True, eq=False)
class Connector:
    """Six springs and dampers between two parts, or a part and ground, at a position.

    StructureError if a number is negative or not finite, or the axes are not orthonormal.
    """

    name: str
    first: str  # name of a body or beam, or "ground"
    second: str  # as first; not both are "ground"
    at: ArrayLike  # (3,), place where both parts are joined, m
    stiffness: ArrayLike  # (6,), along x, y, z in N/m and about x, y, z in N m/rad, of the axes
    damping: ArrayLike = (0.0,) * 6  # (6,), N s/m and N m s/rad
    # (3, 3), rows are the connector's own x, y, z directions; the machine's by default
    axes: ArrayLike = field(default_factory=lambda: np.eye(3))

    def __post_init__(self) -> None:
        where = f'connector "{self.name}"'
        if self.first == self.second:
            raise StructureError(f'{where} joins "{self.first}" with itself')
        object.__setattr__(self, "at", finite(where, "at", self.at, (3,)))
        for what in ("stiffness", "damping"):
            values = finite(where, what, getattr(self, what), (6,))
            for direction, value in zip(DIRECTIONS, values, strict=True):
                if value < 0.0:
                    raise StructureError(f"{where}: {what} {direction} is {value:g}, negative")
            object.__setattr__(self, what, values)
        axes = finite(where, "axes", self.axes, (3, 3))
        if np.max(np.abs(axes @ axes.T - np.eye(3))) > 1e-6:
            raise StructureError(f"{where}: the rows of axes must be perpendicular unit vectors")
        object.__setattr__(self, "axes", axes)

    def shifted(self, shift: NDArray[np.float64]) -> Connector:
        """Same connector elsewhere, shifted by (3,) in m."""
        elsewhere = copy(self)  # its numbers were checked once
        object.__setattr__(elsewhere, "at", self.at + shift)
        return elsewhere

    def in_own_axes(self, motion: NDArray[np.float64]) -> NDArray[np.float64]:
        """Turn motion (6, n) at the position into the connector's own axes."""
        return np.vstack([self.axes @ motion[:3], self.axes @ motion[3:]])


@dataclass(frozen=True, eq=False)
class Point:
    """Named position on a body or beam, moving with it."""

    name: str
    body: str  # name of the body or beam
    at: ArrayLike  # (3,), m

    def __post_init__(self) -> None:
        object.__setattr__(self, "at", finite(f'point "{self.name}"', "at", self.at, (3,)))


def rigid_motion(offset: ArrayLike) -> NDArray[np.float64]:
    """Motion (6, 6) at an offset (3,) in m from the point whose motion is given.

    Displacement u + theta x r, rotation theta (small rotations).
    """
    x, y, z = np.asarray(offset, dtype=np.float64)
    motion = np.eye(6)
    motion[:3, 3:] = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]
    return motion


def finite(where: str, what: str, values: ArrayLike, shape: tuple[int, ...]) -> NDArray:
    """Values as an array of finite numbers of a shape.

    StructureError if they are not; the message begins with `where` and `what`.
    """
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.shape != shape or not np.isfinite(array).all():
        size = " x ".join(str(length) for length in shape)
        raise StructureError(f"{where}: {what} must be {size} finite numbers, not {values!r}")
    return array


def unit_vector(where: str, what: str, values: ArrayLike) -> NDArray[np.float64]:
    """Direction (3,) made a unit vector; StructureError where it has no length."""
    direction = finite(where, what, values, (3,))
    if not np.any(direction):
        raise StructureError(f"{where}: {what} has no length")
    return direction / np.linalg.norm(direction)


def radial_direction(
    where: str, along: NDArray[np.float64], first_radial: ArrayLike | None
) -> NDArray[np.float64]:
    """Unit vector (3,) perpendicular to another one, as near as can be to what is given."""
    if first_radial is None:
        guide = np.roll(np.eye(3)[np.argmax(np.abs(along))], 1)
    else:
        guide = finite(where, "first_radial", first_radial, (3,))
    first = guide - (guide @ along) * along
    if np.linalg.norm(first) <= 1e-6 * np.linalg.norm(guide):
        raise StructureError(f"{where}: first_radial lies along the axis")
    return first / np.linalg.norm(first)


def refuse_ground(where: str, name: str) -> None:
    """Refuse a part with the name of what does not move."""
    if name == GROUND:
        raise StructureError(f'{where}: "{GROUND}" is what does not move; name it otherwise')
