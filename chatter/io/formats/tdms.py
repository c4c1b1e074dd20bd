"""TDMS files of LabVIEW, read by npTDMS."""

from pathlib import Path
from typing import Any

import numpy as np

from chatter.description.arrays import Array
from chatter.io.formats.format import Format
from chatter.io.formats.frf_columns import frfs_of_table
from chatter.io.table import Column, Table, table_of
from dynamics.frf.container import MeasurementError

#: properties of a channel that hold its unit
_UNIT_PROPERTIES = ("unit_string", "NI_UnitDescription", "unit")


def read_channels(path: Path) -> Table:
    """Channels of all groups, with the clock of their waveform where no channel is a time.

    MeasurementError if npTDMS is not installed, the file is none that it reads, or channels differ
    in length.
    """
    try:
        from nptdms import TdmsFile
    except ImportError as error:
        raise MeasurementError(
            f'{path}: TDMS files are read with npTDMS: install "chatter[formats]"'
        ) from error
    columns, clock = [], None
    try:
        groups = [group for group in TdmsFile.read(path).groups() if group.channels()]
        for group in groups:
            for channel in group.channels():
                columns.append(Column(_heading(channel), channel[:]))
                clock = _clock(channel) if clock is None else clock
    except Exception as error:  # whatever the library raises on a broken file
        raise MeasurementError(f"{path}: is no TDMS file that can be read: {error}") from error
    names = [column.name for column in columns]
    if len(groups) > 1 and len(set(names)) < len(names):
        raise MeasurementError(
            f"{path}: the same channels stand in {len(groups)} groups "
            f"({', '.join(group.name for group in groups[:5])}); save one record a file"
        )
    has_time = any(column.name.lower() in ("time", "t") for column in columns)
    if clock is not None and not has_time:
        columns.insert(0, Column("time [s]", clock))
    return table_of(path, columns, "channels")


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
    help='channels with the property unit_string; needs "chatter[formats]"',
    extensions=(".tdms",),
    read_frfs=lambda path: frfs_of_table(read_channels(path)),
    read_signals=read_channels,
)
