"""Measured text files: opening them, telling text from junk, splitting tables of numbers."""

from __future__ import annotations

import math
import re
from array import array
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dynamics.frf.container import MeasurementError

#: largest text file read, bytes: a record of ten million samples is smaller
LARGEST_TEXT_FILE = 512 * 1024**2

_COMMENT = ("#", "%", "//", "!")
_DECIMAL_COMMA = re.compile(r"[+-]?\d+(,\d+)?([eE][+-]?\d+)?")
_BYTE_ORDER_MARKS = {
    b"\xef\xbb\xbf": "utf-8-sig",
    b"\xff\xfe": "utf-16",
    b"\xfe\xff": "utf-16",
}


@dataclass(frozen=True)
class Column:
    """Heading of one column: its name and unit, empty where the file gives none."""

    name: str
    unit: str


@dataclass(frozen=True)
class Table:
    """Columns of numbers with the text that stood around them.

    Parameters
    ----------
    columns : tuple of Column
        Headings, empty where the file has none.
    values : (n, m) array of float
        Finite numbers.
    line_numbers : (n,) array of int
        Line of the file each row stood on, from 1.
    """

    columns: tuple[Column, ...]
    values: NDArray[np.float64]
    line_numbers: NDArray[np.int64]


def require_readable(path: Path, largest: int) -> None:
    """Raise MeasurementError where `path` is no file, is empty, or exceeds `largest` bytes."""
    if path.is_dir():
        raise MeasurementError(f"{path}: is a folder; name a file in it")
    if not path.exists():
        raise MeasurementError(f"{path}: no such file")
    if not path.is_file():
        raise MeasurementError(f"{path}: is not an ordinary file")
    size = path.stat().st_size
    if size == 0:
        raise MeasurementError(f"{path}: the file is empty")
    if size > largest:
        raise MeasurementError(
            f"{path}: the file has {size / 1024**2:.0f} MB; at most {largest / 1024**2:.0f} MB "
            "are read"
        )


def read_head(path: Path, size: int = 65536) -> bytes:
    """Return the first bytes of a file, for telling its format."""
    try:
        with path.open("rb") as stream:
            return stream.read(size)
    except OSError as error:
        raise MeasurementError(f"{path}: cannot be read ({error.strerror})") from error


def decoded(raw: bytes, path: Path) -> str:
    """Decode text (UTF-8, UTF-16 with its mark, or Windows-1252); refuse binary content."""
    for mark, encoding in _BYTE_ORDER_MARKS.items():
        if raw.startswith(mark):
            return raw.decode(encoding, errors="replace")
    control = sum(raw[:4096].count(byte) for byte in range(32) if byte not in b"\t\n\r\f\x1a")
    if b"\0" in raw or control > 0.01 * min(len(raw), 4096):
        raise MeasurementError(f"{path}: is not text (binary content)")
    try:
        return raw.decode("utf-8")
    except UnicodeDecodeError:
        return raw.decode("cp1252", errors="replace")


def read_lines(path: Path) -> list[str]:
    """Read the lines of a text file.

    Raises
    ------
    MeasurementError
        If the file is missing, a folder, empty, too large, unreadable or not text.
    """
    require_readable(path, LARGEST_TEXT_FILE)
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise MeasurementError(f"{path}: cannot be read ({error.strerror})") from error
    lines = decoded(raw, path).splitlines()
    if not any(line.strip() for line in lines):
        raise MeasurementError(f"{path}: the file holds no text")
    return lines


def is_number(cell: str) -> bool:
    """Tell whether a cell is a number, NaN and infinity included."""
    try:
        float(cell)
    except ValueError:
        return False
    return "_" not in cell


def _separator(line: str) -> str | None:
    """Separator of a line of numbers; None for white space."""
    words = line.split()
    if len(words) > 1 and all(_DECIMAL_COMMA.fullmatch(word) for word in words):
        return None
    for candidate in (";", "\t", ","):
        if candidate in line.strip():
            return candidate
    return None


def _cells(line: str, separator: str | None) -> list[str]:
    if separator is None:
        return line.split()
    return [cell.strip().strip('"') for cell in line.rstrip().rstrip(separator).split(separator)]


def _with_decimal_point(cell: str, separator: str | None) -> str:
    return cell if separator == "," else cell.replace(",", ".")


def _is_comment(line: str) -> bool:
    return line.lstrip().startswith(_COMMENT)


def _first_row(lines: Sequence[str]) -> int | None:
    for index, line in enumerate(lines):
        if not line.strip() or _is_comment(line):
            continue
        separator = _separator(line)
        if is_number(_with_decimal_point(_cells(line, separator)[0], separator)):
            return index
    return None


def split_heading(text: str) -> Column:
    """Split ``"real xx [m/N]"`` or ``"Real ((m/s^2)/N)"`` into name and unit."""
    text = text.strip().strip('"').strip()
    found = re.fullmatch(r"(.*?)\[(.*)\]", text)
    if found:
        return Column(found.group(1).strip(), found.group(2).strip())
    if text.endswith(")"):
        depth = 0
        for position in range(len(text) - 1, -1, -1):
            depth += {")": 1, "(": -1}.get(text[position], 0)
            if depth == 0:
                return Column(text[:position].strip(), text[position + 1 : -1].strip())
    return Column(text, "")


def _heading_cells(line: str, separator: str | None, count: int) -> list[str]:
    line = line.strip().lstrip("#%!/").strip()
    if separator is None or separator not in line:
        separator = _separator(re.sub(r"\[[^\]]*\]", "", line))
    if separator is not None:
        return [cell.strip() for cell in line.rstrip(separator).split(separator)]
    cells = re.findall(r"[^\[\]]+\[[^\]]*\]|\S+", line) if "[" in line else line.split()
    return [cell.strip() for cell in cells] if len(cells) == count else []


def _headings(lines: Sequence[str], separator: str | None, count: int) -> tuple[Column, ...]:
    """Headings of `count` columns from the text lines above the numbers."""
    text = [line for line in lines if line.strip()]
    plain = [line for line in text if not _is_comment(line)]
    for candidates in (plain, text):
        rows = [_heading_cells(line, separator, count) for line in candidates]
        rows = [row for row in rows if len(row) == count]
        if not rows:
            continue
        columns = tuple(split_heading(cell) for cell in rows[-1])
        if len(rows) > 1 and not any(column.unit for column in columns):
            # names on one line, units on the next
            return tuple(
                Column(name.strip('" '), unit.strip('" ()[]') if "/" not in unit else unit)
                for name, unit in zip(rows[-2], rows[-1], strict=True)
            )
        return columns
    return ()


def read_table(path: Path) -> Table:
    """Read a table of numbers with a heading line.

    Separators may be comma, semicolon, tab or spaces; where it is not the comma, a decimal comma
    is understood. Lines that begin with ``#``, ``%``, ``!`` or ``//`` are comments; the last of
    them may be the heading.

    Parameters
    ----------
    path : Path
        Text file.

    Returns
    -------
    Table

    Raises
    ------
    MeasurementError
        If the file is not text, has no rows of numbers, has a row with too few or too many cells,
        or a cell that is not a finite number; the message names file and line.
    """
    lines = read_lines(path)
    first = _first_row(lines)
    if first is None:
        raise MeasurementError(f"{path}: no line of numbers; the file is text only")
    separator = _separator(lines[first])
    count = len(_cells(lines[first], separator))
    numbers = array("d")
    line_numbers = array("q")
    for index in range(first, len(lines)):
        line = lines[index]
        if not line.strip() or _is_comment(line):
            continue
        _append_row(numbers, line, separator, count, f"{path}: line {index + 1}")
        line_numbers.append(index + 1)
    return Table(
        columns=_headings(lines[:first], separator, count),
        values=np.frombuffer(numbers, dtype=np.float64).reshape(-1, count),
        line_numbers=np.frombuffer(line_numbers, dtype=np.int64),
    )


def _append_row(
    numbers: array[float], line: str, separator: str | None, count: int, where: str
) -> None:
    cells = _cells(line, separator)
    if len(cells) != count:
        raise MeasurementError(
            f"{where} has {len(cells)} columns where the first row of numbers has {count}: "
            f"{line.strip()[:60]!r}"
        )
    for cell in cells:
        text = _with_decimal_point(cell, separator)
        if not is_number(text):
            raise MeasurementError(f"{where}: {cell[:40]!r} is not a number")
        value = float(text)
        if not math.isfinite(value):
            raise MeasurementError(f"{where}: {cell[:40]!r} is not a finite number")
        numbers.append(value)
