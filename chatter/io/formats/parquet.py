"""Parquet files, read by pyarrow."""

from pathlib import Path
from typing import Any

import numpy as np

from chatter.io.formats.format import Format
from chatter.io.formats.frf_columns import frfs_of_table
from chatter.io.formats.named_arrays import require_size, table_of_arrays
from chatter.io.table import Table
from dynamics.frf.container import MeasurementError


def read_columns(path: Path) -> Table:
    """Columns of numbers by name; missing ones are NaN.

    The unit is in the name, as "Fx [N]" or "Fx_N", or in the property ``unit`` of the column.
    MeasurementError if pyarrow is not installed, the file is no Parquet file, or too large.
    """
    try:
        from pyarrow import parquet
    except ImportError as error:
        raise MeasurementError(
            f'{path}: Parquet files are read with pyarrow: install "chatter[formats]"'
        ) from error
    try:
        with parquet.ParquetFile(path) as file:
            names = _names_of_numbers(path, file.schema_arrow)
            require_size(path, 8.0 * file.metadata.num_rows * len(names))
            table = file.read(columns=names)
            arrays = {}
            for field, column in zip(table.schema, table.columns, strict=True):
                arrays[_heading(field)] = np.asarray(column.to_numpy())
    except MeasurementError:
        raise
    except Exception as error:  # whatever the library raises on a broken file
        raise MeasurementError(f"{path}: is no Parquet file that can be read: {error}") from error
    return table_of_arrays(path, arrays)


def _names_of_numbers(path: Path, schema: Any) -> list[str]:
    """Columns that are read; texts and lists are not, as few bytes may repeat a long one."""
    names = [one.name for one in schema if _is_of_numbers(one.type)]
    if not names:
        held = ", ".join(schema.names) or "nothing"
        raise MeasurementError(f"{path}: holds no column of numbers; there is {held}")
    return names


def _is_of_numbers(kind: Any) -> bool:
    """Whether a column holds numbers or instants."""
    from pyarrow import types

    instants = types.is_timestamp(kind) or types.is_date(kind) or types.is_duration(kind)
    return bool(types.is_floating(kind) or types.is_integer(kind) or instants)


def _heading(field: Any) -> str:
    unit = (field.metadata or {}).get(b"unit", b"").decode("utf-8", errors="replace")
    return f"{field.name} [{unit}]" if unit and "[" not in field.name else field.name


PARQUET = Format(
    name="parquet",
    label="Parquet",
    help='columns of numbers, unit in the name or in the property unit; needs "chatter[formats]"',
    extensions=(".parquet", ".pq"),
    read_frfs=lambda path: frfs_of_table(read_columns(path)),
    read_signals=read_columns,
    recognises=lambda head: head.startswith(b"PAR1"),
)
