"""Forces on the worn land of the flank: edge forces that grow with its length.

The land slides on the machined surface under a mean pressure p with friction mu, so that edge
forces grow in proportion to its length VB: K_re by p VB, K_te by mu p VB (Wallace and Boothroyd
1964, J. Mech. Eng. Sci. 6:74, who found forces on the flank proportional to the land).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from chatter.description.case import Case
from chatter.description.unit_system import units_of
from cutting.force.law import ForceLaw

#: pressure on the land over the tangential cutting pressure, and friction, where the case gives
#: none: assumed here, of the size of worn edge forces in steel and titanium
_PRESSURE_SHARE, _FRICTION = 0.1, 0.3
#: land at which a tool is taken to be worn out, m (ISO 8688-2:1989, uniform wear)
END_OF_LIFE = 0.3e-3


class LandForces(NamedTuple):
    """What the worn land adds to the edge coefficients."""

    pressure: float  # mean on the land, Pa
    tangential: float  # N/m
    radial: float  # N/m


def land_forces(case: Case, law: ForceLaw) -> LandForces:
    """Forces on the worn land beside a force law of the sharp edge."""
    wear, land = case.wear, case.tool.flank_wear
    pressure = None if wear is None else wear.flank_pressure
    friction = None if wear is None else wear.flank_friction
    if pressure is None:
        pressure = _PRESSURE_SHARE * _cutting_pressure(case, law)
    radial = pressure * land
    return LandForces(pressure, (_FRICTION if friction is None else friction) * radial, radial)


def _cutting_pressure(case: Case, law: ForceLaw) -> float:
    """Slope of the tangential force over the chip at the feed per tooth, Pa."""
    return float(law.slope(np.array([case.cut.feed_per_tooth]))[0, 0])


def notes_on_worn_flank(case: Case, law: ForceLaw) -> list[str]:
    """What the user should know of a worn land, and of the life of the edge."""
    land = case.tool.flank_wear
    if not land:
        return _notes_on_life(case)
    found, units = land_forces(case, law), units_of(case)
    notes = []
    if case.wear is None or case.wear.flank_pressure is None:
        pressure, line_force = units.pressure, units.line_force
        notes.append(
            f"tool.flank_wear: the land is taken to press with "
            f"{pressure.text(found.pressure, '.3g')}, a tenth of the tangential cutting pressure: "
            f"{line_force.text(found.tangential, '.3g')} tangential and "
            f"{line_force.text(found.radial, '.3g')} radial more; wear.flank_pressure and "
            "wear.flank_friction state your own"
        )
    if land > END_OF_LIFE * (1.0 + 1e-9):
        notes.append(
            f"tool.flank_wear: {units.length.text(land, 'g')} is beyond the usual end of life, "
            f"{units.length.text(END_OF_LIFE, 'g')} (ISO 8688-2)"
        )
    return notes + _notes_on_life(case)


def _notes_on_life(case: Case) -> list[str]:
    """Say that the edge is worn out by the time that it has cut, where the case states its life."""
    if case.tool_life is None:
        return []
    speed = 0.5 * case.tool.diameter * case.cut.spindle_speed
    life = case.tool_life.life_at(speed)
    if case.cut.cut_time <= life:
        return []
    return [
        f"cut.cut_time: {case.cut.cut_time / 60.0:.3g} min is beyond the life of the edge at "
        f"{units_of(case).cutting_speed.text(speed)}, {life / 60.0:.3g} min (tool_life)"
    ]


def notes_on_limits(case: Case) -> list[str]:
    """What a worn land does to limits of stability."""
    process_damping = case.process_damping
    if not case.tool.flank_wear:
        return []
    if process_damping is not None and process_damping.indentation_force is not None:
        return []
    return [
        "tool.flank_wear changes forces alone, and no limit of the linear methods: process damping "
        "by the land needs process_damping.indentation_force"
    ]
