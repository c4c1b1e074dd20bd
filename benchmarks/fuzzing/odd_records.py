"""Strategies of whole records that no cut makes: odd clocks, dead, saturated and single samples."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

_FACTORS = (1e-300, 1e-12, 1e-3, 1e3, 1e6, 1e300, 0.0, -1.0)
_COUNTS = (1, 2, 3, 7, 16, 100)


def _table(content: bytes) -> tuple[str, np.ndarray]:
    """Heading and numbers (n, k) of a table in text whose cells stand between commas."""
    heading, *rows = content.decode().splitlines()
    return heading, np.array([[float(cell) for cell in row.split(",")] for row in rows])


@st.composite
def odd_tables(draw: st.DrawFn, content: bytes) -> bytes:
    """Table whose clock or channels are odd, by one or two changes; the first is the time."""
    heading, table = _table(content)
    for _ in range(draw(st.integers(1, 2))):
        column = draw(st.integers(0, table.shape[1] - 1))
        row = draw(st.integers(0, len(table) - 1))
        change = draw(st.integers(0, 8))
        if change == 0:
            table[:, column] = draw(st.sampled_from([0.0, 7.0, 1e300, np.nan]))
        elif change == 1:
            table[:, column] *= draw(st.sampled_from(_FACTORS))
        elif change == 2:
            table[row:, 0] += draw(st.sampled_from([-1.0, -1e-3, 1.0, 1e9]))
        elif change == 3:
            table = table[: draw(st.sampled_from(_COUNTS))]
        elif change == 4:
            table = table[::-1]
        elif change == 5:
            limit = 0.3 * np.nanmax(np.abs(table[:, column]))
            table[:, column] = np.clip(table[:, column], -limit, limit)
        elif change == 6:
            table = np.concatenate([table, table])
        elif change == 7:
            table[:, 0] = np.sqrt(np.abs(table[:, 0]))
        else:
            table[row, column] = draw(st.sampled_from([np.nan, np.inf, 1e308]))
    rows = "\n".join(",".join(f"{x:.9g}" for x in row) for row in table)
    return f"{heading}\n{rows}\n".encode()
