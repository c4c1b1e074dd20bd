"""Field types of the case file: one declaration serves reading, checking, writing and schema."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import BeforeValidator, WithJsonSchema

from chatter import units
from chatter.shown import shown

#: what an editor can check: a number, perhaps a deviation, and a unit unless it is zero
_TEXT_PATTERN = (
    rf"^\s*({units.NUMBER}(\s*(\+-|\+/-|±)\s*{units.NUMBER})?\s*[A-Za-z%°\u00b5\u03bc(1].*"
    r"|[+-]?0+\.?0*)\s*$"
)


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
                    f"{shown(given)}{self._bare_unit(given)} is out of range; "
                    f"it must be {words} {self._shown(bound)}"
                )
        return value

    @property
    def noun(self) -> str:
        """What is wanted, with its article."""
        return units.DIMENSIONS[self.dimension].name

    @property
    def example(self) -> str:
        """How such a quantity is written in a case file."""
        entry = units.DIMENSIONS[self.dimension]
        return f'"{entry.example}"' if entry.unit else entry.example

    def _bare_unit(self, given: Any) -> str:
        """Say the unit in which a bare number was understood."""
        unit = units.DIMENSIONS[self.dimension].unit
        return "" if isinstance(given, str) or not unit else f" (a bare number is in {unit})"

    def _shown(self, bound: float) -> str:
        if not bound:
            return "0"
        if self.dimension == "angle":
            return f"{math.degrees(bound):g} deg"
        return f"{bound:g} {units.DIMENSIONS[self.dimension].unit}".rstrip()

    def json_schema(self) -> dict:
        """Return the JSON schema of the field."""
        entry = units.DIMENSIONS[self.dimension]
        if not entry.unit:
            percent = {"type": "string", "pattern": _TEXT_PATTERN, "examples": ["3 %"]}
            return {"anyOf": [{"type": "number", **self._bounds()}, percent]}
        wanted = f"{self.noun}, such as {self.example}"
        return {
            "description": f"{wanted}; a bare number is in {entry.unit}",
            "anyOf": [
                {"type": "string", "pattern": _TEXT_PATTERN, "examples": [entry.example]},
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


#: no cutter is larger, so that a number meant in mm is not taken for one in m
_LARGEST_LENGTH = 2.0

Length = quantity("length", at_least=0.0, at_most=_LARGEST_LENGTH)
PositiveLength = quantity("length", above=0.0, at_most=_LARGEST_LENGTH)


def _whole(given: Any) -> int:
    if isinstance(given, bool) or not isinstance(given, int):
        raise ValueError(f"{shown(given)} is no whole number")
    return given


def whole_number(at_least: int, at_most: int, meaning: str) -> Any:
    """Return the field type of a whole number within limits."""

    def read(given: Any) -> int:
        value = _whole(given)
        if not at_least <= value <= at_most:
            raise ValueError(
                f"{shown(value)} is out of range; {meaning} go from {at_least} to {at_most}"
            )
        return value

    schema = {"type": "integer", "minimum": at_least, "maximum": at_most}
    return Annotated[int, BeforeValidator(read), WithJsonSchema(schema)]
