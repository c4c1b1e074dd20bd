"""TDMS files of LabVIEW, read by npTDMS."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from chatter.io.formats.format import Format
from chatter.io.formats.frf_columns import frfs_of_table
from chatter.io.table import Column, Table
from dynamics.frf.container import Frf, MeasurementError


def read_channels(path: Path) -> Table:
    """Channels of all groups, with the clock of their waveform where no channel is a time.

    Raises
    ------
    MeasurementError
        If npTDMS is not installed, the file is none that it reads, or channels differ in length.
    """
    try:
        from nptdms import TdmsFile
    except ImportError as error:
        raise MeasurementError(
            f'{path}: TDMS files are read with npTDMS: install "chatter[formats]"'
        ) from error
    columns, clock = [], None
    try:
        for group in TdmsFile.read(path).groups():
            for channel in group.channels():
                unit = channel.properties.get("unit_string", "")
                heading = f"{channel.name} [{unit}]" if unit else channel.name
                columns.append(Column(heading, channel[:]))
                if "wf_increment" in channel.properties:
                    clock = np.asarray(channel.time_track(), dtype=np.float64)
    except Exception as error:  # whatever the library raises on a broken file
        raise MeasurementError(f"{path}: is no TDMS file that can be read: {error}") from error
    has_time = any(column.name.lower() in ("time", "t") for column in columns)
    if clock is not None and not has_time:
        columns.insert(0, Column("time [s]", clock))
    lengths = {column.heading: len(column.cells) for column in columns}
    if len(set(lengths.values())) != 1:
        raise MeasurementError(
            f"{path}: the channels differ in length or there are none: {lengths}"
        )
    return Table(path, tuple(columns))


def _read_frfs(path: Path) -> list[Frf]:
    return frfs_of_table(read_channels(path))


TDMS = Format(
    name="tdms",
    label="TDMS of LabVIEW",
    help='channels with the property unit_string; needs "chatter[formats]"',
    extensions=(".tdms",),
    read_frfs=_read_frfs,
    read_signals=read_channels,
)
