"""Frames in which nothing is cut: the floor between the lines tells them from the others."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from chatter.detection.spectral.spectra import Frames

Array = NDArray[np.float64]

#: line half widths to a band
_BAND = 16
#: power of a bin below which it is silence, over the largest
_SILENCE = 1e-9
#: share of the frames of lowest level that is the reference of a band
_QUIET = 0.1
#: dB between the two classes, and their distance over the scatter within, where they differ
_APART_DB, _APART = 3.0, 3.0
#: fewest frames that can be told apart
_FEWEST = 6


def activity_levels(frames: Frames) -> Array:
    """Level of each frame above the quiet ones, dB, (m,).

    Mean of two: of the power as a whole, which chatter or a strong harmonic raises, and of the
    median over bands, which the noise of cutting raises where hum hides the power.
    """
    width = max(round(_BAND * frames.half_width / frames.step), 4)
    count = frames.frequency.size // width
    bands = frames.power[:, : count * width].reshape(len(frames.power), count, width)
    least = _SILENCE * float(frames.power.max()) + 1e-300
    level = 10.0 * np.log10(bands.mean(axis=2) + least)
    by_band = np.median(level - np.quantile(level, _QUIET, axis=0), axis=1)
    whole = 10.0 * np.log10(frames.power.sum(axis=1) + least * frames.frequency.size)
    return 0.5 * (by_band + whole - np.quantile(whole, _QUIET))


def idle_frames(levels: Array) -> NDArray[np.bool_] | None:
    """Frames of the lower of two classes; None where the levels make no two classes.

    The threshold is that of Otsu (1979, IEEE Trans. SMC 9, 62): largest variance between classes.
    """
    if levels.size < _FEWEST:
        return None
    ordered = np.sort(levels)
    count = np.arange(1, ordered.size)
    low = np.cumsum(ordered)[:-1] / count
    high = np.cumsum(ordered[::-1])[:-1][::-1] / count[::-1]
    between = count * count[::-1] * (high - low) ** 2
    best = int(np.argmax(between))
    threshold = 0.5 * (ordered[best] + ordered[best + 1])
    idle = levels < threshold
    within = float(np.sqrt(0.5 * (levels[idle].var() + levels[~idle].var())))
    apart = float(high[best] - low[best])
    if apart < _APART_DB or apart < _APART * within:
        return None
    return idle
