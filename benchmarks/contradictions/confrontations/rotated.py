"""Up- against down-milling with the structure turned about the tool axis.

With the linear law and teeth on one radius the equations of vibration hold the arc of the cut and
the directions of the modes alone: turned together they are the same.
"""

from __future__ import annotations

import math

import numpy as np

from benchmarks.contradictions.confrontation import Comparison, Confrontation, Document
from benchmarks.contradictions.drawing import cut, material, structure, tool
from benchmarks.contradictions.drawing.quantities import chosen, happens, number_of
from benchmarks.contradictions.numbers import spectral_radius
from chatter.description.case import Case

#: of the spectral radius, beyond the stated errors
_ROUNDING = 1e-6


def draw_upright(rng: np.random.Generator) -> Document:
    """End mill of any pitch and helix with a linear law, in up-milling."""
    tool_ = tool.end_mill(rng)
    for deviation in (tool.with_unequal_pitch, tool.with_helix_by_flute):
        if happens(rng, 0.3):
            deviation(rng, tool_)
    cut_ = cut.any_cut(rng, tool_)
    while cut_["mode"] == "slot":
        cut_ = cut.any_cut(rng, tool_)
    law = chosen(rng, (material.linear, material.oblique, material.named))
    sections = {"tool": tool_, "material": law(rng), "cut": {**cut_, "mode": "up"}}
    sections["structure"] = {"mode": structure.modes(rng, sections)}
    sections = structure.at_depth_of_limits(rng, sections)
    if happens(rng, 0.3):
        sections["process_damping"] = structure.viscous_damping(rng, sections)
    return sections


def turned(document: Document) -> Document:
    """The same in down-milling: the arc ends at pi, and all directions turn with it."""
    radius = tool.radius_of(document["tool"])
    arc = math.acos(1.0 - 1e-3 * number_of(document["cut"]["radial_depth"]) / radius)
    c, s = math.cos(math.pi - arc), math.sin(math.pi - arc)
    modes = []
    for mode in document["structure"]["mode"]:
        x, y, z = mode["direction"]
        modes.append({**mode, "direction": [c * x + s * y, c * y - s * x, z]})
    return {**document, "cut": {**document["cut"], "mode": "down"}, "structure": {"mode": modes}}


def compare_turned(document: Document) -> list[Comparison]:
    """Spectral radius of both."""
    one, error = spectral_radius(Case.from_dict(document))
    other, own = spectral_radius(Case.from_dict(turned(document)))
    allowed = error + own + _ROUNDING * max(1.0, one)
    return [Comparison("spectral radius", one, other, allowed)]


ROTATED = Confrontation(
    name="up and down by turned structures",
    ways="up-milling; down-milling with the structure turned by the difference of the arcs",
    stated="the same but for the stated errors of the radius and 1e-6",
    weight=6.0,
    draw=draw_upright,
    compare=compare_turned,
)
