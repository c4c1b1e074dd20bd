"""Calls that take a case, or the path of its file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Concatenate, ParamSpec, TypeVar

from chatter.description.case import Case, load
from chatter.description.described_or_path import takes_described_or_path

Rest = ParamSpec("Rest")
Result = TypeVar("Result")


def takes_case_or_path(
    function: Callable[Concatenate[Case, Rest], Result],
) -> Callable[Concatenate[Case | str | Path, Rest], Result]:
    """Give a function of a case the path of a case file instead, where that is given."""
    return takes_described_or_path(function, Case, load)
