"""Parameters of effects as people read them: SI inside, units of the shop on the terminal."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from chatter.description.units import DIMENSIONS

#: SI unit -> units for larger and larger values: from which value on, name, number of it in one
#: of SI
_READ_IN: dict[str, Sequence[tuple[float, str, float]]] = {
    "m": ((0.0, "um", 1e6), (1e-3, "mm", 1e3)),
    "rad": ((0.0, "deg", 180.0 / math.pi),),
    "Pa": ((0.0, "MPa", 1e-6),),
    # edges have some N/mm, joints and bristles some N/um
    "N/m": ((0.0, "N/mm", 1e-3), (1e6, "N/um", 1e-6)),
    "m/s": ((0.0, "mm/s", 1e3),),
    "N*m/rad": ((1e3, "kN*m/rad", 1e-3), (1e6, "MN*m/rad", 1e-6)),
    "N*s/m": ((1e3, "kN*s/m", 1e-3),),
    "rad/s": ((0.0, "rpm", 30.0 / math.pi),),
    "N/m/s": ((0.0, "N/mm/min", 60e-3),),
    "1": ((0.0, "%", 100.0),),
    "1/s": ((0.0, "1/min", 60.0),),
    # a share by which a frequency changes with the speed
    "s/rad": ((0.0, "% per 1000 rpm", 1e5 * math.pi / 30.0),),
}
#: dimensions that share their SI unit with another, and are read in it: a gain in 1/s, a rate
#: of wear in 1/min
_READ_IN_SI = frozenset({"gain"})


def read_in(unit: str, value: float) -> tuple[str, float]:
    """Unit in which a value of an SI unit is read, and its number in one of SI."""
    found, factor = unit, 1.0
    for least, name, of_si in _READ_IN.get(unit, ()):
        if abs(value) >= least:
            found, factor = name, of_si
    return found, factor


def dimension_read_in(dimension: str, value: float) -> tuple[str, float]:
    """Unit in which a value of a dimension is read, and its number in one of SI.

    Parameters
    ----------
    dimension : str
        A key of `chatter.description.units.DIMENSIONS`.
    value : float
        In SI.
    """
    unit = DIMENSIONS[dimension].unit
    return (unit, 1.0) if dimension in _READ_IN_SI else read_in(unit, value)


def parameter_row(name: str, one: Mapping[str, Any]) -> list[str]:
    """Name, value, unit and interval of a parameter, given as its value, SI unit and `ci95`.

    What was chosen has no interval.
    """
    unit, factor = read_in(str(one["unit"]), one["value"])
    value = f"{factor * one['value']:.4g}"
    if one["ci95"] is None:
        return [name, value, unit, "chosen"]
    low, high = (f"{factor * end:.4g}" for end in one["ci95"])
    return [name, value, unit, f"{low} to {high}"]
