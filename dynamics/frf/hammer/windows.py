"""Windows for hammer records: the blow alone, the ringing alone, and a decay where it is needed."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dynamics.frf.hammer.hit import Hit
from dynamics.frf.hammer.record import HammerRecord
from dynamics.frf.hammer.response_checks import decay_end

#: samples kept ahead of the blow
_LEAD = 32
#: samples over which the force window rises and falls, clear of the blow
_TAPER = 8
#: the response is kept until this many times the duration of the visible ringing
_RINGING_KEPT = 1.6
#: share of the peak to which a ringing that outlasts the record is brought down by its end
_LEAST_END = 1e-3


@dataclass(frozen=True)
class Windows:
    """How the records of one set are cut and weighted, the same for all."""

    lead: int  # samples kept ahead of the blow
    #: samples kept of each record; transforms of this length have lines of independent noise
    length: int
    #: samples, from the first kept, after which the response is let down to zero because nothing
    #: but noise is left; equal to `length` where the ringing outlasts the record
    ringing: int
    added_decay: float  # of the exponential weight on both channels, 1/s; 0 for none


def choose_windows(records: Sequence[HammerRecord], hits: Sequence[Hit]) -> Windows:
    """Choose windows that take away noise and leakage and leave the blow and the ringing alone.

    Where every ringing dies away within the record the response is kept until well after that and
    no exponential weight is used. Else one is, just strong enough to bring the ringing down to a
    thousandth of its peak by the end.
    """
    pairs = list(zip(records, hits, strict=True))
    lead = min([_LEAD, *(hit.onset for hit in hits)])
    length = min(record.force.size - hit.onset for record, hit in pairs) + lead
    ends = [decay_end(record, hit) - hit.onset for record, hit in pairs]
    dies_away = all(
        end < record.force.size - hit.onset for end, (record, hit) in zip(ends, pairs, strict=True)
    )
    if dies_away:
        ringing = min(lead + int(_RINGING_KEPT * max(ends)) + 64, length)
        return Windows(lead, min(ringing + _fall(ringing), length), ringing, 0.0)
    shares = [_end_share(record, hit) for record, hit in pairs]
    duration = length / records[0].sampling_rate
    return Windows(lead, length, length, max(np.log(max(shares) / _LEAST_END), 0.0) / duration)


def _fall(ringing: int) -> int:
    """Samples over which the response is let down to zero."""
    return max(ringing // 4, 1)


def _end_share(record: HammerRecord, hit: Hit) -> float:
    """Amplitude of the response at the end of a record, as a share of its peak."""
    response = np.abs(record.response - hit.response.level)
    return float(np.max(response[-max(response.size // 20, 16) :]) / np.max(response))


def _margin(hit: Hit) -> int:
    """Samples clear of the blow on either side, over which the force window is still one."""
    return max(4, hit.width // 4)


def window_width(hit: Hit) -> float:
    """Sum of the squares of the force window, samples: the noise energy it lets through."""
    return hit.width + 2.0 * _margin(hit) + 0.75 * _TAPER


def force_window(hit: Hit, first: int, windows: Windows) -> NDArray[np.float64]:
    """One over the blow, zero elsewhere, with cosine flanks that lie outside the blow.

    (windows.length,), from the sample of the record at which the kept part begins.
    """
    sample = np.arange(windows.length) + first
    margin = _margin(hit)
    outside = np.maximum(hit.onset - margin - sample, sample - (hit.end - 1 + margin))
    return 0.5 * (1.0 + np.cos(np.pi * np.clip(outside / _TAPER, 0.0, 1.0)))


def response_window(windows: Windows) -> NDArray[np.float64]:
    """One over the ringing, then a cosine to zero over a quarter as long; (windows.length,)."""
    progress = (np.arange(windows.length) - windows.ringing) / _fall(windows.ringing)
    return 0.5 * (1.0 + np.cos(np.pi * np.clip(progress, 0.0, 1.0)))


def exponential_window(windows: Windows, sampling_rate: float) -> NDArray[np.float64]:
    """Exponential weight for both channels.

    Weighting force and response alike by exp(-sigma t) turns H(i omega) into H(i omega + sigma)
    exactly, so that the added decay can be taken off a fitted pole exactly.

    (windows.length,).
    """
    time = (np.arange(windows.length) - windows.lead) / sampling_rate
    return np.exp(-windows.added_decay * time)
