"""Faults of the force channel: a cut or second blow, dropouts, a baseline that moves."""

import numpy as np
import scipy
from numpy.typing import NDArray

from dynamics.frf.hammer.hit import Hit
from dynamics.frf.hammer.record import Finding, HammerRecord
from dynamics.frf.hammer.written_number import written

#: a second blow counts from this share of the first
_SECOND_BLOW_SHARE = 0.01
#: or this many standard deviations of what the filter leaves of the noise
_SECOND_BLOW_DEVIATIONS = 7.0
#: right behind the blow, where a hammer rings on, a second one counts from this share
_RINGING_SHARE = 0.03
#: blow widths over which a hammer rings on
_RINGING_WIDTHS = 4
#: a single sample of the force counts as a dropout beyond this many standard deviations
_SPIKE_DEVIATIONS = 8.0
#: a notch within the blow counts as two humps from this share of the peak
_NOTCH_SHARE = 0.08
#: a moving baseline counts from this share of the peak
DRIFT_SHARE = 0.006
#: or this many standard deviations of the mean of a block
DRIFT_DEVIATIONS = 8.0
_BLOCK = 128


def force_findings(record: HammerRecord, hit: Hit) -> list[Finding]:
    """Examine the force for a blow cut short, a second blow, dropouts and drift."""
    force = hit.polarity * (record.force - hit.force.level)
    outside = outside_hit(force.size, hit)
    baseline = block_medians(np.where(outside, force, 0.0), _BLOCK)
    drift = _drift(record, hit, baseline)
    first = drift or _cut(record, hit)
    if first is not None:
        return [first]
    centers = (np.arange(baseline.size) + 0.5) * _BLOCK
    rest = np.interp(np.arange(force.size), centers, baseline)
    free = np.where(outside, force - rest, 0.0)
    found = (
        _notch(record, hit, force)
        or _second_blow(record, hit, force, free)
        or _spike(record, hit, free)
    )
    return [] if found is None else [found]


def _cut(record: HammerRecord, hit: Hit) -> Finding | None:
    """A record that begins or ends within the blow."""
    if hit.onset == 0:
        return Finding(
            record.name,
            "cut_hit",
            f"the record begins within the blow, at {abs(record.force[0]) / hit.amplitude:.0%} of "
            "its peak; trigger earlier",
        )
    if hit.end >= record.force.size:
        return Finding(record.name, "cut_hit", "the record ends within the blow")
    return None


def outside_hit(samples: int, hit: Hit) -> NDArray[np.bool_]:
    """Samples clear of the blow and of the ringing of the hammer right behind it."""
    outside = np.ones(samples, dtype=bool)
    outside[max(hit.onset - 4, 0) : hit.end + max(4, hit.width // 2)] = False
    return outside


def block_medians(signal: NDArray[np.float64], block: int) -> NDArray[np.float64]:
    """Medians of consecutive blocks; a remainder joins the last one."""
    count = max(signal.size // block, 1)
    return np.array(
        [
            np.median(signal[i * block : (i + 1) * block if i < count - 1 else None])
            for i in range(count)
        ]
    )


def _drift(record: HammerRecord, hit: Hit, baseline: NDArray[np.float64]) -> Finding | None:
    limit = max(
        DRIFT_DEVIATIONS * 1.25 * hit.force.noise / np.sqrt(_BLOCK), DRIFT_SHARE * hit.amplitude
    )
    moved = np.abs(baseline) > limit
    if np.sum(moved) < 2:  # one block can be a broad second blow
        return None
    worst = int(np.argmax(np.abs(baseline)))
    when = (worst + 0.5) * _BLOCK / record.sampling_rate * 1e3
    return Finding(
        record.name,
        "drift",
        f"force baseline moves by {written(hit.polarity * baseline[worst])} N "
        f"({abs(baseline[worst]) / hit.amplitude:.1%} of the peak) by {when:.0f} ms "
        "though no force acts",
    )


def _notch(record: HammerRecord, hit: Hit, force: NDArray[np.float64]) -> Finding | None:
    """Two humps within one blow: the hammer bounced before it let go."""
    blow = force[max(hit.onset - 1, 0) : hit.end + 1]
    depth = max(8.0 * hit.force.noise, _NOTCH_SHARE * hit.amplitude)
    peaks, _ = scipy.signal.find_peaks(blow, prominence=depth, width=2)
    if peaks.size < 2:
        return None
    first, second = peaks[0], peaks[1]
    return Finding(
        record.name,
        "double_hit",
        f"the force has two humps, {written(blow[first])} N and {written(blow[second])} N, "
        f"{(second - first) / record.sampling_rate * 1e3:.2f} ms apart within one blow",
    )


def _least_share(samples: int, hit: Hit) -> NDArray[np.float64]:
    """Share of the peak from which an excursion counts, sample by sample."""
    share = np.full(samples, _SECOND_BLOW_SHARE)
    share[hit.end : hit.end + _RINGING_WIDTHS * hit.width] = _RINGING_SHARE
    return share


def _second_blow(
    record: HammerRecord, hit: Hit, force: NDArray[np.float64], free: NDArray[np.float64]
) -> Finding | None:
    """A pulse like the first one, found by correlating with it."""
    template = force[hit.onset : hit.end] / hit.amplitude
    energy = float(np.sum(template**2))
    height = np.correlate(free, template, mode="same") / energy
    limit = np.maximum(
        _SECOND_BLOW_DEVIATIONS * hit.force.noise / np.sqrt(energy),
        _least_share(free.size, hit) * hit.amplitude,
    )
    sample = int(np.argmax(height / limit))
    if height[sample] <= limit[sample] or not _is_pulse(free, sample, hit):
        return None
    delay = (sample - hit.peak) / record.sampling_rate * 1e3
    return Finding(
        record.name,
        "double_hit",
        f"a second blow of {written(height[sample])} N "
        f"({height[sample] / hit.amplitude:.1%} of the first) "
        f"{abs(delay):.1f} ms {'after' if delay > 0 else 'before'} the main one",
    )


def _spike(record: HammerRecord, hit: Hit, free: NDArray[np.float64]) -> Finding | None:
    """A few samples off the rest level, too short for a blow."""
    limit = np.maximum(
        _SPIKE_DEVIATIONS * hit.force.noise, _least_share(free.size, hit) * hit.amplitude
    )
    sample = int(np.argmax(np.abs(free) / limit))
    if np.abs(free[sample]) <= limit[sample]:
        return None
    when = (record.start_time + sample / record.sampling_rate) * 1e3
    return Finding(
        record.name,
        "dropout",
        f"force jumps by {written(hit.polarity * free[sample])} N "
        f"({abs(free[sample]) / hit.amplitude:.1%} of the peak) at {when:.2f} ms",
    )


def _is_pulse(searched: NDArray[np.float64], sample: int, hit: Hit) -> bool:
    """True where several samples make the excursion: one or two alone are a dropout."""
    near = searched[max(sample - hit.width, 0) : sample + hit.width + 1]
    energy = np.sort(near**2)[::-1]
    return float(energy[:2].sum()) < 0.75 * float(energy.sum())
