"""Values that a call of Python is given, and what is said of other things in their place."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from numbers import Integral, Real
from typing import Any

from chatter.description.errors import InputError
from chatter.description.formatting import formatted

#: as `patch` takes them
EXAMPLE_OF_PATCH = '{"cut.axial_depth": "2 mm"}'


def whole_number_given(given: Any, what: str, least: int, most: int) -> int:
    """Return a whole number within bounds; InputError where what is given is none."""
    is_whole = isinstance(given, Integral) and not isinstance(given, bool)
    if not (is_whole and least <= given <= most):
        raise InputError(f"{what} {formatted(given)}: a number from {least} to {most} is required")
    return int(given)


def share_given(given: Any, what: str) -> float:
    """Return a number above 0 and up to 1; InputError where what is given is none."""
    is_number = isinstance(given, Real) and not isinstance(given, bool)
    if not (is_number and 0.0 < given <= 1.0):
        raise InputError(
            f"{what} {formatted(given)}: a probability above 0 and up to 1 is required"
        )
    return float(given)


def number_given(given: Any, what: str) -> float:
    """Return a number; InputError where what is given is none."""
    if not isinstance(given, Real) or isinstance(given, bool) or given != given:
        raise InputError(f"{what} {formatted(given)}: a number is required")
    return float(given)


def text_given(given: Any, what: str) -> str:
    """Return a text; InputError where what is given is none, with what is required."""
    if not isinstance(given, str):
        raise InputError(f"{what} is required as text; {formatted(given)} is given")
    return given


def texts_given(given: Any, what: str) -> tuple[str, ...]:
    """Return one text or several; InputError where what is given is neither."""
    if isinstance(given, str):
        return (given,)
    if not isinstance(given, Iterable) or isinstance(given, (Mapping, bytes)):
        raise InputError(f"{what} are required as texts; {formatted(given)} is given")
    return tuple(text_given(one, f"each of {what}") for one in given)


def values_given(given: Any, what: str) -> list[Any]:
    """Return values one behind the other; InputError where what is given is none of these."""
    if not isinstance(given, Iterable) or isinstance(given, (str, bytes, Mapping)):
        raise InputError(f"{what} are required as a list; {formatted(given)} is given")
    return list(given)


def mapping_given(given: Any, what: str, example: str) -> Mapping[Any, Any]:
    """Return a dictionary; InputError where what is given is none, with an example."""
    if not isinstance(given, Mapping):
        raise InputError(f"{what} is required, such as {example}; {formatted(given)} is given")
    return given
