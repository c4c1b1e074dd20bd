"""Quantities with units: text such as "20 mm" to SI and back.

pint does the units. Angle is no dimension to it, so that "840 rpm" and "14 Hz" would differ by
2 pi; angular speeds and frequencies are therefore told apart here.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pint


class QuantityError(ValueError):
    """A quantity that cannot be read; the message says what was given and what is wanted."""


@dataclass(frozen=True)
class Dimension:
    """A physical dimension that a key may have.

    Parameters
    ----------
    name : str
        With its article, as in messages.
    unit : str
        SI unit of a bare number.
    example : str
        How such a quantity is written.
    """

    name: str
    unit: str
    example: str


#: every dimension that keys of a case have
DIMENSIONS: dict[str, Dimension] = {
    "length": Dimension("a length", "m", "2 mm"),
    "angle": Dimension("an angle", "rad", "30 deg"),
    "angular_speed": Dimension("a spindle speed", "rad/s", "12000 rpm"),
    "frequency": Dimension("a frequency", "Hz", "922 Hz"),
    "mass": Dimension("a mass", "kg", "0.5 kg"),
    "stiffness": Dimension("a stiffness", "N/m", "12 N/um"),
    "damping": Dimension("a damping coefficient", "N*s/m", "350 N*s/m"),
    "pressure": Dimension("a pressure (force per area)", "Pa", "1650 MPa"),
    "line_force": Dimension("a force per length", "N/m", "25 N/mm"),
    "force": Dimension("a force", "N", "80 N"),
    "torque": Dimension("a torque", "N*m", "2 N*m"),
    "time": Dimension("a time", "s", "0.5 s"),
    "velocity": Dimension("a velocity", "m/s", "420 mm/min"),
    "pressure_gradient": Dimension("a force per volume", "N/m^3", "4e13 N/m^3"),
    "drag": Dimension("a quadratic drag coefficient", "N*s^2/m^2", "300 N*s^2/m^2"),
    "number": Dimension("a plain number", "", "0.03"),
}

_CYCLIC = ("angular_speed", "frequency")
_ANGLE_UNITS = (
    "radian",
    "degree",
    "turn",
    "revolution",
    "grade",
    "arcminute",
    "arcsecond",
    "cycle",
)
_NUMBER = r"[+-]?(?:\d[\d_]*\.?[\d_]*|\.\d[\d_]*)(?:[eE][+-]?\d+)?"
_QUANTITY = re.compile(
    rf"^\s*(?P<value>{_NUMBER}|[+-]?(?:nan|inf|infinity))"
    rf"(?:\s*(?:\+-|\+/-|±)\s*(?P<deviation>{_NUMBER}))?\s*(?P<unit>.*?)\s*$",
    re.IGNORECASE,
)
_LONGEST_TEXT = 200


@dataclass(frozen=True)
class Quantity:
    """A value in SI with its standard deviation (0 where none is given) and the unit as written."""

    value: float
    deviation: float
    unit: str


@lru_cache(maxsize=1)
def registry() -> pint.UnitRegistry:
    """Return the one unit registry; pint is slow to import, so it waits until it is needed."""
    import pint

    ureg = pint.UnitRegistry(cache_folder=None)
    ureg.define("@alias turn = rev")
    return ureg


def _wanted(dimension: str) -> str:
    entry = DIMENSIONS[dimension]
    if not entry.unit:
        return f"a plain number is wanted, such as {entry.example}"
    return f'{entry.name} is wanted, such as "{entry.example}"'


@lru_cache(maxsize=512)
def unit_factor(unit: str, dimension: str) -> float:
    """Return the SI value of one unit.

    Parameters
    ----------
    unit : str
        As in ``"N*s/m"``; empty for a bare number.
    dimension : str
        Key of `DIMENSIONS`.

    Raises
    ------
    QuantityError
        If the unit is unknown or of another dimension.
    """
    if not unit:
        return 1.0
    ureg = registry()
    try:
        parsed = ureg.Unit(unit.replace("µ", "u").replace("μ", "u").replace("·", "*"))
        one = ureg.Quantity(1.0, parsed)
        expected = ureg.Unit(DIMENSIONS[dimension].unit or "dimensionless")
    except Exception as error:
        raise QuantityError(f'"{unit}" is no unit; {_wanted(dimension)}') from error
    angle_for_number = dimension == "number" and _is_angle(parsed)
    if one.dimensionality != expected.dimensionality or angle_for_number:
        raise QuantityError(f"is {_name_of(one)}; {_wanted(dimension)}")
    if dimension in _CYCLIC:
        turns_per_second = _turns_per_second(one, parsed)
        return turns_per_second * (2.0 * math.pi if dimension == "angular_speed" else 1.0)
    return float(one.to(expected).magnitude)


def _is_angle(unit: Any) -> bool:
    return any(part in name for name in unit._units for part in _ANGLE_UNITS)


def _turns_per_second(one: Any, unit: Any) -> float:
    if _is_angle(unit) or "revolutions_per_minute" in unit._units or "rpm" in str(unit):
        return float(one.to("radian/second").magnitude) / (2.0 * math.pi)
    return float(one.to("1/second").magnitude)


def _name_of(one: Any) -> str:
    """Name the dimension of what was given."""
    for entry in DIMENSIONS.values():
        if entry.unit and one.dimensionality == registry().Unit(entry.unit).dimensionality:
            return entry.name
    return f"of dimension {one.dimensionality}" if str(one.dimensionality) else "a plain number"


def parse(given: Any, dimension: str) -> Quantity:
    """Read a quantity: text with a unit, or a bare number in SI.

    Parameters
    ----------
    given : str, int or float
        ``"20 mm"``, ``"1650 +- 80 MPa"``, ``0.02``.
    dimension : str
        Key of `DIMENSIONS`.

    Returns
    -------
    Quantity

    Raises
    ------
    QuantityError
        If it is no quantity, of another dimension or not finite.
    """
    if isinstance(given, bool) or not isinstance(given, (int, float, str)):
        raise QuantityError(f"{_shown(given)} is no quantity; {_wanted(dimension)}")
    if not isinstance(given, str):
        try:
            value = float(given)
        except OverflowError:
            value = math.inf
        return Quantity(_finite(value, given), 0.0, "")
    if len(given) > _LONGEST_TEXT:
        raise QuantityError(f"{_shown(given[:40])}... is too long for a quantity")
    match = _QUANTITY.match(given)
    if match is None:
        raise QuantityError(f'"{given}" is no quantity; {_wanted(dimension)}')
    unit = match["unit"]
    try:
        factor = unit_factor(unit, dimension)
    except QuantityError as error:
        text = str(error)
        raise QuantityError(text if text.startswith('"') else f'"{given}" {text}') from None
    if not unit and DIMENSIONS[dimension].unit and float(match["value"]) != 0.0:
        raise QuantityError(f'"{given}" has no unit; {_wanted(dimension)}')
    value = _finite(float(match["value"]) * factor, given)
    deviation = float(match["deviation"] or 0.0) * factor
    if deviation < 0.0:
        raise QuantityError(f'"{given}" has a negative standard deviation')
    return Quantity(value, _finite(deviation, given), unit)


def _finite(value: float, given: Any) -> float:
    if not math.isfinite(value):
        raise QuantityError(f"{_shown(given)} is not a finite number")
    return value


def _shown(given: Any) -> str:
    return f'"{given}"' if isinstance(given, str) else str(given)


def write(value: float, unit: str, dimension: str) -> str | float:
    """Write an SI value in a unit so that it reads back to 1e-12 relative.

    Parameters
    ----------
    value : float
        SI.
    unit : str
        Empty for a bare number.
    dimension : str

    Returns
    -------
    str or float
    """
    if not unit:
        return value
    return f"{value / unit_factor(unit, dimension):.15g} {unit}"
