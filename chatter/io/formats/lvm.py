"""LVM text files of LabVIEW: segments of channels, each with its heading of properties.

Source of the layout: National Instruments, "Specification for the LabVIEW Measurement File (.lvm)".
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from chatter.description.arrays import Array
from chatter.io.files import read_lines
from chatter.io.formats.format import Format
from chatter.io.formats.frf_columns import frfs_of_tables
from chatter.io.formats.records import of_file, only_record
from chatter.io.table import Column, Table, table_of
from dynamics.frf.container import MeasurementError

_MAGIC = "LabVIEW Measurement"
_END = "***End_of_Header***"
_SEPARATORS = {"tab": "\t", "comma": ","}
#: dimension of the abscissa -> heading
_ABSCISSAS = {"time": "time [s]", "frequency": "frequency [Hz]"}


@dataclass(frozen=True)
class _Layout:
    """What the heading of the file says of all segments."""

    separator: str
    decimal: str
    abscissas: str  # "one", "multi" or "no"


@dataclass(frozen=True)
class _Segment:
    headings: tuple[str, ...]  # of the abscissa, then of the channels
    values: Array  # (channels + 1, samples)


def read_records(path: Path) -> Mapping[str, Table]:
    """Channels over time, or frequency; segments of the same channels one behind the other.

    Where the time begins anew in a segment, every segment is a record. MeasurementError if the file
    is none of LabVIEW, cut short, or its segments or abscissas differ; the message names file and
    line.
    """
    lines = read_lines(path)
    if not lines[0].lstrip("\ufeff").startswith(_MAGIC):
        raise MeasurementError(f'{path}: the first line is not "{_MAGIC}"')
    end = _end_of_heading(path, lines, 0)
    layout = _layout(path, lines[:end])
    segments, position = [], end + 1
    while (position := _next_text(lines, position)) < len(lines):
        segment, position = _segment(path, lines, position, layout)
        segments.append(segment)
    if not segments:
        raise MeasurementError(f"{path}: holds no segment of numbers")
    headings = segments[0].headings
    if any(one.headings != headings for one in segments):
        raise MeasurementError(
            f"{path}: its {len(segments)} segments are of different channels; save one a file"
        )
    whole = np.concatenate([one.values for one in segments], axis=1)
    if np.all(np.diff(whole[0]) > 0.0):
        return {"": _table(path, headings, whole)}
    for number, one in enumerate(segments, start=1):
        if np.any(np.diff(one.values[0]) <= 0.0):
            raise MeasurementError(
                f"{path}: the {headings[0].split()[0]} does not rise over segment {number} of "
                f"{len(segments)}"
            )
    tables = (_table(path, headings, one.values) for one in segments)
    return of_file(path, {f"segment {k}": one for k, one in enumerate(tables, start=1)})


def _table(path: Path, headings: Sequence[str], values: Array) -> Table:
    return table_of(path, [Column(h, v) for h, v in zip(headings, values, strict=True)], "channels")


def _layout(path: Path, lines: Sequence[str]) -> _Layout:
    words = [line.replace(",", "\t", 1).split("\t") for line in lines]
    named = {one[0].strip().lower(): one[1].strip() for one in words if len(one) > 1}
    # a decimal comma stands where the line above would split it
    raw = next((line for line in lines if line.startswith("Decimal_Separator")), "")
    decimal = "," if raw.rstrip().endswith(",") else "."
    separator = named.get("separator", "tab").lower()
    if separator not in _SEPARATORS:
        raise MeasurementError(f'{path}: Separator is "{separator}"; it is Tab or Comma')
    abscissas = named.get("x_columns", "one").lower()
    if abscissas not in ("one", "multi", "no"):
        raise MeasurementError(f'{path}: X_Columns is "{abscissas}"; it is One, Multi or No')
    return _Layout(_SEPARATORS[separator], decimal, abscissas)


def _segment(path: Path, lines: Sequence[str], start: int, layout: _Layout) -> tuple[_Segment, int]:
    """One segment that begins on a line, and the line behind it."""
    end = _end_of_heading(path, lines, start)
    rows = [line.split(layout.separator) for line in lines[start:end]]
    properties = {row[0].strip(): [cell.strip() for cell in row[1:]] for row in rows}
    count = int(_number(path, start, (properties.get("Channels") or [""])[0], layout))
    if end + 1 >= len(lines) or count < 1:
        raise MeasurementError(f"{path}: line {end + 1}: the segment holds no channels")
    names = [cell.strip() for cell in lines[end + 1].split(layout.separator)]
    stop = end + 2
    while stop < len(lines) and lines[stop].strip():
        stop += 1
    # an abscissa before each channel, or one before all
    places = [2 * k + 1 if layout.abscissas == "multi" else k + 1 for k in range(count)]
    wanted = sorted({*places, *(place - 1 for place in places if layout.abscissas == "multi"), 0})
    if layout.abscissas == "no":
        wanted = places
    if len(names) <= max(places):
        raise MeasurementError(f"{path}: line {end + 2}: names {len(names)} columns of {count}")
    cells = {place: np.empty(stop - end - 2) for place in wanted}
    for row, index in enumerate(range(end + 2, stop)):
        parts = lines[index].split(layout.separator)
        for place in wanted:
            text = parts[place] if place < len(parts) else ""
            cells[place][row] = _number(path, index, text, layout)
    units = _units(properties, places)
    headings = [
        f"{names[place]} [{unit}]" if unit else names[place]
        for place, unit in zip(places, units, strict=True)
    ]
    dimension = (properties.get("X_Dimension") or ["Time"])[0].lower()
    abscissa = _abscissa(path, start, cells, places, properties, layout)
    values = np.stack([abscissa, *(cells[place] for place in places)])
    return _Segment((_ABSCISSAS.get(dimension, dimension), *headings), values), stop


def _units(properties: dict[str, list[str]], places: Sequence[int]) -> list[str]:
    """Unit of each channel, empty where it has none."""
    cells = properties.get("Y_Unit_Label", [])
    # LabVIEW leaves the cells above further abscissas empty, other writers leave none
    are_above = not any(cells[1 : places[-1] : 2])
    chosen = [place - 1 if are_above else k for k, place in enumerate(places)]
    return [cells[k] if k < len(cells) else "" for k in chosen]


def _abscissa(
    path: Path,
    line: int,
    cells: dict[int, Array],
    places: Sequence[int],
    properties: dict[str, list[str]],
    layout: _Layout,
) -> Array:
    """Abscissa that all channels have; of start and step where there is no column of it."""
    if layout.abscissas == "no":
        start = _numbers(path, line, properties.get("X0"), layout)
        step = _numbers(path, line, properties.get("Delta_X"), layout)
        size = cells[places[0]].size
        several = [a + b * np.arange(size) for a, b in zip(start, step, strict=False)]
        several = several[: len(places)]
    else:
        several = [cells[place - 1] for place in places] if layout.abscissas == "multi" else []
        several = several or [cells[0]]
    if any(not np.array_equal(one, several[0]) for one in several):
        raise MeasurementError(f"{path}: line {line + 1}: the channels are not sampled together")
    return several[0]


def _numbers(path: Path, line: int, cells: Sequence[str] | None, layout: _Layout) -> list[float]:
    """Numbers of a property; behind them LabVIEW leaves a cell empty for the comments."""
    given = [text for text in cells or () if text]
    return [_number(path, line, text, layout) for text in given or [""]]


def _end_of_heading(path: Path, lines: Sequence[str], start: int) -> int:
    for index in range(start, len(lines)):
        if lines[index].strip().rstrip(",").strip() == _END:
            return index
    raise MeasurementError(f"{path}: line {start + 1}: no {_END} behind it; the file is cut short")


def _next_text(lines: Sequence[str], position: int) -> int:
    while position < len(lines) and not lines[position].strip():
        position += 1
    return position


def _number(path: Path, index: int, text: str, layout: _Layout) -> float:
    text = text.strip()
    try:
        return float(text.replace(",", ".") if layout.decimal == "," else text)
    except ValueError:
        raise MeasurementError(f"{path}: line {index + 1}: {text[:40]!r} is not a number") from None


LVM = Format(
    name="lvm",
    label="LVM of LabVIEW",
    help="channels with their unit label; time of a column or of start and step; segments of which "
    "each begins anew are records",
    extensions=(".lvm",),
    read_frfs=lambda path: frfs_of_tables(read_records(path)),
    read_signals=only_record(read_records),
    read_records=read_records,
    recognises=lambda head: head.lstrip(b"\xef\xbb\xbf").startswith(_MAGIC.encode()),
)
