"""Calls that take a machine, or the path of its file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Concatenate, ParamSpec, TypeVar

from chatter.description.described_or_path import takes_described_or_path
from chatter.description.machine.machine_file import MachineFile, load_machine

Rest = ParamSpec("Rest")
Result = TypeVar("Result")


def takes_machine_or_path(
    function: Callable[Concatenate[MachineFile, Rest], Result],
) -> Callable[Concatenate[MachineFile | str | Path, Rest], Result]:
    """Give a function of a machine the path of a machine file instead, where that is given."""
    return takes_described_or_path(function, MachineFile, load_machine)
