"""Units in which people read FRFs: SI inside, um/N on the page."""

from __future__ import annotations

#: beginning of an SI unit -> beginning of the unit that is read, and number of it in one of SI
_READ_IN = (
    ("m/s^2/", "m/s^2/", 1.0),
    ("m/s/", "mm/s/", 1e3),
    ("m/", "um/", 1e6),
    ("rad/s^2/", "rad/s^2/", 1.0),
    ("rad/s/", "mrad/s/", 1e3),
    ("rad/", "urad/", 1e6),
)
_LOADS = ("N", "(N*m)")


def frf_unit(unit: str) -> tuple[str, float]:
    """Unit in which an FRF of an SI unit is read, and the number of it in one of SI."""
    for given, read, factor in _READ_IN:
        if unit.startswith(given) and unit[len(given) :] in _LOADS:
            return read + unit[len(given) :], factor
    return unit, 1.0
