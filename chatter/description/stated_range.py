"""A range of a case file, from, to and count, stated in a line: "3000 rpm..9000 rpm:200"."""

from __future__ import annotations

import re
from typing import Any

from pydantic import BaseModel

from chatter.description.errors import InputError
from chatter.description.formatting import formatted
from chatter.description.path import Step, join_path, keys_of, model_at
from chatter.description.ranges import without_count
from chatter.description.units import NUMBER

_KEYS = {"from", "to", "count"}
_END = re.compile(rf"\s*({NUMBER})\s*(.*?)\s*")


def range_spelt_out(kind: type[BaseModel], steps: tuple[Step, ...], given: Any) -> Any:
    """Table of a range that is given as FROM..TO or FROM..TO:COUNT; anything else as it is.

    InputError where that is no range, no end has a unit, or one that begins at 0 is to begin
    elsewhere.
    """
    if not isinstance(given, str) or ".." not in given:
        return given
    section = model_at(kind, steps)
    keys = set() if section is None else set(keys_of(section))
    if "to" not in keys or not keys <= _KEYS:
        return given
    span, count = without_count(given)
    first, last = (_END.fullmatch(end) for end in span.split("..", 1))
    if first is None or last is None or not last[2]:
        raise InputError(
            f"{join_path(steps)}: {formatted(given)} is no range with units; FROM..TO:COUNT is "
            'required, such as "3000 rpm..9000 rpm:200" or "1 mm..5 mm:20"'
        )
    table: dict[str, Any] = {"to": f"{last[1]} {last[2]}"}
    if count is not None:
        table["count"] = count
    if "from" in keys:
        # "3000..9000 rpm" is meant as 3000 rpm..9000 rpm
        return {"from": f"{first[1]} {first[2] or last[2]}", **table}
    if float(first[1]) != 0.0:
        raise InputError(
            f"{join_path(steps)}: {formatted(given)} is given; it begins at 0, as in "
            f'"0..{table["to"]}"'
        )
    return table
