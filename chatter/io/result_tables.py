"""Tables of results as files: CSV, Parquet, or none where the summary is enough."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from io import StringIO
from pathlib import Path
from typing import Any, NamedTuple

from chatter.description.errors import InputError
from chatter.description.formatting import formatted
from chatter.description.whole_files import write_whole

#: what tables may be written as
KINDS = ("csv", "parquet", "none")
#: what a formula of a spreadsheet begins with, as wide as other keyboards write it too
_BEGIN_FORMULAS = tuple("=+-@|＝＋－＠")
#: a number with or without unit, which is none, and a dash for nothing
_QUANTITY = re.compile(r"[+-]?[0-9.]+([eE][+-]?[0-9]+)?( [\w/%*^°²³·]+)?|[+-](inf|nan)|-")


class Column(NamedTuple):
    """Column of a table: texts, truth values or numbers; None and nan where there is none."""

    values: Iterable[Any]
    form: str = ""  # of numbers in CSV, such as ".6g"; Parquet keeps all digits
    infinite: str = ""  # what stands in CSV for an infinite number


#: heading -> column
Columns = Mapping[str, Column]


def require_kind(kind: str, option: str = "tables") -> None:
    """Refuse what is none of `KINDS`, and Parquet where pyarrow is not installed; InputError."""
    if not isinstance(kind, str) or kind not in KINDS:
        raise InputError(f"{option}: {formatted(kind)} is not known; there are {', '.join(KINDS)}")
    if kind == "parquet":
        try:
            import pyarrow.parquet  # noqa: F401
        except ImportError as error:
            raise InputError(
                f'{option}: Parquet files are written with pyarrow: install "chatter[formats]"'
            ) from error


def write_table(folder: Path, name: str, kind: str, columns: Columns) -> list[Path]:
    """Write a table into a folder under a name as one of `KINDS`; return what was written.

    One of another kind, left there by an earlier run, would be taken for that of this one: it goes.
    """
    require_kind(kind)
    for other in set(KINDS) - {kind, "none"}:
        (folder / f"{name}.{other}").unlink(missing_ok=True)
    if kind == "none":
        return []
    if kind == "parquet":
        return [write_parquet(folder / f"{name}.parquet", columns)]
    return [write_whole(folder / f"{name}.csv", csv_text(columns))]


def write_parquet(path: Path, columns: Columns) -> Path:
    """Write a table as Parquet; nan is nothing there, as None is."""
    import pyarrow
    import pyarrow.parquet

    table = pyarrow.table(
        {
            heading: pyarrow.array(_of_one_type(column), from_pandas=True)
            for heading, column in columns.items()
        }
    )
    return write_whole(path, lambda file: pyarrow.parquet.write_table(table, file))


def _of_one_type(column: Column) -> Any:
    """Values of a column; texts throughout where texts stand among numbers."""
    if hasattr(column.values, "dtype"):
        return column.values
    values = list(column.values)
    if not any(isinstance(value, str) for value in values):
        return values
    return [None if one is None else _plain(one, column) for one in values]


def csv_text(columns: Columns) -> str:
    """CSV of columns; empty where a value is none or no number.

    Texts and truth values stand as they are, texts `inert`.
    """
    rows = zip(*map(_cells, columns.values()), strict=True)
    return csv_of_rows([list(columns)]) + "".join(",".join(row) + "\n" for row in rows)


def _cells(column: Column) -> Iterator[str]:
    values = column.values
    # numbers of Python are written in half the time
    for value in getattr(values, "tolist", lambda: values)():
        yield _cell(value, column)


def _cell(value: Any, column: Column) -> str:
    return _quoted(value) if isinstance(value, str) else _plain(value, column)


def _plain(value: Any, column: Column) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, bool):
        return str(value).lower()
    if value is None or math.isnan(value):
        return ""
    if math.isinf(value) and column.infinite:
        return column.infinite if value > 0.0 else f"-{column.infinite}"
    return "" if math.isinf(value) else format(value, column.form)


@lru_cache(maxsize=1024)
def _quoted(cell: str) -> str:
    return csv_of_rows([[cell]])[:-1] if cell else ""


def csv_of_rows(rows: Iterable[Sequence[str]]) -> str:
    """CSV of rows of texts, which are quoted where they hold a comma and `inert`."""
    text = StringIO()
    csv.writer(text, lineterminator="\n").writerows(map(inert, row) for row in rows)
    return text.getvalue()


def inert(cell: str) -> str:
    """Text of a cell that no spreadsheet takes for a formula: "=1+1" gets an apostrophe."""
    begins = cell.strip().startswith(_BEGIN_FORMULAS)
    return f"'{cell}" if begins and not _QUANTITY.fullmatch(cell) else cell
