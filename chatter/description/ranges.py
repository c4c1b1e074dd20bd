"""Ranges as people write them: FROM..TO, with the number of values behind a colon."""

from __future__ import annotations

import re

_COUNT = re.compile(r":\s*([+-]?\d+)\s*$")


def without_count(text: str) -> tuple[str, int | None]:
    """Range and the number of its values; None where "FROM..TO" gives none."""
    wanted = _COUNT.search(text)
    if wanted is None or ".." not in text:
        return text, None
    return text[: wanted.start()], int(wanted[1])
