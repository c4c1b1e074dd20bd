"""Graphs of MR Configurator, the set-up program of Mitsubishi servo amplifiers, as CSV.

Title, number and interval of samples, then a line of channels, a line of what each shows (the unit
of the time stands before it), and rows. Units of the channels are not in the file.
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from chatter.io.files import read_lines
from chatter.io.formats.format import Format
from chatter.io.table import Column, Table, table_of
from dynamics.frf.container import MeasurementError

_INTERVAL = "Sampling time interval("
_UNUSED = "not selected"


def read_graph(path: Path) -> Table:
    """Time and the channels that were selected.

    MeasurementError if a part of the heading is missing or a row is not of numbers; the message
    names file and line.
    """
    rows = list(csv.reader(read_lines(path)))
    first = next((k for k, row in enumerate(rows) if row[:1] == ["Time"]), None)
    if first is None or first + 2 >= len(rows):
        raise MeasurementError(
            f'{path}: no line of channels that begins with "Time", or no rows behind it; the file '
            "is cut short"
        )
    shown = [cell.strip() for cell in rows[first + 1]]
    chosen = [k for k, name in enumerate(shown) if k > 0 and name.lower() != _UNUSED]
    values = [
        _numbers(path, k, rows[k], len(shown)) for k in range(first + 2, len(rows)) if any(rows[k])
    ]
    table = np.array(values)
    columns = [Column(f"time [{shown[0]}]", table[:, 0])]
    columns += [Column(shown[k], table[:, k]) for k in chosen]
    return table_of(path, columns, "channels")


def _numbers(path: Path, index: int, row: list[str], count: int) -> list[float]:
    try:
        numbers = [float(cell) for cell in row]
    except ValueError:
        raise MeasurementError(
            f"{path}: line {index + 1}: {','.join(row)[:60]!r} are not numbers"
        ) from None
    if len(numbers) != count:
        raise MeasurementError(
            f"{path}: line {index + 1} has {len(numbers)} columns where the heading has {count}"
        )
    return numbers


MR_CONFIGURATOR = Format(
    name="mr-configurator",
    label="graph of MR Configurator",
    help="the channels selected, without units; time in the unit of the file",
    extensions=(".csv",),
    read_signals=read_graph,
    recognises=lambda head: _INTERVAL.encode() in head[:1000],
)
