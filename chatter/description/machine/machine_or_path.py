"""Calls that take a machine, or the path of its file."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Concatenate, ParamSpec, TypeVar

from chatter.description.machine.machine_file import MachineFile, load_machine

Rest = ParamSpec("Rest")
Result = TypeVar("Result")


def takes_machine_or_path(
    function: Callable[Concatenate[MachineFile, Rest], Result],
) -> Callable[Concatenate[MachineFile | str | Path, Rest], Result]:
    """Give a function of a machine the path of a machine file, where that is what is given."""

    @wraps(function)
    def taking(file: MachineFile | str | Path, *args: Rest.args, **kwargs: Rest.kwargs) -> Result:
        machine = load_machine(file) if isinstance(file, (str, Path)) else file
        return function(machine, *args, **kwargs)

    return taking
