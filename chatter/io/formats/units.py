"""What a column of a measured file holds, by its unit, and its factor to SI."""

import math
from collections.abc import Mapping
from typing import Literal, TypeVar

from chatter.description.units import dimension_of, measured_unit
from dynamics.frf.container import MeasurementError, Quantity

#: what a column of a measured file can hold
Channel = Literal["time", "frequency", "force", "displacement", "velocity", "acceleration"]

#: quantity of an FRF -> its SI unit
_QUANTITIES: dict[Quantity, str] = {
    "receptance": "m/N",
    "mobility": "m/s/N",
    "accelerance": "m/s**2/N",
}
#: content of a column of a record, or of a frequency axis -> its SI unit
_CHANNELS: dict[Channel, str] = {
    "time": "s",
    "frequency": "1/s",
    "force": "N",
    "displacement": "m",
    "velocity": "m/s",
    "acceleration": "m/s**2",
}
_Content = TypeVar("_Content", Quantity, Channel)


def _content(unit: str, known: Mapping[_Content, str], wanted: str) -> tuple[_Content, float]:
    found = measured_unit(unit)
    if found is None:
        raise MeasurementError(f"unit {unit.strip()[:60]!r} is not understood")
    for content, si_unit in known.items():
        if found.dimension == dimension_of(si_unit):
            cycles = content == "frequency" and found.has_angle
            return content, found.factor / (2.0 * math.pi) if cycles else found.factor
    raise MeasurementError(f"unit {unit.strip()!r} is {wanted}")


def frf_unit(unit: str) -> tuple[Quantity, float]:
    """Quantity of an FRF in a unit of response per force, and its factor to SI.

    Units as written in files: ``"um/N"``, ``"(m/s^2)/N"``, ``"g/N"`` (g is the acceleration of
    gravity here), ``"in/lbf"``, ``"1/kg"``. SI value = factor times the value in `unit`.
    MeasurementError if `unit` is not understood or is not a response per force.
    """
    wanted = (
        "not a response per force; "
        "allowed are units such as m/N, um/N, mm/s/N, m/s^2/N, g/N, in/lbf, 1/kg"
    )
    return _content(unit, _QUANTITIES, wanted)


def channel_unit(unit: str) -> tuple[Channel, float]:
    """Content of a column of a time record or of a frequency axis, and its factor to SI.

    Units such as ``"s"``, ``"ms"``, ``"Hz"``, ``"rad/s"``, ``"N"``, ``"lbf"``, ``"m/s^2"``,
    ``"g"``. SI value (frequencies in Hz) = factor times the value in `unit`. MeasurementError if
    `unit` is not understood or is none of these.
    """
    wanted = "none of a time, frequency, force, displacement, velocity or acceleration"
    return _content(unit, _CHANNELS, wanted)
