"""Arrays by name, as archives and programs of numbers keep them: columns of a table."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from chatter.io.files import LARGEST_FILE
from chatter.io.table import Column, Table, heading_of_name, table_of
from dynamics.frf.container import MeasurementError

#: content that always has room, bytes, and how many times its file anything larger may be: noise
#: that was measured packs ten times at most, beside channels that nothing was connected to
_NEVER_A_BOMB, _MOST_TIMES = 64 * 1024**2, 100
#: most columns that one array is taken for
_MOST_COLUMNS = 256
#: names of a single number, in lower case and without strokes -> Hz or s
_RATES = ("fs", "samplingrate", "samplerate", "samplingfrequency")
_STEPS = ("dt", "ts", "timestep", "samplingtime")


def require_size(path: Path, size: float) -> None:
    """Raise MeasurementError where the content, in bytes, is larger than what is read.

    What unpacks to far more than any record does is refused, too: it was made to fill memory.
    """
    if size > LARGEST_FILE:
        raise MeasurementError(
            f"{path}: its content unpacks to {size / 1024**2:.0f} MB; at most "
            f"{LARGEST_FILE / 1024**2:.0f} MB are read"
        )
    times = size / max(path.stat().st_size, 1)
    if size > _NEVER_A_BOMB and times > _MOST_TIMES:
        raise MeasurementError(
            f"{path}: its content unpacks to {size / 1024**2:.0f} MB, {times:.0f} times its size; "
            f"no record does, and at most {_MOST_TIMES} times are read beyond "
            f"{_NEVER_A_BOMB / 1024**2:.0f} MB"
        )


def table_of_arrays(path: Path, arrays: Mapping[str, np.ndarray]) -> Table:
    """Columns of the arrays of numbers of a file.

    Vectors (n,), (n, 1) or (1, n) are a column each, a matrix (n, k) with n > k is k columns, a
    complex array its real and imaginary part; what is no number is passed over. A single number
    called `fs` or `sampling_rate`, Hz, or `dt`, s, gives the time where no array is one. Dates are
    a time since the first.
    MeasurementError if there is none, or they differ in length.
    """
    columns: list[Column] = []
    for name, values in arrays.items():
        if values.dtype.kind in "fiuc" and values.size > 1:
            columns += _columns(path, name, values)
        elif values.dtype.kind in "mM" and values.size > 1 and values.ndim == 1:
            seconds = (values - values[0]).astype("timedelta64[ns]").astype(np.float64) * 1e-9
            columns.append(Column("time [s]", seconds))
    if not columns:
        held = ", ".join(arrays) or "nothing"
        raise MeasurementError(f"{path}: holds no array of numbers; there is {held}")
    table = table_of(path, columns, "arrays")
    step = _step(arrays)
    if step is None or any(one.name.lower() in ("t", "time", "frequency") for one in columns):
        return table
    return table_of(path, [Column("time [s]", step * np.arange(table.size)), *columns], "arrays")


def _columns(path: Path, name: str, values: np.ndarray) -> list[Column]:
    if values.ndim > 2:
        raise MeasurementError(
            f"{path}: {name} has {values.ndim} dimensions; a signal is a vector or a matrix with a "
            "column for each channel"
        )
    if 1 in values.shape or values.ndim == 1:
        return _parts(heading_of_name(name), values.ravel())
    rows = values if values.shape[0] > values.shape[1] else values.T
    if rows.shape[1] > _MOST_COLUMNS:
        raise MeasurementError(
            f"{path}: {name} has {values.shape[0]} times {values.shape[1]} numbers; a matrix of "
            f"signals has at most {_MOST_COLUMNS} columns"
        )
    return [
        column
        for k in range(rows.shape[1])
        for column in _parts(f"{name} {k + 1}", rows[:, k])
    ]  # fmt: skip


def _parts(heading: str, values: np.ndarray) -> list[Column]:
    if not np.iscomplexobj(values):
        return [Column(heading, values)]
    unit = heading[heading.index("[") :] if "[" in heading else ""
    return [Column(f"real {unit}", values.real), Column(f"imag {unit}", values.imag)]


def _step(arrays: Mapping[str, np.ndarray]) -> float | None:
    """Interval of the samples, s, of a single number that names it."""
    for name, values in arrays.items():
        if values.size != 1 or values.dtype.kind not in "fiu":
            continue
        plain = name.rpartition(".")[2].lower().replace("_", "")
        number = float(values.ravel()[0])
        if not 0.0 < number < np.inf:
            continue
        if plain in _RATES:
            return 1.0 / number
        if plain in _STEPS:
            return number
    return None
