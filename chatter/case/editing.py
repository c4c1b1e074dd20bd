"""Change a TOML document in place, so that comments, order and units stay as they are."""

from __future__ import annotations

from typing import Any

import tomlkit

from chatter.case.path import Step, join_path
from chatter.errors import InputError

#: giving one of these keys takes the other away
_ALTERNATIVES = {
    "mass": "stiffness",
    "stiffness": "mass",
    "duration": "revolutions",
    "revolutions": "duration",
}


def set_value(document: Any, steps: tuple[Step, ...], value: Any) -> None:
    """Set, or with None remove, the value at a path; ``"*"`` stands for every place of a list.

    Tables on the way that are not there are made, and a table set one place past the end of a
    list is appended.

    Raises
    ------
    InputError
        If the path leads through something that is no table or list, or past the end of a list.
    """
    containers = [document]
    for place in range(len(steps) - 1):
        containers = [
            inner for item in containers for inner in _enter(item, steps, place, value is None)
        ]
    for item in containers:
        if isinstance(steps[-1], str) and steps[-1] != "*":
            _assign_key(item, steps, value)
        else:
            _assign_places(item, steps, value)


def _enter(item: Any, steps: tuple[Step, ...], place: int, removing: bool) -> list[Any]:
    """Return what the step at a place leads to, made if it is not there and not to be removed."""
    step = steps[place]
    if isinstance(step, int) or step == "*":
        return [item[k] for k in _places(item, steps, place)]
    if not isinstance(item, dict):
        raise InputError(f"{join_path(steps)}: {join_path(steps[:place])} is no table")
    if step not in item:
        if removing:
            return []
        item[step] = _empty(steps, place)
    return [item[step]]


def _empty(steps: tuple[Step, ...], place: int) -> Any:
    if isinstance(steps[place + 1], int) or steps[place + 1] == "*":
        return tomlkit.aot()
    return tomlkit.table() if _is_section(steps[: place + 1]) else tomlkit.inline_table()


def _is_section(steps: tuple[Step, ...]) -> bool:
    """Whether a table at a path has a header of its own; other tables are written in one line."""
    return len(steps) == 1 or (len(steps) == 2 and steps[0] == "friction")


def _places(item: Any, steps: tuple[Step, ...], place: int) -> range:
    step, where = steps[place], join_path(steps[:place])
    if not isinstance(item, list):
        raise InputError(f"{join_path(steps)}: {where} is no list")
    if not len(item):
        raise InputError(f"{join_path(steps)}: {where} has no entries")
    if step == "*":
        return range(len(item))
    if step >= len(item):
        raise InputError(
            f"{join_path(steps)}: {where} has {len(item)} entries; "
            f"the last is {where}[{len(item) - 1}]"
        )
    return range(step, step + 1)


def _assign_key(item: Any, steps: tuple[Step, ...], value: Any) -> None:
    if not isinstance(item, dict):
        raise InputError(f"{join_path(steps)}: {join_path(steps[:-1])} is no table")
    key = steps[-1]
    if value is None:
        item.pop(key, None)
        return
    if key in _ALTERNATIVES:
        item.pop(_ALTERNATIVES[key], None)
    item[key] = _inline(value) if isinstance(value, dict) and not _is_section(steps) else value


def _assign_places(item: Any, steps: tuple[Step, ...], value: Any) -> None:
    if isinstance(item, list) and steps[-1] == len(item) and isinstance(value, dict):
        item.append(value)
        return
    for k in reversed(_places(item, steps, len(steps) - 1)):
        if value is None:
            del item[k]
        else:
            item[k] = value


def _inline(table: dict) -> Any:
    inline = tomlkit.inline_table()
    inline.update(table)
    return inline
