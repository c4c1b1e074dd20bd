"""Ranges as people write them: FROM..TO, with the number of values behind a colon."""

from __future__ import annotations

import re

from chatter.description.shop_units import with_decimals
from chatter.description.units import NUMBER

_END = re.compile(rf"\s*({NUMBER})\s*(.*?)\s*")
_COUNT = re.compile(r":\s*([+-]?\d+)\s*$")


def without_count(text: str) -> tuple[str, int | None]:
    """Range and the number of its values; None where "FROM..TO" gives none."""
    wanted = _COUNT.search(text)
    if wanted is None or ".." not in text:
        return text, None
    return text[: wanted.start()], int(wanted[1])


def stated_ends(text: str) -> list[str] | None:
    """Ends of a range "FROM..TO", each with its unit; None of what is none.

    "10..200 Hz" is meant as 10 Hz..200 Hz.
    """
    ends = [_END.fullmatch(end) for end in with_decimals(text).split("..")]
    if len(ends) != 2 or ends[0] is None or ends[1] is None:
        return None
    first, last = ends
    return [f"{first[1]} {first[2] or last[2]}".rstrip(), f"{last[1]} {last[2]}".rstrip()]
