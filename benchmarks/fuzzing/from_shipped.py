"""Strategies of shipped documents with a few keys changed, added or missing."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from typing import Any

from hypothesis import strategies as st

from benchmarks.fuzzing.from_schema import WILD, Schema, alternatives, values

Path = tuple[Any, ...]

_WAYS = (*["schema"] * 3, *["scaled"] * 4, *["add"] * 2, "wild", "missing", "twice")
_EXPONENTS = (300, -300, 12, -12, 6, -6, *[3, -3, 2, -2, 1, -1] * 2)


def paths(data: Any, path: Path = ()) -> Iterator[Path]:
    """Paths of all values of a document, those of tables and lists included."""
    if path:
        yield path
    entries = ()
    if isinstance(data, (dict, list)):
        entries = data.items() if isinstance(data, dict) else enumerate(data)
    for key, value in entries:
        yield from paths(value, (*path, key))


def at(data: Any, path: Path) -> Any:
    """Value at a path."""
    for key in path:
        data = data[key]
    return data


def nodes_at(schema: Schema, path: Path) -> list[Schema]:
    """Nodes of the schema that a path of a document may follow; none where it has no such path."""
    found = [schema]
    for key in path:
        found = [one for node in found for one in _below(node, key, schema)]
    return found


def _below(node: Schema, key: Any, root: Schema) -> Iterator[Schema]:
    for one in alternatives(node, root):
        if isinstance(key, int):
            prefix = one.get("prefixItems", [])
            below = prefix[key] if key < len(prefix) else one.get("items")
        else:
            below = one.get("properties", {}).get(key, one.get("additionalProperties"))
        if isinstance(below, dict):
            yield below


def _scaled(value: Any, factor: float) -> Any:
    if isinstance(value, bool):
        return not value
    if isinstance(value, int) and abs(value * factor) < 1e18:
        return int(value * factor)
    if isinstance(value, (int, float)):
        return value * factor
    if isinstance(value, list):
        return [_scaled(one, factor) for one in value]
    if not isinstance(value, str):
        return value
    number, _, unit = value.partition(" ")
    try:
        return f"{float(number) * factor:g} {unit}".strip()
    except ValueError:
        return value + value


@st.composite
def _changed(draw: st.DrawFn, data: dict[str, Any], schema: Schema) -> None:
    """One change in place."""
    found = list(paths(data))
    # a table drawn anew is nearly always refused: mostly single values change
    single = [path for path in found if not isinstance(at(data, path), (dict, list))]
    path = draw(st.sampled_from(found) if draw(st.integers(0, 5)) == 0 else st.sampled_from(single))
    table, key = at(data, path[:-1]), path[-1]
    nodes = nodes_at(schema, path)
    way = draw(st.sampled_from(_WAYS))
    if way == "schema" and nodes:
        table[key] = draw(values(draw(st.sampled_from(nodes)), schema))
    elif way == "add" and nodes:
        _add(draw, table, path, schema)
    elif way == "missing":
        del table[key]
    elif way == "twice" and isinstance(table, list):
        table.insert(key, copy.deepcopy(table[key]))
    elif way == "wild":
        table[key] = draw(WILD)
    else:
        sign = draw(st.sampled_from([1.0, 1.0, 1.0, 1.0, -1.0, 0.0]))
        table[key] = _scaled(table[key], sign * 10.0 ** draw(st.sampled_from(_EXPONENTS)))


def _add(draw: st.DrawFn, table: Any, path: Path, schema: Schema) -> None:
    """Add a key that the schema has beside that of the path."""
    beside = {
        name: node
        for parent in nodes_at(schema, path[:-1])
        for one in alternatives(parent, schema)
        for name, node in one.get("properties", {}).items()
    }
    if isinstance(table, dict) and beside:
        name = draw(st.sampled_from(sorted(beside)))
        table[name] = draw(values(beside[name], schema))


@st.composite
def changed(draw: st.DrawFn, shipped: dict[str, Any], schema: Schema) -> dict[str, Any]:
    """Shipped document with one to three changes."""
    data = copy.deepcopy(shipped)
    for _ in range(draw(st.integers(1, 3))):
        if data:
            draw(_changed(data, schema))
    return data
