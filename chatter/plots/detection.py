"""Picture of detected chatter: spectrogram, verdicts over time, spectrum with harmonics marked."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from chatter.plots import style

if TYPE_CHECKING:
    from chatter.monitoring.result import DetectedChatter

_COLOURS = {
    "chatter": style.RED,
    "stable": style.GREEN,
    "idle": "#C8C8C8",
    "not judged": style.ORANGE,
}
#: dB below the largest value that the colours span
_SPAN = 55.0
#: the picture ends at this multiple of the chatter frequency, or of so many tooth passings, Hz
_ABOVE_CHATTER, _TOOTH_PASSINGS, _LEAST = 2.5, 16.0, 1000.0
#: most columns and rows of the spectrogram
_COLUMNS, _ROWS = 1500, 1200


def plot_detection(found: DetectedChatter) -> Figure:
    """Draw the spectrogram, the verdicts above it, and the spectrum beside it."""
    figure = style.new_figure(11.0, 5.6)
    grid = figure.add_gridspec(2, 2, height_ratios=(0.07, 1.0), width_ratios=(1.0, 0.42))
    strip = figure.add_subplot(grid[0, 0])
    image = figure.add_subplot(grid[1, 0], sharex=strip)
    side = figure.add_subplot(grid[1, 1], sharey=image)
    figure.suptitle(_title(found), fontsize=11.0, x=0.01, ha="left")
    highest = _highest(found)
    _draw_verdicts(strip, found)
    _draw_spectrogram(image, found, highest)
    _draw_spectrum(side, found, highest)
    return figure


def _title(found: DetectedChatter) -> str:
    name = found.recording.name.replace("\\", "/").rpartition("/")[2]
    words = f"{name}: {found.headline}"
    if found.chatter_frequency is not None:
        words += f", at {found.chatter_frequency:.1f} Hz"
    if found.evidence.revolution is not None:
        words += f", {60.0 * found.evidence.revolution.mean:.0f} rpm"
    if found.refuting_speed is not None:
        words += f" as stated, {60.0 * found.refuting_speed.frequency:.0f} rpm by the lines"
    return words


def _highest(found: DetectedChatter) -> float:
    """Highest frequency of the picture, Hz."""
    end = float(found.evidence.frames.frequency[-1])
    wanted = _LEAST
    if found.chatter_frequency is not None:
        wanted = max(wanted, _ABOVE_CHATTER * found.chatter_frequency)
    if found.evidence.revolution is not None:
        tooth = found.evidence.revolution.mean * (found.evidence.teeth or 1)
        wanted = max(wanted, _TOOTH_PASSINGS * tooth)
    return min(wanted, end)


def _draw_verdicts(axes: Axes, found: DetectedChatter) -> None:
    named = set()
    for one in found.segments:
        label = None if one.verdict in named else one.verdict
        named.add(one.verdict)
        axes.axvspan(one.begin, one.end, color=_COLOURS[one.verdict], label=label, linewidth=0.0)
    axes.set_yticks([])
    axes.tick_params(labelbottom=False, bottom=False)
    for side in axes.spines.values():
        side.set_visible(False)
    axes.figure.legend(
        *axes.get_legend_handles_labels(), loc="upper right", ncols=4, fontsize=8.0, frameon=False
    )


def _draw_spectrogram(axes: Axes, found: DetectedChatter, highest: float) -> None:
    frames = found.evidence.frames
    count = int(np.searchsorted(frames.frequency, highest))
    rows = max(-(-count // _ROWS), 1)
    columns = max(-(-frames.time.size // _COLUMNS), 1)
    # the largest of what falls on one point: no line is lost
    power = frames.power[:, : count // rows * rows].reshape(frames.time.size, -1, rows)
    power = power.max(axis=2)[::columns]
    level = 10.0 * np.log10(power.T + 1e-300)
    top = float(level.max())
    half = 0.5 * frames.length
    extent = (frames.time[0] - half, frames.time[-1] + half, 0.0, frames.frequency[count - 1])
    axes.imshow(
        level, origin="lower", aspect="auto", extent=extent, cmap="magma",
        vmin=top - _SPAN, vmax=top, interpolation="nearest",
    )  # fmt: skip
    for one in found.segments:
        if one.verdict == "chatter":
            axes.plot(
                [one.begin, one.end], 2 * [one.chatter_frequency], color="white", linewidth=0.8,
                linestyle=(0, (1, 6)),
            )  # fmt: skip
    axes.set_xlabel("time [s]")
    axes.set_ylabel("frequency [Hz]")


def _draw_spectrum(axes: Axes, found: DetectedChatter, highest: float) -> None:
    """Mean spectrum of the longest chatter, else of what is cut, with the harmonics."""
    frames = found.evidence.frames
    rows = _rows_of_interest(found)
    level = 10.0 * np.log10(frames.power[rows].mean(axis=0) + 1e-300)
    shown = frames.frequency <= highest
    level = level - level[shown].max()
    revolution = found.evidence.revolution
    if revolution is not None:
        other = found.refuting_speed
        speed = float(np.median(revolution.frequency[rows])) if other is None else other.frequency
        tooth = speed * (found.evidence.teeth or 1)
        for k, order in enumerate(np.arange(tooth, highest, tooth)):
            axes.axhline(
                order, color=style.BLUE, linewidth=0.5, alpha=0.6,
                label=f"harmonics of {tooth:.1f} Hz" if k == 0 else None,
            )  # fmt: skip
    axes.plot(level[shown], frames.frequency[shown], color="black", linewidth=0.6)
    if found.chatter_frequency is not None:
        at = int(np.argmin(np.abs(frames.frequency - found.chatter_frequency)))
        axes.plot(
            level[at], found.chatter_frequency, "o", color=style.RED, markersize=6.0,
            label=f"chatter {found.chatter_frequency:.1f} Hz",
        )  # fmt: skip
    axes.set_xlim(-_SPAN - 10.0, 4.0)
    axes.set_ylim(0.0, highest)
    axes.set_xlabel("power [dB]")
    axes.tick_params(labelleft=False)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="upper left", fontsize=8.0)


def _rows_of_interest(found: DetectedChatter) -> np.ndarray:
    """Frames of the longest segment of the verdict of the recording."""
    own = [one for one in found.segments if one.verdict == found.verdict]
    longest = max(own, key=lambda one: one.end - one.begin)
    time = found.evidence.frames.time
    return np.flatnonzero((time >= longest.begin) & (time <= longest.end))
