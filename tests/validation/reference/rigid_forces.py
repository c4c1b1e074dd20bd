"""Forces on a rigid tool from the definitions alone: sums over thousands of slices, drawn cuts.

Written from the conventions of the documentation (angles, signs, runout, engagement, laws), with
nothing of the packages that are tested. The chip is that of the delayed description: the feed
over the delay of each earlier tooth along the radius, and the thinnest of all counts.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TURN = 2.0 * math.pi


@dataclass(frozen=True)
class Edge:
    """Edge of a tool in n slices, from the tip up to the axial depth.

    Parameters
    ----------
    height, radius, immersion, length : (n,) array of float
        Of the middle of each slice, m and rad, and its length of edge, m.
    """

    height: Array
    radius: Array
    immersion: Array
    length: Array


def edge_of(tool: dict, depth: float, slices: int) -> Edge:
    """Cut the edge of a tool into slices of equal length on the corner and on the flank."""
    radius, corner = 0.5 * tool["diameter"], tool.get("corner_radius", 0.0)
    if tool["kind"] == "ball":
        corner = radius
    immersion = tool.get("cutting_edge_angle", 0.5 * math.pi) - tool.get("taper_angle", 0.0)
    top = min(depth, corner * (1.0 - math.cos(immersion)))
    parts = []
    if top > 0.0:
        last = math.acos(1.0 - top / corner)
        k = last * (np.arange(slices) + 0.5) / slices
        along = radius - corner + corner * np.sin(k)
        parts.append(
            (corner * (1.0 - np.cos(k)), along, k, np.full(slices, corner * last / slices))
        )
    if depth - top > 1e-12:
        z = top + (depth - top) * (np.arange(slices) + 0.5) / slices
        start = radius - corner * (1.0 - math.sin(immersion))
        flank = np.full(slices, (depth - top) / slices / math.sin(immersion))
        along = start + (z - top) / math.tan(immersion)
        parts.append((z, along, np.full(slices, immersion), flank))
    return Edge(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def coefficients(material: dict, helix: float) -> tuple[Array, Array]:
    """Cutting (N/m^2) and edge (N/m) coefficients, each tangential, radial, axial."""
    edge = np.array([material.get(name, 0.0) for name in ("Kte", "Kre", "Kae")])
    if material["law"] != "oblique":
        return np.array([material.get(name, 0.0) for name in ("Ktc", "Krc", "Kac")]), edge
    # Budak, Altintas and Armarego 1996, chip flow angle equal to the inclination
    shear = material["shear_angle"]
    friction = math.atan(math.tan(material["friction_angle"]) * math.cos(helix))
    beyond = friction - material["rake_angle"]
    lean = math.tan(helix) * math.sin(friction)
    scale = material["shear_stress"] / math.sin(shear)
    scale /= math.hypot(math.cos(shear + beyond), lean)
    tangential = math.cos(beyond) + math.tan(helix) * lean
    axial = math.cos(beyond) * math.tan(helix) - lean
    radial = math.sin(beyond) / math.cos(helix)
    return scale * np.array([tangential, radial, axial]), edge


@dataclass(frozen=True)
class RigidCut:
    """A rigid cut by its definitions: edge, teeth, arcs and law.

    Parameters
    ----------
    case : dict
        Sections tool, material and cut, in SI units and radians.
    slices : int
        Of corner and flank each.
    """

    case: dict
    slices: int = 3000

    def __post_init__(self) -> None:
        tool, cut = self.case["tool"], self.case["cut"]
        teeth, radius = tool["teeth"], 0.5 * tool["diameter"]
        edge = edge_of(tool, cut["axial_depth"], self.slices)
        pitch = np.array(tool.get("pitch") or [TURN / teeth] * teeth)
        place = np.concatenate([[0.0], np.cumsum(pitch)[:-1]])
        given = tool.get("helix", 0.0)
        helix = np.array(given if isinstance(given, (list, tuple)) else [given] * teeth)
        runout = tool.get("runout", {"offset": 0.0, "angle": 0.0})
        outwards = runout["offset"] * np.cos(runout["angle"] - place)
        outwards = outwards + np.array(tool.get("radial_error") or [0.0] * teeth)
        down = np.array(tool.get("axial_error") or [0.0] * teeth)
        arc = np.arccos(np.clip((radius - cut["radial_depth"]) / edge.radius, -1.0, 1.0))
        none, all_round = np.zeros_like(arc), np.full_like(arc, math.pi)
        arcs = {"slot": (none, all_round), "up": (none, arc), "down": (math.pi - arc, all_round)}
        lag = np.tan(helix)[:, None] / radius
        known = {
            "teeth": teeth,
            "helix": helix,
            "edge": edge,
            "arcs": arcs[cut["mode"]],
            "on_tool": place[:, None] - lag * edge.height,
            "at_ends": place[:, None] - lag * np.array([0.0, cut["axial_depth"]]),
            "outwards": outwards,
            "down": down,
            "feed": cut["feed_per_tooth"] * teeth / TURN,
        }
        for name, value in known.items():
            object.__setattr__(self, name, value)

    def of_edge(self, j: int, piece: Array, phi: Array) -> tuple[Array, Array, Array]:
        """Force (x, y, z) of tooth j on slices of its edge that are in the arc, N."""
        material, edge = self.case["material"], self.edge
        cutting, at_edge = coefficients(material, float(self.helix[j]))
        sk, ck = np.sin(edge.immersion), np.cos(edge.immersion)
        s, c = np.sin(phi), np.cos(phi)
        chip = np.full(np.shape(phi), np.inf)
        for k in range(self.teeth):
            # how far ahead each tooth stands, itself a revolution
            ahead = np.mod(self.on_tool[k] - self.on_tool[j], TURN)
            ahead[ahead < 1e-9] = TURN
            beside = (self.outwards[j] - self.outwards[k]) * sk + (self.down[j] - self.down[k]) * ck
            chip = np.minimum(chip, self.feed * ahead[piece] * s * sk[piece] + beside[piece])
        cuts = chip > 0.0
        chip = np.where(cuts, chip, 1e-12)
        size = chip
        if material["law"] == "exponential":
            size = material["h0"] * (chip / material["h0"]) ** material["exponent"]
        length = np.where(cuts, edge.length[piece], 0.0)
        ft, fr, fa = ((cutting[i] * size + at_edge[i]) * length for i in range(3))
        plane = fa * ck[piece] - fr * sk[piece]
        return plane * s - ft * c, plane * c + ft * s, fr * ck[piece] + fa * sk[piece]

    def mean(self, points: int = 400) -> Array:
        """Mean force (3,) over a revolution, N: each slice over its own arc, whatever its lag."""
        entry, leave = self.arcs
        pieces = np.flatnonzero(leave > entry)
        share = (np.arange(points) + 0.5) / points
        total = np.zeros(3)
        width = (leave - entry)[pieces]
        for j in range(self.teeth):
            phi = entry[pieces] + share[:, None] * width
            force = self.of_edge(j, np.broadcast_to(pieces, phi.shape), phi)
            total += [np.sum(part * width) / points / TURN for part in force]
        return total

    def forces(self, turned: Array) -> Array:
        """Force (n, 3) at spindle angles (n,), N."""
        entry, leave = self.arcs
        force = np.zeros((turned.size, 3))
        for j in range(self.teeth):
            for begin in range(0, turned.size, 200):
                rows = turned[begin : begin + 200]
                phi = np.mod(rows[:, None] + self.on_tool[j], TURN)
                row, piece = np.nonzero((phi > entry) & (phi < leave))
                parts = self.of_edge(j, piece, phi[row, piece])
                for axis, part in enumerate(parts):
                    force[begin : begin + 200, axis] += np.bincount(row, part, rows.size)
        return force

    def peak(self, angles: int = 3600) -> Array:
        """Largest size (3,) of each force, N.

        Kinks and jumps stand where an end of an edge passes an end of its arc: they are looked at
        from both sides.
        """
        entry, leave = self.arcs
        cutting = np.flatnonzero(leave > entry)[[0, -1]]
        borders = np.unique(np.concatenate([entry[cutting], leave[cutting]]))
        special = (borders[:, None, None] - self.at_ends).ravel()
        inner = np.concatenate([self.on_tool[:, cutting].ravel()])
        special = np.concatenate([special, (borders[:, None] - inner).ravel()])
        near = (special[:, None] + np.array([-1e-7, 1e-7])).ravel()
        even = (np.arange(angles) + 0.5) * TURN / angles
        return np.abs(self.forces(np.concatenate([even, np.mod(near, TURN)]))).max(axis=0)


#: kinds of tools that are drawn
KINDS = ("end mill", "ball", "bull nose", "taper", "inserted")


def drawn_case(random: np.random.Generator) -> dict:
    """Draw a rigid cut of any tool, engagement and law; sections in SI units and radians."""
    kind = str(random.choice(KINDS))
    diameter = float(random.uniform(4e-3, 25e-3))
    teeth = int(random.integers(1, 6))
    helix = float(random.choice([0.0, random.uniform(0.0, math.radians(45.0))]))
    if random.random() < 0.1:
        helix = -helix
    depth = float(diameter * math.exp(random.uniform(math.log(0.02), math.log(0.5))))
    tool = {"kind": kind, "teeth": teeth, "diameter": diameter, "helix": helix}
    if kind == "bull nose":
        tool["corner_radius"] = float(random.uniform(0.05, 0.45) * diameter)
    if kind == "taper":
        tool["taper_angle"] = float(math.radians(random.uniform(1.0, 20.0)))
        tool["corner_radius"] = float(random.choice([0.0, random.uniform(0.05, 0.3) * diameter]))
    if kind == "inserted":
        tool["cutting_edge_angle"] = float(math.radians(random.uniform(30.0, 89.0)))
        tool["corner_radius"] = float(random.choice([0.0, random.uniform(0.02, 0.1) * diameter]))
    feed = float(diameter * random.uniform(0.002, 0.01))
    if teeth > 1 and random.random() < 0.35:
        pitch = 1.0 + random.uniform(-0.2, 0.2, teeth)
        tool["pitch"] = [float(p) for p in pitch / pitch.sum() * TURN]
    if teeth > 1 and random.random() < 0.35:
        tool["runout"] = {
            "offset": float(feed * random.uniform(0.05, 0.6)),
            "angle": float(random.uniform(0.0, TURN)),
        }
    law = str(random.choice(["linear", "exponential", "oblique"]))
    material: dict = {"law": law}
    if law == "oblique":
        material |= {
            "shear_stress": 6e8,
            "friction_angle": float(random.uniform(0.3, 0.6)),
            "shear_angle": float(random.uniform(0.35, 0.6)),
            "rake_angle": float(random.uniform(-0.1, 0.25)),
        }
    else:
        material |= {"Ktc": 1.5e9, "Krc": float(random.uniform(2e8, 9e8)), "Kac": 2e8}
    if law == "exponential":
        material |= {"h0": 1e-4, "exponent": float(random.uniform(0.6, 0.95))}
    if random.random() < 0.6:
        material |= {"Kte": 2e4, "Kre": 3e4, "Kae": 3e3}
    mode = str(random.choice(["up", "down", "up", "down", "slot"]))
    share = math.exp(random.uniform(math.log(0.01), 0.0))
    width = diameter if mode == "slot" else float(diameter * share)
    cut = {
        "mode": mode,
        "spindle_speed": 500.0,
        "feed_per_tooth": feed,
        "axial_depth": depth,
        "radial_depth": width,
    }
    edge = edge_of(tool, depth, 50)
    if mode != "slot" and edge.radius.max() <= 1.001 * (0.5 * diameter - width):
        # the edge does not reach the stock
        return drawn_case(random)
    return {"tool": tool, "material": material, "cut": cut}
