"""The coefficients of a case in words: which law, which numbers, where they come from."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from chatter.description.law_section import FORCE_LAWS
from chatter.description.unit_system import METRIC, UnitSystem, units_of
from chatter.description.usual_units import UsualUnit, of_dimension

if TYPE_CHECKING:
    from collections.abc import Mapping

    from chatter.description.case import Case
    from cutting.material.row import MaterialRow


def values_in_words(law: str, values: Mapping[str, float], units: UnitSystem = METRIC) -> str:
    """Law and its coefficients, SI, in units that people read; those that are zero left out."""
    parts = []
    for key in FORCE_LAWS[law].keys:
        value = values.get(key.name)
        if not value:
            continue
        unit = _unit_of(key.dimension, units)
        parts.append(f"{key.name} {value * unit.factor:.4g} {unit.name}".rstrip())
    return f"{FORCE_LAWS[law].label}, {', '.join(parts)}"


def _unit_of(dimension: str, units: UnitSystem) -> UsualUnit:
    own = {"pressure": units.pressure, "line_force": units.line_force, "length": units.length}
    return own.get(dimension) or of_dimension(dimension)


def coefficients_in_words(case: Case) -> str | None:
    """Sentence on the coefficients that a case cuts with; None where it has no material."""
    material = case.material
    if material is None:
        return None
    named = f"{material.row_name}: " if material.name else ""
    return f"coefficients: {named}{values_in_words(material.law, material.values, units_of(case))}"


def notes_on_material(case: Case) -> list[str]:
    """Source, assumptions and range of the row that a case names; empty where it names none."""
    row = None if case.material is None else case.material.row
    if row is None:
        return []
    given = [key for key, value in case.material.values.items() if value != row.values.get(key, 0)]
    own = f"; {', '.join(given)} as in the case" if given else ""
    notes = [f"material.name: source: {row.source}{own}; {range_in_words(row)}"]
    if row.assumption:
        notes.append(f"material.name: {row.assumption}")
    return [*notes, *_out_of_range(case, row)]


def range_in_words(row: MaterialRow) -> str:
    """Range of the chip thickness that a row holds for."""
    if row.chip_thickness is None:
        return "no range of the chip thickness is stated there"
    low, high = (1e3 * end for end in row.chip_thickness)
    return f"chip thickness {low:g} to {high:g} mm"


def _out_of_range(case: Case, row: MaterialRow) -> list[str]:
    """Note where the thickest chip of the cut is out of the range of the row."""
    if row.chip_thickness is None or case.cut is None or case.tool is None:
        return []
    thickest = thickest_chip(case)
    low, high = row.chip_thickness
    length = units_of(case).length
    if low <= thickest <= high:
        return []
    return [
        f"material.name: the thickest chip is {length.text(thickest, '.3g')}, out of the range of "
        f"the row, {low * length.factor:.4g} to {length.text(high)}"
    ]


def thickest_chip(case: Case) -> float:
    """Thickest chip of the rigid cut at the full radius, m.

    h = f_z sin(kappa) sin(phi), largest where the arc of the cut comes nearest to the feed axis,
    phi = pi/2 (Altintas, Manufacturing Automation, 2012, section 2.6), with the angle kappa of a
    straight edge against the plane of the feed; a corner makes it thinner than that.
    """
    tool, depth = case.tool, case.cut.axial_depth
    edge = tool.cutting_edge_angle - tool.taper_angle
    tip = 0.5 * tool.diameter
    thickest = max(_largest_sine(case, radius) for radius in (tip, tip + depth / math.tan(edge)))
    return case.cut.feed_per_tooth * math.sin(edge) * thickest


def _largest_sine(case: Case, radius: float) -> float:
    """Largest sine of the angle of engagement from +y at a radius of the tool, m."""
    band = case.uncut_band
    lowest, highest = (float(border.at(radius)) / radius for border in (band.lower, band.upper))
    nearest = min(max(0.0, lowest, -1.0), highest, 1.0)
    return math.sqrt(max(0.0, 1.0 - nearest**2))
