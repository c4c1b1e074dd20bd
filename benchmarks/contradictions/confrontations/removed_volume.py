"""Volume that carved chips take away against the volume that the tool sweeps.

The tolerance is that of the force, 0.5 %, and the cusps between two turns, whose mean height is
feed squared over 12 diameters. A border of the stock lies on lines of dexels or cells, wherever
that of the case is: half a spacing at each border of a block, and of voxels on the wall.
"""

from __future__ import annotations

import math

import numpy as np

from benchmarks.contradictions.confrontation import (
    Comparison,
    Confrontation,
    Document,
    PremiseFailsError,
)
from benchmarks.contradictions.confrontations.carved_chips import draw_carved
from benchmarks.contradictions.drawing.quantities import happens, log_uniform, text
from benchmarks.contradictions.drawing.tool import radius_of
from benchmarks.contradictions.edge_quadrature import RigidCut
from chatter.description.case import Case
from chatter.simulation.simulate import simulate

_SHARE = 0.005
#: of a spacing, at a border
_CELLS = 0.5
#: turns of the two runs whose difference is a steady cut
_SHORT, _LONG = 3, 7
#: turns that a pass through a block may take
_MOST_TURNS = 120


def draw_volume(rng: np.random.Generator) -> Document:
    """Carved cut of teeth on one radius, in an endless stock or straight through a block."""
    sections = draw_carved(rng)
    sections["tool"].pop("runout", None)
    radius = 1e3 * radius_of(sections["tool"])
    if sections["tool"]["kind"] == "taper" or not happens(rng, 0.5):
        return sections
    # feeds at which a pass through a block takes few turns
    length = radius * log_uniform(rng, 0.05, 0.5)
    way = length + 2.4 * radius
    feed = min(way / (60.0 * sections["tool"]["teeth"]), 0.04 * radius)
    sections["cut"]["feed_per_tooth"] = text(1e3 * feed, "um")
    turns = math.ceil(way / (feed * sections["tool"]["teeth"])) + 1
    low, high = _sides(sections, radius)
    start, floor = 1.2 * radius, 1.0 + 2.0 * radius * 1.5
    sections["simulation"]["revolutions"] = min(turns, _MOST_TURNS)
    sections["stock"] = {
        "box": [
            {
                "x": [text(start, "mm"), text(start + length, "mm")],
                "y": [text(low, "mm"), text(high, "mm")],
                "z": ["0 mm", text(floor, "mm")],
            }
        ]
    }
    return sections


def _sides(sections: Document, radius: float) -> tuple[float, float]:
    """Where a block begins and ends across the feed, mm."""
    far = 1.3 * radius
    if sections["cut"]["mode"] == "slot":
        return -far, far
    wall = radius - float(sections["cut"]["radial_depth"].split()[0])
    return (wall, far) if sections["cut"]["mode"] == "up" else (-far, -wall)


def swept_section(case: Case) -> tuple[float, float]:
    """Section of the cut across the feed, m^2, and what cusps may leave of it."""
    nodes = RigidCut(case).nodes
    radius = 0.5 * case.tool.diameter
    width = 2.0 * nodes.radius
    sides = 2.0
    if case.cut.mode != "slot":
        width = np.clip(nodes.radius - (radius - case.cut.radial_depth), 0.0, width)
        sides = 1.0
    height = nodes.length * np.sin(nodes.immersion)
    cusp = (case.cut.feed_per_tooth * case.tool.teeth) ** 2 / (24.0 * nodes.radius)
    return float(width @ height), float(sides * np.minimum(cusp, width) @ height)


def compare_volume(document: Document) -> list[Comparison]:
    """Volume of a steady cut, or of a whole pass through a block."""
    case = Case.from_dict(document)
    area, cusps = swept_section(case)
    if case.stock is None:
        short, _ = _removed(case.patch({"simulation.revolutions": _SHORT}))
        long, spacing = _removed(case.patch({"simulation.revolutions": _LONG}))
        removed = long - short
        way = (_LONG - _SHORT) * case.cut.feed_per_tooth * case.tool.teeth
    else:
        box = case.stock.box[0]
        way = box.x[1] - box.x[0]
        turns = (box.x[1] + 0.5 * case.tool.diameter) / (case.cut.feed_per_tooth * case.tool.teeth)
        if turns > case.simulation.revolutions:
            raise PremiseFailsError("the tool does not come through the block")
        removed, spacing = _removed(case)
    allowed = way * (_SHARE * area + cusps)
    if case.stock is not None:
        allowed += 2.0 * _CELLS * spacing * area
    if case.stock is not None or case.simulation.chip == "voxel":
        allowed += way * _CELLS * spacing * case.cut.axial_depth
    return [Comparison("removed volume, mm3", 1e9 * removed, 1e9 * area * way, 1e9 * allowed)]


def _removed(case: Case) -> tuple[float, float]:
    """Volume that a run has taken away, m^3, and its spacing, m."""
    cut = simulate(case).setup.groups[0]
    return float(cut.removed[0]), cut.stock.spacing


REMOVED_VOLUME = Confrontation(
    name="removed volume",
    ways="volume taken from dexels or voxels; section of the cut times the way of the tool, in an "
    "endless stock and straight through a block",
    stated="0.5 %, the tolerance of forces, and the cusps between two turns; half a spacing at "
    "borders of blocks and walls of voxels",
    weight=0.5,
    draw=draw_volume,
    compare=compare_volume,
)
