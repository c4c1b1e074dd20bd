"""Universal files (UFF, UNV): splitting into datasets; the units dataset 164."""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from chatter.io.files import read_content
from dynamics.frf.container import MeasurementError

_DELIMITER = re.compile(rb"^[ \t]*-1[ \t]*\r?(?:\n|\Z)", re.MULTILINE)
_CLOSING_AFTER_BINARY = re.compile(rb"(?:\r?\n)? {4}-1[ \t]*\r?(?:\n|\Z)")
_IDENTIFIER = re.compile(rb"[ \t]*(\d{1,6})(b?)(?![\w.])")


@dataclass(frozen=True)
class Dataset:
    """One dataset of a universal file: what stands between two lines of -1."""

    number: int  # dataset number; 58 is a function at nodal degrees of freedom
    identifier: str  # first line, with the binary layout for 58b
    body: bytes  # everything after the first line
    order: int  # place in the file, from 1
    line: int  # line of the file the body begins on, from 1 (meaningless behind binary content)

    @property
    def is_binary(self) -> bool:
        """True for dataset 58b: text heading, binary numbers."""
        return "b" in self.identifier.split()[0]


@dataclass(frozen=True)
class FileUnits:
    """Units of a universal file (dataset 164): a value in SI is the file's divided by a factor."""

    length: float = 1.0
    force: float = 1.0


def is_universal(head: bytes) -> bool:
    """Tell a universal file by its first lines: -1, then the number of a dataset."""
    lines = head.lstrip(b"\xef\xbb\xbf\r\n\t ").split(b"\n", 3)[:3]
    if lines[0].strip() != b"-1":
        return False
    first = next((line for line in lines if line.strip() != b"-1"), b"")
    return _IDENTIFIER.match(first) is not None


def read_datasets(path: Path) -> Iterator[Dataset]:
    """Yield the datasets of a universal file in order.

    MeasurementError if the file cannot be read or a dataset is not closed by a line of -1
    (truncated file).
    """
    content = read_content(path).removeprefix(b"\xef\xbb\xbf")
    if b"\n" not in content:
        # lines of an old Macintosh
        content = content.replace(b"\r", b"\n")
    position, line, order = 0, 1, 1
    while (opening := _DELIMITER.search(content, position)) is not None:
        if _DELIMITER.match(content, opening.end()) is not None:  # a stray line of -1
            line += content.count(b"\n", position, opening.end())
            position = opening.end()
            continue
        start = content.find(b"\n", opening.end()) + 1
        found = _IDENTIFIER.match(content, opening.end())
        line += content.count(b"\n", position, start)
        where = f"{path}: dataset {order}, line {line - 1}"
        if start == 0 or found is None:
            raise MeasurementError(f"{where}: no dataset number follows the line of -1")
        closing = _closing(content, start, is_binary=bool(found.group(2)))
        if closing is None:
            raise MeasurementError(f"{where}: no line of -1 closes it; the file is cut short")
        yield Dataset(
            number=int(found.group(1)),
            identifier=content[opening.end() : start].decode("latin-1").strip(),
            body=content[start : closing.start()],
            order=order,
            line=line,
        )
        line += content.count(b"\n", start, closing.end())
        position = closing.end()
        order += 1


def with_e_and_points(numbers: str) -> str:
    """Numbers with E before their exponents, and points before their decimals.

    Nothing stands between numbers of a universal file but blanks, so that a comma is decimal.
    """
    return numbers.replace("D", "E").replace("d", "e").replace(",", ".")


def _closing(content: bytes, start: int, *, is_binary: bool) -> re.Match[bytes] | None:
    """Line of -1 that closes a dataset; behind binary numbers it may follow without a new line."""
    if not is_binary:
        return _DELIMITER.search(content, start)
    return _CLOSING_AFTER_BINARY.search(content, start)


def file_units(dataset: Dataset, path: Path) -> FileUnits:
    """Read the factors of length and force of a units dataset (164).

    MeasurementError if the factors are missing or not positive numbers.
    """
    lines = dataset.body.decode("latin-1").splitlines()
    words = with_e_and_points(" ".join(lines[1:])).split()
    try:
        length, force = float(words[0]), float(words[1])
    except (IndexError, ValueError):
        length = force = math.nan
    if not (0.0 < length < math.inf and 0.0 < force < math.inf):
        raise MeasurementError(
            f"{path}: dataset {dataset.order} (164, units), line {dataset.line + 1}: the factors "
            "of length and force must be positive numbers"
        )
    return FileUnits(length, force)
