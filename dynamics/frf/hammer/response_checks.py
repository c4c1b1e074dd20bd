"""Faults of the response that need no other record: drift, no answer to the blow, late bumps."""

import numpy as np

from dynamics.frf.hammer.force_checks import DRIFT_DEVIATIONS, DRIFT_SHARE, block_medians
from dynamics.frf.hammer.hit import Hit
from dynamics.frf.hammer.record import Finding, HammerRecord
from dynamics.frf.hammer.written_number import written

#: peak of the response over its noise before the blow, below which it does not answer
_LEAST_PEAK_OVER_NOISE = 8.0
#: median steps from block to block by which a baseline must be off to be no ringing
_RINGING_STEPS = 6.0
#: samples ahead of the force from which a response is too early
_LEAST_LEAD = 5
_BLOCK = 128
_ENERGY_BLOCK = 64


def response_findings(record: HammerRecord, hit: Hit) -> list[Finding]:
    """Examine the response for drift, and for its answer to the blow: none, or too early."""
    found = _early(record, hit) or _no_answer(record, hit) or _drift(record, hit)
    return [] if found is None else [found]


def decay_end(record: HammerRecord, hit: Hit) -> int:
    """First sample from which the ringing has sunk into the noise; the length where it never does.

    Blocks are judged by their standard deviation about a straight line, so that a drifting
    baseline does not count as ringing.
    """
    ring = record.response[hit.onset :]
    count = ring.size // _ENERGY_BLOCK
    if count < 2:
        return record.response.size
    blocks = ring[: count * _ENERGY_BLOCK].reshape(count, _ENERGY_BLOCK)
    x = np.arange(_ENERGY_BLOCK) - 0.5 * (_ENERGY_BLOCK - 1)
    slope = blocks @ x / np.sum(x**2)
    level = np.std(blocks - slope[:, None] * x, axis=1)
    loud = np.flatnonzero(level > 1.5 * hit.response.noise)
    last = int(loud[-1]) + 1 if loud.size else 0
    return hit.onset + last * _ENERGY_BLOCK if last < count else record.response.size


def _early(record: HammerRecord, hit: Hit) -> Finding | None:
    """A response that moves before the force: the channels are shifted against each other."""
    before = record.response[: hit.onset]
    rest = before[: before.size // 2]
    if rest.size < 32:
        return None
    level = float(np.median(rest))
    limit = max(8.0 * float(np.std(rest)), 8.0 * hit.response.noise)
    moving = np.abs(before - level) > limit
    start = int(np.argmax(moving)) if moving.any() else hit.onset
    lead = hit.onset - start
    if lead < _LEAST_LEAD or np.mean(moving[start:]) < 0.25:
        return None
    return Finding(
        record.name,
        "trigger_skew",
        f"the response begins {lead / record.sampling_rate * 1e6:.0f} us ({lead} samples) before "
        "the force that causes it",
    )


def _no_answer(record: HammerRecord, hit: Hit) -> Finding | None:
    before = record.response[: max(hit.onset - 2, 0)]
    noise = float(np.std(before)) if before.size >= 32 else hit.response.noise
    noise = max(noise, hit.response.noise)
    segment = record.response[hit.onset : hit.end + max(64, record.response.size // 8)]
    peak = float(np.max(np.abs(segment - hit.response.level)))
    if peak >= _LEAST_PEAK_OVER_NOISE * noise:
        return None
    return Finding(
        record.name,
        "no_coherence",
        f"the response does not answer the blow: its peak of {written(peak)} "
        f"{record.response_unit} is {peak / noise:.1f} times its noise before it",
    )


def _drift(record: HammerRecord, hit: Hit) -> Finding | None:
    response = record.response - hit.response.level
    peak = float(np.max(np.abs(response[hit.onset : hit.end + _BLOCK])))
    start = min(decay_end(record, hit), response.size // 2)
    medians = block_medians(response[start:], _BLOCK)
    group = max(1, medians.size // 8)
    means = np.convolve(medians, np.full(group, 1.0 / group), mode="valid")
    # a slow ringing that goes on moves block by block, a drift does not
    ringing = float(np.median(np.abs(np.diff(medians)))) if medians.size > 1 else 0.0
    limit = max(
        DRIFT_DEVIATIONS * 1.25 * hit.response.noise / np.sqrt(_BLOCK * group),
        DRIFT_SHARE * peak,
        _RINGING_STEPS * ringing,
    )
    worst = int(np.argmax(np.abs(means)))
    if abs(means[worst]) <= limit:
        return None
    when = (start + (worst + 0.5 * group) * _BLOCK) / record.sampling_rate * 1e3
    return Finding(
        record.name,
        "drift",
        f"response baseline stands {written(means[worst])} {record.response_unit} "
        f"({abs(means[worst]) / peak:.1%} of the peak) off its rest level at {when:.0f} ms",
    )
