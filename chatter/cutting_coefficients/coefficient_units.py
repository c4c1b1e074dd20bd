"""Units of coefficients as they are written."""

from __future__ import annotations

from chatter.description.unit_system import UnitSystem
from chatter.description.usual_units import UsualUnit


def unit_of(key: str, units: UnitSystem) -> UsualUnit:
    """Unit of a coefficient, cutting or of the edge by the last letter of its key."""
    return {"c": units.pressure, "e": units.line_force}[key[-1]]
