"""An inclined tool axis (lead, tilt): its engagement, and what is not computed with it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from chatter.compile.cutter import cutter_of
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.unit_system import units_of
from cutting.engagement.inclined_tool import InclinedEngagement, ToolAxis
from cutting.tool.cutter import Cutter, corner_height

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: engagements that an inclined tool is computed with
_SIDES = ("up", "down", "slot")
#: an edge that stands steeper runs along the tool axis
_UPRIGHT = 0.5 * math.pi - 1e-9
#: places on the edge, and around the axis, at which the largest diameter is searched
_HEIGHTS, _ANGLES = 400, 721


def is_inclined(case: Case) -> bool:
    """Whether the tool axis is another than the normal of the surface."""
    return case.cut is not None and (case.cut.lead != 0.0 or case.cut.tilt != 0.0)


def tool_axis(case: Case) -> ToolAxis:
    """Inclination of the tool axis."""
    return ToolAxis(case.cut.lead, case.cut.tilt)


def tool_axis_angle(case: Case) -> float:
    """Angle between the tool axis and the normal of the surface, rad."""
    return math.acos(max(-1.0, min(1.0, float(tool_axis(case).direction[2]))))


def inclined_engagement(
    case: Case, cutter: Cutter, axial_depth: float | None = None
) -> InclinedEngagement:
    """Engagement of an inclined tool, by default at the axial depth (m) of [cut]."""
    cut = case.cut
    depth = cut.axial_depth if axial_depth is None else axial_depth
    width = cut.radial_depth
    return InclinedEngagement(
        cutter, tool_axis(case), depth, cut.mode, cut.stepover,
        None if width is None else min(width, cutter.diameter),
    )  # fmt: skip


def effective_diameter_of_ball(diameter: float, axial_depth: float, axis_angle: float) -> float:
    """Largest diameter, m, on which a ball that is inclined cuts.

    D sin(a + acos(1 - 2 a_p/D)), at most D, with the axis at the angle a, rad, from the normal,
    lengths in m (Sandvik Coromant, technical guide of milling, profile milling; exact where the
    axis leans towards what is cut).
    """
    reached = axis_angle + math.acos(max(-1.0, 1.0 - 2.0 * axial_depth / diameter))
    return diameter * math.sin(min(reached, 0.5 * math.pi))


def effective_diameter(engagement: InclinedEngagement) -> float:
    """Largest diameter, m, of what of the tool lies ahead and below the uncut surface.

    The widest edge that cuts in a slot; of a ball that leans towards the feed
    `effective_diameter_of_ball`.
    """
    cutter, top = engagement.cutter, engagement.top
    height = np.linspace(0.0, top, _HEIGHTS + 1)[1:]
    reached = np.array([cutter.radius_at(one) for one in height])
    immersion = np.array([_immersion_at(cutter, one) for one in height])
    wide = _widest(engagement, height, reached, immersion)
    return 2.0 * wide


def diameter_in_cut(case: Case) -> float | None:
    """Largest diameter, m, on which the tool of a case cuts; None where it is the diameter."""
    cutter = cutter_of(case)
    if is_inclined(case):
        return effective_diameter(inclined_engagement(case, cutter))
    return None if cutter.is_cylindrical else 2.0 * cutter.radius_at(case.cut.axial_depth)


def _immersion_at(cutter: Cutter, height: float) -> float:
    """Axial immersion angle of the edge at a height above the tip, rad."""
    if height < corner_height(cutter):
        return math.acos(1.0 - height / cutter.corner_radius)
    return cutter.edge_angle


def _widest(
    engagement: InclinedEngagement,
    height: NDArray[np.float64],
    radius: NDArray[np.float64],
    immersion: NDArray[np.float64],
) -> float:
    """Largest radius, m, at which a point lies in the cut; refined between two heights."""
    cutter = engagement.cutter
    angle = np.linspace(-0.5 * math.pi, 1.5 * math.pi, _ANGLES)

    def cuts(at: float, wide: float, kappa: float) -> bool:
        around = np.concatenate([angle, _ends_ahead(engagement, kappa, angle)])
        _, z = engagement.position(np.full(around.size, at), np.full(around.size, wide), around)
        ahead = engagement.ahead(np.full(around.size, kappa), around) >= -1e-9
        return bool(np.any(ahead & (engagement.below_surface(z) >= 0.0)))

    inside = [k for k in range(height.size) if cuts(height[k], radius[k], immersion[k])]
    if not inside:
        return 0.0
    last = inside[-1]
    if last == height.size - 1 or radius[last] >= radius[-1] * (1.0 - 1e-12):
        return float(radius[last])
    low, high = float(height[last]), float(height[last + 1])
    for _ in range(40):
        middle = 0.5 * (low + high)
        inside_there = cuts(middle, cutter.radius_at(middle), _immersion_at(cutter, middle))
        low, high = (middle, high) if inside_there else (low, middle)
    return float(cutter.radius_at(low))


def _ends_ahead(
    engagement: InclinedEngagement, kappa: float, angle: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Angles about the axis, rad, at which an edge at an immersion angle ends to lie ahead."""
    ahead = engagement.ahead(np.full(angle.size, kappa), angle)
    change = np.flatnonzero(ahead[:-1] * ahead[1:] < 0.0)
    inside = np.where(ahead[change] > 0.0, angle[change], angle[change + 1])
    outside = np.where(ahead[change] > 0.0, angle[change + 1], angle[change])
    for _ in range(40):
        middle = 0.5 * (inside + outside)
        positive = engagement.ahead(np.full(middle.size, kappa), middle) >= 0.0
        inside, outside = np.where(positive, middle, inside), np.where(positive, outside, middle)
    return inside


def hint_of_tilt(case: Case) -> str:
    """Say that the tilt lifts the side of the tool that cuts, where it does; else nothing."""
    tilt, side = case.cut.tilt, {"down": -1.0, "up": 1.0}.get(case.cut.mode, 0.0)
    if not side * tilt < 0.0:
        return ""
    wall = "+y" if side > 0.0 else "-y"
    return (
        f'. With mode = "{case.cut.mode}" the tool cuts on its side at {wall}, which a tilt of '
        f"{math.degrees(tilt):.4g} deg lifts: tilt it towards the work, by "
        f"{math.degrees(-tilt):.4g} deg, or cut deeper"
    )


def refuse_inclined_axis(case: Case) -> None:
    """InputError where the tool axis is inclined, for what does not take it."""
    _ = case.uncut_band


def _key(case: Case) -> str:
    return "lead" if case.cut.lead else "tilt"


def check_inclined_axis(case: Case) -> None:
    """InputError where the tool axis is inclined and the case holds what is not computed then."""
    if not is_inclined(case):
        return
    problems = _of_tool(case) + _of_flutes(case) + _of_cut(case) + _of_laws(case)
    if problems:
        where = f"{case.name}: cut.{_key(case)}: with an inclined tool axis "
        raise InputError([where + problem for problem in problems])


def _of_tool(case: Case) -> list[str]:
    tool, found = case.tool, []
    cutter = cutter_of(case)
    if cutter.edge_angle < _UPRIGHT:
        found += _of_cone(case, cutter)
    if tool.serration is not None:
        found.append(
            "a serrated edge (tool.serration) is not computed; leave it out, as finishing tools "
            "have none"
        )
    flat = cutter.radius - cutter.corner_radius > 1e-9 * cutter.radius
    if flat and case.cut.lead < 0.0:
        found.append(
            "the lead of a tool with a flat end must not be below 0 deg, not "
            f"{math.degrees(case.cut.lead):.4g} deg: its end would rub behind the tip, without "
            'edges in the model; lead by 0 deg or more, tilt alone, or take a ball (kind = "ball")'
        )
    return found


def _of_cone(case: Case, cutter: Cutter) -> list[str]:
    """What keeps a tapered or chamfered edge from being computed."""
    if tool_axis_angle(case) < cutter.edge_angle:
        return []
    return [
        f"the flank of the taper, at {math.degrees(cutter.edge_angle):.4g} deg, would be the "
        f"lowest of the tool, with its axis at {math.degrees(tool_axis_angle(case)):.4g} deg; "
        "incline it by less"
    ]


def _of_flutes(case: Case) -> list[str]:
    """What keeps edges from reaching as far up the tool as the work does."""
    tool, cutter = case.tool, cutter_of(case)
    if case.cut.mode not in _SIDES:
        return []
    reached, length = inclined_engagement(case, cutter).top, units_of(case).length
    # within a corner the height is that of the cylinder around it, above the edge
    if reached <= max(tool.depth_that_tool_allows, corner_height(cutter)) * (1.0 + 1e-9):
        return []
    return [
        f"the work reaches {length.text(reached, '.3g')} up the tool, which is more than "
        f"tool.{tool.limiting_length}, {length.text(tool.depth_that_tool_allows, 'g')}; incline it "
        "by less, or cut less deep"
    ]


def _of_cut(case: Case) -> list[str]:
    found = []
    if case.cut.mode not in _SIDES:
        found.append(
            f'mode = "{case.cut.mode}" is not computed; state a workpiece wider than the tool by '
            'mode = "slot", a pass beside another by "up" or "down" with stepover'
        )
    simulation = case.simulation
    carved = simulation is not None and simulation.chip != "delay"
    if case.stock is not None or carved:
        found.append(
            'the chip is that of simulation.chip = "delay"; leave [stock] out, and state a '
            "straight pass by cut.axial_depth and cut.stepover"
        )
    if simulation is not None and simulation.has_own_path:
        found.append(
            "the tool moves straight on; leave simulation.path and program out, and simulate the "
            "passes of a path one by one, each with its lead and tilt"
        )
    return found


def _of_laws(case: Case) -> list[str]:
    found = []
    if case.contact is not None:
        found.append(
            "[contact] is not computed, as its share counts depths along the tool axis; leave it "
            "out: process damping is computed ([process_damping])"
        )
    return found
