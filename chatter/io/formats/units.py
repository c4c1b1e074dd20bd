"""Units written in measured files: what a column holds and its factor to SI."""

from __future__ import annotations

import math
import re
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Literal

from dynamics.frf.container import MeasurementError, Quantity

if TYPE_CHECKING:
    import pint

#: what a column of a measured file can hold
Channel = Literal["time", "frequency", "force", "displacement", "velocity", "acceleration"]

#: quantity of an FRF by its dimension, exponents of (length, mass, time)
_QUANTITIES: dict[tuple[int, int, int], Quantity] = {
    (0, -1, 2): "receptance",
    (0, -1, 1): "mobility",
    (0, -1, 0): "accelerance",
}

#: content of a time or frequency column by its dimension, exponents of (length, mass, time)
_CHANNELS: dict[tuple[int, int, int], Channel] = {
    (0, 0, 1): "time",
    (0, 0, -1): "frequency",
    (1, 1, -2): "force",
    (1, 0, 0): "displacement",
    (1, 0, -1): "velocity",
    (1, 0, -2): "acceleration",
}

_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁻", "01234-")
#: how measurement software writes a unit -> how the units library does
_SPELLINGS = {
    "g": "standard_gravity",
    "G": "standard_gravity",
    "mg": "millistandard_gravity",
    "lb": "lbf",
    "Ns": "(N*s)",
    "mil": "thou",
    "ips": "(inch/s)",
}
_ALLOWED = re.compile(r"[A-Za-zµμ0-9 ()*/^.·⋅⁰¹²³⁴⁻-]{1,60}")
_SMALL_POWER = re.compile(r"\*\*\s*(-?[1-4]|\(\s*-?[1-4]\s*\))(?![\d.]|\s*\*\*)")


@lru_cache(maxsize=1)
def _registry() -> pint.UnitRegistry[Any]:
    import pint

    return pint.UnitRegistry()


def _spelled_for_library(unit: str) -> str:
    text = unit.strip().replace("μ", "µ").replace("·", "*").replace("⋅", "*")
    text = re.sub(r"([⁰¹²³⁴⁻]+)", lambda m: "^" + m.group(1).translate(_SUPERSCRIPTS), text)
    text = re.sub(r"\bNs\^?2\b", "(N*s^2)", text)
    text = re.sub(r"([A-Za-zµ])(\d)", r"\1^\2", text)
    text = re.sub(r"[A-Za-zµ]+", lambda m: _SPELLINGS.get(m.group(0), m.group(0)), text)
    return re.sub(r"^\s*1\s*/", "dimensionless/", text).replace("^", "**")


@lru_cache(maxsize=256)
def _dimension_and_factor(unit: str) -> tuple[tuple[int, int, int], float]:
    """Exponents of length, mass and time, and the factor to the SI unit of that dimension."""
    text = unit.strip()
    refused = MeasurementError(f"unit {text[:60]!r} is not understood")
    if not _ALLOWED.fullmatch(text):
        raise refused
    spelled = _spelled_for_library(text)
    # the units library computes powers of numbers: untrusted text must not ask for huge ones
    if re.search(r"\d|\*\*", _SMALL_POWER.sub("", spelled)):
        raise refused
    registry = _registry()
    try:
        parsed = registry.parse_units(spelled)
    except Exception as error:  # whatever the library's parser raises on odd text
        raise refused from error
    base = registry.Quantity(1.0, parsed).to_base_units()
    powers = dict(base.dimensionality)
    exponents = tuple(powers.pop(name, 0) for name in ("[length]", "[mass]", "[time]"))
    if powers or any(float(power) != int(power) for power in exponents):
        raise refused
    length, mass, time = (int(power) for power in exponents)
    factor = float(base.magnitude)
    if (length, mass, time) == (0, 0, -1) and "radian" in str(base.units):
        factor /= 2.0 * math.pi  # the library takes a radian as 1; a cycle is 2 pi of them
    return (length, mass, time), factor


def frf_unit(unit: str) -> tuple[Quantity, float]:
    """Tell the quantity of a unit of response per force and its factor to SI.

    Parameters
    ----------
    unit : str
        As written in a file: ``"um/N"``, ``"(m/s^2)/N"``, ``"g/N"`` (g is the acceleration of
        gravity here), ``"in/lbf"``, ``"1/kg"``.

    Returns
    -------
    quantity : str
        ``"receptance"``, ``"mobility"`` or ``"accelerance"``.
    factor : float
        SI value = factor times the value in `unit`.

    Raises
    ------
    MeasurementError
        If `unit` is not understood or is not a response per force.
    """
    dimension, factor = _dimension_and_factor(unit)
    if dimension not in _QUANTITIES:
        raise MeasurementError(
            f"unit {unit.strip()!r} is not a response per force; "
            "allowed are units such as m/N, um/N, mm/s/N, m/s^2/N, g/N, in/lbf, 1/kg"
        )
    return _QUANTITIES[dimension], factor


def channel_unit(unit: str) -> tuple[Channel, float]:
    """Tell what a column of a time record or a frequency axis holds, and its factor to SI.

    Parameters
    ----------
    unit : str
        ``"s"``, ``"ms"``, ``"Hz"``, ``"rad/s"``, ``"N"``, ``"lbf"``, ``"m/s^2"``, ``"g"`` ...

    Returns
    -------
    channel : str
        ``"time"``, ``"frequency"``, ``"force"``, ``"displacement"``, ``"velocity"`` or
        ``"acceleration"``.
    factor : float
        SI value (frequencies in Hz) = factor times the value in `unit`.

    Raises
    ------
    MeasurementError
        If `unit` is not understood or is none of these.
    """
    dimension, factor = _dimension_and_factor(unit)
    if dimension not in _CHANNELS:
        raise MeasurementError(
            f"unit {unit.strip()!r} is none of a time, frequency, force, displacement, velocity "
            "or acceleration"
        )
    return _CHANNELS[dimension], factor
