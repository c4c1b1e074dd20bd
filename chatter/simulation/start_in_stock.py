"""Stock that the tool already stands in at the start: it is cleared before the first step.

A tool cannot have come to such a start but by clearing it, by a plunge or an earlier pass; cut by
the first revolution it would be a chip as thick as the overlap.
"""

from __future__ import annotations

import numpy as np

from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.simulation.spindle import ToolPath
from chatter.simulation.workpiece import DISCRETE_CHIPS
from cutting.chip.discrete_chip import DiscreteCut
from cutting.tool.cutter import EdgeSlices

#: share of the volume of the tool in the stock that is rounding, not overlap
_ROUNDING = 1e-6


def clear_start(
    case: Case, cut: DiscreteCut, slices: EdgeSlices, path: ToolPath
) -> tuple[str, ...]:
    """Clear the stock of a cut within the tool at the start of its path; return notes of it.

    InputError if nothing is left of the stock.
    """
    kind, start = DISCRETE_CHIPS[case.simulation.chip], path.corners[0]
    # out to the tooth that reaches furthest
    envelope = slices.radius + slices.normal_offset.max(axis=0) / np.sin(slices.immersion)
    cleared, left = 0.0, 0.0
    for layer, (radius, thickness) in enumerate(zip(envelope, slices.thickness, strict=True)):
        before = kind.remaining_area(cut.stock, layer)
        if before > 0.0:
            kind.remove_path(cut.stock, layer, *start, *start, radius)
            after = kind.remaining_area(cut.stock, layer)
            cleared += (before - after) * thickness
            left += after * thickness
    if cleared <= _ROUNDING * np.pi * float(np.sum(envelope**2 * slices.thickness)):
        return ()
    if left == 0.0:
        raise InputError(f"{_where(case, start)} all of the stock lies within the tool")
    return (
        f"{_where(case, start)} the tool stands in the stock; {cleared * 1e9:.3g} mm3 of it were "
        "cleared before the first step",
    )


def _where(case: Case, start: np.ndarray) -> str:
    """Name the start of the path in the case file."""
    key = "simulation.path[0]" if case.simulation.path else "stock"
    at = f"[{start[0] * 1e3:g} mm, {start[1] * 1e3:g} mm]"
    return f"{case.name}: {key}: at the start, with its axis at {at},"
