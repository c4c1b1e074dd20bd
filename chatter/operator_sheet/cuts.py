"""Rows of an operator's sheet: cuts of one case with limits and margins."""

from __future__ import annotations

import math
from typing import NamedTuple

from chatter.description.case import Case
from chatter.description.units import rpm
from chatter.operator_sheet.variation import Variation
from chatter.stability.diagram import StabilityDiagram
from chatter.stability.neglected_effects import CHATTER, NOT_CERTAIN, STABLE


class SheetCut(NamedTuple):
    """One line of the sheet, in the units of the shop."""

    name: str
    spindle_speed: float | None  # rpm; None for any speed
    cutting_speed: float | None  # m/min
    axial_depth: float  # mm
    width_of_cut: float  # mm
    feed_per_tooth: float  # mm
    feed_rate: float | None  # mm/min
    limit: float | None  # mm; None where none was found up to the searched depth
    removal_rate: float | None  # cm^3/min
    verdict: str  # "stable", "chatter" or "not certain"
    because: str = ""  # why it is not certain

    @property
    def margin(self) -> float | None:
        """Share of the limit that is kept in hand; negative beyond the limit."""
        return None if self.limit is None else 1.0 - self.axial_depth / self.limit

    def __repr__(self) -> str:
        """What the line says first."""
        speed = "any speed" if self.spindle_speed is None else f"{self.spindle_speed:.6g} rpm"
        return f"<SheetCut {self.name}: {self.axial_depth:.4g} mm at {speed}, {self.verdict}>"


class CaseCuts(NamedTuple):
    """Cuts of one case."""

    case: Case
    diagram: StabilityDiagram
    cuts: tuple[SheetCut, ...]
    variation: Variation | None

    def __repr__(self) -> str:
        """Of which case, and how many: the cuts would fill the screen."""
        return f"<CaseCuts of {self.case.name!r}: {len(self.cuts)} cuts>"


def cuts_of(diagram: StabilityDiagram) -> tuple[SheetCut, ...]:
    """The cut as stated, the best pockets, and the depth that any speed of the range allows."""
    case = diagram.case
    cut = case.cut
    stated = _at_speed(
        case,
        "as stated",
        cut.spindle_speed,
        cut.axial_depth,
        float(diagram.operating.critical_depth[0]),
        _verdict(diagram),
        diagram.why_not_certain,
    )
    pockets = [
        _at_speed(
            case,
            f"pocket {place}",
            pocket.spindle_speed,
            pocket.axial_depth,
            pocket.critical_depth,
            STABLE,
        )
        for place, pocket in enumerate(diagram.pockets, start=1)
    ]
    return (stated, *pockets, *_at_any_speed(diagram))


def _verdict(diagram: StabilityDiagram) -> str:
    """Verdict on the cut as stated."""
    if diagram.deciding:
        return NOT_CERTAIN
    return STABLE if diagram.operating_is_stable else CHATTER


def _at_speed(
    case: Case, name: str, speed: float, depth: float, limit: float, verdict: str, because: str = ""
) -> SheetCut:
    turns = speed / (2.0 * math.pi)
    feed = case.cut.feed_per_tooth * case.tool.teeth * turns
    return SheetCut(
        name,
        rpm(speed),
        60.0 * math.pi * case.tool.diameter * turns,
        1e3 * depth,
        1e3 * case.width_of_cut,
        1e3 * case.cut.feed_per_tooth,
        60e3 * feed,
        1e3 * limit if math.isfinite(limit) else None,
        60e6 * depth * case.width_of_cut * feed,
        verdict,
        because,
    )


def _at_any_speed(diagram: StabilityDiagram) -> list[SheetCut]:
    """Depth below every limit of the range, less the margin; none where there is no limit."""
    lowest = diagram.lowest.critical_depth
    # where no bound is known, no depth is stable for certain
    if not math.isfinite(lowest) or diagram.depth_margin >= 1.0:
        return []
    case = diagram.case
    return [
        SheetCut(
            "any speed",
            None,
            None,
            1e3 * (1.0 - diagram.depth_margin) * lowest,
            1e3 * case.width_of_cut,
            1e3 * case.cut.feed_per_tooth,
            None,
            1e3 * lowest,
            None,
            STABLE,
        )
    ]
