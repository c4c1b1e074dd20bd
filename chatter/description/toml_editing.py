"""Change a TOML document in place, so that comments, order and units stay as they are."""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import tomlkit

from chatter.description.errors import InputError
from chatter.description.path import Step, join_path


class Layout(NamedTuple):
    """How a kind of file is written.

    Parameters
    ----------
    headed : frozenset of tuple of str
        Paths of tables, below the first level, that have a header of their own; ``"*"`` stands
        for any name. Other tables are written in one line.
    alternatives : mapping of str to str or tuple of str
        Giving one of these keys takes the other, or the others, away.
    """

    headed: frozenset[tuple[str, ...]]
    alternatives: Mapping[str, str | tuple[str, ...]]


class Containers(NamedTuple):
    """What new tables and lists of a document are made of."""

    table: Callable[[], Any]
    inline_table: Callable[[], Any]
    tables: Callable[[], Any]


#: of a document that is written as it was read
WRITTEN = Containers(tomlkit.table, tomlkit.inline_table, tomlkit.aot)
#: of its bare content
PLAIN = Containers(dict, dict, list)


def set_value(
    document: Any,
    steps: tuple[Step, ...],
    value: Any,
    layout: Layout,
    containers: Containers = WRITTEN,
) -> None:
    """Set, or with None remove, the value at a path; ``"*"`` stands for every place of a list.

    Tables on the way that are not there are made, and a table set one place past the end of a
    list is appended.

    InputError if the path leads through something that is not a table or list, or past the end of a
    list.
    """
    reached = [document]
    for index in range(len(steps) - 1):
        reached = [
            inner
            for item in reached
            for inner in _enter(
                item,
                steps,
                index,
                None if value is None else _empty(steps, index, layout, containers),
            )
        ]
    for item in reached:
        if isinstance(steps[-1], str) and steps[-1] != "*":
            _assign_key(item, steps, value, layout, containers)
        else:
            _assign_places(item, steps, value)


def _enter(item: Any, steps: tuple[Step, ...], index: int, empty: Any) -> list[Any]:
    """Return what the step at a place leads to; where there is nothing, put what is empty there.

    With None for it, nothing is put there and nothing reached.
    """
    step = steps[index]
    if isinstance(step, int) or step == "*":
        return [item[k] for k in _places(item, steps, index)]
    if not isinstance(item, dict):
        raise InputError(f"{join_path(steps)}: {join_path(steps[:index])} is not a table")
    if step not in item:
        if empty is None:
            return []
        item[step] = empty
    return [item[step]]


def _empty(steps: tuple[Step, ...], index: int, layout: Layout, containers: Containers) -> Any:
    if isinstance(steps[index + 1], int) or steps[index + 1] == "*":
        return containers.tables()
    headed = _is_headed(steps[: index + 1], layout)
    return containers.table() if headed else containers.inline_table()


def _is_headed(steps: tuple[Step, ...], layout: Layout) -> bool:
    """Whether a table at a path has a header of its own; other tables are written in one line."""
    return len(steps) == 1 or any(
        len(steps) == len(path)
        and all(key in ("*", step) for key, step in zip(path, steps, strict=True))
        for path in layout.headed
    )


def _places(item: Any, steps: tuple[Step, ...], index: int) -> range:
    step, where = steps[index], join_path(steps[:index])
    if not isinstance(item, list):
        raise InputError(f"{join_path(steps)}: {where} is not a list")
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


def _assign_key(
    item: Any, steps: tuple[Step, ...], value: Any, layout: Layout, containers: Containers
) -> None:
    if not isinstance(item, dict):
        raise InputError(f"{join_path(steps)}: {join_path(steps[:-1])} is not a table")
    key = steps[-1]
    if value is None:
        item.pop(key, None)
        return
    others = layout.alternatives.get(key, ())
    for other in (others,) if isinstance(others, str) else others:
        item.pop(other, None)
    in_one_line = isinstance(value, dict) and not _is_headed(steps, layout)
    item[key] = _filled(containers.inline_table(), value) if in_one_line else value


def _assign_places(item: Any, steps: tuple[Step, ...], value: Any) -> None:
    if isinstance(item, list) and steps[-1] == len(item) and isinstance(value, dict):
        item.append(value)
        return
    for k in reversed(_places(item, steps, len(steps) - 1)):
        if value is None:
            del item[k]
        else:
            item[k] = value


def _filled(table: Any, content: dict) -> Any:
    table.update(content)
    return table
