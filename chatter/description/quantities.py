"""Field types of the case file: one declaration serves reading, checking, writing and schema."""

from __future__ import annotations

import math
from dataclasses import dataclass
from types import GenericAlias
from typing import Annotated, Any

from pydantic import BeforeValidator, WithJsonSchema

from chatter.description import units
from chatter.description.formatting import formatted

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
                    f"{formatted(given)}{self._bare_unit(given)} is out of range; "
                    f"it must be {words} {self._shown(bound)}"
                )
        return value

    def matching(self, text: str) -> QuantityField:  # noqa: ARG002
        """Field for another value of the same dimension as a text."""
        return self

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
        Key of `chatter.description.units.DIMENSIONS`.
    **bounds : float
        ``above``, ``at_least``, ``below``, ``at_most``, in SI.
    """
    field = QuantityField(dimension, **bounds)
    return Annotated[float, BeforeValidator(field.read), WithJsonSchema(field.json_schema()), field]


@dataclass(frozen=True)
class EitherQuantityField(QuantityField):
    """Field of one of several dimensions, as along a travel or about an axis.

    Which one it must be follows from another key; `dimension` is the first of them.
    """

    others: tuple[str, ...] = ()

    def matching(self, text: str) -> QuantityField:
        """Field for another value of the same dimension as a text."""
        for dimension in (self.dimension, *self.others):
            try:
                units.parse(text, dimension)
            except units.QuantityError:
                continue
            return self.of(dimension)
        return self.of(self.dimension)

    def of(self, dimension: str) -> QuantityField:
        """Field of one of the dimensions."""
        return QuantityField(dimension, self.above, self.at_least, self.below, self.at_most)

    def read(self, given: Any) -> float:
        """Read a quantity of any of the dimensions; raise ValueError with a sentence."""
        return (self.matching(given) if isinstance(given, str) else self.of(self.dimension)).read(
            given
        )

    @property
    def noun(self) -> str:
        """What is wanted, with its article."""
        names = [units.DIMENSIONS[one].name for one in (self.dimension, *self.others)]
        return " or ".join(dict.fromkeys(names))

    def json_schema(self) -> dict:
        """Return the JSON schema of the field."""
        entries = [units.DIMENSIONS[one] for one in (self.dimension, *self.others)]
        examples = [entry.example for entry in entries if entry.unit]
        return {
            "description": f"{self.noun}; a bare number is in SI",
            "anyOf": [
                {"type": "string", "pattern": _TEXT_PATTERN, "examples": examples},
                {"type": "number", **self._bounds()},
            ],
        }


def either_quantity(*dimensions: str, **bounds: float) -> Any:
    """Return the field type of a quantity of one of several dimensions.

    Parameters
    ----------
    *dimensions : str
        Keys of `chatter.description.units.DIMENSIONS`.
    **bounds : float
        As for `quantity`.
    """
    field = EitherQuantityField(dimensions[0], **bounds, others=dimensions[1:])
    return Annotated[float, BeforeValidator(field.read), WithJsonSchema(field.json_schema()), field]


def quantities(count: int, dimension: str, **bounds: float) -> Any:
    """Return the field type of a list of quantities of one dimension.

    Parameters
    ----------
    count : int
        How many there must be.
    dimension : str
    **bounds : float
        As for `quantity`.
    """
    field = QuantityField(dimension, **bounds)
    example = f"[{', '.join([field.example] * count)}]"

    def read(given: Any) -> tuple[float, ...]:
        if not isinstance(given, (list, tuple)) or len(given) != count:
            raise ValueError(
                f"{formatted(given)} is given; {count} quantities are wanted, such as {example}"
            )
        return tuple(field.read(part) for part in given)

    schema = {
        "type": "array",
        "items": {"anyOf": field.json_schema()["anyOf"]},
        "minItems": count,
        "maxItems": count,
        "description": f"{count} quantities, each {field.noun}",
    }
    numbers: Any = GenericAlias(tuple, (float,) * count)
    return Annotated[numbers, BeforeValidator(read), WithJsonSchema(schema), field]


def quantity_list(dimension: str, fewest: int, most: int, **bounds: float) -> Any:
    """Return the field type of a list of any number of quantities of one dimension.

    Parameters
    ----------
    dimension : str
    fewest, most : int
        Entries that there may be.
    **bounds : float
        As for `quantity`.
    """
    field = QuantityField(dimension, **bounds)

    def read(given: Any) -> tuple[float, ...]:
        if not isinstance(given, (list, tuple)) or not fewest <= len(given) <= most:
            raise ValueError(
                f"{formatted(given)} is given; a list of {fewest} to {most} quantities is wanted, "
                f"such as [{field.example}, ...]"
            )
        return tuple(field.read(part) for part in given)

    schema = {
        "type": "array",
        "items": {"anyOf": field.json_schema()["anyOf"]},
        "minItems": fewest,
        "maxItems": most,
        "description": f"quantities, each {field.noun}",
    }
    return Annotated[tuple[float, ...], BeforeValidator(read), WithJsonSchema(schema), field]


#: no cutter is larger, so that a number meant in mm is not taken for one in m
_LARGEST_LENGTH = 2.0

Length = quantity("length", at_least=0.0, at_most=_LARGEST_LENGTH)
PositiveLength = quantity("length", above=0.0, at_most=_LARGEST_LENGTH)


def _whole(given: Any) -> int:
    if isinstance(given, bool) or not isinstance(given, int):
        raise ValueError(f"{formatted(given)} is no whole number")
    return given


def whole_number(at_least: int, at_most: int, meaning: str) -> Any:
    """Return the field type of a whole number within limits."""

    def read(given: Any) -> int:
        value = _whole(given)
        if not at_least <= value <= at_most:
            raise ValueError(
                f"{formatted(value)} is out of range; {meaning} go from {at_least} to {at_most}"
            )
        return value

    schema = {"type": "integer", "minimum": at_least, "maximum": at_most}
    return Annotated[int, BeforeValidator(read), WithJsonSchema(schema)]
