"""Forces of a rigid tool by quadrature, from the definitions and without any slice of the packages.

Nodes along the profile of the edge (Engin and Altintas 2001), the passes of all teeth within a
revolution at each of them, and the force law at the thinnest chip. Conventions: x feed, y normal,
z tool axis; rotation angle phi clockwise from +y; h = f sin(phi) sin(kappa), the thinnest of all
earlier passes counts; forces act on the tool.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case

Array = NDArray[np.float64]

_REVOLUTION = 2.0 * math.pi
#: nodes along the corner and along the straight edge, at the least and at the most
_FEWEST, _MOST = 300, 2500
#: nodes within the lag that an arc holds, and within a wave of a serration
_NODES_AN_ARC, _NODES_A_WAVE = 250, 60
#: angles within the arc of a node, for means
_ANGLES = 800


@dataclass(frozen=True)
class EdgeNodes:
    """Nodes (n,) of the profile: middles of short pieces of edge."""

    height: Array  # above the tip, m
    radius: Array  # m
    immersion: Array  # between axis and normal, rad
    length: Array  # of edge, m


class RigidCut:
    """The cut of a case by a tool that does not give way."""

    def __init__(self, case: Case) -> None:
        tool, cut = case.tool, case.cut
        self.case = case
        self.radius = 0.5 * tool.diameter
        self.helix = np.broadcast_to(np.asarray(tool.helix, dtype=float), (tool.teeth,))
        pitch = np.asarray(tool.pitch or (1.0,) * tool.teeth)
        pitch = pitch * _REVOLUTION / pitch.sum()
        self.tooth_angle = np.concatenate([[0.0], np.cumsum(pitch)[:-1]])
        self.nodes = _nodes(case, self.radius, self._widest_arc(), float(np.abs(self.helix).max()))
        lag = np.outer(np.tan(self.helix) / self.radius, self.nodes.height)
        #: angle of the edges on the tool (N, n), rad
        self.angle = self.tooth_angle[:, None] - lag
        self.offset = self._normal_offsets()
        self.entry, self.exit = self._arc(self.nodes.radius)
        self.feed = cut.feed_per_tooth * tool.teeth
        self.coefficients = [_coefficients(case, helix) for helix in self.helix]

    def _widest_arc(self) -> float:
        entry, leave = self._arc(np.array([self.radius]))
        return max(float(leave[0] - entry[0]), 1e-3)

    def _arc(self, radius: Array) -> tuple[Array, Array]:
        """Entry and exit of edges at some radii; the stock ends R - ae from the axis."""
        cut = self.case.cut
        if cut.mode == "slot":
            return np.zeros_like(radius), np.full_like(radius, math.pi)
        arc = np.arccos(np.clip((self.radius - cut.radial_depth) / radius, -1.0, 1.0))
        if cut.mode == "up":
            return np.zeros_like(arc), arc
        return math.pi - arc, np.full_like(arc, math.pi)

    def _normal_offsets(self) -> Array:
        """Deviation (N, n) of the edges along their outward normal, m."""
        tool, nodes = self.case.tool, self.nodes
        out = np.zeros((tool.teeth, nodes.height.size))
        if tool.runout is not None:
            out += tool.runout.offset * np.cos(tool.runout.angle - self.tooth_angle)[:, None]
        if tool.radial_error:
            out += np.asarray(tool.radial_error)[:, None]
        if tool.serration is not None:
            wave = nodes.height / tool.serration.wavelength
            phase = wave + np.arange(tool.teeth)[:, None] / tool.teeth
            out += 0.5 * tool.serration.depth * (np.cos(_REVOLUTION * phase) - 1.0)
        out = out * np.sin(nodes.immersion)
        if tool.axial_error:
            out += np.outer(tool.axial_error, np.cos(nodes.immersion))
        return out

    def _chip(self, tooth: int, node: NDArray[np.intp], phi: Array) -> Array:
        """Chip of nodes of a tooth at rotation angles, m: the thinnest over all earlier passes."""
        slope = np.sin(phi) * np.sin(self.nodes.immersion[node])
        thinnest = self.feed * slope
        for other in range(len(self.tooth_angle)):
            if other == tooth:
                continue
            since = np.mod(self.angle[other] - self.angle[tooth], _REVOLUTION)[node]
            chip = self.feed * since / _REVOLUTION * slope
            chip += (self.offset[tooth] - self.offset[other])[node]
            thinnest = np.minimum(thinnest, chip)
        return thinnest

    def _force(self, tooth: int, node: NDArray[np.intp], phi: Array) -> Array:
        """Force on the tool and tangential force times radius (4, ...), per length of edge.

        Of nodes of a tooth at rotation angles of like shape; 0 where there is no chip.
        """
        immersion = self.nodes.immersion[node]
        s, c = np.sin(phi), np.cos(phi)
        sk, ck = np.sin(immersion), np.cos(immersion)
        thinnest = self._chip(tooth, node, phi)
        cuts = thinnest > 0.0
        tangential, radial, axial = _edge_force(
            self.coefficients[tooth], np.where(cuts, thinnest, 1.0)
        )
        parts = [
            -tangential * c - radial * sk * s + axial * ck * s,
            tangential * s - radial * sk * c + axial * ck * c,
            radial * ck + axial * sk,
            tangential * self.nodes.radius[node],
        ]
        return np.stack(parts) * cuts

    @property
    def _alike(self) -> bool:
        """Whether all teeth cut alike."""
        even = np.allclose(np.diff(self.tooth_angle), _REVOLUTION / len(self.tooth_angle))
        return bool(even and np.ptp(self.helix) == 0.0 and not self.offset.any())

    def mean(self) -> Array:
        """Mean force on the tool over a revolution (3,), N, and mean torque, N m: (4,)."""
        count = _ANGLES if self.offset.any() else _ANGLES // 4
        share = (np.arange(count) + 0.5) / count
        arc = np.maximum(self.exit - self.entry, 0.0)
        reached = np.flatnonzero(arc > 0.0)
        phi = self.entry[reached] + share[:, None] * arc[reached]
        node = np.broadcast_to(reached, phi.shape)
        weight = (self.nodes.length * arc)[reached] / _REVOLUTION
        total = np.zeros(4)
        teeth = len(self.tooth_angle)
        for tooth in range(1 if self._alike else teeth):
            total += self._force(tooth, node, phi).mean(axis=1) @ weight
        return total * (teeth if self._alike else 1)

    def at(self, spindle_angle: Array) -> Array:
        """Force on the tool, N, and torque, N m, at spindle angles (a,), rad: (4, a)."""
        total = np.zeros((4, spindle_angle.size))
        for tooth in range(len(self.tooth_angle)):
            phi = np.mod(spindle_angle[:, None] + self.angle[tooth], _REVOLUTION)
            # an arc from zero is not broken by rounding
            phi = np.where(phi > 1.5 * math.pi, phi - _REVOLUTION, phi)
            # at the very end of the arc an edge is out
            place, node = np.nonzero((phi >= self.entry) & (phi < self.exit - 1e-9))
            force = self._force(tooth, node, phi[place, node]) * self.nodes.length[node]
            for k in range(4):
                total[k] += np.bincount(place, force[k], minlength=spindle_angle.size)
        return total

    @property
    def jumps(self) -> bool:
        """Whether an edge enters or leaves the cut all at once."""
        reach = np.ptp(self.angle, axis=1)
        return bool(reach.min() < 0.02 * self._widest_arc())


def _nodes(case: Case, radius: float, arc: float, helix: float) -> EdgeNodes:
    tool, depth = case.tool, case.cut.axial_depth
    corner = radius if tool.kind == "ball" else tool.corner_radius
    slope = tool.cutting_edge_angle - tool.taper_angle
    blend = corner * (1.0 - math.cos(slope))
    top = min(depth, blend)
    parts = []
    if top > 0.0:
        count = _count(case, top, radius, arc, helix)
        lowest = _lowest_reached(case, corner)
        bounds = np.linspace(lowest, max(math.acos(1.0 - top / corner), lowest), count + 1)
        kappa = 0.5 * (bounds[1:] + bounds[:-1])
        parts.append(
            (
                corner * (1.0 - np.cos(kappa)),
                radius - corner + corner * np.sin(kappa),
                kappa,
                corner * np.diff(bounds),
            )
        )
    if depth > top:
        count = _count(case, depth - top, radius, arc, helix)
        bounds = np.linspace(top, depth, count + 1)
        z = 0.5 * (bounds[1:] + bounds[:-1])
        start = radius - corner * (1.0 - math.sin(slope))
        grown = (z - top) / math.tan(slope) if slope < 0.5 * math.pi - 1e-9 else 0.0 * z
        length = np.diff(bounds) / math.sin(slope)
        parts.append((z, start + grown, np.full(count, slope), length))
    return EdgeNodes(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def _lowest_reached(case: Case, corner: float) -> float:
    """Immersion below which a corner does not reach the stock R - ae from the axis, rad."""
    if case.cut.mode == "slot":
        return 0.0
    sine = (corner - case.cut.radial_depth) / corner
    return math.asin(min(max(sine, 0.0), 1.0))


def _count(case: Case, height: float, radius: float, arc: float, helix: float) -> int:
    lag = height * math.tan(helix) / radius
    wanted = max(_FEWEST, _NODES_AN_ARC * lag / arc)
    if case.tool.serration is not None:
        wanted = max(wanted, _NODES_A_WAVE * height / case.tool.serration.wavelength)
    return int(min(_MOST, math.ceil(wanted)))


@dataclass(frozen=True)
class _Coefficients:
    cutting: Array  # (3,), N/m^2
    edge: Array  # (3,), N/m
    reference: float  # m
    exponent: float


def _coefficients(case: Case, helix: float) -> _Coefficients:
    given = case.material.values
    edge = np.array([given.get(key, 0.0) for key in ("Kte", "Kre", "Kae")])
    if case.material.law == "oblique":
        return _Coefficients(oblique_coefficients(given, helix), edge, 1.0, 1.0)
    cutting = np.array([given.get(key, 0.0) for key in ("Ktc", "Krc", "Kac")])
    if case.material.law == "exponential":
        return _Coefficients(cutting, edge, given["h0"], given["exponent"])
    return _Coefficients(cutting, edge, 1.0, 1.0)


def oblique_coefficients(given: dict[str, float], helix: float) -> Array:
    """Budak, Altintas and Armarego 1996, equations 10 to 12, the chip flowing along the normal."""
    shear, rake = given["shear_angle"], given["rake_angle"]
    friction = math.atan(math.tan(given["friction_angle"]) * math.cos(helix))
    root = math.sqrt(
        math.cos(shear + friction - rake) ** 2 + (math.tan(helix) * math.sin(friction)) ** 2
    )
    turn = math.tan(helix) * math.sin(friction)
    stress = given["shear_stress"] / math.sin(shear) / root
    return stress * np.array(
        [
            math.cos(friction - rake) + math.tan(helix) * turn,
            math.sin(friction - rake) / math.cos(helix),
            math.cos(friction - rake) * math.tan(helix) - turn,
        ]
    )


def _edge_force(law: _Coefficients, chip: Array) -> tuple[Array, Array, Array]:
    """Tangential, radial and axial force per length of edge, N/m."""
    size = chip if law.exponent == 1.0 else law.reference * (chip / law.reference) ** law.exponent
    tangential, radial, axial = (law.cutting[k] * size + law.edge[k] for k in range(3))
    return tangential, radial, axial
