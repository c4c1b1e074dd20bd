"""Change a TOML document in place, so that comments, order and units stay as they are."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import tomlkit

from chatter.case.path import Step, join_path
from chatter.errors import InputError


class Layout(NamedTuple):
    """How a kind of file is written.

    Parameters
    ----------
    headed : frozenset of tuple of str
        Paths of tables, below the first level, that have a header of their own; ``"*"`` stands
        for any name. Other tables are written in one line.
    alternatives : mapping of str to str
        Giving one of these keys takes the other away.
    """

    headed: frozenset[tuple[str, ...]]
    alternatives: Mapping[str, str]


def set_value(document: Any, steps: tuple[Step, ...], value: Any, layout: Layout) -> None:
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
            inner
            for item in containers
            for inner in _enter(item, steps, place, value is None, layout)
        ]
    for item in containers:
        if isinstance(steps[-1], str) and steps[-1] != "*":
            _assign_key(item, steps, value, layout)
        else:
            _assign_places(item, steps, value)


def _enter(
    item: Any, steps: tuple[Step, ...], place: int, removing: bool, layout: Layout
) -> list[Any]:
    """Return what the step at a place leads to, made if it is not there and not to be removed."""
    step = steps[place]
    if isinstance(step, int) or step == "*":
        return [item[k] for k in _places(item, steps, place)]
    if not isinstance(item, dict):
        raise InputError(f"{join_path(steps)}: {join_path(steps[:place])} is no table")
    if step not in item:
        if removing:
            return []
        item[step] = _empty(steps, place, layout)
    return [item[step]]


def _empty(steps: tuple[Step, ...], place: int, layout: Layout) -> Any:
    if isinstance(steps[place + 1], int) or steps[place + 1] == "*":
        return tomlkit.aot()
    headed = _is_headed(steps[: place + 1], layout)
    return tomlkit.table() if headed else tomlkit.inline_table()


def _is_headed(steps: tuple[Step, ...], layout: Layout) -> bool:
    """Whether a table at a path has a header of its own; other tables are written in one line."""
    return len(steps) == 1 or any(
        len(steps) == len(path)
        and all(key in ("*", step) for key, step in zip(path, steps, strict=True))
        for path in layout.headed
    )


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


def _assign_key(item: Any, steps: tuple[Step, ...], value: Any, layout: Layout) -> None:
    if not isinstance(item, dict):
        raise InputError(f"{join_path(steps)}: {join_path(steps[:-1])} is no table")
    key = steps[-1]
    if value is None:
        item.pop(key, None)
        return
    if key in layout.alternatives:
        item.pop(layout.alternatives[key], None)
    in_one_line = isinstance(value, dict) and not _is_headed(steps, layout)
    item[key] = _inline(value) if in_one_line else value


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
