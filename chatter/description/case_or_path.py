"""Calls that take a case, or the path of its file."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Concatenate, ParamSpec, TypeVar

from chatter.description.case import Case, load
from chatter.description.errors import InputError
from chatter.description.formatting import formatted

Rest = ParamSpec("Rest")
Result = TypeVar("Result")


def takes_case_or_path(
    function: Callable[Concatenate[Case, Rest], Result],
) -> Callable[Concatenate[Case | str | Path, Rest], Result]:
    """Give a function of a case the path of a case file instead, where that is what is given."""

    @wraps(function)
    def taking(case: Case | str | Path, *args: Rest.args, **kwargs: Rest.kwargs) -> Result:
        return function(_case_of(case), *args, **kwargs)

    return taking


def _case_of(given: Case | str | Path) -> Case:
    """Case that is given, or that of its file; InputError for what is neither."""
    if isinstance(given, (str, Path)):
        return load(given)
    if isinstance(given, Case):
        return given
    raise InputError(f"a case or the path of its file is required; {formatted(given)} is given")
