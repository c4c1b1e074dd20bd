"""Calls that take a description, such as a case or a machine, or the path of its file."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Concatenate, ParamSpec, TypeVar

from chatter.description.errors import InputError
from chatter.description.formatting import formatted
from chatter.description.patchable import Description

Described = TypeVar("Described", bound=Description)
Rest = ParamSpec("Rest")
Result = TypeVar("Result")


def described_or_read(
    given: Described | str | Path, kind: type[Described], read: Callable[[str | Path], Described]
) -> Described:
    """Return the description that is given, or that of its file.

    InputError for what is neither, another kind of description among them.
    """
    if isinstance(given, (str, Path)):
        return read(given)
    if isinstance(given, kind):
        return given
    raise InputError(
        f"a {kind.NOUN} or the path of its file is required; {formatted(given)} is given"
    )


def takes_described_or_path(
    function: Callable[Concatenate[Described, Rest], Result],
    kind: type[Described],
    read: Callable[[str | Path], Described],
) -> Callable[Concatenate[Described | str | Path, Rest], Result]:
    """Give a function of a description the path of its file instead, where that is given."""

    @wraps(function)
    def taking(given: Described | str | Path, *args: Rest.args, **kwargs: Rest.kwargs) -> Result:
        return function(described_or_read(given, kind, read), *args, **kwargs)

    return taking
