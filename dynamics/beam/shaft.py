"""Shafts, spindles and tools as lines of beam elements, with discs and bearings.

A line is a part that `dynamics.structure.assembly.assemble` joins with bodies and other lines.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.beam.element import (
    Material,
    Segment,
    cowper,
    element_mass,
    element_stiffness,
    hutchinson,
    positive,
    shape_functions,
)
from dynamics.structure.bodies import (
    GROUND,
    Connector,
    finite,
    radial_direction,
    refuse_ground,
    rigid_motion,
)
from dynamics.structure.linear_structure import StructureError

__all__ = ["BeamLine", "Bearing", "Disc", "Material", "Segment", "cowper", "hutchinson"]

# Positions closer together than this part of an element share a node: a sliver of an element would
# spoil the numbers, and the shape functions tell the motion beside a node as well.
NEAREST_NODES = 0.02


@dataclass(frozen=True)
class Disc:
    """Rigid disc on a line: a chuck, pulley, rotor or nut, centred on the axis."""

    station: float  # along the line, m
    mass: float  # kg
    polar_inertia: float  # about the axis, kg m^2
    diametral_inertia: float  # about a diameter, kg m^2

    def __post_init__(self) -> None:
        for what in ("mass", "polar_inertia", "diametral_inertia"):
            positive(f"disc at {self.station} m", what, getattr(self, what))

    @classmethod
    def from_size(
        cls, station: float, width: float, inner: float, outer: float, density: float
    ) -> Disc:
        """Disc of given width, inner and outer diameter (m) and density (kg/m^3)."""
        mass = 0.25 * np.pi * (outer**2 - inner**2) * width * density
        polar = mass * (outer**2 + inner**2) / 8.0
        return cls(station, mass, polar, 0.5 * polar + mass * width**2 / 12.0)


@dataclass(frozen=True)
class Bearing:
    """Springs and dampers between a line and ground or another part, in the line's own axes."""

    name: str
    station: float  # along the line, m
    radial: tuple[float, float]  # stiffness in the line's two radial directions, N/m
    axial: float = 0.0  # N/m
    #: stiffness against rotation about the two radial directions, N m/rad
    tilt: tuple[float, float] = (0.0, 0.0)
    #: against rotation about the axis, N m/rad; a drive holds it, a bearing does not
    torsion: float = 0.0
    radial_damping: tuple[float, float] = (0.0, 0.0)  # N s/m
    axial_damping: float = 0.0  # N s/m
    tilt_damping: tuple[float, float] = (0.0, 0.0)  # N m s/rad
    torsion_damping: float = 0.0  # N m s/rad
    body: str = GROUND  # what carries the bearing


@dataclass(frozen=True, eq=False)
class BeamLine:
    """Line of stepped round segments along an axis.

    Parameters
    ----------
    name : str
    segments : sequence of Segment
        From the origin on.
    origin : (3,) array of float
        Place of the first end, m.
    axis : (3,) array of float
        Direction from the first end to the last; of any length.
    discs : sequence of Disc
    bearings : sequence of Bearing
    first_radial : (3,) array of float, optional
        Direction of the first radial axis, made perpendicular to the axis; the second is axis x
        first. Default: x for an axis along z, y for x, z for y, and in between by the nearest.
    stiffness_damping : float
        Damping matrix over stiffness matrix of the line, s: damping ratio pi f times this.
    stations : sequence of float
        Further positions that get a node, m.

    Raises
    ------
    StructureError
        If there is no segment, a position lies off the line, or a direction is not one.
    """

    name: str
    segments: Sequence[Segment]
    origin: ArrayLike = (0.0, 0.0, 0.0)
    axis: ArrayLike = (0.0, 0.0, 1.0)
    discs: Sequence[Disc] = ()
    bearings: Sequence[Bearing] = ()
    first_radial: ArrayLike | None = None
    stiffness_damping: float = 0.0
    stations: Sequence[float] = ()

    def __post_init__(self) -> None:
        where = f'beam "{self.name}"'
        refuse_ground(where, self.name)
        if not self.segments:
            raise StructureError(f"{where} has no segments")
        if not (np.isfinite(self.stiffness_damping) and self.stiffness_damping >= 0.0):
            raise StructureError(f"{where}: stiffness_damping is {self.stiffness_damping}")
        object.__setattr__(self, "origin", finite(where, "origin", self.origin, (3,)))
        object.__setattr__(self, "axis", finite(where, "axis", self.axis, (3,)))
        if not np.any(self.axis):
            raise StructureError(f"{where}: axis has no length")
        for station in self._stations_with_nodes():
            self._within(station)
        _ = self.axes

    @property
    def length(self) -> float:
        """Length of all segments, m."""
        return float(sum(segment.length for segment in self.segments))

    @cached_property
    def axes(self) -> NDArray[np.float64]:
        """(3, 3): rows are the axis, the first and the second radial direction."""
        along = self.axis / np.linalg.norm(self.axis)
        first = radial_direction(f'beam "{self.name}"', along, self.first_radial)
        return np.array([along, first, np.cross(along, first)])

    @cached_property
    def nodes(self) -> NDArray[np.float64]:
        """(nodes,): positions of the nodes along the line, m."""
        asked = self._stations_with_nodes()
        marks = [0.0]
        start = 0.0
        for segment in self.segments:
            end = start + segment.length
            element = segment.length / segment.elements
            inside = [start]
            for station in sorted(set(asked)):
                near = NEAREST_NODES * element
                if inside[-1] + near < station < end - near:
                    inside.append(station)
            for left, right in zip(inside, [*inside[1:], end], strict=True):
                count = int(np.ceil((right - left) / element - 1e-9))
                marks += list(np.linspace(left, right, max(count, 1) + 1)[1:])
            start = end
        return np.array(marks)

    @cached_property
    def mass_matrix(self) -> NDArray[np.float64]:
        """(6 nodes, 6 nodes), kg, kg m and kg m^2, in the machine's directions."""
        mass = self._over_elements(element_mass)
        for disc in self.discs:
            motion = self._own_motion(disc.station)
            inertia = [disc.mass] * 3 + [disc.polar_inertia] + [disc.diametral_inertia] * 2
            mass += motion.T @ (np.array(inertia)[:, None] * motion)
        return mass

    @property
    def damping_matrix(self) -> NDArray[np.float64]:
        """(6 nodes, 6 nodes), N s/m and kin, without the bearings."""
        return self.stiffness_damping * self.stiffness_matrix

    @cached_property
    def stiffness_matrix(self) -> NDArray[np.float64]:
        """(6 nodes, 6 nodes), N/m and kin, without the bearings."""
        return self._over_elements(element_stiffness)

    @property
    def rigid_motions(self) -> NDArray[np.float64]:
        """(6 nodes, 6): along and about x, y, z of the first end."""
        along = self.axis / np.linalg.norm(self.axis)
        return np.vstack([rigid_motion(station * along) for station in self.nodes])

    @property
    def connectors(self) -> tuple[Connector, ...]:
        """The bearings as connectors, each named "line: bearing"."""
        return tuple(
            Connector(
                name=f"{self.name}: {one.name}",
                first=self.name,
                second=one.body,
                at=self.position(one.station),
                stiffness=(one.axial, *one.radial, one.torsion, *one.tilt),
                damping=(
                    one.axial_damping,
                    *one.radial_damping,
                    one.torsion_damping,
                    *one.tilt_damping,
                ),
                axes=self.axes,
            )
            for one in self.bearings
        )

    def position(self, station: float) -> NDArray[np.float64]:
        """Place (3,) in m on the axis at a station."""
        return self.origin + self._within(station) * self.axes[0]

    def with_nodes_at(self, positions: Iterable[ArrayLike]) -> BeamLine:
        """Same line with nodes at the stations of positions (3,) in m."""
        found = [self._station(position) for position in positions]
        meshed = replace(self, stations=(*self.stations, *found))
        # its matrices are known where nothing is new
        return self if np.array_equal(meshed.nodes, self.nodes) else meshed

    def with_stations(self, stations: Iterable[float]) -> BeamLine:
        """Same line with nodes at stations, m, those asked for before left out."""
        return replace(self, stations=tuple(stations))

    def begun_at(self, origin: ArrayLike) -> BeamLine:
        """Same line elsewhere, beginning at (3,), m; what is known of its matrices stays known."""
        elsewhere = copy(self)
        object.__setattr__(elsewhere, "origin", finite(self.name, "origin", origin, (3,)))
        return elsewhere

    def shifted(self, shift: ArrayLike) -> BeamLine:
        """Same line elsewhere, shifted by (3,) in m."""
        return self.begun_at(np.asarray(self.origin) + shift)

    def motion_at(self, position: ArrayLike) -> NDArray[np.float64]:
        """Displacements and rotations at a position per freedom of the nodes.

        The section at the position's station moves by the shape functions; a position off the axis
        moves with it rigidly.

        Parameters
        ----------
        position : (3,) array of float
            m.

        Returns
        -------
        (6, 6 nodes) array of float

        Raises
        ------
        StructureError
            If the position lies beyond an end.
        """
        station = self._station(position)
        section = self._turned[:6, :6].T @ self._own_motion(station)
        return (
            rigid_motion(np.asarray(position, dtype=np.float64) - self.position(station)) @ section
        )

    def _station(self, position: ArrayLike) -> float:
        where = finite(f'beam "{self.name}"', "position", position, (3,))
        return self._within(float(self.axes[0] @ (where - self.origin)))

    def _stations_with_nodes(self) -> list[float]:
        """Positions of discs and bearings, and further ones that are asked for, m."""
        return [
            *(disc.station for disc in self.discs),
            *(bearing.station for bearing in self.bearings),
            *self.stations,
        ]

    def _within(self, station: float) -> float:
        if not -1e-9 * self.length <= station <= (1.0 + 1e-9) * self.length:
            raise StructureError(
                f'beam "{self.name}": station {station:g} m is off the line, '
                f"which is {self.length:g} m long"
            )
        return min(max(float(station), 0.0), self.length)

    @cached_property
    def _turned(self) -> NDArray[np.float64]:
        """(12, 12): turns the motion of two nodes into the line's own directions."""
        return np.kron(np.eye(4), self.axes)

    def _element(self, station: float) -> int:
        last = len(self.nodes) - 2
        return int(np.clip(np.searchsorted(self.nodes, station, side="right") - 1, 0, last))

    def _section_of(self, element: int) -> Segment:
        middle = 0.5 * (self.nodes[element] + self.nodes[element + 1])
        ends = np.cumsum([segment.length for segment in self.segments])
        return self.segments[int(np.searchsorted(ends[:-1], middle))]

    def _own_motion(self, station: float) -> NDArray[np.float64]:
        """(6, 6 nodes): motion of the section at a station in the line's own directions."""
        element = self._element(station)
        left, right = self.nodes[element : element + 2]
        functions = shape_functions(
            self._section_of(element), right - left, (station - left) / (right - left)
        )
        motion = np.zeros((6, 6 * len(self.nodes)))
        motion[:, 6 * element : 6 * element + 12] = functions @ self._turned
        return motion

    def _over_elements(self, matrix: Callable[[Segment, float], NDArray]) -> NDArray[np.float64]:
        whole = np.zeros((6 * len(self.nodes),) * 2)
        turned = self._turned
        for element, length in enumerate(np.diff(self.nodes)):
            part = slice(6 * element, 6 * element + 12)
            own = matrix(self._section_of(element), float(length))
            whole[part, part] += turned.T @ own @ turned
        return whole
