"""Time records from universal files: dataset 58 and 58b of function type 1 (time response)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from chatter.io.formats.uff58 import axis_content, point_of, read_heading, read_values
from chatter.io.formats.units import Channel
from chatter.io.formats.universal import FileUnits, file_units, read_datasets
from dynamics.frf.container import MeasurementError, Point

#: general functions are taken for time records too, where their abscissa is time
_TIME_RESPONSE = (0, 1)


@dataclass(frozen=True)
class TimeRecord:
    """One signal over time.

    Parameters
    ----------
    time : (n,) array of float
        s.
    values : (n,) array of float
        SI where the content is known, else as stored.
    content : str or None
        "force", "displacement", "velocity" or "acceleration"; None where nothing tells.
    point : Point
        Where it was measured.
    title : str
    source : str
        File and dataset.
    """

    time: NDArray[np.float64]
    values: NDArray[np.float64]
    content: Channel | None
    point: Point
    title: str
    source: str


def read_time_records(path: Path) -> list[TimeRecord]:
    """Read every time record of a universal file, text or binary.

    Datasets other than 58 are passed over, save 164 (units).

    Raises
    ------
    MeasurementError
        If the file is cut short, malformed, or holds no time record.

    Notes
    -----
    Layout: SDRC universal dataset 58, "Function at Nodal DOF", and its binary form 58b by UC-SDRL.
    """
    units = FileUnits()
    records = []
    held = []
    for dataset in read_datasets(path):
        if dataset.number == 164:
            units = file_units(dataset, path)
        if dataset.number != 58:
            held.append(f"dataset {dataset.number}")
            continue
        where = f"{path}: dataset {dataset.order}"
        heading, first_byte = read_heading(dataset, where)
        content, factor = axis_content(heading.abscissa, units, where)
        if heading.function_type not in _TIME_RESPONSE or content not in (None, "time"):
            held.append(f"function type {heading.function_type}")
            continue
        time, values = read_values(dataset, heading, first_byte, where)
        channel, channel_factor = axis_content(heading.numerator, units, where)
        title = "" if heading.title.upper() == "NONE" else heading.title
        records.append(
            TimeRecord(
                time=time * factor,
                values=values.real * channel_factor,
                content=channel,
                point=point_of(heading.response),
                title=title,
                source=where,
            )
        )
    if not records:
        content = ", ".join(held) or "no dataset"
        raise MeasurementError(f"{path}: holds no time record; it holds {content}")
    return records
