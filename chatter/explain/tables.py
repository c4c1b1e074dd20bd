"""Signals from files: CSV, NPZ, TDMS with name and unit of every column, UFF-58 for FRFs."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from chatter.errors import InputError
from chatter.units import registry

_HEADING = re.compile(r"\s*(?P<name>[^\[\]]+?)\s*(?:\[(?P<unit>[^\]]*)\])?\s*")
#: of larger files no row is read
_MOST_BYTES = 1 << 30

Signals = dict[str, NDArray[np.float64]]


def read_signals(path: Path) -> Signals:
    """Columns of a file in SI, by name.

    Raises
    ------
    InputError
        If it is missing, of a kind that is not read, or holds what is no number.
    """
    if not path.is_file():
        raise InputError(f"{path}: there is no such file")
    if path.stat().st_size > _MOST_BYTES:
        raise InputError(f"{path}: is larger than {_MOST_BYTES >> 30} GB")
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(f"{path}: {path.suffix or 'no ending'}; read are {', '.join(READERS)}")
    signals = reader(path)
    lengths = {name: column.size for name, column in signals.items()}
    if not signals or len(set(lengths.values())) != 1:
        raise InputError(f"{path}: the columns differ in length or there are none: {lengths}")
    return signals


def _csv(path: Path) -> Signals:
    try:
        rows = list(csv.reader(path.read_text(encoding="utf-8-sig").splitlines()))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{path}: cannot be read: {error}") from error
    rows = [row for row in rows if row]
    if len(rows) < 2:
        raise InputError(f"{path}: holds no rows below a heading")
    values = np.empty((len(rows) - 1, len(rows[0])))
    for line, row in enumerate(rows[1:], start=2):
        if len(row) != len(rows[0]):
            raise InputError(
                f"{path}: line {line} has {len(row)} cells, the heading {len(rows[0])}"
            )
        for place, cell in enumerate(row):
            values[line - 2, place] = _number(path, line, rows[0][place], cell)
    return _named(path, dict(zip(rows[0], values.T, strict=True)))


def _number(path: Path, line: int, heading: str, cell: str) -> float:
    if not cell.strip():
        return np.nan
    try:
        return float(cell)
    except ValueError:
        raise InputError(f'{path}: line {line}: {heading}: "{cell}" is no number') from None


def _npz(path: Path) -> Signals:
    try:
        with np.load(path, allow_pickle=False) as content:
            columns = {name: np.asarray(content[name], dtype=np.float64) for name in content.files}
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read: {error}") from error
    return _named(path, {name: column for name, column in columns.items() if column.ndim == 1})


def _tdms(path: Path) -> Signals:
    try:
        from nptdms import TdmsFile
    except ImportError as error:
        raise InputError(
            f'{path}: TDMS files are read with npTDMS: install "chatter[formats]"'
        ) from error
    columns = {}
    for group in TdmsFile.read(path).groups():
        for channel in group.channels():
            unit = channel.properties.get("unit_string", "")
            heading = f"{channel.name} [{unit}]" if unit else channel.name
            columns[heading] = np.asarray(channel[:], dtype=np.float64)
    return _named(path, columns)


def _uff(path: Path) -> Signals:
    from dynamics.formats import read_frfs
    from dynamics.frf import MeasurementError

    try:
        frf = read_frfs(path)[0].receptance()
    except MeasurementError as error:
        raise InputError(str(error)) from error
    return {"frequency": frf.frequency, "real": frf.values.real, "imag": frf.values.imag}


#: ending of a file -> reader of its columns
READERS: dict[str, Callable[[Path], Signals]] = {
    ".csv": _csv,
    ".npz": _npz,
    ".tdms": _tdms,
    ".uff": _uff,
    ".unv": _uff,
}


def _named(path: Path, columns: Mapping[str, NDArray[np.float64]]) -> Signals:
    """Columns in SI by the name before their unit."""
    signals: Signals = {}
    for heading, values in columns.items():
        match = _HEADING.fullmatch(heading)
        if match is None:
            raise InputError(f'{path}: "{heading}" is no heading such as "Fx [N]"')
        name = match["name"]
        if name in signals:
            raise InputError(f'{path}: there are two columns "{name}"')
        signals[name] = values * _factor(path, heading, match["unit"])
    return signals


def _factor(path: Path, heading: str, unit: str | None) -> float:
    if unit in (None, "", "1", "-"):
        return 1.0
    if unit == "rpm":
        return 2.0 * np.pi / 60.0
    try:
        return float(registry().Quantity(1.0, unit).to_base_units().magnitude)
    except Exception as error:
        raise InputError(f'{path}: "{heading}": {unit} is no unit that is known') from error
