"""Headings of columns: names, units and their dimensions, and the spellings that are understood."""

import re
from pathlib import Path

from chatter.description.errors import InputError
from chatter.description.formatting import formatted
from chatter.description.units import QuantityError, dimension_of, measured_unit, parse
from chatter.description.usual_units import UsualUnit, of_dimension
from chatter.io.sensitivities import VOLTS

#: name of a column -> dimension of its unit; "" for one without
DIMENSIONS = {
    "time": "time",
    "spindle_angle": "angle",
    "Fx": "force",
    "Fy": "force",
    "Fz": "force",
    "x": "length",
    "y": "length",
    "z": "length",
    "command": "length",
    "position": "length",
    "scale": "length",
    "torque": "torque",
    "velocity": "velocity",
    "force": "force",
    "spindle_speed": "angular_speed",
    "axial_depth": "length",
    "stable": "number",
    "feed_per_tooth": "length",
    "radial_depth": "length",
    "cut_time": "time",
    "chatter_frequency": "frequency",
    "spindle_power": "power",
    "frequency": "frequency",
    "real": "",
    "imag": "",
    "magnitude": "",
    "phase": "angle",
}
#: spellings, in lower case and without spaces and strokes -> name
_SPELLINGS = {name.lower().replace("_", ""): name for name in DIMENSIONS} | {
    "t": "time",
    "zeit": "time",
    "angle": "spindle_angle",
    "speed": "spindle_speed",
    "depth": "axial_depth",
    "width": "radial_depth",
    "power": "spindle_power",
    "verdict": "stable",
    "freq": "frequency",
    "re": "real",
    "im": "imag",
    "imaginary": "imag",
    "mag": "magnitude",
}
_BRACKETS = re.compile(r"\s*(?P<name>[^\[\]()]+?)\s*(?:\[(?P<unit>[^\]]*)\]|\((?P<other>[^)]*)\))?")
_STROKE = re.compile(
    r"\s*(?P<name>[A-Za-z_ ]+?)\s*(?:/|,)\s*(?P<unit>[A-Za-z\u00b5\u03bc%/^*0-9 ]+)"
)
_UNITLESS = ("", "1", "-")


def signal_unit(name: str) -> UsualUnit:
    """Unit that people read a signal in, by the name of its column; without a name if unknown."""
    dimension = DIMENSIONS.get(name, "")
    if dimension == "length":
        # motion, which is small beside the lengths of a case
        return UsualUnit("um", 1e6)
    return of_dimension(dimension) if dimension else UsualUnit("", 1.0)


def named(path: Path, heading: str) -> tuple[str, float]:
    """Name of a column and the factor of its numbers to SI, of a heading such as "Fx [N]".

    InputError if it is no heading, or its unit is unknown or of another dimension than the column.
    """
    name, unit = _parted(path, heading)
    known = _SPELLINGS.get(_plain(name))
    if known is None:
        return name, _factor_of_any(unit)
    if unit in _UNITLESS or known == "stable":
        return known, 1.0
    return known, _factor(path, heading, known, unit)


def _plain(name: str) -> str:
    return re.sub(r"[\s_-]", "", name).lower()


def _parted(path: Path, heading: str) -> tuple[str, str]:
    """Name and unit; "Fx_N", "Fx / N" and "Fx in N" are understood where both parts are known."""
    match = _BRACKETS.fullmatch(heading.strip())
    if match is None or not match["name"].strip():
        match = _STROKE.fullmatch(heading)
        if match is None:
            raise InputError(f'{path}: {formatted(heading)} is no heading such as "Fx [N]"')
        return match["name"], match["unit"].strip()
    name, unit = match["name"], (match["unit"] or match["other"] or "").strip()
    if unit or _plain(name) in _SPELLINGS:
        return name, unit
    for parts in (name.rpartition("_"), name.rpartition("/"), name.rpartition(" in ")):
        stem, _, end = parts
        known = _SPELLINGS.get(_plain(stem))
        if known and _fits(DIMENSIONS[known], end.strip()):
            return stem, end.strip()
    return name, ""


def _fits(dimension: str, unit: str) -> bool:
    try:
        return bool(dimension) and parse(f"1 {unit}", dimension) is not None
    except QuantityError:
        return False


def _factor(path: Path, heading: str, name: str, unit: str) -> float:
    dimension = DIMENSIONS[name]
    try:
        if dimension:
            return parse(f"1 {unit}", dimension).value
        return _receptance(unit)
    except (QuantityError, ValueError) as error:
        raise InputError(f"{path}: {formatted(heading)}: {error}{_of_volts(name, unit)}") from error


def _of_volts(name: str, unit: str) -> str:
    """How the sensitivity of a sensor is stated, where the file has volts."""
    if unit not in VOLTS:
        return ""
    return (
        f'; state the sensitivity, such as "{name} [500 N/V]" for a force, and all columns, by '
        "--columns, or by columns of the run in measurement.toml"
    )


def _receptance(unit: str) -> float:
    found = measured_unit(unit)
    if found is None or found.dimension != dimension_of("m/N"):
        raise ValueError(f'"{unit}" is no unit of a displacement per force, such as m/N or um/N')
    return found.factor


def _factor_of_any(unit: str) -> float:
    """Factor of a column that nothing asks for: 1 where its unit is not known either."""
    found = None if unit in _UNITLESS else measured_unit(unit)
    return 1.0 if found is None else found.factor
