"""Pulses of a tacho a revolution by the lines: those between its harmonics show a slower spindle.

A spindle of which a tacho gives p pulses a revolution has lines at k/p of the tacho's frequency,
with every remainder of k by p: runout makes those of the revolution, and teeth of another number
than p make some of them. A chatter frequency and its sidebands have one remainder alone.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from chatter.detection.spectral.spectra import Frames

Array = NDArray[np.float64]

#: most pulses a revolution that are told
MOST_PULSES = 8
#: multiples of the tacho's frequency up to which lines are looked for: few teeth have low lines
_HIGHEST_ORDERS = (2, 4, 8, 16, 24)
#: orders of one multiple that levels are read at, and how many of them a quantile leaves out
_PER_ORDER, _CHANCE = 840, 0.05
#: standard deviations by which more lines stand out than chance makes: of p alone, of a remainder
_CERTAIN, _OF_EACH = 6.0, 2.5


class Pulses(NamedTuple):
    """Pulses a revolution that lines show."""

    count: int
    #: number without the factors 2 and 3: a chatter line half way between the harmonics of fewer
    #: pulses, or at a third, has sidebands at all the orders of twice or thrice as many
    least: int


def pulses_by_lines(frames: Frames, tacho: Array) -> Pulses:
    """Pulses a revolution with which the lines fit; one where none lie between the harmonics.

    Parameters
    ----------
    frames : Frames
        Long enough to tell lines an eighth of the tacho's frequency apart.
    tacho : (m,) array of float
        Hz, frequency of the pulses over each frame.
    """
    levels = _levels_over_order(frames, tacho)
    half_width = frames.half_width / float(np.mean(tacho))
    found = [one for one in range(2, MOST_PULSES + 1) if _has_lines(levels, one, half_width)]
    together = math.lcm(*found) if found else 1
    if together > MOST_PULSES:
        together = max(found)
    least = together
    for factor in (2, 3):
        least = least // factor if least % factor == 0 else least
    return Pulses(together, least)


def _levels_over_order(frames: Frames, tacho: Array) -> Array:
    """Mean logarithm above the floor at orders of the tacho, (n,), from 0 on."""
    highest = min(int(frames.frequency[-1] / float(tacho.max())), _HIGHEST_ORDERS[-1])
    orders = np.arange(highest * _PER_ORDER) / _PER_ORDER
    reach = max(round(0.25 * frames.half_width / frames.step), 1)
    total = np.zeros(orders.size)
    for above, frequency in zip(frames.above, tacho, strict=True):
        near = maximum_filter1d(above, 2 * reach + 1)
        at = np.round(orders * frequency / frames.step).astype(np.intp)
        total += near[np.minimum(at, near.size - 1)]
    return total / max(len(tacho), 1)


def _has_lines(levels: Array, pulses: int, half_width: float) -> bool:
    """Whether lines lie at the orders k/p with every remainder, and with those of p alone."""
    beside, width = _between_lines(levels, pulses, half_width), round(half_width * _PER_ORDER)
    each = {one: _standing(levels, beside, one / pulses, width) for one in range(1, pulses)}
    own = [one for one in each if math.gcd(one, pulses) == 1]
    for highest in _HIGHEST_ORDERS:
        shown = {one: standing[:highest] for one, standing in each.items()}
        least = min(map(_significance, shown.values()))
        if least > _OF_EACH and _significance(np.concatenate([shown[k] for k in own])) > _CERTAIN:
            return True
    return False


def _significance(standing: NDArray[np.bool_]) -> float:
    """Standard deviations by which more orders stand out than chance makes."""
    if not standing.size:
        return 0.0
    excess = float(standing.sum()) - _CHANCE * standing.size
    return excess / math.sqrt(_CHANCE * (1.0 - _CHANCE) * standing.size)


def _between_lines(levels: Array, pulses: int, half_width: float) -> Array:
    """Levels at orders that are none of so many pulses, nor of a multiple; nan at the others."""
    orders = np.arange(levels.size) / _PER_ORDER
    left = levels.copy()
    for one in range(pulses, MOST_PULSES + 1, pulses):
        left[np.abs(orders * one - np.round(orders * one)) < 1.5 * half_width * one] = np.nan
    return left


def _standing(levels: Array, beside: Array, first: float, width: int) -> NDArray[np.bool_]:
    """Whether levels at an order and whole ones above exceed nearly all within half of one.

    They have to be peaks: the flank of a broad chatter line is none.
    """
    at = np.arange(round(first * _PER_ORDER), levels.size, _PER_ORDER)
    half, last = _PER_ORDER // 2, levels.size - 1
    flanks = np.maximum(levels[np.maximum(at - width, 0)], levels[np.minimum(at + width, last)])
    found = levels[at] > flanks
    for number in np.flatnonzero(found):
        near = beside[max(at[number] - half, 0) : at[number] + half]
        near = near[np.isfinite(near)]
        least = np.quantile(near, 1.0 - _CHANCE) if near.size > half // 4 else math.inf
        found[number] = levels[at[number]] > least
    return found
