"""Columns of a run as a file: CSV, Parquet, or none where the summary is enough."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from chatter.description.whole_files import write_whole
from chatter.io.result_tables import Column, csv_of_rows, require_kind, write_parquet

_ROWS_AT_ONCE = 512


def write_columns(
    folder: Path, name: str, kind: str, columns: Mapping[str, np.ndarray], forms: list[str]
) -> list[Path]:
    """Write columns (n,), heading -> values, into a folder under a name; return what was written.

    Forms are those of numbers in CSV, such as "%.6g"; Parquet keeps all digits.
    """
    require_kind(kind, "signals")
    if kind == "none":
        return []
    path = folder / f"{name}.{kind}"
    folder.mkdir(parents=True, exist_ok=True)
    if kind == "parquet":
        return [write_parquet(path, {name: Column(one) for name, one in columns.items()})]
    table = np.column_stack(list(columns.values()))
    return [write_whole(path, csv_of_rows([list(columns)]) + _rows(table, forms))]


def _rows(table: np.ndarray, forms: list[str]) -> str:
    """Rows as text, many in one: one by one, as by `np.savetxt`, they take twice as long."""
    row = ",".join(forms) + "\n"
    many = row * _ROWS_AT_ONCE
    written = []
    for first in range(0, len(table), _ROWS_AT_ONCE):
        values = table[first : first + _ROWS_AT_ONCE]
        form = many if len(values) == _ROWS_AT_ONCE else row * len(values)
        written.append(form % tuple(values.ravel().tolist()))
    return "".join(written)
