"""Empirical terms of a case, as `cutting` knows them."""

import math

import numpy as np

from chatter.description.case import Case
from chatter.description.errors import InputError
from cutting.force.force_factor import ForceFactor

#: entries of a table for the kernels
_ENTRIES = 720


def speed_factor(case: Case) -> float:
    """Factor of the cutting force at the cutting speed of a case."""
    term = case.empirical_over("cutting speed")
    if term is None or case.cut is None:
        return 1.0
    return float(term.value_at(0.5 * case.tool.diameter * case.cut.spindle_speed))


def force_factor(case: Case, bins: int) -> ForceFactor | None:
    """Factor over the angle of the spindle, in so many bins, and over the travel; None if none.

    InputError where the tool follows a path with corners, along which nothing was learnt.
    """
    over_angle = case.empirical_over("spindle angle")
    over_travel = case.empirical_over("feed distance")
    if over_angle is None and over_travel is None:
        return None
    section = case.simulation
    bent = section is not None and (section.program or len(section.path or ()) > 2)
    if over_travel is not None and bent:
        key = "program" if section.program else "path"
        raise InputError(
            f"{case.name}: simulation.{key}: has corners; the empirical term over the feed "
            "distance holds along a straight path"
        )
    angles = np.ones(2)
    if over_angle is not None:
        angles = over_angle.value_at(np.linspace(0.0, 2.0 * math.pi, _ENTRIES + 1))
    travels, first, length, repeats = np.ones(2), 0.0, 1.0, False
    if over_travel is not None:
        first, length = over_travel.at[0], over_travel.at[-1] - over_travel.at[0]
        travels = np.interp(
            np.linspace(first, first + length, _ENTRIES + 1), over_travel.at, over_travel.factor
        )
        repeats = over_travel.repeats
    return ForceFactor(angles, float(bins), travels, first, length, repeats)
