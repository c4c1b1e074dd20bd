"""Faults that one channel shows by itself: stuck samples, clipping, dropouts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from dynamics.frf.hammer.hit import Baseline, Hit, noise_of
from dynamics.frf.hammer.record import Fault, Finding, HammerRecord
from dynamics.frf.hammer.written_number import written

#: expected number of chance events in a record below which a coincidence is taken as a fault
_CHANCE = 1e-5
#: chance below which equal values at the very top are taken as clipping
_CHANCE_OF_EQUAL_TOPS = 1e-3
#: how far a single sample may lie from the curve through its neighbours, in standard deviations
_SPIKE_DEVIATIONS = 8.0
#: the same against the typical distance nearby, for signals that are not smooth
_SPIKE_OVER_NEIGHBOURS = 12.0
#: norm of 1, (-15, 6, -1) / 20: noise of the distance from a curve through six neighbours
_SIXTH_DIFFERENCE_NORM = float(np.sqrt(1.0 + 2.0 * (225.0 + 36.0 + 1.0) / 400.0))
#: an overshoot that clipping must have cut off, as a share of the peak
_CLIPPED_SHARE = 0.015
#: a segment of equal values up to this long may be a dropout, samples
_LONGEST_DROPOUT = 40


def channel_findings(record: HammerRecord, hit: Hit) -> list[Finding]:
    """Examine force and response each by itself.

    At most one finding a channel: a clipped or stuck segment has edges that look like dropouts.
    """
    findings = []
    for name in ("force", "response"):
        channel = _Channel.of(record, hit, name)
        found = _constant(channel) or _clipped(channel) or _stuck(channel) or _dropout(channel)
        if found is not None:
            findings.append(Finding(record.name, *found))
    return findings


@dataclass(frozen=True)
class _Channel:
    """One channel of a record with what the checks need to judge and to describe it."""

    name: str
    unit: str
    signal: NDArray[np.float64]
    baseline: Baseline
    hit: Hit
    record: HammerRecord

    @classmethod
    def of(cls, record: HammerRecord, hit: Hit, name: str) -> _Channel:
        if name == "force":
            return cls(name, "N", record.force, hit.force, hit, record)
        return cls(name, record.response_unit, record.response, hit.response, hit, record)

    def when(self, sample: int) -> str:
        seconds = self.record.start_time + sample / self.record.sampling_rate
        return f"{seconds * 1e3:.2f} ms"


def equal_runs(signal: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """First sample and length of each run of equal values, in order."""
    changes = np.flatnonzero(np.diff(signal) != 0.0) + 1
    starts = np.concatenate(([0], changes))
    return starts, np.diff(np.concatenate((starts, [signal.size])))


def _constant(channel: _Channel) -> tuple[Fault, str] | None:
    if np.ptp(channel.signal) > 0.0:
        return None
    return "stuck_samples", f"{channel.name} is constant over the record"


def _stuck(channel: _Channel) -> tuple[Fault, str] | None:
    """A run of equal values longer than chance allows, given how often neighbours are equal."""
    signal = channel.signal
    starts, lengths = equal_runs(signal)
    starts, lengths = starts[lengths >= 2], lengths[lengths >= 2]
    if channel.name == "force":
        starts, lengths = _without_acquisition_window(signal, starts, lengths, channel.hit)
    glides = [_glides(channel, int(a), int(n)) for a, n in zip(starts, lengths, strict=True)]
    starts, lengths = starts[np.logical_not(glides)], lengths[np.logical_not(glides)]
    if lengths.size == 0:
        return None
    longest = int(np.argmax(lengths))
    start, length = int(starts[longest]), int(lengths[longest])
    pairs = float(np.sum(lengths[lengths < length] - 1)) + 1.0  # one more: errs to the safe side
    if length < 3 or signal.size * (pairs / signal.size) ** (length - 1) > _CHANCE:
        return None
    what = f"{signal[start]:.4g} {channel.unit} for {length} samples from {channel.when(start)}"
    if length <= _LONGEST_DROPOUT and _jumps(channel, start, length):
        return "dropout", f"{channel.name} jumps to {what}"
    return "stuck_samples", f"{channel.name} holds {what}"


def _glides(channel: _Channel, start: int, length: int) -> bool:
    """True where a channel without visible noise comes to a value and leaves it step by step."""
    signal, end = channel.signal, start + length
    if start == 0 and abs(end - channel.hit.onset) <= 8:  # at rest until the blow
        return True
    beside = np.concatenate((signal[max(start - 3, 0) : start], signal[end : end + 3]))
    return bool(np.all(np.abs(beside - signal[start]) <= 5.0 * channel.baseline.resolution))


def _jumps(channel: _Channel, start: int, length: int) -> bool:
    """True where a signal leaves its course at both ends of a segment, which sticking does not."""
    signal, reach = channel.signal, 3
    if start < reach or start + length + reach > signal.size:
        return False
    usual = float(np.max(np.abs(np.diff(signal[max(start - 40, 0) : start]))))
    least = max(8.0 * channel.baseline.noise, 1.5 * usual)
    into = abs(signal[start] - signal[start - 1])
    back = abs(signal[start + length] - signal[start + length - 1])
    return bool(into > least and back > least)


def _without_acquisition_window(
    signal: NDArray[np.float64], starts: NDArray[np.int64], lengths: NDArray[np.int64], hit: Hit
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Drop the runs of exact zero that a force window of the acquisition leaves behind the hit."""
    reaches_end = lengths.size > 0 and starts[-1] + lengths[-1] == signal.size
    if not reaches_end or signal[-1] != 0.0 or lengths[-1] < 0.3 * (signal.size - hit.end):
        return starts, lengths
    keep = signal[starts] != 0.0
    return starts[keep], lengths[keep]


def _clipped(channel: _Channel) -> tuple[Fault, str] | None:
    """Flat tops at the largest or smallest value of a channel."""
    noise, level = channel.baseline.noise, channel.baseline.level
    for sense in (1.0, -1.0):
        outward = sense * (channel.signal - level)
        limit = float(outward.max())
        if limit < 20.0 * noise:
            continue
        tops = _exact_tops(channel, outward, limit)
        if not tops and channel.name == "force" and sense == channel.hit.polarity:
            tops = _noisy_tops(outward, limit, noise)
        if tops:
            count = sum(length for _, length in tops)
            return "clipped", (
                f"{channel.name} is cut off at {sense * limit + level:.4g} {channel.unit}: "
                f"{count} samples in {len(tops)} flat top{'s' if len(tops) > 1 else ''}, "
                f"the first from {channel.when(tops[0][0])}"
            )
    return None


def _exact_tops(
    channel: _Channel, outward: NDArray[np.float64], limit: float
) -> list[tuple[int, int]]:
    """Tops of equal values, as a limiter or the end of the converter's range leaves them.

    Where values are fine-grained equal ones at the very top are no chance; where they are coarse
    the curve around them must have risen above.
    """
    noise, resolution = channel.baseline.noise, channel.baseline.resolution
    tops = [top for top in _runs_above(outward, limit - 0.5 * resolution) if top[1] >= 2]
    if len(tops) == 1 and tops[0][1] <= _LONGEST_DROPOUT and _jumps(channel, *tops[0]):
        return []
    # two values with normal noise fall in one step of the converter with this chance
    chance = min(resolution / (np.sqrt(4.0 * np.pi) * noise), 1.0) if noise > 0.0 else 1.0
    coincidences = sum(length - 1 for _, length in tops)
    if tops and chance**coincidences < _CHANCE_OF_EQUAL_TOPS:
        return tops
    return tops if any(_cut_off(outward, *top, noise) for top in tops) else []


def _noisy_tops(outward: NDArray[np.float64], limit: float, noise: float) -> list[tuple[int, int]]:
    """Flat tops with noise on them: the limiter stood ahead of the source of the noise."""
    return [
        (start, length)
        for start, length in _runs_above(outward, limit - 6.0 * noise)
        if length >= 3 and _cut_off(outward, start, length, noise)
    ]


def _runs_above(values: NDArray[np.float64], threshold: float) -> list[tuple[int, int]]:
    above = np.concatenate(([False], values >= threshold, [False]))
    edges = np.flatnonzero(np.diff(above.astype(np.int8)))
    return [(int(a), int(b - a)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _cut_off(outward: NDArray[np.float64], start: int, length: int, noise: float) -> bool:
    """True where a parabola through the flanks of a flat top rises clearly above it."""
    left = np.arange(start - 3, start)
    right = np.arange(start + length, start + length + 3)
    flanks = np.concatenate((left, right))
    if flanks[0] < 0 or flanks[-1] >= outward.size:
        return False
    center = start + 0.5 * (length - 1)
    parabola = np.polynomial.Polynomial.fit(flanks - center, outward[flanks], 2)
    top = outward[start : start + length]
    excess = float(parabola(0.0)) - float(np.mean(top))
    is_flat = np.ptp(top) < max(8.0 * noise, 0.15 * excess)
    return is_flat and excess > max(8.0 * noise, _CLIPPED_SHARE * float(np.max(top)))


def _dropout(channel: _Channel) -> tuple[Fault, str] | None:
    """Single samples far off the curve through their neighbours, away from the blow."""
    signal, hit = channel.signal, channel.hit
    distance = distance_from_neighbours(signal)
    noise = noise_of(signal)
    threshold = np.maximum(
        _SPIKE_DEVIATIONS * _SIXTH_DIFFERENCE_NORM * noise + 2.0 * channel.baseline.resolution,
        _SPIKE_OVER_NEIGHBOURS * _typical_nearby(np.abs(distance)),
    )
    excess = np.abs(distance) / threshold
    excess[max(hit.onset - 8, 0) : hit.end + 16] = 0.0
    sample = int(np.argmax(excess))
    if excess[sample] <= 1.0:
        return None
    return "dropout", (
        f"{channel.name} jumps to {written(signal[sample], 4)} {channel.unit} "
        f"at {channel.when(sample)}, {written(abs(distance[sample]))} {channel.unit} off the curve "
        f"through its neighbours ({abs(distance[sample]) / noise:.0f} times its noise)"
    )


def distance_from_neighbours(signal: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distance of each sample from the quintic through three neighbours on either side."""
    distance = np.zeros_like(signal)
    middle = signal[3:-3]
    distance[3:-3] = (
        middle
        - (
            15.0 * (signal[2:-4] + signal[4:-2])
            - 6.0 * (signal[1:-5] + signal[5:-1])
            + (signal[:-6] + signal[6:])
        )
        / 20.0
    )
    return distance


def _typical_nearby(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Median of blocks of 16 samples, the larger of each block and its neighbours'."""
    count = values.size // 16
    blocks = np.median(values[: count * 16].reshape(count, 16), axis=1)
    spread = np.repeat(scipy.ndimage.maximum_filter1d(blocks, 3, mode="nearest"), 16)
    return np.concatenate((spread, np.full(values.size - spread.size, spread[-1])))
