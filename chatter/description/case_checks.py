"""Checks across sections of a case."""

from collections.abc import Mapping
from typing import Any

from chatter.description.path import field_at
from chatter.description.sections.cut import Cut
from chatter.description.sections.friction import Friction
from chatter.description.sections.optimisation import Optimum
from chatter.description.sections.structure import StructureSection
from chatter.description.sections.tool import Tool

_WIDTH = "cut.radial_depth"


def engagement_problems(
    mode: str | None, radial_depth: float | None, diameter: float | None
) -> list[tuple[str, str]]:
    """Check the radial depth (m) against the diameter (m) of the tool.

    None stands for what is not known. Path and sentence of what is wrong are returned.
    """
    if radial_depth is None or diameter is None:
        return []
    width, size = f"{radial_depth * 1e3:g} mm", f"{diameter * 1e3:g} mm"
    if radial_depth > diameter * (1.0 + 1e-9):
        return [(_WIDTH, f"{width} is more than the diameter of the tool, {size}")]
    if mode == "slot" and radial_depth < diameter * (1.0 - 1e-6):
        text = f'{width} is not the diameter, {size}, that mode = "slot" cuts; '
        return [(_WIDTH, text + 'leave it out, or choose "up" or "down"')]
    return []


def depth_problems(cut: Cut | None, tool: Tool | None) -> list[tuple[str, str]]:
    """Check the axial depth against what the tool can cut.

    Path and sentence of what is wrong are returned.
    """
    if cut is None or tool is None or cut.axial_depth <= tool.depth_that_tool_allows * (1.0 + 1e-9):
        return []
    depth, deepest = f"{cut.axial_depth * 1e3:g} mm", f"{tool.depth_that_tool_allows * 1e3:g} mm"
    return [("cut.axial_depth", f"{depth} is more than tool.{tool.limiting_length}, {deepest}")]


def engagement_problems_of_draft(data: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Make the same check on a case that has other faults, as far as its values can be read."""
    tool, cut = data.get("tool"), data.get("cut")
    return engagement_problems(
        cut.get("mode") if isinstance(cut, Mapping) else None,
        _length(Cut, cut, "radial_depth"),
        _length(Tool, tool, "diameter"),
    )


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
    optimum: Optimum | None, cut: Cut | None, tool: Tool | None
) -> list[tuple[str, str]]:
    """Check the radial depths of [optimum] against the cut and the tool.

    Path and sentence of what is wrong are returned.
    """
    if optimum is None or optimum.radial_depths is None or cut is None or tool is None:
        return []
    if cut.mode == "slot":
        text = 'mode = "slot" cuts the whole diameter; leave it out, or choose "up" or "down"'
        return [("optimum.radial_depths", text)]
    if optimum.radial_depths.to > tool.diameter * (1.0 + 1e-9):
        width, size = f"{optimum.radial_depths.to * 1e3:g} mm", f"{tool.diameter * 1e3:g} mm"
        text = f"{width} is more than the diameter of the tool, {size}"
        return [("optimum.radial_depths.to", text)]
    return []


def _length(section: type, table: Any, key: str) -> float | None:
    if not isinstance(table, Mapping) or key not in table:
        return None
    try:
        return field_at(section, (key,)).read(table[key])
    except ValueError:
        # told by the section itself
        return None
