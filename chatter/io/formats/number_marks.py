"""Numbers of a text as Python reads them: exponents, minus signs, marks between thousands."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from dynamics.frf.container import MeasurementError

#: "1.2D-03", as Fortran writes double precision, in a cell of its own
_FORTRAN = re.compile(r"(?<![\w.])([+-]?(?:\d+\.?\d*|\.\d+))[dD]([+-]?\d+)(?![\w.])")
#: a minus sign of typesetters before a number
_MINUS = re.compile(r"(?:(?<![\w.])|(?<=\d[eE]))\u2212(?=[\d.])")
#: groups of three digits with what stands between thousands alone, and with blanks in a cell
_GROUPED = re.compile(r"(?<![\w.,])[+-]?\d{1,3}(?:['\u2019\u00a0\u202f\u2009]\d{3})+(?!\d)")
_BLANKS = re.compile(
    r"(?:(?<=^)|(?<=[;\t]))\s*[+-]?[1-9]\d{0,2}(?: \d{3})+(?=[.,]\d*\s*(?:[;\t]|$))"
)
_NUMBER = r"([+-]?(?:\d[\d.,]*|\.\d+))(?:[eE][+-]?\d+)?"
#: a number that is a cell between semicolons or tabs, and one in quotes
_CELL = re.compile(rf"(?:^|(?<=[;\t]))\s*\"?{_NUMBER}\"?\s*(?=[;\t]|$)")
_WORD = re.compile(rf"(?<!\S){_NUMBER}(?!\S)")
_IN_QUOTES = re.compile(rf"\"\s*{_NUMBER}\s*\"")
_SEPARATORS = re.compile(r"[;\t]")
#: mark between thousands -> numbers that surely have it, or that may have it
_SURELY = {
    ",": re.compile(r"[+-]?\d{1,3}(?:,\d{3})+\.\d*|[+-]?\d{1,3}(?:,\d{3}){2,}"),
    ".": re.compile(r"[+-]?\d{1,3}(?:\.\d{3})+,\d*|[+-]?\d{1,3}(?:\.\d{3}){2,}"),
}
_PERHAPS = {mark: re.compile(rf"[+-]?[1-9]\d{{0,2}}\{mark}\d{{3}}") for mark in ",."}


def with_plain_numbers(path: Path, lines: Sequence[str]) -> Sequence[str]:
    """Lines whose numbers have E before their exponents, a hyphen as minus, and no marks between.

    Commas and points stand between thousands only where no comma can be between columns, and where
    some number says so: 1,234.5 or 1,234,567. In such a file 1,234 is a thousand and more, too, and
    so it is where another number has a decimal point. Apostrophes and narrow blanks never stand for
    anything else.

    MeasurementError if one number says that a comma or point is decimal, and another that it
    stands between thousands; the message names the lines.
    """
    if any("D" in line or "d" in line for line in lines):
        lines = [_FORTRAN.sub(r"\1E\2", line) for line in lines]
    if not all(line.isascii() for line in lines) or any("'" in line for line in lines):
        lines = [_GROUPED.sub(_without_gaps, _MINUS.sub("-", line)) for line in lines]
    lines = [_BLANKS.sub(_without_gaps, line) if _may_have_blanks(line) else line for line in lines]
    mark = _mark_of_thousands(path, lines)
    return lines if mark is None else [_without(line, mark) for line in lines]


def _without_gaps(found: re.Match[str]) -> str:
    return re.sub(r"[^\d+-]", "", found[0])


def _may_have_blanks(line: str) -> bool:
    return " " in line and (";" in line or "\t" in line)


def _mark_of_thousands(path: Path, lines: Sequence[str]) -> str | None:
    """Mark between thousands of the lines; None where they have none."""
    if not any("," in line for line in lines):
        return None
    sure: dict[str, str] = {}
    decimal: dict[str, str] = {}
    may_be = False
    for where, number in _numbers(lines):
        if "," not in number and "." not in number:
            continue
        surely = [mark for mark, form in _SURELY.items() if form.fullmatch(number)]
        if surely:
            sure.setdefault(surely[0], f"{number} in {where}")
        elif _PERHAPS[","].fullmatch(number):
            may_be = True
        elif number.count(",") + number.count(".") == 1 and not _PERHAPS["."].fullmatch(number):
            decimal.setdefault("," if "," in number else ".", f"{number} in {where}")
    if not sure:
        return "," if may_be and "." in decimal and "," not in decimal else None
    mark = next(iter(sure))
    against = sure.get("." if mark == "," else ",") or decimal.get(mark)
    if against:
        raise MeasurementError(
            f"{path}: {sure[mark]} has {mark!r} between thousands, {against} has it before its "
            "decimals; write all numbers in one way"
        )
    return mark


def _numbers(lines: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Where each number stands that is a cell of its own, and the number without exponent."""
    for index, line in enumerate(lines, start=1):
        form = _form_of_cells(line)
        if form is None:
            continue
        found = [one[1] for one in form.finditer(line)]
        # a line above the table has words, and numbers such as that of a version
        if form is not _CELL or 2 * len(found) > len(_SEPARATORS.split(line)):
            yield from ((f"line {index}", number) for number in found)


def _form_of_cells(line: str) -> re.Pattern[str] | None:
    """Form of the cells of a line in which a comma may be a part of a number."""
    if ";" in line or "\t" in line:
        return _CELL
    if '"' in line:
        return _IN_QUOTES
    words = line.split()
    return _WORD if len(words) > 1 and all(map(_WORD.fullmatch, words)) else None


def _without(line: str, mark: str) -> str:
    """Line without the marks between thousands, of numbers that are cells of their own."""
    form = _form_of_cells(line)
    if mark not in line or form is None:
        return line

    def plain(found: re.Match[str]) -> str:
        number = found[1]
        grouped = _SURELY[mark].fullmatch(number) or _PERHAPS[mark].fullmatch(number)
        return found[0].replace(number, number.replace(mark, "")) if grouped else found[0]

    return form.sub(plain, line)
