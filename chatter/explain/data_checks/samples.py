"""Samples and channels by themselves: gaps, flat tops, dropouts, dead channels, copies of runs."""

from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.explain.data_checks.finding import (
    CHANNEL,
    FATAL,
    NOTE,
    RUN,
    SAMPLES,
    Check,
    SignalFinding,
)
from chatter.explain.measurement import Measurement, Run

#: share of a channel's samples up to which they are excluded; beyond, the channel is
_MOST_EXCLUDED = 0.3
#: zeros in a row that no signal with noise has
_HELD = 3


class Columns(NamedTuple):
    """Columns of a kind of measurement that are checked sample by sample."""

    recorded: tuple[str, ...]
    needed: tuple[str, ...] = ()  # without which a run is of no use
    optional: tuple[str, ...] = ()  # without which everything is done
    may_rest: tuple[str, ...] = ()  # that may be zero from end to end

    def of(self, run: Run) -> list[str]:
        """Those that a run has."""
        return [name for name in (*self.recorded, *run.described) if name in run.signals]


def sample_checks(columns: Columns) -> tuple[Check, ...]:
    """Checks of records of any kind: copies of runs, dead channels, gaps, flat tops."""
    return tuple(partial(check, columns) for check in (copies, dead_channels, gaps, flat_tops))


def dropouts(columns: Columns) -> Check:
    """Check of records in time: samples at exactly zero in between."""
    return partial(_dropouts, columns)


def intervals(of: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Begin and end (exclusive) of the intervals that are true."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], of, [False]]).astype(np.int8)))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def gaps(columns: Columns, measurement: Measurement) -> list[SignalFinding]:
    """Samples that are no numbers."""
    found = []
    for run in measurement.runs:
        for channel in columns.of(run):
            bad = ~np.isfinite(run.signals[channel])
            if bad.any():
                description = (
                    f"{run.name}: {channel} has {bad.sum()} samples of {bad.size} that are no "
                    f"numbers, in {len(intervals(bad))} gaps"
                )
                found.append(_of_samples(columns, run, channel, bad, description))
    return found


def dead_channels(columns: Columns, measurement: Measurement) -> list[SignalFinding]:
    """Channels that never change."""
    found = []
    for run in measurement.runs:
        for channel in columns.of(run):
            values = run.signals[channel]
            values = values[np.isfinite(values)]
            rests = channel in columns.may_rest and not np.any(values)
            if values.size < 2 or (np.ptp(values) == 0.0 and not rests):
                level = f" at {values[0]:.4g}" if values.size else ""
                description = f"{run.name}: {channel} is dead: constant{level} (SI) from end to end"
                found.append(_of_channel(columns, run, channel, description))
    # a channel that is dead in every run is missing from the set, which may need it
    fatal = []
    for channel in {one.channel for one in found}:
        dead = [one for one in found if one.channel == channel]
        if len(dead) == len(measurement.runs) and channel not in (
            *columns.optional,
            *columns.may_rest,
        ):
            description = f"{channel} is dead, constant from end to end, in all {len(dead)} runs"
            fatal.append(SignalFinding(FATAL, "", channel, description))
    return fatal + found


def flat_tops(columns: Columns, measurement: Measurement) -> list[SignalFinding]:
    """Saturation: the extreme repeated exactly, cut off from a signal that was on its way."""
    found = []
    for run in measurement.runs:
        for channel in columns.of(run):
            values = run.signals[channel]
            if np.sum(np.isfinite(values)) < 16 or np.nanmax(values) == np.nanmin(values):
                continue
            clipped = clipped_samples(values)
            if clipped.any():
                level = float(np.abs(values[clipped]).max())
                description = (
                    f"{run.name}: {channel} is cut off at {level:.4g} (SI): {clipped.sum()} "
                    f"samples in {len(intervals(clipped))} flat tops; the amplifier or its range "
                    "was at its end"
                )
                found.append(_of_samples(columns, run, channel, clipped, description))
    return found


def clipped_samples(values: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Samples on flat tops at the highest or lowest value.

    A rounded crest repeats its highest value too, but comes to it by steps of the resolution.
    """
    clipped = np.zeros(values.size, dtype=bool)
    known = values[np.isfinite(values)]
    levels = np.unique(known)
    resolution = float(np.min(np.diff(levels)))
    typical = float(np.median(np.abs(np.diff(known))))
    for extreme in (levels[0], levels[-1]):
        if extreme == 0.0:  # out of cut, at rest
            continue
        flats = [(a, b) for a, b in intervals(values == extreme) if b - a >= 3]
        count = sum(b - a for a, b in flats)
        if not flats or (len(flats) < 2 and count < 6):
            continue
        steps = [abs(values[a - 1] - extreme) for a, _ in flats if a > 0]
        steps += [abs(values[b] - extreme) for _, b in flats if b < values.size]
        steps = [step for step in steps if np.isfinite(step)]
        if steps and np.median(steps) > max(4.0 * resolution, 0.1 * typical):
            clipped |= values == extreme
    return clipped


def _dropouts(columns: Columns, measurement: Measurement) -> list[SignalFinding]:
    """Samples that are exactly zero in the middle of a signal."""
    found = []
    for run in measurement.runs:
        for channel in columns.of(run):
            lost = dropped_samples(run.signals[channel])
            if lost.any():
                description = (
                    f"{run.name}: {channel} drops to exactly zero for {lost.sum()} samples in "
                    f"{len(intervals(lost))} places"
                )
                found.append(_of_samples(columns, run, channel, lost, description))
    return found


def dropped_samples(values: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Zeros to which and from which a signal jumps.

    Of a signal that is often at zero (a tool out of cut, an axis at rest) none is a dropout.
    """
    lost = np.zeros(values.size, dtype=bool)
    level = float(np.sqrt(np.nanmean(values**2)))
    often = np.mean(values == 0.0) > 0.05
    if level == 0.0 or often:
        return lost
    step = 6.0 * float(np.nanmedian(np.abs(np.diff(values))))
    for begin, end in intervals(values == 0.0):
        before = values[begin - 1] if begin > 0 else np.inf
        after = values[end] if end < values.size else np.inf
        jump = min(abs(before), abs(after))
        # noise alone holds no zero for several samples
        held = end - begin >= _HELD and jump > 0.1 * level
        if np.isfinite(jump) and (held or jump > max(0.3 * level, step)):
            lost[begin:end] = True
    return lost


def copies(columns: Columns, measurement: Measurement) -> list[SignalFinding]:
    """Runs that hold the same numbers as another one."""
    found = []
    runs = measurement.runs
    for later in range(1, len(runs)):
        for earlier in range(later):
            a, b = runs[earlier], runs[later]
            if not _same(columns, a, b):
                continue
            alike = _declared(a) == _declared(b)
            description = f"{b.name}: holds the same numbers as {a.name}"
            if not alike:
                description += (
                    ", though declared otherwise; one of them is wrong: both are excluded"
                )
                found.append(SignalFinding(RUN, a.name, "", description))
            found.append(SignalFinding(RUN, b.name, "", description))
            break
    return found


def _declared(run: Run) -> tuple:
    return dict(run.overrides), run.condition, run.direction


def _same(columns: Columns, a: Run, b: Run) -> bool:
    shared = [name for name in columns.of(a) if name in b.signals]
    for name in shared:
        one, other = a.signals[name], b.signals[name]
        if one.size != other.size or not np.array_equal(one, other, equal_nan=True):
            return False
    return any(
        np.ptp(a.signals[name][np.isfinite(a.signals[name])]) > 0.0
        for name in shared
        if np.isfinite(a.signals[name]).any()
    )


def _of_samples(
    columns: Columns, run: Run, channel: str, bad: NDArray[np.bool_], description: str
) -> SignalFinding:
    if bad.mean() > _MOST_EXCLUDED:
        return _of_channel(columns, run, channel, description)
    if channel in columns.optional:
        return SignalFinding(NOTE, run.name, channel, description)
    return SignalFinding(SAMPLES, run.name, channel, description, bad)


def _of_channel(columns: Columns, run: Run, channel: str, description: str) -> SignalFinding:
    severity = RUN if channel in columns.needed else CHANNEL
    return SignalFinding(severity, run.name, channel, description)
