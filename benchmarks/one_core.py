"""Times, peak and memory bandwidth of one core, and the table that they stand in.

The shortest and the median of some repeats, warm, with compilation left out. Times are those of the
processor in the only thread that works, which other programs on the machine lengthen less than
those of the clock.
"""

from __future__ import annotations

import os
import statistics
import time
from collections.abc import Callable
from typing import NamedTuple

# figures of one core: threads of the linear algebra would wait for a busy second one
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from numba import njit

REPEATS = 7


class Timing(NamedTuple):
    """Shortest and median of repeats, s."""

    shortest: float
    median: float


def timed(call: Callable[[], object], repeats: int = REPEATS) -> Timing:
    """Time a call that was made once before."""
    call()
    taken = []
    for _ in range(repeats):
        start = time.thread_time()
        call()
        taken.append(time.thread_time() - start)
    return Timing(min(taken), statistics.median(taken))


def show(title: str, heads: str, rows: list[tuple]) -> list[dict]:
    """Print a table, its heads parted by bars, and return its rows by column."""
    columns = heads.split("|")
    text = [
        tuple(columns),
        *[tuple(x if isinstance(x, str) else f"{x:.3g}" for x in row) for row in rows],
    ]
    widths = [max(len(row[i]) for row in text) for i in range(len(columns))]
    print(f"\n{title}")
    for row in text:
        print("  " + "  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)))
    return [dict(zip(columns, row, strict=True)) for row in rows]


@njit(fastmath={"contract"}, error_model="numpy")
def _independent_fmas(value, factor, rounds):
    """16 multiply-adds on each of the values, which do not depend on each other."""
    for _ in range(rounds):
        for i in range(value.shape[0]):
            x = value[i]
            x = x * factor + 1e-9
            x = x * factor + 2e-9
            x = x * factor + 3e-9
            x = x * factor + 4e-9
            x = x * factor + 5e-9
            x = x * factor + 6e-9
            x = x * factor + 7e-9
            x = x * factor + 8e-9
            x = x * factor + 9e-9
            x = x * factor + 10e-9
            x = x * factor + 11e-9
            x = x * factor + 12e-9
            x = x * factor + 13e-9
            x = x * factor + 14e-9
            x = x * factor + 15e-9
            x = x * factor + 16e-9
            value[i] = x


def floating_point_peak() -> float:
    """Operations a second of one core, a multiply-add counted as two."""
    value, rounds = np.ones(512), 20_000
    taken = timed(lambda: _independent_fmas(value, 0.999, rounds))
    return 2 * 16 * value.size * rounds / taken.shortest


@njit
def _copies(source, target, rounds):
    """Copy arrays again and again."""
    for _ in range(rounds):
        target[:] = source


def bandwidth_of(numbers: int) -> float:
    """Bytes a second that one core copies, read and written, in arrays of so many numbers."""
    source, target = np.ones(numbers), np.zeros(numbers)
    rounds = max(1, (1 << 24) // numbers)
    taken = timed(lambda: _copies(source, target, rounds))
    return 2 * source.nbytes * rounds / taken.shortest
