"""Magnitudes, in SI, and counts of entries beyond which a value of any key is a mistake.

It would overflow a solver, or never end. Parts that are meant to be rigid and axes that are meant
to be free lie within.
"""

from collections.abc import Mapping
from typing import Any

#: least magnitude of what is not zero, and largest, by key of `units.DIMENSIONS`
_MAGNITUDES: dict[str, tuple[float, float]] = {
    "moment_of_inertia": (1e-18, 1e12),
    "density": (1e-6, 1e8),
    "length": (1e-15, 1e6),
    "angle": (1e-15, 1e9),
    "angular_speed": (1e-12, 1e8),
    "frequency": (1e-9, 1e9),
    "mass": (1e-12, 1e12),
    "time": (1e-12, 1e9),
    "velocity": (1e-15, 1e6),
    "resistance": (1e-12, 1e12),
    "inductance": (1e-15, 1e9),
    "pressure_gradient": (1e-30, 1e24),
}
_OTHERS = (1e-30, 1e18)
#: entries of a list: tables such as modes, and others
_MOST_TABLES, _MOST_ENTRIES = 1000, 10_000


def long_lists(data: Any, path: str = "") -> list[str]:
    """Say which lists of nested tables and lists hold more than any description needs."""
    if isinstance(data, Mapping):
        return [
            text
            for key, value in data.items()
            for text in long_lists(value, f"{path}.{key}" if path else str(key))
        ]
    if not isinstance(data, (list, tuple)):
        return []
    nested = any(isinstance(value, (Mapping, list, tuple)) for value in data[:1])
    most = _MOST_TABLES if nested else _MOST_ENTRIES
    if len(data) > most:
        return [f"{path}: {len(data)} entries are given; at most {most} are allowed"]
    return [
        text for index, value in enumerate(data) for text in long_lists(value, f"{path}[{index}]")
    ]


def is_plausible(value: float, dimension: str) -> bool:
    """Whether a value in SI is zero or of a plausible magnitude."""
    least, largest = _MAGNITUDES.get(dimension, _OTHERS)
    return value == 0.0 or least <= abs(value) <= largest


def words_of_range(dimension: str) -> str:
    """Range of plausible magnitudes, in words without unit."""
    least, largest = _MAGNITUDES.get(dimension, _OTHERS)
    return f"0, or {least:g} to {largest:g} in magnitude,"
