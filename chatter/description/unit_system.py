"""Units that the people of a case read: metric ones, or inches and pounds where it is in inches."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from chatter.description.usual_units import UsualUnit, usual_unit

if TYPE_CHECKING:
    from chatter.description.case import Case

#: m and N by definition (NIST SP 811): the units library, slow to load, need not be asked
_INCH, _POUND = 0.0254, 4.4482216152605
_OF_INCHES = re.compile(r"(?:in|inch|inches|mil|thou|ft|ipt|ipm|sfm|sfpm)\b|\"|″", re.IGNORECASE)
_OF_METRES = re.compile(r"(?:mm|um|µm|μm|cm|m)\b")
_UNIT = re.compile(r"[^0-9]*$")
#: m, from which on a chip or a vibration is read in the unit of lengths, not in that of small ones
_LONG = 1e-4


class UnitSystem(NamedTuple):
    """Units of a shop, and the number of each in one of SI.

    `displacement` is that of vibration, runout and errors of a surface, `roughness` of Ra and Rz.
    """

    length: UsualUnit
    feed_per_tooth: UsualUnit
    cutting_speed: UsualUnit
    feed_rate: UsualUnit
    removal_rate: UsualUnit
    force: UsualUnit
    pressure: UsualUnit
    line_force: UsualUnit
    stiffness: UsualUnit
    displacement: UsualUnit
    roughness: UsualUnit
    power: UsualUnit
    torque: UsualUnit

    def at_the_size_of(self, *lengths: float) -> UsualUnit:
        """Unit in which lengths, m, are read together: that of displacement where all are small."""
        return self.length if max(lengths) >= _LONG else self.displacement

    def instead_of(self, metric: str, quantity: str = "") -> UsualUnit:
        """Unit that is read instead of a metric one, by its name, and its number in one of it.

        Parameters
        ----------
        metric : str
        quantity : str, optional
            Such as "roughness", where it is another than what is mostly read in that unit.
        """
        of_si = _FACTORS.get(metric)
        if self is METRIC or of_si is None:
            return UsualUnit(metric, 1.0)
        mostly, factor = of_si
        unit: UsualUnit = getattr(self, quantity or mostly)
        return UsualUnit(unit.name, unit.factor / factor)


METRIC = UnitSystem(
    length=UsualUnit("mm", 1e3),
    feed_per_tooth=UsualUnit("mm", 1e3),
    cutting_speed=UsualUnit("m/min", 60.0),
    feed_rate=UsualUnit("mm/min", 6e4),
    removal_rate=UsualUnit("cm^3/min", 6e7),
    force=UsualUnit("N", 1.0),
    pressure=UsualUnit("MPa", 1e-6),
    line_force=UsualUnit("N/mm", 1e-3),
    stiffness=UsualUnit("N/um", 1e-6),
    displacement=UsualUnit("um", 1e6),
    roughness=UsualUnit("um", 1e6),
    power=UsualUnit("W", 1.0),
    torque=UsualUnit("N m", 1.0),
)
INCH = UnitSystem(
    length=UsualUnit("in", 1.0 / _INCH),
    feed_per_tooth=UsualUnit("ipt", 1.0 / _INCH),
    cutting_speed=UsualUnit("sfm", 60.0 / (12.0 * _INCH)),
    feed_rate=UsualUnit("ipm", 60.0 / _INCH),
    removal_rate=UsualUnit("in^3/min", 60.0 / _INCH**3),
    force=UsualUnit("lbf", 1.0 / _POUND),
    pressure=UsualUnit("ksi", 1e-3 * _INCH**2 / _POUND),
    line_force=UsualUnit("lbf/in", _INCH / _POUND),
    stiffness=UsualUnit("lbf/in", _INCH / _POUND),
    displacement=UsualUnit("mil", 1e3 / _INCH),
    roughness=UsualUnit("uin", 1e6 / _INCH),
    power=UsualUnit("hp", 1.0 / (550.0 * 12.0 * _INCH * _POUND)),
    torque=UsualUnit("lbf ft", 1.0 / (12.0 * _INCH * _POUND)),
)
#: metric unit -> quantity that is read in it, and the number of it in one of SI
_FACTORS = {
    "mm": ("length", 1e3),
    "um": ("displacement", 1e6),
    "µm": ("displacement", 1e6),
    "m/min": ("cutting_speed", 60.0),
    "mm/min": ("feed_rate", 6e4),
    "cm^3/min": ("removal_rate", 6e7),
    "cm³/min": ("removal_rate", 6e7),
    "N": ("force", 1.0),
    "MPa": ("pressure", 1e-6),
    "N/mm": ("line_force", 1e-3),
    "N/um": ("stiffness", 1e-6),
    "W": ("power", 1.0),
    "kW": ("power", 1e-3),
    "N m": ("torque", 1.0),
}


def units_of(case: Case) -> UnitSystem:
    """Units that most lengths, feeds and speeds of the tool and the cut of a case are written in.

    Metric ones where as many are, and where none is written with a unit.
    """
    return units_of_content(case.stated)


def unit_at(case: Case, path: str) -> UsualUnit:
    """Unit that the people of a case read the quantity at a path of it in."""
    usual = usual_unit(type(case), path)
    read = units_of(case).instead_of(usual.name)
    return UsualUnit(read.name, usual.factor * read.factor)


def units_of_content(written: Mapping[str, Any]) -> UnitSystem:
    """Units of the content of a case file; see `units_of`."""
    units = [
        _UNIT.search(text)[0].strip()  # type: ignore[index]  # the end is always found
        for section in ("tool", "cut")
        for text in _texts(written.get(section, {}))
    ]
    inches = sum(bool(_OF_INCHES.match(one)) for one in units)
    return INCH if inches > sum(bool(_OF_METRES.match(one)) for one in units) else METRIC


def _texts(value: Any) -> Iterator[str]:
    """Texts of a section, those of lists and tables in it too."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping):
        for one in value.values():
            yield from _texts(one)
    elif isinstance(value, (list, tuple)):
        for one in value:
            yield from _texts(one)
