"""Field types of the case file: one declaration serves reading, checking, writing and schema."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import BeforeValidator, WithJsonSchema

from chatter import units

_LONGEST_VALUE = 60


def shown(value: Any) -> str:
    """Show a value as it stands in the file, shortened."""
    text = f'"{value}"' if isinstance(value, str) else str(value)
    return text if len(text) <= _LONGEST_VALUE else text[:_LONGEST_VALUE] + "..."


@dataclass(frozen=True)
class QuantityField:
    """Dimension and allowed range of a field, in SI."""

    dimension: str
    above: float | None = None
    at_least: float | None = None
    below: float | None = None
    at_most: float | None = None

    def read(self, given: Any) -> float:
        """Read a quantity and check its range; raise ValueError with a sentence for people."""
        value = units.parse(given, self.dimension).value
        checks = (
            (self.above, value > (self.above or 0.0), "greater than"),
            (self.at_least, value >= (self.at_least or 0.0), "at least"),
            (self.below, value < (self.below or 0.0), "less than"),
            (self.at_most, value <= (self.at_most or 0.0), "at most"),
        )
        for bound, holds, words in checks:
            if bound is not None and not holds:
                raise ValueError(
                    f"{shown(given)} is out of range; it must be {words} {self._shown(bound)}"
                )
        return value

    def _shown(self, bound: float) -> str:
        if self.dimension == "angle" and bound:
            return f"{bound * 180.0 / 3.141592653589793:g} deg"
        return f"{bound:g}"

    def json_schema(self) -> dict:
        """Return the JSON schema of the field."""
        entry = units.DIMENSIONS[self.dimension]
        if not entry.unit:
            return {"type": "number", **self._bounds()}
        return {
            "description": f'such as "{entry.example}"; a bare number is in {entry.unit}',
            "anyOf": [
                {"type": "string", "examples": [entry.example]},
                {"type": "number", **self._bounds()},
            ],
        }

    def _bounds(self) -> dict:
        keywords = {
            "exclusiveMinimum": self.above,
            "minimum": self.at_least,
            "exclusiveMaximum": self.below,
            "maximum": self.at_most,
        }
        return {key: bound for key, bound in keywords.items() if bound is not None}


def quantity(dimension: str, **bounds: float) -> Any:
    """Return the field type of a quantity.

    Parameters
    ----------
    dimension : str
        Key of `chatter.units.DIMENSIONS`.
    **bounds : float
        ``above``, ``at_least``, ``below``, ``at_most``, in SI.
    """
    field = QuantityField(dimension, **bounds)
    return Annotated[float, BeforeValidator(field.read), WithJsonSchema(field.json_schema()), field]


Length = quantity("length", at_least=0.0)
PositiveLength = quantity("length", above=0.0)


def _whole(given: Any) -> int:
    if isinstance(given, bool) or not isinstance(given, int):
        raise ValueError(f"{shown(given)} is no whole number")
    return given


def whole_number(at_least: int, at_most: int, meaning: str) -> Any:
    """Return the field type of a whole number within limits."""

    def read(given: Any) -> int:
        value = _whole(given)
        if not at_least <= value <= at_most:
            raise ValueError(f"{value} is out of range; {meaning} go from {at_least} to {at_most}")
        return value

    schema = {"type": "integer", "minimum": at_least, "maximum": at_most}
    return Annotated[int, BeforeValidator(read), WithJsonSchema(schema)]
