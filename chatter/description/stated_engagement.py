"""Engagement as a shop states it: radial depth, stepover, place of the workpiece, or angles."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from chatter.description.path import field_at
from chatter.description.sections.cut import ENGAGEMENTS, Cut
from chatter.description.sections.tool import Tool
from chatter.description.usual_units import UsualUnit
from cutting.engagement.uncut_band import (
    SLOT,
    UncutBand,
    band_beside_pass,
    band_beside_wall,
    band_between_angles,
    band_of_workpiece,
)

#: keys that state the engagement beside the mode
ENGAGEMENT_KEYS = tuple(key for keys in ENGAGEMENTS for key in keys)
#: keys of [cut] that take others away
ALTERNATIVE_ENGAGEMENTS = {
    key: tuple(other for other in ENGAGEMENT_KEYS if other not in keys)
    for keys in ENGAGEMENTS
    for key in keys
}


def uncut_band(cut: Cut, tool: Tool) -> UncutBand:
    """Uncut work across the feed of a cut, beside the axis of a tool."""
    radius = 0.5 * tool.diameter
    if cut.workpiece_width is not None:
        return band_of_workpiece(cut.workpiece_width, cut.tool_offset or 0.0)
    if cut.entry_angle is not None:
        return band_between_angles(cut.entry_angle, cut.exit_angle, radius)
    if cut.stepover is not None:
        return band_beside_pass(cut.mode, cut.stepover)
    if cut.radial_depth is None:
        return SLOT
    # a conversion of units may have rounded it to a hair more than the diameter
    return band_beside_wall(cut.mode, min(cut.radial_depth, tool.diameter), radius)


def engagement_problems(
    cut: Cut | None, tool: Tool | None, length: UsualUnit
) -> list[tuple[str, str]]:
    """Check the engagement against the diameter of the tool, in words in a unit of length.

    Path and sentence of what is wrong are returned.
    """
    if cut is None or tool is None:
        return []
    diameter = tool.diameter
    if cut.workpiece_width is not None:
        return _place_problems(cut.workpiece_width, cut.tool_offset or 0.0, diameter, length)
    widths = {"radial_depth": cut.radial_depth, "stepover": cut.stepover}
    return [
        problem
        for key, width in widths.items()
        if width is not None
        for problem in _width_problems(key, cut.mode, width, diameter, length)
    ]


def _width_problems(
    key: str, mode: str, width: float, diameter: float, length: UsualUnit
) -> list[tuple[str, str]]:
    given, size = length.text(width, "g"), length.text(diameter, "g")
    if width > diameter * (1.0 + 1e-9):
        return [(f"cut.{key}", f"{given} is more than the diameter of the tool, {size}")]
    if mode == "slot" and width < diameter * (1.0 - 1e-6):
        text = f'{given} is not the diameter, {size}, that mode = "slot" cuts; '
        return [(f"cut.{key}", text + 'leave it out, or choose "up" or "down"')]
    return []


def _place_problems(
    width: float, offset: float, diameter: float, length: UsualUnit
) -> list[tuple[str, str]]:
    nearest = abs(offset) - 0.5 * width
    if nearest < 0.5 * diameter * (1.0 - 1e-9):
        return []
    text = (
        f"{length.text(offset, 'g')} from the middle of a workpiece {length.text(width, 'g')} wide "
        f"the tool of {length.text(diameter, 'g')} does not reach it"
    )
    return [("cut.tool_offset", text)]


def engagement_problems_of_draft(
    data: Mapping[str, Any], length: UsualUnit
) -> list[tuple[str, str]]:
    """Check the radial depth of a case that has other faults, as far as its values can be read."""
    tool, cut = data.get("tool"), data.get("cut")
    width, diameter = _length(Cut, cut, "radial_depth"), _length(Tool, tool, "diameter")
    if width is None or diameter is None:
        return []
    return _width_problems("radial_depth", str(cut.get("mode")), width, diameter, length)


def _length(section: type, table: Any, key: str) -> float | None:
    if not isinstance(table, Mapping) or key not in table:
        return None
    try:
        return field_at(section, (key,)).read(table[key])
    except ValueError:
        # told by the section itself
        return None
