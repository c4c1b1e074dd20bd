"""Stages of a record: air, entry, cut and exit; and the part in which the cut is settled."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.explain.records.description import AIR
from cutting.engagement.immersion import engagement

Array = NDArray[np.float64]

#: share of the way, on a logarithmic scale, from the level in the air to that in the cut
_CONTACT = 0.5
#: least ratio of the levels in the cut and in the air by which they differ for certain
_APART = 3.0
#: deviation from the settled revolutions, over that among these, from which one is not settled,
#: and least one, as a share of the signal
_UNSETTLED, _LEAST_UNSETTLED = 1.8, 0.03
#: revolutions, and samples, of the settled part, at the least and at the most
_LEAST_REVOLUTIONS, _MOST_SAMPLES = 4, 6000


class Stages(NamedTuple):
    """Stages of a record by samples, and how steady its settled part is."""

    entry: int  # first sample in contact
    leave: int  # sample after the last in contact
    settled: slice
    unsteadiness: float  # rms of what does not repeat with the revolution, over that which does
    #: rms of the change from the first half of the settled part to the second, over the signal
    drift: float

    def description(self, time: Array) -> str:
        """Stages in words."""
        begin, end = time[self.settled.start], time[self.settled.stop - 1]
        parts = [f"settled from {begin - time[0]:.3g} s to {end - time[0]:.3g} s"]
        if self.entry > 0:
            parts.insert(0, f"in the air up to {time[self.entry] - time[0]:.3g} s")
        if self.leave < time.size:
            parts.append(f"out of the cut from {time[self.leave] - time[0]:.3g} s")
        return ", ".join(parts)


def stages_of(case: Case, time: Array, signals: Array, begins: str) -> Stages:
    """Stages of a record of channels (c, n) by the case of the run, with its true speed."""
    step = float(time[-1] - time[0]) / (time.size - 1)
    turn = 2.0 * math.pi / case.cut.spindle_speed
    entry, leave, latest = 0, time.size, 0
    ramp = int(_entry_travel(case) / _feed_speed(case) / step)
    if begins == AIR:
        window = max(int(turn / step), 4)
        entry, leave = _contact(signals, window)
        # a contact within the first revolution is not seen: it is the end of it at the latest
        latest = (entry or window) + ramp
    first = min(latest, leave)
    last = max(leave - ramp, 0) if leave < time.size else leave
    if (last - first) * step < _LEAST_REVOLUTIONS * turn:
        first, last = entry, leave
    begin, unsteadiness = _settled_from(signals[:, first:last], turn / step)
    most = max(_MOST_SAMPLES, int(_LEAST_REVOLUTIONS * turn / step) + 1)
    whole = int((last - first - begin) * step / turn)
    size = min(max(round(whole * turn / step), 1) if whole else last - first - begin, most)
    if size == most and whole:
        size = round(max(int(most * step / turn), 1) * turn / step)
    settled = slice(last - size, last)
    return Stages(entry, leave, settled, unsteadiness, _drift(signals[:, settled], turn / step))


def _contact(signals: Array, window: int) -> tuple[int, int]:
    """First sample in contact, and that after the last: by the swing within a revolution."""
    swing = np.max(
        [_swing(row, window) / max(_swing(row, window).max(), 1e-300) for row in signals], axis=0
    )
    low, high = np.quantile(swing, 0.02), np.quantile(swing, 0.9)
    if high < _APART * low:
        return 0, signals.shape[1]
    touching = np.flatnonzero(swing > low ** (1.0 - _CONTACT) * high**_CONTACT)
    # a window that begins in the air holds the first contact at its end
    entry = int(touching[0]) + window - 1 if touching[0] > 0 else 0
    leave = int(touching[-1]) + 1 if touching[-1] < swing.size - 1 else signals.shape[1]
    return min(entry, signals.shape[1] - 1), leave


def _swing(row: Array, window: int) -> Array:
    """Standard deviation within every window (n - window + 1,)."""
    sums = np.cumsum(np.concatenate([[0.0], row - row.mean()]))
    squares = np.cumsum(np.concatenate([[0.0], (row - row.mean()) ** 2]))
    mean = (sums[window:] - sums[:-window]) / window
    return np.sqrt(np.maximum((squares[window:] - squares[:-window]) / window - mean**2, 0.0))


def _entry_travel(case: Case) -> float:
    """Travel of the tool from the first touch of a straight front edge to full immersion, m."""
    radius = 0.5 * case.tool.diameter
    arc = engagement(case.uncut_band, radius)
    # the edge at phi is R sin(phi) ahead of the axis
    ahead = [math.sin(arc.entry), math.sin(arc.exit)]
    middle = 0.5 * math.pi
    foremost = 1.0 if arc.entry <= middle <= arc.exit else max(ahead)
    return radius * (foremost - min(ahead))


def _feed_speed(case: Case) -> float:
    cut = case.cut
    return max(cut.feed_per_tooth * case.tool.teeth * cut.spindle_speed / (2.0 * math.pi), 1e-12)


def _revolutions(signals: Array, turn: float) -> Array:
    """Channels (c, n) by whole revolutions (c, r, p), the last at the end, means taken off.

    Over the deviations of the channels.
    """
    count = signals.shape[1]
    whole = int((count - 1) / turn)
    points = max(int(turn), 8)
    at = count - 1 - whole * turn
    at = at + (np.arange(whole)[:, None] + np.arange(points) / points) * turn
    rows = np.array([np.interp(at, np.arange(count), row) for row in signals])
    rows -= rows.mean(axis=2, keepdims=True)
    return rows / np.maximum(np.std(signals, axis=1), 1e-300)[:, None, None]


def _drift(signals: Array, turn: float) -> float:
    """Change of channels (c, n) from the first half of the revolutions to the second, by rms."""
    rows = _revolutions(signals, turn)
    half = rows.shape[1] // 2
    if half < 1:
        return 0.0
    change = rows[:, -half:].mean(axis=1) - rows[:, :half].mean(axis=1)
    return math.sqrt(float(np.mean(change**2)))


def _settled_from(signals: Array, turn: float) -> tuple[int, float]:
    """First sample from which channels (c, n) repeat with a revolution of that many samples."""
    rows = _revolutions(signals, turn)
    whole = rows.shape[1]
    if whole < 2:
        return 0, 0.0
    tail = max(2, whole // 3)
    steady = rows[:, -tail:].mean(axis=1)
    level = math.sqrt(float(np.mean(steady**2))) + 1e-300
    away = np.sqrt(np.mean((rows - steady[:, None]) ** 2, axis=(0, 2))) / level
    typical = float(np.median(away[-tail:])) * math.sqrt(tail / (tail - 1.0))
    limit = max(_UNSETTLED * typical, _LEAST_UNSETTLED)
    unsettled = np.flatnonzero(away[: whole - min(tail, whole)] > limit)
    first = int(unsettled[-1]) + 1 if unsettled.size else 0
    first = min(first, max(whole - _LEAST_REVOLUTIONS, 0))
    begin = signals.shape[1] - 1 - whole * turn
    start = 0 if first == 0 else math.ceil(begin + first * turn)
    return start, typical
