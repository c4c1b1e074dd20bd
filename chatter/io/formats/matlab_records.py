"""Records in the variables of a MAT file: structure arrays, structures, signals with their time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from chatter.io.formats.matlab_nodes import Node, Variables
from chatter.io.formats.named_arrays import table_of_arrays
from chatter.io.formats.testlab import testlab_records
from chatter.io.table import Table
from dynamics.frf.container import MeasurementError

#: share of the step by which those of a time differ at the most
_EQUAL = 0.1
#: fields of a signal that hold its time, its numbers and its unit, in lower case
_TIMES = ("t", "time")
_VALUES = ("y", "data", "values", "value", "signal")
_UNITS = ("unit", "units")


def tables_of_variables(path: Path, variables: Variables) -> dict[str, Table]:
    """Tables of the records that the variables hold, by name.

    The elements of a structure array are a record each, and so are structures with the same
    fields, two or more vectors beside the time, and matrices of as many columns whose first one
    is a time; what stands beside them, such as a sampling rate, holds for all. Structures of one
    vector, with or without its time, are signals of one record. Everything else is one record.
    MeasurementError if there is no array of numbers, or those of a record differ in length or time.
    """
    of_testlab = testlab_records(path, variables)
    if of_testlab is not None:
        return {name: table_of_arrays(path, dict(_leaves(one))) for name, one in of_testlab.items()}
    records, common = _records(variables)
    if not records:
        return {"": table_of_arrays(path, dict(_leaves(_signals(path, variables))))}
    shared = {name: one for name, one in _leaves(common) if one.size == 1}
    return {
        name: table_of_arrays(path, {**shared, **dict(_leaves(_signals(path, record)))})
        for name, record in records.items()
    }


def _records(variables: Variables) -> tuple[dict[str, Variables], Variables]:
    """Records by name, and what stands beside them; none where all is one record."""
    matrices = _matrices_with_time(variables)
    if matrices:
        return matrices, {}
    if len(variables) == 1:
        ((name, only),) = variables.items()
        if isinstance(only, dict):
            inner, beside = _records(only)
            return {f"{name}.{key}": one for key, one in inner.items()}, beside
    found: dict[str, Variables] = {}
    for name, node in variables.items():
        if isinstance(node, list):
            elements = [one for one in node if isinstance(one, dict) and _vectors(one)]
            found |= {f"{name}({k + 1})": one for k, one in enumerate(elements)}
        elif isinstance(node, dict) and len(_vectors(node)) > 1:
            found[name] = node
    if len(found) < 2 or len({frozenset(map(str.lower, one)) for one in found.values()}) > 1:
        return {}, {}
    names = {name.partition("(")[0] for name in found} | set(found)
    return found, {name: node for name, node in variables.items() if name not in names}


def _matrices_with_time(variables: Variables) -> dict[str, Variables]:
    """Matrices of as many columns, the first of each a time; none where there are not two."""
    arrays = {n: a for n, a in variables.items() if isinstance(a, np.ndarray) and a.size > 1}
    if len(arrays) < 2 or any(isinstance(one, (dict, list)) for one in variables.values()):
        return {}
    if any(one.ndim != 2 or one.dtype.kind not in "fiu" for one in arrays.values()):
        return {}
    rows = [one if one.shape[0] > one.shape[1] else one.T for one in arrays.values()]
    counts = {one.shape[1] for one in rows}
    if len(counts) > 1 or counts == {1} or not all(_is_time(one[:, 0]) for one in rows):
        return {}
    return {name: {name: one} for name, one in arrays.items()}


def _is_time(values: np.ndarray) -> bool:
    """Whether numbers increase by equal steps."""
    steps = np.diff(values.astype(float))
    return bool(np.all(steps > 0.0) and np.ptp(steps) < _EQUAL * steps.mean())


def _vectors(node: Mapping[str, Node]) -> list[str]:
    """Fields of a structure that hold more than one number, but for its time."""
    return [
        name
        for name, one in node.items()
        if isinstance(one, np.ndarray) and one.size > 1 and name.lower() not in _TIMES
    ]


def _signals(path: Path, variables: Variables) -> Variables:
    """Variables with every structure of one signal as its vector; their time stands beside them."""
    found: dict[str, Node] = {}
    for name, node in variables.items():
        signal = _signal(node)
        if signal is None:
            found[name] = node
            continue
        values, time, unit = signal
        found[f"{name} [{unit}]" if unit else name] = values
        if time is not None and not any(key.lower() in _TIMES for key in variables):
            first = found.setdefault("time", time)
            if isinstance(first, np.ndarray) and not np.array_equal(first.ravel(), time.ravel()):
                raise MeasurementError(
                    f"{path}: {name} has other times than the signals before it; save signals of "
                    "one clock"
                )
    return found


def _signal(node: Node) -> tuple[np.ndarray, np.ndarray | None, str] | None:
    """Vector, time and unit of a structure that is a signal; None of any other."""
    if not isinstance(node, dict):
        return None
    vectors = _vectors(node)
    if len(vectors) != 1 or vectors[0].lower() not in _VALUES:
        return None
    arrays = {name.lower(): one for name, one in node.items() if isinstance(one, np.ndarray)}
    texts = {name.lower(): one for name, one in node.items() if isinstance(one, str)}
    values = arrays[vectors[0].lower()]
    times = [arrays[one] for one in _TIMES if one in arrays and arrays[one].size == values.size]
    return values, times[0] if times else None, next((texts[u] for u in _UNITS if u in texts), "")


def _leaves(variables: Variables, prefix: str = "") -> Iterator[tuple[str, np.ndarray]]:
    """Arrays of numbers of variables and of the fields of single structures, by dotted name."""
    for name, node in variables.items():
        if isinstance(node, np.ndarray):
            yield f"{prefix}{name}", node
        elif isinstance(node, dict):
            yield from _leaves(node, f"{prefix}{name}.")
        elif isinstance(node, list) and any(isinstance(one, (dict, np.ndarray)) for one in node):
            yield from _leaves(_elements(node), f"{prefix}{name}")


def _elements(node: list[Node]) -> dict[str, Node]:
    """Elements of a structure or cell array by their numbers."""
    # in brackets a number would be read as a unit
    return {f" {k + 1}": one for k, one in enumerate(node)}
