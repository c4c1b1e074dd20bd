"""Axis of a diagram over any path of a case: `PATH=FROM..TO[:COUNT]`, or values of Python."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.formatting import formatted
from chatter.description.given_values import text_given, values_given
from chatter.description.path import info_at, parse_path
from chatter.description.units import rpm, unit_factor
from chatter.description.wording import unknown_key
from chatter.stability.search_range import spindle_speeds
from chatter.studies.counted_range import counted_range
from chatter.studies.model import field_of, value_of
from chatter.studies.whatif.variation import (
    MOST_VALUES,
    Value,
    Variation,
    read_variation,
    variation,
)

SPEED_PATH, DEPTH_PATH = "cut.spindle_speed", "cut.axial_depth"
_EXAMPLE = 'such as cut.radial_depth="0.5 mm..10 mm:40"'

#: text of the command line, or a path and its values
AxisGiven = str | tuple[str, Sequence[Any]]


def axis_of(
    given: AxisGiven, case: Case, option: str, count: int, most: int = MOST_VALUES
) -> Variation:
    """Axis from what is given, its numbers ascending.

    Given is ``"PATH=FROM..TO[:COUNT]"``, or a path and quantities as text or numbers in SI; `count`
    is for a range that gives none, no range has more than `most`, and messages name the option.
    InputError if there is no such path, it takes no quantity, or the range is empty.
    """
    try:
        found = _read(given, case, option, count, most)
    except InputError as error:
        messages = [text.replace("--vary", option) for text in error.messages]
        raise InputError(messages) from None
    numbers = found.numbers
    if numbers is None or len(set(numbers)) < 2:
        raise InputError(
            f"{option} {found.path}: the range is empty; two different ends are required"
        )
    ascending = sorted(found.values, key=lambda value: value.number)
    return Variation(found.path, tuple(ascending), found.unit)


def _read(given: AxisGiven, case: Case, option: str, count: int, most: int) -> Variation:
    if not isinstance(given, str):
        pair = values_given(given, f"{option}: a path and its values")
        if len(pair) != len(("path", "values")):
            raise InputError(
                f"{option}: a path and its values are required; {formatted(pair)} is given"
            )
        path = text_given(pair[0], f"{option}: the path")
        values = values_given(pair[1], f"{option} {path}: values")
        _require_quantity(case, path, option)
        return variation(path, values, case)
    path, equals, span = given.partition("=")
    if not (equals and path.strip() and ".." in span):
        raise InputError(
            f"{option} {formatted(given)}: PATH=FROM..TO[:COUNT] is required, {_EXAMPLE}"
        )
    _require_quantity(case, path.strip(), option)
    span, count = counted_range(f"{option} {path.strip()}", span, count, most)
    return read_variation(f"{path}={span}", case, count)


def _require_quantity(case: Case, path: str, option: str) -> None:
    if field_of(case, path) is None:
        steps = parse_path(path)
        if info_at(Case, steps) is None:
            why = f"there is no such quantity in a case; {unknown_key(Case, steps)}"
        else:
            why = (
                f"is no quantity that varies smoothly, as an axis does ({_EXAMPLE}); "
                f"`chatter whatif` compares its values"
            )
        raise InputError(f"{option} {formatted(path)}: {why}")


def speed_axis(case: Case) -> Variation:
    """Spindle speeds of the case's diagram, rpm."""
    values = tuple(
        Value(f"{rpm(speed):.6g} rpm", {SPEED_PATH: float(speed)}, float(rpm(speed)))
        for speed in spindle_speeds(case)
    )
    return Variation(SPEED_PATH, values, "rpm")


def case_value(case: Case, axis: Variation) -> float:
    """What the case has at the path of an axis, in its unit; nan where that is not a number."""
    value = value_of(case, axis.path)
    kind = field_of(case, axis.path)
    if kind is None or isinstance(value, bool) or not isinstance(value, (int, float, np.floating)):
        return math.nan
    sample = f"1 {axis.unit}" if axis.unit else "1"
    return float(value) / unit_factor(axis.unit, kind.matching(sample).dimension)
