"""Directions: three numbers, or the name of an axis, which "-" turns round."""

import math
from typing import Annotated, Any

from pydantic import BeforeValidator, WithJsonSchema

from chatter.description.formatting import formatted

#: a unit vector may miss unit length by this much before it is refused rather than normalised
_UNIT_TOLERANCE = 0.01
_SHORTEST = 1e-9
_AXES = {
    "x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0),
    "-x": (-1.0, 0.0, 0.0), "-y": (0.0, -1.0, 0.0), "-z": (0.0, 0.0, -1.0),
}  # fmt: skip
_SCHEMA = WithJsonSchema(
    {
        "anyOf": [
            {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3},
            {"type": "string", "enum": list(_AXES)},
        ]
    }
)


def _vector(given: Any) -> tuple[tuple[float, float, float], float]:
    """Three numbers and their length."""
    if isinstance(given, str) and given in _AXES:
        return _AXES[given], 1.0
    numbers = isinstance(given, (list, tuple)) and all(
        isinstance(part, (int, float)) and not isinstance(part, bool) and -1e9 < part < 1e9
        for part in given
    )
    if not numbers or len(given) != 3:
        raise ValueError(
            f'{formatted(given)} is not a direction; "x", "y", "z" or three numbers are required, '
            "such as [1, 0, 0]"
        )
    return given, math.hypot(*given)


def _unit_vector(given: Any) -> tuple[float, float, float]:
    vector, length = _vector(given)
    if abs(length - 1.0) > _UNIT_TOLERANCE:
        raise ValueError(f"{formatted(given)} has length {length:.4g}; a unit vector is required")
    return tuple(float(part) / length for part in vector)


def _direction(given: Any) -> tuple[float, float, float]:
    vector, length = _vector(given)
    if length < _SHORTEST:
        raise ValueError(f"{formatted(given)} is not a direction; it has no length")
    return tuple(part / length for part in vector)


#: of unit length in the file
UnitVector = Annotated[tuple[float, float, float], BeforeValidator(_unit_vector), _SCHEMA]
#: of any length in the file, of unit length when read
Direction = Annotated[tuple[float, float, float], BeforeValidator(_direction), _SCHEMA]
