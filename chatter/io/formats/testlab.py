"""Signals and FRFs as Testlab of Siemens exports them into MAT files: values over an axis of steps.

The layout follows files of others; none of the maker's own documents was at hand.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from chatter.io.formats.matlab_nodes import Node
from dynamics.frf.container import MeasurementError

_AXIS, _VALUES, _ABOUT = "x_values", "y_values", "function_record"
#: unit of the axis -> what it is
_AXES = {"s": "time", "Hz": "frequency"}


class _Function(NamedTuple):
    """Channels over one axis."""

    axis: str  # name and unit
    at: np.ndarray  # (n,)
    columns: dict[str, np.ndarray]  # (n,) by name and unit


def testlab_records(path: Path, variables: Mapping[str, Node]) -> dict[str, dict[str, Node]] | None:
    """Records of the functions of a Testlab file, by name; None of a file of another layout.

    Real functions of one time are channels of one record; every FRF is a record of its own.
    MeasurementError if a function lacks its axis or its unit is not read.
    """
    functions = list(_functions(path, variables))
    if not functions:
        return None
    records: dict[str, dict[str, Node]] = {}
    for name, one in functions:
        is_real = not any(np.iscomplexobj(values) for values in one.columns.values())
        shared = next((each for each in records.values() if _has_axis(each, one)), None)
        if is_real and shared is not None:
            shared |= {_free(heading, shared): values for heading, values in one.columns.items()}
            continue
        if is_real:
            records[name] = {one.axis: one.at, **one.columns}
            continue
        for heading, values in one.columns.items():
            label = heading.partition(" [")[0]
            records[label if label not in records else f"{name} {label}"] = {
                one.axis: one.at, heading: values,
            }  # fmt: skip
    return records


def _has_axis(record: Mapping[str, Node], one: _Function) -> bool:
    at = record.get(one.axis)
    return isinstance(at, np.ndarray) and np.array_equal(at, one.at)


def _free(heading: str, record: Mapping[str, Node]) -> str:
    """Heading that no column of a record has yet."""
    if heading not in record:
        return heading
    name, bracket, unit = heading.partition(" [")
    number = next(k for k in range(2, 10_000) if f"{name} {k}{bracket}{unit}" not in record)
    return f"{name} {number}{bracket}{unit}"


def _functions(path: Path, variables: Mapping[str, Node]) -> Iterator[tuple[str, _Function]]:
    for name, node in variables.items():
        for number, one in enumerate(node if isinstance(node, list) else [node]):
            if isinstance(one, dict) and _AXIS in one and _VALUES in one:
                called = f"{name}({number + 1})" if isinstance(node, list) else name
                yield called, _function(path, called, one)


def _function(path: Path, name: str, node: Mapping[str, Node]) -> _Function:
    values = _array(node[_VALUES], "values")
    start, step = _array(node[_AXIS], "start_value"), _array(node[_AXIS], "increment")
    if values is None or values.ndim > 2:
        raise MeasurementError(f"{path}: {name}.{_VALUES} has no vector or matrix of values")
    if start is None or step is None or start.size != 1 or step.size != 1 or not step.item() > 0.0:
        raise MeasurementError(
            f"{path}: {name}.{_AXIS} has no start_value and increment above zero: only functions "
            "at equal steps are read"
        )
    unit = _unit(node[_AXIS])
    if unit not in _AXES:
        raise MeasurementError(
            f"{path}: {name}.{_AXIS}: unit {unit!r} of the axis; s and Hz are read"
        )
    rows = values.reshape(-1, 1) if 1 in values.shape or values.ndim == 1 else values
    labels, own = _labels(node.get(_ABOUT), name, rows.shape[1]), _unit(node[_VALUES])
    columns: dict[str, np.ndarray] = {}
    for label, channel in zip(labels, rows.T, strict=True):
        columns[_free(f"{label} [{own}]" if own else label, columns)] = np.ascontiguousarray(
            channel
        )
    at = start.item() + step.item() * np.arange(len(rows))
    return _Function(f"{_AXES[unit]} [{unit}]", at, columns)


def _array(node: Node, field: str) -> np.ndarray | None:
    found = node.get(field) if isinstance(node, dict) else None
    return found if isinstance(found, np.ndarray) else None


def _unit(node: Node) -> str:
    """Label of the quantity of an axis or of values; empty where there is none."""
    quantity = node.get("quantity") if isinstance(node, dict) else None
    label = quantity.get("label") if isinstance(quantity, dict) else None
    return label.strip() if isinstance(label, str) else ""


def _labels(about: Node | None, name: str, count: int) -> list[str]:
    """Names of the channels of a function, without what headings set apart."""
    given = about.get("name") if isinstance(about, dict) else None
    each = given if isinstance(given, list) else [given]
    texts = [one for one in each if isinstance(one, str) and one.strip()]
    if len(texts) != count:
        texts = [name] if count == 1 else [f"{name} {k + 1}" for k in range(count)]
    return [one.translate(str.maketrans("[](),", "     ")).strip() for one in texts]
