"""Recordings of TNCscope, the oscilloscope of HEIDENHAIN controls: ``.sco`` in text.

A heading of lines that begin with a percent sign, a section for each curve (CHANNELTYPE, AXISTYPE,
DIMENSION, COUNT, CYCLETIME in microseconds), then rows of the time and a value for each curve.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from chatter.io.files import read_lines
from chatter.io.formats.format import Format
from chatter.io.table import Column, Table, table_of
from dynamics.frf.container import MeasurementError

_CURVE, _DATA = "%[CURVE", "%[DATA]"
_MICROSECOND = 1e-6


def read_scope(path: Path) -> Table:
    """Time of the cycle and curves, with type and axis in their headings: ``"v act. X [mm/min]"``.

    MeasurementError if there is no curve, curves are sampled differently, or a row is short; the
    message names file and line.
    """
    lines = read_lines(path)
    start = next((k for k, line in enumerate(lines) if line.strip().upper() == _DATA), None)
    curves = [] if start is None else _curves(lines[:start])
    if start is None or not curves:
        missing = _DATA if start is None else f"section {_CURVE}0]"
        raise MeasurementError(f"{path}: no {missing}; the file is none of TNCscope, or cut short")
    cycle, count = _sampling(path, curves)
    rows = [k for k in range(start + 1, len(lines)) if lines[k].strip()]
    if len(rows) < count:
        raise MeasurementError(
            f"{path}: {len(rows)} rows where COUNT says {count}; the file is cut short"
        )
    values = np.array([_row(path, lines, k, len(curves)) for k in rows[:count]])
    columns = [Column("time [s]", cycle * np.arange(count))]
    columns += [Column(_heading(one), values[:, k]) for k, one in enumerate(curves)]
    return table_of(path, columns, "curves")


def _curves(lines: Sequence[str]) -> list[dict[str, str]]:
    """Keys and values of each curve, in their order."""
    curves: list[dict[str, str]] = []
    inside = False
    for line in lines:
        text = line.strip()
        if text.startswith("%["):
            inside = text.upper().startswith(_CURVE)
            if inside:
                curves.append({})
        elif inside and "=" in text:
            key, _, value = text.lstrip("%").partition("=")
            curves[-1][key.strip().upper()] = value.strip()
    return curves


def _sampling(path: Path, curves: Sequence[Mapping[str, str]]) -> tuple[float, int]:
    """Cycle, s, and number of samples that all curves have."""
    told = {(one.get("CYCLETIME", ""), one.get("COUNT", "")) for one in curves}
    if len(told) != 1:
        cycles = ", ".join(f"{count} every {cycle} us" for cycle, count in sorted(told))
        raise MeasurementError(
            f"{path}: its curves are sampled differently ({cycles}); record them at one cycle time"
        )
    ((cycle, count),) = told
    try:
        found = _MICROSECOND * float(cycle), int(float(count))
    except ValueError:
        found = 0.0, 0
    if not (found[0] > 0.0 and found[1] > 0):
        raise MeasurementError(
            f"{path}: CYCLETIME={cycle}, COUNT={count}: both must be above 0; the file is damaged"
        )
    return found


def _heading(curve: Mapping[str, str]) -> str:
    name = " ".join(part for key in ("CHANNELTYPE", "AXISTYPE") if (part := curve.get(key, "")))
    unit = curve.get("DIMENSION", "")
    if unit.lower().startswith("id("):
        # a channel of the drive's signal processor: its number, and no unit
        return f"{name} {unit}"
    return f"{name} [{unit}]" if unit else name


def _row(path: Path, lines: Sequence[str], index: int, curves: int) -> list[float]:
    cells = [cell.strip() for cell in lines[index].rstrip().rstrip(";").split(";")]
    if len(cells) != curves + 1:
        raise MeasurementError(
            f"{path}: line {index + 1} has {len(cells)} columns; the time and {curves} curves are "
            "required"
        )
    try:
        return [float(cell.replace(",", ".")) for cell in cells[1:]]
    except ValueError:
        raise MeasurementError(
            f"{path}: line {index + 1}: {lines[index].strip()[:60]!r} are not numbers"
        ) from None


TNCSCOPE = Format(
    name="tncscope",
    label="recording of TNCscope",
    help="curves by type and axis with their dimension; the time by the cycle time",
    extensions=(".sco",),
    read_signals=read_scope,
    recognises=lambda head: b"%CHANNELTYPE" in head or b"%[CURVE" in head,
)
