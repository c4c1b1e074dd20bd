"""TDMS files of LabVIEW, read by npTDMS."""

from pathlib import Path

import numpy as np

from chatter.io.formats.format import Format
from chatter.io.formats.frf_columns import frfs_of_table
from chatter.io.table import Column, Table, table_of
from dynamics.frf.container import MeasurementError


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
    return table_of(path, columns, "channels")


TDMS = Format(
    name="tdms",
    label="TDMS of LabVIEW",
    help='channels with the property unit_string; needs "chatter[formats]"',
    extensions=(".tdms",),
    read_frfs=lambda path: frfs_of_table(read_channels(path)),
    read_signals=read_channels,
)
