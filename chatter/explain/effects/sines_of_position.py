"""Sines of a position in a force: where to begin the search for a period along an axis."""

from __future__ import annotations

import numpy as np
import scipy
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: shortest period, m
LEAST_PERIOD = 2e-4
#: bins a shortest period, and periods tried for each cycle over the travel
_BINS, _A_CYCLE = 5, 6
#: bins at the most: shorter periods than five of them are not looked for
_MOST_BINS = 2000
#: sines that are proposed
_PROPOSED = 3


def strongest_sines(
    position: Array, force: Array, weight: Array
) -> list[tuple[float, float, float]]:
    """Sines of the position that take most of a force away, the best first.

    Each by least squares: the amplitudes of sine and cosine, N, and the period, m. Position, m,
    force, N, and weight are (n,) each. Periods reach from a travel to the shortest.
    """
    begin, travel = float(position.min()), float(np.ptp(position))
    count = int(min(_BINS * travel / LEAST_PERIOD, _MOST_BINS))
    if count < 2 * _BINS:
        return []
    index = np.minimum(((position - begin) / travel * count).astype(np.int64), count - 1)
    total = np.bincount(index, weight, count)
    used = total > 0.0
    mean = np.bincount(index, weight * force, count)[used] / total[used]
    total = total[used]
    mean -= np.average(mean, weights=total)
    # bins where the samples in them are, so that many in few places do no harm
    place = np.bincount(index, weight * position, count)[used] / total
    cycles = np.arange(1.0, count / _BINS, 1.0 / _A_CYCLE)
    found = [_sine_at(place, mean, total, 2.0 * np.pi * one / travel) for one in cycles]
    gain = np.array([one[0] for one in found])
    peaks = scipy.signal.argrelmax(np.pad(gain, 1))[0] - 1
    best = sorted(peaks, key=lambda peak: -gain[peak])[:_PROPOSED]
    return [(*found[peak][1:], float(travel / cycles[peak])) for peak in best]


def _sine_at(place: Array, force: Array, weight: Array, rate: float) -> tuple[float, float, float]:
    """Weighted sum of squares that a sine takes away, and its components."""
    sines = np.stack([np.sin(rate * place), np.cos(rate * place)])
    weighted = weight * sines
    right = weighted @ force
    components = np.linalg.lstsq(weighted @ sines.T, right, rcond=None)[0]
    return float(right @ components), float(components[0]), float(components[1])
