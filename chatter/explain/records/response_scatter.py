"""Scatter of measured FRFs: from repetitions, or of one from its own lines."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from chatter.explain.measurement import Run

Array = NDArray[np.float64]

#: lines over which the scatter is taken for one
_SMOOTHED = 31


def repetitions_of(run: Run, runs: Sequence[Run]) -> list[Run]:
    """Runs of the same condition, direction and lines, the run itself among them."""
    return [
        one
        for one in runs
        if (one.condition, one.direction) == (run.condition, run.direction)
        and one.signals["real"].size == run.signals["real"].size
    ]


def scatter(run: Run, repetitions: Sequence[Run]) -> Array:
    """Standard deviation of real and imaginary part at every line, from repetitions."""
    values = np.array([one.signals["real"] + 1j * one.signals["imag"] for one in repetitions])
    if len(values) > 1:
        spread = np.sum(np.abs(values - values.mean(axis=0)) ** 2, axis=0) / (2 * (len(values) - 1))
    else:
        own = run.signals["real"] + 1j * run.signals["imag"]
        spread = np.abs(np.convolve(own, [1, -2, 1], mode="same")) ** 2 / 12.0
    return np.sqrt(_smoothed(spread, np.abs(values.mean(axis=0)) ** 2))


def _smoothed(spread: Array, square: Array) -> Array:
    """Variance at every line, from its spread about it, with the square of the response.

    Part of it is near enough the same over some lines, as that of a sensor, and part a share of the
    response, as that of a hammer test: a straight line over the square, of parts not below nothing.
    """
    spreads, squares = (
        np.lib.stride_tricks.sliding_window_view(
            np.pad(one, _SMOOTHED // 2, mode="reflect"), _SMOOTHED
        )
        for one in (spread, square)
    )
    mean, level = spreads.mean(axis=1), squares.mean(axis=1)
    away = squares - level[:, None]
    slope = np.sum(away * spreads, axis=1) / np.maximum(np.sum(away**2, axis=1), 1e-300)
    share = np.clip(slope, 0.0, mean / np.maximum(level, 1e-300))
    return mean + share * (square - level)
