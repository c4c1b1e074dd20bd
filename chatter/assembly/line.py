"""Entries of a library as stepped lines of round sections, from the tip towards the spindle."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

import numpy as np

from chatter.assembly.library import MATERIALS, HolderEntry, RoundSection, ToolEntry
from dynamics.beam.element import Material, Segment

#: cylinders that stand for a cone
_STEPS_OF_A_CONE = 8


def tool_segments(tool: ToolEntry, stick_out: float) -> list[Segment]:
    """Segments of a tool that are outside the holder, m, the tip first."""
    material = MATERIALS[tool.material]
    fluted = min(tool.flute_length, stick_out)
    found = [Segment(fluted, tool.flute_ratio * tool.diameter, material)]
    if stick_out > fluted:
        found.append(Segment(stick_out - fluted, tool.shank_diameter, material))
    return found


def holder_segments(holder: HolderEntry, tool: ToolEntry | None, stick_out: float) -> list[Segment]:
    """Segments of a holder from its face on; the shank in it is one with it.

    With no tool its bore is empty.
    """
    inserted = 0.0 if tool is None else min(tool.length - stick_out, holder.bore_depth)
    marks = sorted({inserted, holder.bore_depth})
    found, start = [], 0.0
    for piece in _cylinders(holder.sections):
        for length, middle in _cut(start, piece.length, marks):
            bore = piece.bore
            if middle < holder.bore_depth:
                bore = max(bore, holder.bore)
            if tool is not None and middle < inserted:
                found.append(_filled(length, piece.diameter, bore, MATERIALS[tool.material]))
            else:
                found.append(Segment(length, piece.diameter, MATERIALS["steel"], bore))
        start += piece.length
    return found


def round_segments(sections: Iterable[RoundSection]) -> list[Segment]:
    """Steel segments of plain sections."""
    return [
        Segment(piece.length, piece.diameter, MATERIALS["steel"], piece.bore)
        for piece in _cylinders(sections)
    ]


def _cylinders(sections: Iterable[RoundSection]) -> list[RoundSection]:
    """Cones as cylinders of their mean diameters."""
    found = []
    for one in sections:
        if one.end_diameter is None or one.end_diameter == one.diameter:
            found.append(one.model_copy(update={"end_diameter": None}))
            continue
        edges = np.linspace(one.diameter, one.end_diameter, _STEPS_OF_A_CONE + 1)
        for diameter in 0.5 * (edges[1:] + edges[:-1]):
            update = {
                "length": one.length / _STEPS_OF_A_CONE,
                "diameter": float(diameter),
                "end_diameter": None,
            }
            found.append(one.model_copy(update=update))
    return found


def _cut(start: float, length: float, marks: list[float]) -> list[tuple[float, float]]:
    """Lengths and middles of a piece that is cut at the marks within it."""
    end = start + length
    edges = [start, *(mark for mark in marks if start + 1e-9 < mark < end - 1e-9), end]
    return [(right - left, 0.5 * (left + right)) for left, right in pairwise(edges)]


def _filled(length: float, diameter: float, bore: float, core: Material) -> Segment:
    """Ring of steel with a shank in it, as one section of the same bending stiffness and mass."""
    steel = MATERIALS["steel"]
    fourth, second = (bore / diameter) ** 4, (bore / diameter) ** 2
    young = steel.young * (1.0 - fourth) + core.young * fourth
    density = steel.density * (1.0 - second) + core.density * second
    return Segment(length, diameter, Material(young, density, steel.poisson))
