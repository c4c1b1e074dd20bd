"""Values of a path, as the command line gives them.

``PATH=v1,v2,...``, ``PATH=from..to:count``, or ``PATH=+-10%`` about the value that stands.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from chatter.description.assignments import parse_assignments
from chatter.description.bare_numbers import refuse_bare_assignments
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.formatting import formatted, printable
from chatter.description.quantities import QuantityField
from chatter.description.shop_units import with_decimals
from chatter.description.stated_cut import share_in_length
from chatter.description.units import DIMENSIONS, NUMBER, parse, unit_factor, write
from chatter.studies.counted_range import counted_range
from chatter.studies.model import PREFIX, field_of, unit_at, value_of

if TYPE_CHECKING:
    from chatter.studies.model import Model

#: points of a range where the count is not given
DEFAULT_COUNT = 5
#: values of a path at the most
MOST_VALUES = 2000
_RELATIVE = re.compile(rf"^\s*(?:\+-|\+/-|±)\s*({NUMBER})\s*%\s*$")
#: a change of which the unit is missing
_BARE_CHANGE = re.compile(rf"^\s*(?:\+-|\+/-|±)\s*({NUMBER})\s*$")
#: a range of whole numbers, such as those of teeth
_WHOLE_RANGE = re.compile(r"\s*(\d+)\s*\.\.\s*(\d+)\s*(?::\s*(\d+)\s*)?")
_PLAIN = str.maketrans("", "", '"[]{}')
_EXAMPLE = 'such as cut.axial_depth="1 mm, 2 mm" or cut.spindle_speed="3000 rpm..9000 rpm"'


@dataclass(frozen=True)
class Value:
    """One value of a path."""

    label: str  # as people read it
    patch: Mapping[str, Any] = field(hash=False)  # what it changes
    number: float | None = None  # in the unit of the variation; None for what is not a quantity


@dataclass(frozen=True)
class Variation:
    """A path and its values."""

    path: str
    values: tuple[Value, ...]
    unit: str = ""  # of the numbers

    @property
    def numbers(self) -> list[float] | None:
        """Numbers of all values, None where some value has none."""
        found = [value.number for value in self.values]
        return None if any(number is None for number in found) else found

    @property
    def axis_label(self) -> str:
        """Path with the unit of its numbers."""
        return f"{self.path} [{self.unit}]" if self.unit and self.numbers else self.path


def read_variation(text: str, model: Model, count: int | None = None) -> Variation:
    """Read a variation of the command line; a range has `count` values where it says no other.

    InputError if it is none: no path, no values, mixed units.
    """
    path, equals, given = text.partition("=")
    path = path.strip()
    if not equals or not path:
        raise InputError(f"--vary {formatted(text)}: PATH=VALUES is required, {_EXAMPLE}")
    if not isinstance(model, Case):
        path = path.removeprefix(PREFIX)
    kind = field_of(model, path)
    relative = _RELATIVE.match(given)
    if relative:
        return _relative(model, path, float(relative[1]) / 100.0, kind)
    bare_change = _BARE_CHANGE.match(given)
    if bare_change:
        raise InputError(
            f"--vary {path}: {formatted(given.strip())} has no unit; a change is written in "
            f'percent of what stands, "+-{bare_change[1]}%"'
        )
    if isinstance(model, Case):
        given = share_in_length(path, given, model.tool and model.tool.diameter)
    parts = _split(given)
    if not parts:
        raise InputError(f"--vary {path}: there are no values; give some, {_EXAMPLE}")
    if any(not part for part in parts):
        raise InputError(f"--vary {path}: a value is empty in {formatted(given)}")
    if len(parts) == 1 and ".." in parts[0] and kind is not None:
        return _range(path, parts[0], kind, count)
    whole = _WHOLE_RANGE.fullmatch(parts[0]) if len(parts) == 1 and kind is None else None
    if whole:
        parts = _whole_numbers(path, *(int(one) if one else None for one in whole.groups()))
    values = {part: parse_assignments([f"{path}={part}"])[path] for part in parts}
    _refuse_bare_numbers(path, values.values())
    _refuse_mixed(path, values, kind)
    return _listed(path, list(values.items()), kind)


def variation(path: str, values: list[Any], model: Model) -> Variation:
    """Variation from values of Python: quantities as text, numbers in SI, None takes a key away.

    InputError if there are no values, or one is of the wrong kind.
    """
    if len(values) == 0:
        raise InputError(f"{path}: there are no values")
    pairs = [(value if isinstance(value, str) else formatted(value), value) for value in values]
    return _listed(path, pairs, field_of(model, path))


def _split(text: str) -> list[str]:
    """Parts between commas that stand in no bracket and no quotes."""
    parts, depth, quoted, part = [], 0, False, ""
    for letter in text.strip():
        quoted ^= letter == '"'
        if not quoted:
            depth += (letter in "[{") - (letter in "]}")
        if letter == "," and depth == 0 and not quoted:
            parts.append(part.strip())
            part = ""
        else:
            part += letter
    return [*parts, part.strip()] if text.strip() else []


def _refuse_bare_numbers(path: str, values: Iterable[Any]) -> None:
    """Refuse 14000, which may be meant in rpm or in rad/s."""
    for value in values:
        refuse_bare_assignments(Case, {path: value}, "--vary")


def _refuse_mixed(path: str, values: Mapping[str, Any], kind: QuantityField | None) -> None:
    """Refuse "1, 2, 3 mm": a bare number is SI, which is hardly meant."""
    if kind is None:
        return
    bare = [
        text
        for text, value in values.items()
        if isinstance(value, (int, float)) and not isinstance(value, bool) and value != 0
    ]
    with_unit = [text for text, value in values.items() if isinstance(value, str)]
    if bare and with_unit and DIMENSIONS[kind.dimension].unit:
        raise InputError(
            f"--vary {path}: {formatted(bare[0])} has no unit, {formatted(with_unit[0])} has one; "
            "give every value its unit"
        )


def _listed(path: str, pairs: list[tuple[str, Any]], kind: QuantityField | None) -> Variation:
    if len(pairs) > MOST_VALUES:
        raise InputError(f"{path}: {len(pairs)} values; at most {MOST_VALUES} are allowed")
    _refuse_wrong(path, [given for _, given in pairs], kind)
    unit = _unit(path, [value for _, value in pairs], kind)
    dimension = kind.dimension if kind is not None else "number"
    values = []
    for text, given in pairs:
        number = None
        if kind is not None and isinstance(given, (int, float, str)):
            number = _read(path, kind, given) / unit_factor(
                unit, kind.matching(str(given)).dimension
            )
        elif kind is None and isinstance(given, (int, float)) and not isinstance(given, bool):
            number = float(given)
        label = printable(text.translate(_PLAIN).strip())
        bare = number is not None and not isinstance(given, str)
        if bare and unit and dimension != "number":
            label = f"{number:.6g} {unit}"
        values.append(Value(label, {path: given}, number))
    return Variation(path, tuple(values), unit)


def _refuse_wrong(path: str, values: Iterable[Any], kind: QuantityField | None) -> None:
    """Raise InputError with what is wrong with each of the values, not with the first alone."""
    problems: list[str] = []
    for given in values:
        if kind is None or not isinstance(given, (int, float, str)):
            continue
        try:
            _read(path, kind, given)
        except InputError as error:
            problems += error.messages
    if problems:
        raise InputError(problems)


def _read(path: str, kind: QuantityField, given: Any) -> float:
    try:
        return kind.read(given)
    except ValueError as error:
        of_change = isinstance(given, str) and given.strip().endswith("%")
        hint = '; a change in percent is written "+-10%"' if of_change else ""
        raise InputError(f"--vary {path}: {error}{hint}") from None


def _unit(path: str, given: list[Any], kind: QuantityField | None) -> str:
    """Unit of the first value that has one, else the SI unit."""
    if kind is None:
        return ""
    for value in given:
        if isinstance(value, str):
            _read(path, kind, value)
            found = parse(value, kind.matching(value).dimension).unit
            if found:
                return found
    return DIMENSIONS[kind.dimension].unit


def _unquoted(end: str) -> str:
    """End of a range without the quotes around it; a mark of an inch stays."""
    end = end.strip()
    return end[1:-1] if len(end) > 1 and end[0] == end[-1] == '"' else end


def _without_outer_quotes(text: str) -> str:
    """Range without quotes around the whole of it, where no end has its own."""
    return _unquoted(text) if text.count('"') == 2 else text


def _range(path: str, text: str, kind: QuantityField, count: int | None) -> Variation:
    where = f"--vary {path}"
    count = DEFAULT_COUNT if count is None else count
    text, count = counted_range(where, _without_outer_quotes(text), count, MOST_VALUES)
    ends = _without_outer_quotes(text).partition("..")
    low, _, high = (with_decimals(_unquoted(part)) for part in ends)
    # "1..4 mm" is meant as 1 mm..4 mm
    unit = re.sub(rf"^\s*{NUMBER}", "", high).strip()
    if re.fullmatch(NUMBER, low) and unit:
        low = f"{low} {unit}"
    ends = [end if not re.fullmatch(NUMBER, end) else float(end) for end in (low, high)]
    _refuse_bare_numbers(path, ends)
    pair = _listed(path, list(zip((low, high), ends, strict=True)), kind)
    first, last = (value.number for value in pair.values)
    values = tuple(
        Value(f"{number:.6g} {pair.unit}".strip(), {path: _text(number, pair.unit)}, float(number))
        for number in np.linspace(first, last, count)
    )
    return Variation(path, values, pair.unit)


def _whole_numbers(path: str, low: int, high: int, count: int | None) -> list[str]:
    """Numbers of a range of teeth or such: all, or so many of them, about even."""
    if not low < high:
        raise InputError(f"--vary {path}: the range is empty: {low} is not less than {high}")
    every = high - low + 1
    chosen = every if count is None else min(max(count, 2), every)
    if chosen > MOST_VALUES:
        raise InputError(f"--vary {path}: {chosen} values; at most {MOST_VALUES} are allowed")
    return [str(round(one)) for one in np.linspace(low, high, chosen)]


def _text(number: float, unit: str) -> str | float:
    return f"{float(number)!r} {unit}" if unit else float(number)


def _relative(model: Model, path: str, share: float, kind: QuantityField | None) -> Variation:
    """Two values a share below and above what stands; of all of them where the path has [*]."""
    if share == 0.0:
        raise InputError(f"--vary {path}: a change of 0 % varies nothing")
    standing = value_of(model, path)
    if kind is None or standing is None:
        raise InputError(
            f"{model.name}: --vary {path}: there is no quantity of which {100.0 * share:.3g} % "
            "could be taken; give values instead"
        )
    several = isinstance(standing, tuple)
    numbers = standing if several else (standing,)
    values = []
    for factor in (1.0 - share, 1.0 + share):
        patch = {
            path.replace("[*]", f"[{index}]", 1) if several else path: factor * float(number)
            for index, number in enumerate(numbers)
        }
        for own, number in patch.items():
            _check_change(model, own, share, number, kind)
        label = f"{100.0 * (factor - 1.0):+.4g} %"
        values.append(Value(label, patch, 100.0 * (factor - 1.0)))
    return Variation(path, tuple(values), "%")


def _check_change(
    model: Model, path: str, share: float, number: float, kind: QuantityField
) -> None:
    """Refuse a value, SI, that a change of what stands leads to, in the unit of the file."""
    unit = unit_at(model, path)
    sample = kind.matching(f"1 {unit}") if unit else kind
    try:
        sample.read(write(number, unit, sample.dimension))
    except ValueError as error:
        standing = _shown(value_of(model, path), unit, sample)
        change = f"+-{100.0 * share:.4g}%"
        raise InputError(f"{model.name}: --vary {path}: {change} of {standing}: {error}") from None


def _shown(number: float, unit: str, kind: QuantityField) -> str:
    """Value, SI, in a unit."""
    return f"{number / unit_factor(unit, kind.dimension):.6g} {unit}".rstrip()
