"""Field types of the case file: one declaration serves reading, checking, writing and schema."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from types import GenericAlias
from typing import Annotated, Any

from pydantic import BeforeValidator, WithJsonSchema

from chatter.description import units
from chatter.description.formatting import formatted
from chatter.description.magnitudes import is_plausible, words_of_range
from chatter.description.ranges import stated_ends

#: unit in which people state what a bare number states in SI, by dimension
_MEANT = {"angle": "deg", "length": "mm", "number": "%", "pressure": "MPa"}

#: a decimal number, or a fraction as shops write sizes
_NUMBER = rf"({units.NUMBER}|([0-9]+[ -])?[0-9]+/[0-9]+|[0-9]*[\u00bc-\u00be])"
#: what an editor can check: a number, perhaps a deviation, and a unit unless it is zero
_TEXT_PATTERN = (
    rf"^\s*({_NUMBER}(\s*(\+-|\+/-|±)\s*{_NUMBER})?\s*[A-Za-z%°\"\u00b5\u03bc(1].*"
    r"|[+-]?0+\.?0*)\s*$"
)
#: of a range as text: FROM..TO, a unit behind TO, perhaps :COUNT
RANGE_PATTERN = rf"^\s*{_NUMBER}.*\.\.\s*{_NUMBER}\s*[A-Za-z%°\"\u00b5\u03bc].*$"


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
        if not is_plausible(value, self.dimension):
            raise ValueError(
                f"{formatted(given)}{self._bare_unit(given)} is out of any plausible range; "
                f"{self.noun} is {words_of_range(self.dimension)} "
                f"{units.DIMENSIONS[self.dimension].unit}".rstrip()
            )
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
                    f"it must be {words} {self._shown(bound)}{self._meant(given)}"
                )
        return value

    def _meant(self, given: Any) -> str:
        """Ask whether a bare number out of range was meant in the usual unit, where that fits."""
        unit = _MEANT.get(self.dimension)
        if unit is None or isinstance(given, (bool, str)) or not isinstance(given, (int, float)):
            return ""
        text = f"{given:g} {unit}"
        try:
            QuantityField.read(self, text)
        except ValueError:
            return ""
        return f'; is "{text}" meant?'

    def matching(self, text: str) -> QuantityField:  # noqa: ARG002
        """Field for another value of the same dimension as a text."""
        return self

    @property
    def noun(self) -> str:
        """What is required, with its article."""
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
        if self.dimension == "length" and abs(bound) < 1.0:
            return f"{bound * 1e3:g} mm"
        if self.dimension == "power":
            return f"{bound * 1e-3:g} kW"
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
        dimensions = (self.dimension, *self.others)
        # the units library, slow to load, is asked last
        for dimension in dimensions:
            if units.known_by_heart(text, dimension):
                return self.of(dimension)
        for dimension in dimensions:
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
        """What is required, with its article."""
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

    Dimensions are keys of `chatter.description.units.DIMENSIONS`, bounds as for `quantity`.
    """
    field = EitherQuantityField(dimensions[0], **bounds, others=dimensions[1:])
    return Annotated[float, BeforeValidator(field.read), WithJsonSchema(field.json_schema()), field]


def list_type(
    kind: Any,
    read: Callable[[Any], Any],
    field: QuantityField,
    description: str = "",
    fewest: int | None = None,
    most: int | None = None,
) -> Any:
    """Return the field type of a list, by what reads it and the quantity of its entries."""
    keywords = {"minItems": fewest, "maxItems": most, "description": description or None}
    schema = {
        "type": "array",
        "items": {"anyOf": field.json_schema()["anyOf"]},
        **{key: value for key, value in keywords.items() if value is not None},
    }
    return Annotated[kind, BeforeValidator(read), WithJsonSchema(schema), field]


def list_reader(
    field: QuantityField, wanted: str, fewest: int = 0, most: float = math.inf
) -> Callable[[Any], tuple[float, ...]]:
    """Return what reads a list of quantities and says what is required where it is none."""

    def read(given: Any) -> tuple[float, ...]:
        if not isinstance(given, (list, tuple)) or not fewest <= len(given) <= most:
            raise ValueError(f"{formatted(given)} {wanted}")
        return tuple(field.read(part) for part in given)

    return read


def _examples(field: QuantityField, count: int) -> list[str]:
    """Quantities that rise, so that two of them are the ends of a range."""
    number, _, unit = field.example.strip('"').partition(" ")
    values = (f"{place * float(number):.4g} {unit}".rstrip() for place in range(1, count + 1))
    return [f'"{value}"' if unit else value for value in values]


def quantities(count: int, dimension: str, **bounds: float) -> Any:
    """Return the field type of so many quantities of one dimension; bounds as for `quantity`."""
    field = QuantityField(dimension, **bounds)
    example = f"[{', '.join(_examples(field, count))}]"
    wanted = f"is given; {count} quantities are required, such as {example}"
    read = list_reader(field, wanted, count, count)
    description = f"{count} quantities, each {field.noun}"
    kind = GenericAlias(tuple, (float,) * count)
    return list_type(kind, read, field, description, count, count)


def ends_of_range(dimension: str, **bounds: float) -> Any:
    """Return the field type of a range, "FROM..TO" or a list of two; bounds as for `quantity`."""
    field = QuantityField(dimension, **bounds)
    first, last = (one.strip('"') for one in _examples(field, 2))
    wanted = f'is given; a range is required, such as "{first}..{last}" or ["{first}", "{last}"]'
    read = list_reader(field, wanted, 2, 2)

    def read_either(given: Any) -> tuple[float, ...]:
        return read(stated_ends(given) or given if isinstance(given, str) else given)

    entry = {"anyOf": field.json_schema()["anyOf"]}
    schema = {
        "description": f"a range, each end {field.noun}",
        "anyOf": [
            {"type": "array", "items": entry, "minItems": 2, "maxItems": 2},
            {"type": "string", "pattern": RANGE_PATTERN, "examples": [f"{first}..{last}"]},
        ],
    }
    return Annotated[
        tuple[float, float], BeforeValidator(read_either), WithJsonSchema(schema), field
    ]


def quantity_list(dimension: str, fewest: int, most: int, **bounds: float) -> Any:
    """Return the field type of a list of quantities of one dimension; bounds as for `quantity`."""
    field = QuantityField(dimension, **bounds)
    read = list_reader(
        field,
        f"is given; a list of {fewest} to {most} quantities is required, such as "
        f"[{field.example}, ...]",
        fewest,
        most,
    )
    description = f"quantities, each {field.noun}"
    return list_type(tuple[float, ...], read, field, description, fewest, most)


#: no cutter is larger, so that a number meant in mm is not taken for one in m
_LARGEST_LENGTH = 2.0

Length = quantity("length", at_least=0.0, at_most=_LARGEST_LENGTH)
PositiveLength = quantity("length", above=0.0, at_most=_LARGEST_LENGTH)


def _written(given: Any) -> str:
    """How a whole number is written that stands there as text or with a decimal point."""
    try:
        value = float(given)
    except (TypeError, ValueError):
        return ""
    if isinstance(given, bool) or not value.is_integer():
        return ""
    how = "without quotes" if isinstance(given, str) else "without a decimal point"
    return f" as it stands; write {value:.0f}, {how}"


def whole_number(at_least: int, at_most: int, meaning: str) -> Any:
    """Return the field type of a whole number within limits."""

    def read(given: Any) -> int:
        if isinstance(given, bool) or not isinstance(given, int):
            raise ValueError(f"{formatted(given)} is not a whole number{_written(given)}")
        if not at_least <= given <= at_most:
            raise ValueError(
                f"{formatted(given)} is out of range; {meaning} go from {at_least} to {at_most}"
            )
        return given

    schema = {"type": "integer", "minimum": at_least, "maximum": at_most}
    return Annotated[int, BeforeValidator(read), WithJsonSchema(schema)]
