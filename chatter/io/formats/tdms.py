"""TDMS files of LabVIEW, read by npTDMS."""

from pathlib import Path
from typing import Any

import numpy as np

from chatter.description.arrays import Array
from chatter.io.formats.format import Format
from chatter.io.formats.frf_columns import frfs_of_tables
from chatter.io.formats.records import Tables, of_file, only_record
from chatter.io.table import Column, Table, split_heading, table_of
from dynamics.frf.container import MeasurementError

#: properties of a channel that hold its unit
_UNIT_PROPERTIES = ("unit_string", "NI_UnitDescription", "unit")


def read_records(path: Path) -> Tables:
    """Channels of all groups, with the clock of their waveform where no channel is a time.

    Groups of the same channels are a record each, by name; those of others are one.
    MeasurementError if npTDMS is not installed, the file is none that it reads, or channels of a
    record differ in length.
    """
    try:
        from nptdms import TdmsFile
    except ImportError as error:
        raise MeasurementError(
            f'{path}: TDMS files are read with npTDMS: install "chatter[formats]"'
        ) from error
    try:
        groups = {
            group.name: [(_heading(one), _values(one), _clock(one)) for one in channels]
            for group in TdmsFile.read(path).groups()
            if (channels := [one for one in group.channels() if _is_of_numbers(one)])
        }
    except Exception as error:  # whatever the library raises on a broken file
        raise MeasurementError(f"{path}: is no TDMS file that can be read: {error}") from error
    names = [split_heading(heading)[0] for one in groups.values() for heading, _, _ in one]
    if len(set(names)) < len(names):
        return of_file(path, {name: _table(path, one) for name, one in groups.items()})
    return {"": _table(path, [channel for one in groups.values() for channel in one])}


def _table(path: Path, channels: list[tuple[str, Array, Array | None]]) -> Table:
    """Table of channels: heading, values and clock of each."""
    columns = [Column(heading, values) for heading, values, _ in channels]
    clock = next((one for _, _, one in channels if one is not None), None)
    has_time = any(column.name.lower() in ("time", "t") for column in columns)
    if clock is not None and not has_time:
        columns.insert(0, Column("time [s]", clock))
    return table_of(path, columns, "channels")


def _is_of_numbers(channel: Any) -> bool:
    """Whether a channel is a signal, or its times; texts and empty channels are notes."""
    return len(channel) > 0 and channel.dtype.kind in "iufM"


def _values(channel: Any) -> Array:
    """Samples of a channel; of dates, the seconds since the first."""
    values = channel[:]
    if channel.dtype.kind == "M":
        return (values - values[0]) / np.timedelta64(1, "s")
    return values


def _heading(channel: Any) -> str:
    """Name and unit: of LabVIEW's waveforms, or of its unit description."""
    units = (str(channel.properties.get(name, "")).strip() for name in _UNIT_PROPERTIES)
    unit = next((one for one in units if one), "")
    return f"{channel.name} [{unit}]" if unit else str(channel.name)


def _clock(channel: Any) -> Array | None:
    """Times (n,) of a waveform, s; None of a channel that is none. The start may be left out."""
    step = float(channel.properties.get("wf_increment", 0.0))
    if not step > 0.0:
        return None
    start = float(channel.properties.get("wf_start_offset", 0.0))
    return start + step * np.arange(len(channel))


TDMS = Format(
    name="tdms",
    label="TDMS of LabVIEW",
    help="channels with the property unit_string; groups of the same channels are records; "
    'needs "chatter[formats]"',
    extensions=(".tdms",),
    read_frfs=lambda path: frfs_of_tables(read_records(path)),
    read_signals=only_record(read_records),
    read_records=read_records,
)
