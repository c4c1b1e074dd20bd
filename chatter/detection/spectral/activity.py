"""Frames in which nothing is cut: their level tells them, and that no teeth are heard in them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from chatter.detection.spectral.chatter_lines import Comb, share_of_harmonics
from chatter.detection.spectral.recording import Recording
from chatter.detection.spectral.spectra import Frames, above_floor

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
#: low harmonics of the teeth, their share from which quiet frames cut as well, and how many frames
#: it takes, as those at the border of a cut hold a part of it
_LOW, _TEETH, _FEWEST_CUTTING = 12, 0.6, 4
#: harmonics of the teeth whose level tells a cut from a machine that hums louder
_HARMONICS = 30
#: s without any change of the signal that is no record: muted, or before the first sample
_UNCHANGED = 0.05


def silent_frames(recording: Recording, frames: Frames) -> NDArray[np.bool_]:
    """Frames in which no channel changes for a while: nothing was recorded, (m,).

    A machine at rest makes noise; digital silence does not say what it sounds like.
    """
    changes = np.any(np.diff(recording.values, axis=0) != 0.0, axis=1)
    at = np.concatenate([[0], np.flatnonzero(changes) + 1, [len(recording.values) - 1]])
    long = np.flatnonzero(np.diff(at) * recording.time_step > _UNCHANGED)
    silent = np.zeros(frames.time.size, dtype=bool)
    half = 0.5 * frames.length
    for begin, end in zip(at[long], at[long + 1], strict=True):
        begin_time = recording.start + begin * recording.time_step
        end_time = recording.start + end * recording.time_step
        shared = np.minimum(frames.time + half, end_time) - np.maximum(
            frames.time - half, begin_time
        )
        silent |= shared > _UNCHANGED
    # values that are held from one reading to the next are a slow channel, and all there is
    return silent if not silent.all() else np.zeros_like(silent)


def activity_levels(frames: Frames, silent: NDArray[np.bool_]) -> Array:
    """Level of each frame above the quiet ones, dB, (m,); -inf of silent ones.

    Mean of two: of the power as a whole, which chatter or a strong harmonic raises, and of the
    median over bands, which the noise of cutting raises where hum hides the power.
    """
    power = frames.power[~silent]
    # a slow recording has a single band
    width = min(max(round(_BAND * frames.half_width / frames.step), 4), frames.frequency.size)
    count = frames.frequency.size // width
    bands = power[:, : count * width].reshape(len(power), count, width)
    least = _SILENCE * float(power.max()) + 1e-300
    level = 10.0 * np.log10(bands.mean(axis=2) + least)
    by_band = np.median(level - np.quantile(level, _QUIET, axis=0), axis=1)
    whole = 10.0 * np.log10(power.sum(axis=1) + least * frames.frequency.size)
    levels = np.full(frames.time.size, -np.inf)
    levels[~silent] = 0.5 * (by_band + whole - np.quantile(whole, _QUIET))
    return levels


def harmonic_levels(frames: Frames, combs: Sequence[Comb], silent: NDArray[np.bool_]) -> Array:
    """Mean level of the harmonics of the teeth above that of quiet frames, dB, (m,).

    It is -inf of silent ones. A line of the machine that is louder than the cut does not hide them.
    """
    levels = np.full(frames.time.size, -np.inf)
    for row in np.flatnonzero(~silent):
        at = combs[row].tooth * np.arange(1, _HARMONICS + 1)
        index = np.round(at[at < frames.frequency[-1]] / frames.step).astype(np.intp)
        levels[row] = np.mean(np.log10(frames.power[row, index] + 1e-300)) if index.size else 0.0
    return 10.0 * (levels - np.quantile(levels[~silent], _QUIET))


def frames_at_rest(
    levels: Array, frames: Frames, combs: Sequence[Comb]
) -> NDArray[np.bool_] | None:
    """Frames of so low a level that nothing is cut; None where no frame is such.

    Quiet frames in which the teeth are heard are a cut that is stable, or shallow, beside one that
    chatters, or is deep: what is quieter still is looked for among them.
    """
    idle = idle_frames(levels)
    while idle is not None:
        rows = np.flatnonzero(idle)
        inside = idle_frames(levels[rows])
        louder = None if inside is None else rows[~inside]
        if louder is not None and are_cutting(frames, combs, louder):
            idle = np.zeros_like(idle)
            idle[rows[inside]] = True
        elif are_cutting(frames, combs, rows[np.isfinite(levels[rows])]):
            return None
        else:
            return idle
    return None


def are_cutting(frames: Frames, combs: Sequence[Comb], rows: NDArray[np.intp]) -> bool:
    """Whether most of the low harmonics of the teeth stand out in some frames.

    A spindle that turns in the air has some too, of its balance, its bearings and its drive.
    """
    if rows.size < _FEWEST_CUTTING:
        return False
    middle = combs[rows[rows.size // 2]]
    above = above_floor(np.median(frames.power[rows], axis=0), frames.frequency, frames.length)
    return share_of_harmonics(above, frames.frequency, middle, _LOW) > _TEETH


def idle_frames(levels: Array) -> NDArray[np.bool_] | None:
    """Frames of the lower of two classes; None where the levels make no two classes.

    Silent frames, of level -inf, are of neither, and are told from the others in any case.
    The threshold is that of Otsu (1979, IEEE Trans. SMC 9, 62): largest variance between classes.
    """
    heard = levels[np.isfinite(levels)]
    if heard.size < _FEWEST:
        return None
    ordered = np.sort(heard)
    count = np.arange(1, ordered.size)
    low = np.cumsum(ordered)[:-1] / count
    high = np.cumsum(ordered[::-1])[:-1][::-1] / count[::-1]
    between = count * count[::-1] * (high - low) ** 2
    best = int(np.argmax(between))
    threshold = 0.5 * (ordered[best] + ordered[best + 1])
    within = float(np.sqrt(0.5 * (ordered[: best + 1].var() + ordered[best + 1 :].var())))
    apart = float(high[best] - low[best])
    if apart < _APART_DB or apart < _APART * within:
        return None
    return levels < threshold
