"""Times of day in the rows of a record, with or without a date, as seconds since the first."""

from __future__ import annotations

import itertools
import re
from collections.abc import Sequence

import numpy as np

from chatter.description.arrays import Array

_DAY = 86400.0
#: a date in any spelling, hours, minutes, seconds with any part of one
_STAMP = re.compile(
    r"(?:(?P<date>[0-9]{1,4}[-./][0-9]{1,2}[-./][0-9]{1,4})[T\s]\s*)?"
    r"(?P<hour>[0-9]{1,2}):(?P<minute>[0-9]{2}):(?P<second>[0-9]{2}(?:[.,][0-9]+)?)"
    r"(?:Z|\s*[+-][0-9]{2}:?[0-9]{2})?"
)


def is_time_stamp(cell: str) -> bool:
    """Tell whether a cell is a time of day, such as "2024-03-12 09:12:33.125"."""
    return _STAMP.fullmatch(cell.strip()) is not None


def seconds_of(cells: Sequence[str]) -> Array | None:
    """Seconds (n,) since the first of these times of day; None where one is none.

    A change of the date is the next day, and so is a time of day that falls back by more than half
    a day where there are no dates.
    """
    found = [_STAMP.fullmatch(str(cell).strip()) for cell in cells]
    if not found or any(one is None for one in found):
        return None
    stamps = [one for one in found if one is not None]
    clock = np.array(
        [
            3600.0 * int(one["hour"])
            + 60.0 * int(one["minute"])
            + float(one["second"].replace(",", "."))
            for one in stamps
        ]
    )
    dates = [one["date"] for one in stamps]
    changes = [before != after for before, after in itertools.pairwise(dates)]
    is_next = np.array(changes, dtype=bool)
    if dates[0] is None:
        is_next |= np.diff(clock) < -0.5 * _DAY
    days = np.concatenate([[0.0], np.cumsum(is_next)])
    return clock - clock[0] + _DAY * days
