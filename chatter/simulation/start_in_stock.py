"""Stock that the tool already stands in at the start: it is cleared before the first step.

A tool cannot have come to such a start but by clearing it, by a plunge or an earlier pass; cut by
the first revolution it would be a chip as thick as the overlap.
"""

from __future__ import annotations

import numpy as np

from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.simulation.spindle import ToolPath
from chatter.simulation.tool_course import ToolCourse
from chatter.simulation.workpiece import DISCRETE_CHIPS
from cutting.chip.discrete_chip import DiscreteCut
from cutting.tool.cutter import EdgeSlices

#: share of the volume of the tool in the stock that is rounding, not overlap
_ROUNDING = 1e-6


def clear_start(
    case: Case, cut: DiscreteCut, slices: EdgeSlices, path: ToolPath | ToolCourse
) -> tuple[str, ...]:
    """Clear the stock of a cut within the tool at the start of its path; return notes of it.

    InputError if nothing is left of the stock.
    """
    start = path.start
    if isinstance(path, ToolCourse) and not path.cuts_at(0.0):
        return ()
    envelope = _envelope(slices)
    cleared, left = clear_position(case, cut, slices, start)
    if cleared <= _ROUNDING * np.pi * float(np.sum(envelope**2 * slices.thickness)):
        return ()
    if left == 0.0:
        raise InputError(f"{_where(case, start)} all of the stock lies within the tool")
    return (
        f"{_where(case, start)} the tool stands in the stock; {cleared * 1e9:.3g} mm3 of it were "
        "cleared before the first step",
    )


def _envelope(slices: EdgeSlices) -> np.ndarray:
    """Radius (L,) of each slice out to the tooth that reaches furthest, m."""
    return slices.radius + slices.normal_offset.max(axis=0) / np.sin(slices.immersion)


def clear_position(
    case: Case, cut: DiscreteCut, slices: EdgeSlices, position: np.ndarray
) -> tuple[float, float]:
    """Clear the stock of a cut within the tool at a position; volumes cleared and left, m^3."""
    kind = DISCRETE_CHIPS[case.simulation.chip]
    cleared, left = 0.0, 0.0
    for layer, (radius, thickness) in enumerate(
        zip(_envelope(slices), slices.thickness, strict=True)
    ):
        before = kind.remaining_area(cut.stock, layer)
        if before > 0.0:
            kind.remove_path(cut.stock, layer, *position, *position, radius)
            after = kind.remaining_area(cut.stock, layer)
            cleared += (before - after) * thickness
            left += after * thickness
    return cleared, left


def _where(case: Case, start: np.ndarray) -> str:
    """Name the start of the path in the case file."""
    key = "simulation.path[0]" if case.simulation.path else "stock"
    key = "simulation.program" if case.simulation.program else key
    at = f"[{start[0] * 1e3:g} mm, {start[1] * 1e3:g} mm]"
    return f"{case.name}: {key}: at the start, with its axis at {at},"
