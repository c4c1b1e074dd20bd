"""Checks across sections of a case."""

from collections.abc import Mapping
from typing import Any

from chatter.description.sections.cut import Cut
from chatter.description.sections.friction import Friction
from chatter.description.sections.optimisation import Optimum
from chatter.description.sections.structure import StructureSection
from chatter.description.sections.tool import Tool
from chatter.description.usual_units import UsualUnit

#: m, which no tool cuts
_NO_DEPTH = 0.5


def depth_problems(
    cut: Cut | None, tool: Tool | None, length: UsualUnit, data: Mapping[str, Any]
) -> list[tuple[str, str]]:
    """Check the axial depth against what the tool can cut, in words with a unit of length.

    Data are what the file says. Path and sentence of what is wrong are returned.
    """
    if cut is None or tool is None or cut.axial_depth <= tool.depth_that_tool_allows * (1.0 + 1e-9):
        return []
    depth = length.text(cut.axial_depth, "g")
    deepest = length.text(tool.depth_that_tool_allows, "g")
    given = data.get("cut", {}).get("axial_depth")
    # no tool cuts a metre deep: a number without a unit was meant in another than m
    bare = isinstance(given, (int, float)) and cut.axial_depth >= _NO_DEPTH
    meant = f'; is "{given:g} {length.name}" meant?' if bare else ""
    text = f"{depth} is more than tool.{tool.limiting_length}, {deepest}{meant}"
    return [("cut.axial_depth", text)]


def friction_problems(
    structure: StructureSection | None, frictions: Mapping[str, Friction]
) -> list[tuple[str, str]]:
    """Check that the frictions named by modes are there.

    Path and sentence of what is wrong are returned.
    """
    known = ", ".join(f"[friction.{name}]" for name in frictions) or "none"
    return [
        (
            f"structure.mode[{index}].friction",
            f"there is no [friction.{mode.friction}]; there is {known}",
        )
        for index, mode in enumerate(structure.mode if structure is not None else ())
        if mode.friction is not None and mode.friction not in frictions
    ]


def optimum_problems(
    optimum: Optimum | None, cut: Cut | None, tool: Tool | None, length: UsualUnit
) -> list[tuple[str, str]]:
    """Check the radial depths of [optimum] against cut and tool, in words with a unit of length.

    Path and sentence of what is wrong are returned.
    """
    if optimum is None or optimum.radial_depths is None or cut is None or tool is None:
        return []
    if cut.mode == "slot":
        text = 'mode = "slot" cuts the whole diameter; leave it out, or choose "up" or "down"'
        return [("optimum.radial_depths", text)]
    if cut.radial_depth is None:
        text = "varies cut.radial_depth, which [cut] does not state; leave it out, or state it"
        return [("optimum.radial_depths", text)]
    if optimum.radial_depths.to > tool.diameter * (1.0 + 1e-9):
        width = length.text(optimum.radial_depths.to, "g")
        size = length.text(tool.diameter, "g")
        text = f"{width} is more than the diameter of the tool, {size}"
        return [("optimum.radial_depths.to", text)]
    return []
