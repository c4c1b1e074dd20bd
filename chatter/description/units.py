"""Quantities with units: text such as "20 mm" to SI and back.

pint does the units. Angle is no dimension to it, so that "840 rpm" and "14 Hz" would differ by
2 pi; angular speeds and frequencies are therefore told apart here: both are turns per second,
whatever they are written in.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from chatter.description.formatting import formatted
from chatter.description.known_units import MEASURED, SI_VALUE
from chatter.description.shop_units import (
    WORDS,
    advice,
    advice_on_number,
    speed_of_any,
    speed_of_shop,
    with_decimals,
)

if TYPE_CHECKING:
    import numpy as np
    import pint
    from numpy.typing import NDArray


Speed = TypeVar("Speed", float, "NDArray[np.float64]")


class QuantityError(ValueError):
    """A quantity that cannot be read; the message says what was given and what is required."""


@dataclass(frozen=True)
class Dimension:
    """A physical dimension that a key may have."""

    name: str  # with its article, as in messages
    unit: str  # SI unit of a bare number
    example: str  # how such a quantity is written


#: every dimension that keys of a case or machine have; the later ones are named first
DIMENSIONS: dict[str, Dimension] = {
    "moment_of_inertia": Dimension("a moment of inertia", "kg*m^2", "0.01 kg*m^2"),
    "density": Dimension("a density", "kg/m^3", "7850 kg/m^3"),
    "gain": Dimension("a gain", "1/s", "50 1/s"),
    "rotational_stiffness": Dimension("a rotational stiffness", "N*m/rad", "1e6 N*m/rad"),
    "rotational_damping": Dimension("a rotational damping", "N*m*s/rad", "15 N*m*s/rad"),
    "inverse_length": Dimension("an inverse of a length", "1/m", "11500 1/m"),
    "inverse_angle": Dimension("an inverse of an angle", "1/rad", "40 1/rad"),
    "inverse_velocity": Dimension("an inverse of a velocity", "s/m", "20 s/m"),
    "inverse_angular_speed": Dimension("an inverse of an angular speed", "s/rad", "0.5 s/rad"),
    "resistance": Dimension("a resistance", "ohm", "0.5 ohm"),
    "inductance": Dimension("an inductance", "H", "5 mH"),
    "voltage": Dimension("a voltage", "V", "400 V"),
    "torque_constant": Dimension("a torque constant", "N*m/A", "1.5 N*m/A"),
    "force_constant": Dimension("a force constant", "N/A", "80 N/A"),
    "back_emf": Dimension("a voltage per angular speed", "V*s/rad", "0.9 V*s/rad"),
    "linear_back_emf": Dimension("a voltage per velocity", "V*s/m", "60 V*s/m"),
    "length": Dimension("a length", "m", "2 mm"),
    "angle": Dimension("an angle", "rad", "30 deg"),
    "angular_speed": Dimension("a spindle speed", "rad/s", "12000 rpm"),
    "frequency": Dimension("a frequency", "Hz", "922 Hz"),
    "mass": Dimension("a mass", "kg", "0.5 kg"),
    "line_force": Dimension("a force per length", "N/m", "25 N/mm"),
    "stiffness": Dimension("a stiffness", "N/m", "12 N/um"),
    "damping": Dimension("a damping coefficient", "N*s/m", "350 N*s/m"),
    "pressure": Dimension("a pressure (force per area)", "Pa", "1650 MPa"),
    "force": Dimension("a force", "N", "80 N"),
    "torque": Dimension("a torque", "N*m", "2 N*m"),
    "power": Dimension("a power", "W", "15 kW"),
    "time": Dimension("a time", "s", "0.5 s"),
    "acceleration": Dimension("an acceleration", "m/s^2", "5 m/s^2"),
    "jerk": Dimension("a jerk", "m/s^3", "500 m/s^3"),
    "line_force_rate": Dimension("a force per length and time", "N/m/s", "5 N/mm/s"),
    "rate": Dimension("a rate", "1/s", "0.1 1/s"),
    "velocity": Dimension("a velocity", "m/s", "420 mm/min"),
    "pressure_gradient": Dimension("a force per volume", "N/m^3", "4e13 N/m^3"),
    "drag": Dimension("a quadratic drag coefficient", "N*s^2/m^2", "300 N*s^2/m^2"),
    "number": Dimension("a plain number", "", "0.03"),
}

#: what else may be written by mistake, by SI unit
_FOREIGN = {
    "m^2": "an area",
    "m^3": "a volume",
    "m/s^2": "an acceleration",
    "m/N": "a compliance",
    "K": "a temperature",
    "A": "a current",
}
_CYCLIC = ("angular_speed", "frequency")
_NEEDS_ANGLE = ("angle", "inverse_angle")
#: pint's names of units of angle, apart from prefixes
_ANGLE_UNITS = ("radian", "degree", "turn", "revolution", "grade", "arcminute", "arcsecond")
_NUMBER_UNITS = {"%": 0.01, "percent": 0.01, "ppm": 1e-6, "dimensionless": 1.0}

NUMBER = r"[+-]?(?:[0-9]+(?:_[0-9]+)*\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_QUANTITY = re.compile(
    rf"^\s*(?P<value>{NUMBER}|[+-]?(?:nan|inf|infinity)\b)"
    rf"(?:\s*(?:\+-|\+/-|±)\s*(?P<deviation>{NUMBER}))?\s*(?P<unit>.*?)\s*$",
    re.IGNORECASE,
)
#: of a unit that something stands behind
_LATE_DEVIATION = re.compile(r"\+-|\+/-|±")
_DECIMAL_COMMA = re.compile(r"^\s*[+-]?[0-9]+,[0-9]")
#: pint evaluates what it reads, powers of powers too: only names and powers of a digit reach it
_UNIT = re.compile(
    r"(?:1\s*/|[A-Za-z_]+|%|\*\*\s*(?:-?[0-9]|\(\s*-?[0-9]\s*\))(?![0-9]|\s*\*\*)|[*/()\s])+",
    re.ASCII,
)
#: characters of a unit -> as the units library has them
_CHARACTERS = str.maketrans(
    {"µ": "u", "μ": "u", "·": "*", "⋅": "*", "×": "*", ".": "*", "°": "deg", "^": "**"}
)
_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁻", "01234-")
#: words of a unit in measured files, where g is the acceleration of gravity and a pound a force
_MEASURED_WORDS = {
    **WORDS,
    "g": "standard_gravity",
    "G": "standard_gravity",
    "mg": "millistandard_gravity",
    "lb": "lbf",
    "Sec": "second",
    # as LabVIEW and others write them out
    **{one: one.lower() for one in ("Newton", "Newtons", "Volt", "Volts", "Pascal", "Pascals")},
    **{one: one.lower() for one in ("Second", "Seconds", "Ampere", "Amperes", "Watt", "Watts")},
    **{
        "gs": "standard_gravity",
        "gn": "standard_gravity",
        "g_n": "standard_gravity",
        "Amps": "ampere",
        "amps": "ampere",
    },
}
_LONGEST_TEXT = 100


@dataclass(frozen=True)
class Quantity:
    """A value in SI with its standard deviation (0 where none is given) and the unit as written."""

    value: float
    deviation: float
    unit: str


def rpm(speed: Speed) -> Speed:
    """Spindle speed in revolutions per minute, of one in rad/s."""
    return speed * (30.0 / math.pi)


def from_rpm(speed: Speed) -> Speed:
    """Spindle speed in rad/s, of one in revolutions per minute."""
    return speed / (30.0 / math.pi)


class MeasuredUnit(NamedTuple):
    """A unit as it stands in a measured file."""

    dimension: dict[str, int]  # exponents of pint's base dimensions: {"[length]": 1, "[time]": -2}
    factor: float  # SI value = factor times the value in the unit; angles in rad
    has_angle: bool  # it is an angle, or one per something


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
        return f"a plain number is required, such as {entry.example}"
    return f'{entry.name} is required, such as "{entry.example}"'


@lru_cache(maxsize=512)
def unit_factor(unit: str, dimension: str) -> float:
    """Return the SI value of one unit.

    As in ``"N*s/m"``, empty for a bare number, for a key of `DIMENSIONS`. QuantityError if the unit
    is unknown or of another dimension; the message does not name the value.
    """
    if not unit:
        return 1.0
    known = _by_heart(unit, dimension)
    return asked_of_library(unit, dimension) if known is None else known


def _by_heart(unit: str, dimension: str) -> float | None:
    """SI value of one unit where the units library need not be asked."""
    if unit == DIMENSIONS[dimension].unit:
        return 1.0
    return SI_VALUE.get(dimension, {}).get(unit)


def known_by_heart(text: str, dimension: str) -> bool:
    """Whether a text has a unit that is known to be of a dimension without the units library."""
    match = _QUANTITY.match(text) if len(text) <= _LONGEST_TEXT else None
    return bool(match and match["unit"]) and _by_heart(match["unit"], dimension) is not None


def asked_of_library(unit: str, dimension: str) -> float:
    """SI value of one unit by the units library; as `unit_factor`, which knows many by heart."""
    if dimension in _CYCLIC:
        unit = speed_of_shop(unit) or unit
    parsed, one = _parsed_unit(unit, dimension)
    if dimension == "number":
        if unit in _NUMBER_UNITS:
            return _NUMBER_UNITS[unit]
        raise QuantityError(f"has the unit {formatted(unit)}; {_wanted(dimension)}")
    expected = registry().Unit(DIMENSIONS[dimension].unit)
    no_angle = dimension in _NEEDS_ANGLE and not _is_angle(parsed)
    if one.dimensionality != expected.dimensionality or no_angle:
        raise QuantityError(f"is {_name_of(one, parsed)}; {_wanted(dimension)}")
    if _is_angle(parsed) and not _may_have_angle(dimension):
        raise QuantityError(f"is per angle or turn; {_wanted(dimension)}")
    if dimension in _CYCLIC:
        turns_per_second = _turns_per_second(one, parsed)
        return turns_per_second * (2.0 * math.pi if dimension == "angular_speed" else 1.0)
    return float(one.to(expected).magnitude)


def _parsed_unit(unit: str, dimension: str) -> tuple[Any, Any]:
    """Return pint's unit and one of it in base units."""
    known = _unit_of_library(unit, WORDS)
    if known is None and _LATE_DEVIATION.search(unit):
        raise QuantityError(
            "has its standard deviation behind the unit; write both numbers before it, such as "
            '"1650 +- 80 MPa"'
        )
    if known is None:
        raise QuantityError(f"has the unknown unit {formatted(unit)}; {_wanted(dimension)}")
    parsed, one, proportional = known
    if not proportional:
        # decibels, degrees Celsius
        raise QuantityError(f"has the unit {formatted(unit)}; {_wanted(dimension)}")
    return parsed, one


def _unit_of_library(unit: str, words: Mapping[str, str]) -> tuple[Any, Any, bool] | None:
    """Unit, one of it in base units, and whether zero of it is zero; None where it is unknown."""
    text = re.sub("[⁰¹²³⁴⁻]+", lambda m: "^" + m[0].translate(_SUPERSCRIPTS), unit)
    text = re.sub(r"\bNs\^?2\b", "(N*s^2)", text)
    text = re.sub(r"([A-Za-zµμ])(\d)", r"\1^\2", text)
    text = re.sub(r"[A-Za-zµμ_]+", lambda m: words.get(m[0], m[0]), text).translate(_CHARACTERS)
    if not _UNIT.fullmatch(text):
        return None
    try:
        parsed = registry().Unit(text)
        one, two = (registry().Quantity(value, parsed).to_base_units() for value in (1.0, 2.0))
        return parsed, one, math.isclose(two.magnitude, 2.0 * one.magnitude)
    except Exception:  # whatever the library's parser raises on odd text
        return None


@lru_cache(maxsize=256)
def measured_unit(unit: str) -> MeasuredUnit | None:
    """Read a unit of a measured file; None where it is unknown.

    Such as ``"um/N"``, ``"g"`` (the acceleration of gravity here), ``"lb"`` (a force), ``"m/s2"``.
    """
    if unit in MEASURED:
        return MeasuredUnit(*MEASURED[unit])
    return measured_by_library(unit)


def measured_by_library(unit: str) -> MeasuredUnit | None:
    """Unit of a measured file by the units library; as `measured_unit`, which knows many."""
    unit = re.sub(r"\bg(0|₀)(?!\w)", "gn", speed_of_any(unit) or unit)
    known = _unit_of_library(unit.strip(), _MEASURED_WORDS) if len(unit) <= _LONGEST_TEXT else None
    if known is None or not known[2]:
        return None
    parsed, one, _ = known
    return MeasuredUnit(dict(one.dimensionality), float(one.magnitude), _is_angle(parsed))


@lru_cache(maxsize=64)
def dimension_of(unit: str) -> dict[str, int]:
    """Exponent of each base dimension of pint, of an SI unit such as ``"m/N"``."""
    if unit in MEASURED and unit not in _MEASURED_WORDS:
        return MEASURED[unit][0]
    return dict(registry().Unit(unit).dimensionality)


def _is_angle(unit: Any) -> bool:
    return any(part in name for name in unit._units for part in _ANGLE_UNITS)


def _may_have_angle(dimension: str) -> bool:
    return dimension in (*_CYCLIC, "angle", "gain") or "rad" in DIMENSIONS[dimension].unit


def _turns_per_second(one: Any, unit: Any) -> float:
    if _is_angle(unit):
        return float(one.to("radian/second").magnitude) / (2.0 * math.pi)
    return float(one.to("1/second").magnitude)


def _name_of(one: Any, unit: Any) -> str:
    """Name the dimension of what was given."""
    ureg = registry()
    if one.dimensionality == ureg.Unit("Hz").dimensionality:
        return "an angular speed" if _is_angle(unit) else "a frequency"
    if one.dimensionality == ureg.Unit("").dimensionality:
        return "an angle" if _is_angle(unit) else "a plain number"
    named = {entry.unit: entry.name for entry in reversed(DIMENSIONS.values()) if entry.unit}
    for si, name in {**named, **_FOREIGN}.items():
        if one.dimensionality == ureg.Unit(si).dimensionality:
            return name
    return "of another dimension"


def parse(given: Any, dimension: str) -> Quantity:
    """Read a quantity: text with a unit, or a bare number in SI.

    Parameters
    ----------
    given : str, int or float
        ``"20 mm"``, ``"1650 +- 80 MPa"``, ``"1 1/4 in"``, ``0.02``.
    dimension : str
        Key of `DIMENSIONS`.

    Raises
    ------
    QuantityError
        If it is not a quantity, of another dimension or not finite.
    """
    if isinstance(given, bool) or not isinstance(given, (int, float, str)):
        raise QuantityError(f"{formatted(given)} is not a quantity; {_wanted(dimension)}")
    if not isinstance(given, str):
        return Quantity(_finite(_as_float(given), given), 0.0, "")
    return _parsed(given, dimension)


@lru_cache(maxsize=4096)
def _parsed(given: str, dimension: str) -> Quantity:
    """Read a quantity from text; a case that is patched is read again and again."""
    text = with_decimals(given) if len(given) <= _LONGEST_TEXT else ""
    match = _QUANTITY.match(text)
    if match is None:
        raise QuantityError(f"{formatted(given)} is not a quantity; {_wanted(dimension)}")
    hint = advice_on_number(text) or advice(match["value"], match["unit"], dimension)
    if hint:
        raise QuantityError(f"{formatted(given)} {hint}")
    if _DECIMAL_COMMA.match(given):
        raise QuantityError(f"{formatted(given)} has a decimal comma; write a decimal point")
    unit = match["unit"]
    try:
        factor = unit_factor(unit, dimension)
    except QuantityError as error:
        raise QuantityError(f"{formatted(given)} {error}") from None
    if not unit and DIMENSIONS[dimension].unit and float(match["value"]) != 0.0:
        raise QuantityError(f"{formatted(given)} has no unit; {_wanted(dimension)}")
    value = _finite(_times(float(match["value"]), factor), given)
    deviation = _times(float(match["deviation"] or 0.0), factor)
    if deviation < 0.0:
        raise QuantityError(f"{formatted(given)} has a negative standard deviation")
    return Quantity(value, _finite(deviation, given), unit)


def _times(number: float, factor: float) -> float:
    """Multiply so that decimal numbers stay so: 5 um is 5e-6, not 4.9999999999999996e-6."""
    if factor >= 1.0 and math.isclose(factor, round(factor), rel_tol=1e-14):
        return number * round(factor)
    inverse = round(1.0 / factor) if 1e-15 < factor < 1.0 else 0
    if inverse and math.isclose(inverse * factor, 1.0, rel_tol=1e-14):
        return number / inverse
    return number * factor


def _as_float(given: int | float) -> float:
    try:
        return float(given)
    except OverflowError:
        return math.inf


def _finite(value: float, given: Any) -> float:
    if not math.isfinite(value):
        raise QuantityError(f"{formatted(given)} is not a finite number")
    return value


def write(value: float, unit: str, dimension: str) -> str | float:
    """Write an SI value in a unit so that it reads back to 1e-12 relative.

    The unit is empty for a bare number.
    """
    if not unit:
        return value
    return f"{value / unit_factor(unit, dimension):.15g} {unit}"
