"""Set points of axes in a record: what the program writes itself, or the trace of a control."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from chatter.description.arrays import Array
from chatter.description.errors import InputError
from chatter.description.units import dimension_of
from chatter.io.stated_columns import read_signal_table
from chatter.io.table import Table
from chatter.io.trace_headings import (
    COMMANDED,
    DEVIATIONS,
    TIME,
    headings_of,
    plain_name,
    split_trace_heading,
    unit_of_trace,
)
from dynamics.frf.container import MeasurementError

_EXAMPLE_UNITS = {"s": "ms", "m": "mm"}


def recorded_positions(path: Path, axes: Sequence[str]) -> tuple[Array, Array]:
    """Times (n,), s, and set points (n, axes), m, of a record.

    A set point stands under the name of its axis, under ``"X set"``, or under a heading of a
    control that names the axis and a commanded length: ``"Lagesollwert X [mm]"``, ``"s nominal
    X/mm"``. InputError if the file cannot be read or lacks a column, or several may be meant.
    """
    try:
        table = read_signal_table(path)
        time = _numbers(path, table, _of_time(path, table), "s")
        columns = [_numbers(path, table, _of_axis(path, table, axis), "m") for axis in axes]
    except MeasurementError as error:
        raise InputError(str(error)) from error
    return time, np.column_stack(columns)


def _of_time(path: Path, table: Table) -> int:
    found = [index for index, name in enumerate(_names(table)) if TIME.search(name)]
    if len(found) != 1:
        count = f"{len(found)} columns" if found else "no column"
        raise InputError(f'{path}: {count} "time"; there are {headings_of(table)}')
    return found[0]


def _of_axis(path: Path, table: Table, axis: str) -> int:
    names = _names(table)
    for plain in (f"{axis} set".lower(), axis.lower()):
        if plain in names:
            return names.index(plain)
    found = [
        index
        for index, name in enumerate(names)
        if axis.lower() in name.split()
        and COMMANDED.search(name)
        and not DEVIATIONS.search(name)
        and _is_length(table, index)
    ]
    if len(found) == 1:
        return found[0]
    if found:
        several = ", ".join(f'"{table.columns[index].heading}"' for index in found)
        raise InputError(
            f"{path}: {several} may each be the set point of {axis}; head one of them "
            f'"{axis} set [mm]"'
        )
    raise InputError(
        f'{path}: no column "{axis}" or "{axis} set", nor one of a control such as "s nominal '
        f'{axis} [mm]"; there are {headings_of(table)}'
    )


def _is_length(table: Table, index: int) -> bool:
    unit = unit_of_trace(split_trace_heading(table.columns[index].heading)[1])
    return unit is not None and unit.dimension == dimension_of("m")


def _numbers(path: Path, table: Table, index: int, si: str) -> Array:
    column = table.columns[index]
    if column.content is not None:
        return table.numbers(index)
    name, unit = split_trace_heading(column.heading)
    example = f'"{name} [{_EXAMPLE_UNITS[si]}]"'
    if not unit:
        raise InputError(
            f'{path}: "{column.heading}" has no unit; write it in brackets, such as {example}'
        )
    found = unit_of_trace(unit)
    if found is None or found.dimension != dimension_of(si):
        raise InputError(
            f'{path}: "{column.heading}" has the unit "{unit}"; such as {example} is wanted'
        )
    return found.factor * table.numbers(index)


def _names(table: Table) -> list[str]:
    return [plain_name(split_trace_heading(column.heading)[0]) for column in table.columns]
