"""Spectral radius of a cut: collocation against the matrix-free method, and semi-discretization."""

from __future__ import annotations

import numpy as np

from benchmarks.contradictions.confrontation import Comparison, Confrontation, Document
from benchmarks.contradictions.drawing import cut, material, structure, tool
from benchmarks.contradictions.drawing.quantities import happens
from benchmarks.contradictions.numbers import spectral_radius
from chatter.description.case import Case
from chatter.stability.model import milling_model

#: what a method may be off beyond its own estimate: that of one is a difference, not a bound
_BEYOND_ESTIMATES = 5e-5


def draw_vibrating(rng: np.random.Generator) -> Document:
    """Any tool, law and cut on modes, near the limits; process damping, varying speed."""
    tool_ = tool.any_tool(rng)
    sections = {
        "tool": tool_,
        "material": material.any_material(rng),
        "cut": cut.any_cut(rng, tool_),
    }
    sections["structure"] = {"mode": structure.modes(rng, sections)}
    sections = structure.at_depth_of_limits(rng, sections)
    if happens(rng, 0.25):
        sections["process_damping"] = structure.viscous_damping(rng, sections)
    return sections


def draw_any_speed(rng: np.random.Generator) -> Document:
    """The same, in one of eight draws under a varying speed."""
    sections = draw_vibrating(rng)
    if happens(rng, 0.12):
        sections["cut"] = cut.varying_speed(rng, sections["cut"])
    return sections


def compare_radii(document: Document) -> list[Comparison]:
    """Spectral radius by the methods that give one."""
    case = Case.from_dict(document)
    methods = ["matrix-free"]
    if milling_model(case).is_uniform:
        methods.append("semi-discretization")
    one, error = spectral_radius(case)
    found = []
    for name in methods:
        other, own = spectral_radius(case, name)
        allowed = error + own + _BEYOND_ESTIMATES * max(1.0, one)
        if name == "semi-discretization":
            # its estimate is a difference of nested resolutions, about 1e-4 at the default steps
            allowed += 1e-3 * max(1.0, one)
        found.append(Comparison(f"spectral radius ({name})", one, other, allowed))
    return found


MULTIPLIERS = Confrontation(
    name="spectral radius",
    ways="collocation; matrix-free; semi-discretization of uniform end mills",
    stated="their stated errors and 5e-5 of the radius, 1e-3 for semi-discretization, whose "
    "default steps are for limits",
    weight=5.0,
    draw=draw_any_speed,
    compare=compare_radii,
)
