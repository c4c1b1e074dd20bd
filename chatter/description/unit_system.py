"""Units that the people of a case read: metric ones, or inches and pounds where it is in inches."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import tomlkit

from chatter.description.usual_units import UsualUnit

if TYPE_CHECKING:
    from chatter.description.case import Case

#: m and N by definition (NIST SP 811): the units library, slow to load, need not be asked
_INCH, _POUND = 0.0254, 4.4482216152605
_OF_INCHES = re.compile(r"(?:in|inch|inches|mil|thou|ft|ipt|ipm|sfm|sfpm)\b|\"|″", re.IGNORECASE)
_OF_METRES = re.compile(r"(?:mm|um|µm|μm|cm|m)\b")
_UNIT = re.compile(r"[^0-9]*$")


class UnitSystem(NamedTuple):
    """Units of a shop, and the number of each in one of SI."""

    length: UsualUnit
    feed_per_tooth: UsualUnit
    cutting_speed: UsualUnit
    feed_rate: UsualUnit
    removal_rate: UsualUnit
    force: UsualUnit
    pressure: UsualUnit
    line_force: UsualUnit
    runout: UsualUnit


METRIC = UnitSystem(
    length=UsualUnit("mm", 1e3),
    feed_per_tooth=UsualUnit("mm", 1e3),
    cutting_speed=UsualUnit("m/min", 60.0),
    feed_rate=UsualUnit("mm/min", 6e4),
    removal_rate=UsualUnit("cm^3/min", 6e7),
    force=UsualUnit("N", 1.0),
    pressure=UsualUnit("MPa", 1e-6),
    line_force=UsualUnit("N/mm", 1e-3),
    runout=UsualUnit("um", 1e6),
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
    runout=UsualUnit("mil", 1e3 / _INCH),
)


def units_of(case: Case) -> UnitSystem:
    """Units that most lengths, feeds and speeds of the tool and the cut of a case are written in.

    Metric ones where as many are, and where none is written with a unit.
    """
    written = tomlkit.parse(case.to_toml()).unwrap()
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
    elif isinstance(value, dict):
        for one in value.values():
            yield from _texts(one)
    elif isinstance(value, list):
        for one in value:
            yield from _texts(one)
