"""Signals from files: CSV, NPZ, TDMS, universal files; name and unit of every column."""

from __future__ import annotations

import csv
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from chatter.description.errors import InputError
from chatter.description.formatting import shown
from chatter.io.formats import read_frfs
from chatter.io.formats.records58 import TimeRecord, read_time_records
from chatter.io.headings import named
from dynamics.frf.container import Frf, MeasurementError

#: of larger files no row is read
_MOST_BYTES = 1 << 30

Signals = dict[str, NDArray[np.float64]]

#: words of a verdict -> stable or not; marginal and unknown ones are no verdict
_VERDICTS = {
    **dict.fromkeys(("1", "1.0", "true", "yes", "stable", "ok"), 1.0),
    **dict.fromkeys(("0", "0.0", "false", "no", "chatter", "unstable"), 0.0),
    **dict.fromkeys(("", "nan", "marginal", "unknown", "?", "-"), np.nan),
}


def read_signals(path: Path, kind: str = "", direction: str = "") -> Signals:
    """Columns of a file in SI, by name.

    Parameters
    ----------
    path : Path
    kind : str
        Kind of measurement: what a displacement or a force of a universal file is called there.
    direction : str
        Of the FRF that is wanted of a file of several, response first.

    Raises
    ------
    InputError
        If it is missing, of a kind that is not read, or holds what is no number.
    """
    if not path.is_file():
        raise InputError(f"{path}: there is no such file")
    if path.stat().st_size > _MOST_BYTES:
        raise InputError(f"{path}: is larger than {_MOST_BYTES >> 30} GB")
    suffix = path.suffix.lower()
    if kind == "frf" and suffix not in READERS:
        return _response(path, direction)
    if suffix in _UNIVERSAL:
        return _universal(path, kind)
    reader = READERS.get(suffix)
    if reader is None:
        endings = ", ".join((*READERS, *_UNIVERSAL))
        raise InputError(f"{path}: {path.suffix or 'no ending'}; read are {endings}")
    try:
        signals = with_parts(path, reader(path))
    except InputError:
        if kind != "frf" or suffix != ".csv":
            raise
        # a table of another quantity, or of several FRFs
        return _response(path, direction)
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
    for line, row in enumerate(rows[1:], start=2):
        if len(row) != len(rows[0]):
            raise InputError(
                f"{path}: line {line} has {len(row)} cells, the heading {len(rows[0])}"
            )
    cells = zip(*rows[1:], strict=True)
    return _in_si(path, dict(zip(_unique(path, rows[0]), cells, strict=True)))


def _unique(path: Path, headings: list[str]) -> list[str]:
    for heading in headings:
        if headings.count(heading) > 1:
            raise InputError(f"{path}: there are two columns {shown(heading)}")
    return headings


def _npz(path: Path) -> Signals:
    try:
        with np.load(path, allow_pickle=False) as content:
            columns = {name: content[name] for name in content.files}
    except (OSError, ValueError, EOFError, zipfile.BadZipFile) as error:
        raise InputError(f"{path}: cannot be read: {error}") from error
    except AttributeError as error:  # a single array, not a file of several
        raise InputError(f"{path}: holds one array; save them by name with numpy.savez") from error
    parts: dict[str, Any] = {}
    for name, column in columns.items():
        if column.ndim != 1:
            continue
        if np.iscomplexobj(column):
            unit = name[name.index("[") :] if "[" in name else ""
            parts |= {f"real {unit}": column.real, f"imag {unit}": column.imag}
        else:
            parts[name] = column
    return _in_si(path, parts)


def _tdms(path: Path) -> Signals:
    try:
        from nptdms import TdmsFile
    except ImportError as error:
        raise InputError(
            f'{path}: TDMS files are read with npTDMS: install "chatter[formats]"'
        ) from error
    columns: dict[str, Any] = {}
    clock, twice = None, ""
    try:
        for group in TdmsFile.read(path).groups():
            for channel in group.channels():
                unit = channel.properties.get("unit_string", "")
                heading = f"{channel.name} [{unit}]" if unit else channel.name
                twice = twice or (heading if heading in columns else "")
                columns[heading] = channel[:]
                if "wf_increment" in channel.properties:
                    clock = channel.time_track()
    except Exception as error:
        raise InputError(f"{path}: is no TDMS file that can be read: {error}") from error
    if twice:
        raise InputError(f"{path}: there are two channels {shown(twice)}")
    signals = _in_si(path, columns)
    if "time" not in signals and clock is not None:
        signals = {"time": np.asarray(clock, dtype=np.float64), **signals}
    return signals


#: ending of a file -> reader of its columns
READERS: dict[str, Callable[[Path], Signals]] = {".csv": _csv, ".npz": _npz, ".tdms": _tdms}
_UNIVERSAL = (".uff", ".unv", ".uf")


def _in_si(path: Path, columns: Mapping[str, Any]) -> Signals:
    """Columns in SI by the name before their unit."""
    signals: Signals = {}
    for heading, cells in columns.items():
        name, factor = named(path, heading)
        if name in signals:
            raise InputError(f'{path}: there are two columns "{name}"')
        if name in ("stable", "chatter"):
            verdicts = np.array([_verdict(path, heading, k, c) for k, c in enumerate(cells)])
            signals["stable"] = verdicts if name == "stable" else 1.0 - verdicts
        else:
            signals[name] = _numbers(path, heading, cells) * factor
    return signals


def _numbers(path: Path, heading: str, cells: Any) -> NDArray[np.float64]:
    try:
        return np.array(cells, dtype=np.float64)
    except (TypeError, ValueError):
        return np.array([_number(path, k, heading, cell) for k, cell in enumerate(cells)])


def _number(path: Path, row: int, heading: str, cell: Any) -> float:
    text = str(cell).strip()
    if not text:
        return np.nan
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{path}: line {row + 2}: {heading}: {shown(text)} is no number") from None


def _verdict(path: Path, heading: str, row: int, cell: Any) -> float:
    text = str(cell).strip().lower()
    if text not in _VERDICTS:
        raise InputError(
            f"{path}: line {row + 2}: {heading}: {shown(str(cell))} is no verdict; 1, true or "
            "stable, 0, false or chatter, or marginal"
        )
    return _VERDICTS[text]


def with_parts(path: Path, signals: Signals) -> Signals:
    """Real and imaginary part in the place of magnitude and phase."""
    if "magnitude" not in signals or "real" in signals:
        return signals
    if "phase" not in signals:
        raise InputError(f"{path}: there is a magnitude without a phase")
    rest = {k: v for k, v in signals.items() if k not in ("magnitude", "phase")}
    values = signals["magnitude"] * np.exp(1j * signals["phase"])
    return {**rest, "real": values.real, "imag": values.imag}


def _response(path: Path, direction: str) -> Signals:
    """FRF of a direction from a file of FRFs."""
    try:
        frfs = [frf.along_axes() for frf in read_frfs(path)]
    except MeasurementError as error:
        raise InputError(str(error)) from error
    wanted = (direction[:1], direction[-1:])
    chosen = [frf for frf in frfs if wanted == (frf.response.direction, frf.reference.direction)]
    if len(frfs) == 1 and not _is_labelled(frfs[0]):
        chosen = frfs
    if len(chosen) != 1:
        held = ", ".join(f"{f.response.direction}{f.reference.direction}" or "?" for f in frfs)
        raise InputError(
            f'{path}: holds {len(chosen)} FRFs of direction "{direction}" (response, then force); '
            f"there are {held}"
        )
    frf = chosen[0].receptance()
    return {"frequency": frf.frequency, "real": frf.values.real, "imag": frf.values.imag}


def _is_labelled(frf: Frf) -> bool:
    return bool(frf.response.direction and frf.reference.direction)


def _universal(path: Path, kind: str) -> Signals:
    """Time records of a universal file, by what they hold and their direction."""
    try:
        records = read_time_records(path)
    except MeasurementError as error:
        raise InputError(str(error)) from error
    signals: Signals = {"time": records[0].time}
    for record in records:
        name, factor = _name_of(path, record, kind)
        if name in signals:
            raise InputError(f'{path}: there are two records "{name}"')
        same = record.time.size == records[0].time.size and np.allclose(
            record.time, records[0].time, rtol=1e-6, atol=1e-9
        )
        if not same:
            raise InputError(f'{path}: record "{name}" has other times than the first')
        signals[name] = record.values * factor
    return signals


def _name_of(path: Path, record: TimeRecord, kind: str) -> tuple[str, float]:
    axis, sign = record.point.direction, record.point.sign
    of_kind = {
        "milling": {"force": f"F{axis}", "displacement": axis},
        "axis": {"force": "force", "displacement": "position", "velocity": "velocity"},
    }.get(kind, {})
    name = of_kind.get(record.content or "")
    if name in ("", "F"):
        raise InputError(f"{path}: {record.source}: a {record.content} without a direction")
    if name:
        return name, float(sign) if kind == "milling" else 1.0
    # what the standard has no code for goes by its title
    return named(path, record.title) if record.title else (f"record {record.source}", 1.0)
