"""An inclined tool axis is refused, with what can be said of the cut without its engagement."""

from __future__ import annotations

import math

from chatter.description.case import Case
from chatter.description.errors import InputError


def angle_to_surface_normal(case: Case) -> float:
    """Angle of the tool axis from the normal of the surface, rad: cos = cos(lead) cos(tilt)."""
    return math.acos(math.cos(case.cut.lead) * math.cos(case.cut.tilt))


def effective_diameter_of_ball(diameter: float, axial_depth: float, axis_angle: float) -> float:
    """Largest diameter, m, on which a ball that is inclined cuts.

    D sin(a + acos(1 - 2 a_p/D)), at most D, with the axis at the angle a, rad, from the normal,
    lengths in m (Sandvik Coromant, technical guide of milling, profile milling; exact where the
    axis leans towards what is cut).
    """
    reached = axis_angle + math.acos(max(-1.0, 1.0 - 2.0 * axial_depth / diameter))
    return diameter * math.sin(min(reached, 0.5 * math.pi))


def refuse_inclined_axis(case: Case) -> None:
    """InputError where the tool axis is inclined; it names the effective diameter of a ball."""
    cut, tool = case.cut, case.tool
    angle = angle_to_surface_normal(case)
    if angle == 0.0:
        return
    key = "lead" if cut.lead else "tilt"
    words = (
        f"{case.name}: cut.{key}: an inclined tool axis is not computed: it changes which part of "
        "the edge is engaged, at which angles"
    )
    if tool.kind == "ball":
        wide = effective_diameter_of_ball(tool.diameter, cut.axial_depth, angle)
        speed = 30.0 * wide * cut.spindle_speed
        words += (
            f". Inclined by {math.degrees(angle):.4g} deg the ball cuts up to an effective "
            f"diameter of {1e3 * wide:.4g} mm, at {speed:.4g} m/min there; leave lead and tilt out "
            "for the limits and forces of an axis normal to the surface, with the tip in the cut"
        )
    else:
        words += "; leave lead and tilt out for an axis normal to the surface"
    raise InputError(words)
