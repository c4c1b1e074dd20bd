"""Records of a file that may hold several: sheets, groups, structures. FILE#RECORD names one."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

from chatter.io.table import Table
from dynamics.frf.container import MeasurementError

#: what stands between a file and one of its records
MARK = "#"
#: most records that a message lists
_LISTED = 5
#: characters that are left out of the name of a folder
_NO_NAME = re.compile(r"[^\w.+-]+")

Tables = Mapping[str, Table]


def stated_record(path: Path) -> tuple[Path, str]:
    """File and record that a path names; no record where the whole is a file, or nothing is."""
    given, begin = str(path), 0
    while not path.is_file() and (mark := given.find(MARK, begin)) > 0:
        if Path(given[:mark]).is_file():
            return Path(given[:mark]), given[mark + 1 :]
        begin = mark + 1
    return path, ""


def stem_of(path: Path) -> str:
    """Name for what is written of a file, or of the record of it that a path names."""
    file, record = stated_record(path)
    return f"{file.stem}-{_NO_NAME.sub('-', record)}" if record else path.stem


def of_file(path: Path, tables: Tables) -> Tables:
    """Tables by the names of their records; each is called by file and record where several are."""
    if len(tables) == 1:
        return tables
    return {
        name: replace(table, path=Path(f"{path}{MARK}{name}")) for name, table in tables.items()
    }


def only_record(read_records: Callable[[Path], Tables]) -> Callable[[Path], Table]:
    """Reader of the one record of a file.

    MeasurementError where there are several; the message says how one is named.
    """

    def read(path: Path) -> Table:
        tables = read_records(path)
        if len(tables) == 1:
            return next(iter(tables.values()))
        first = next(iter(tables))
        raise MeasurementError(
            f"{path}: holds {len(tables)} records: {_listed(tables)}; name one, "
            f'"{path.name}{MARK}{first}", or its number, {path.name}{MARK}1'
        )

    return read


def record_of(path: Path, tables: Tables, record: str) -> Table:
    """Record of a file by its name, or by its number from 1.

    MeasurementError where it holds no such record.
    """
    if record in tables:
        return tables[record]
    if record.isdecimal() and 1 <= int(record) <= len(tables):
        return list(tables.values())[int(record) - 1]
    count = f"{len(tables)} records: " if len(tables) > 1 else "one record: "
    raise MeasurementError(
        f"{path}: there is no record {record[:60]!r}; it holds {count}{_listed(tables)}"
    )


def _listed(tables: Tables) -> str:
    names = [name or "without a name" for name in tables]
    more = f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
    return ", ".join(names[:_LISTED]) + more
