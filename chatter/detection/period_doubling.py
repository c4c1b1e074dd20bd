"""Period doubling within a revolution: even number of teeth, runout not known.

Both runout and a flip make neighbouring teeth differ. A forced motion is there from the first
revolution on and only settles: its changes shrink. A flip starts from the little that the transient
leaves of it, and its changes grow before it saturates.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.detection.cut_record import CutRecord
from chatter.detection.deviations import deviations_of
from chatter.detection.poincare_sections import cut_into_periods

#: difference of neighbouring teeth, share of the rms of the motion, from which they differ
_DIFFER = 0.1
#: difference of every second tooth, as a share of that of neighbours, up to which they are alike
_ALIKE = 0.1
#: factor by which the change from one pair of teeth to the next has to grow
_GROWTH = 1.7
#: share of the final difference of neighbours that the change has to reach
_NOTABLE = 0.1
#: share of the final difference up to which neighbours differ before it grows
_SMALL = 0.5


class Doubling(NamedTuple):
    """How neighbouring teeth came to differ."""

    is_there: bool  # neighbours differ, every second tooth is alike
    grew: bool  # and the difference grew from little


def doubling_within_revolution(record: CutRecord) -> Doubling:
    """Whether neighbouring teeth differ with every second one alike, and came to it by growth.

    Parameters
    ----------
    record : CutRecord
        Equal pitch, even number of teeth; from rest.

    Returns
    -------
    Doubling
        Not grown either where a flip grew within the first revolution: that looks like runout.
    """
    teeth = cut_into_periods(record, record.teeth).values
    last = teeth[-4 * record.teeth :]
    # averages over revolutions, to keep noise out
    mean = last.reshape(4, record.teeth, *last.shape[1:]).mean(axis=0)
    neighbours = _rms(mean - np.roll(mean, 1, axis=0))
    seconds = _rms(mean - np.roll(mean, 2, axis=0))
    spread = _rms(mean - mean.mean(axis=(0, 1)))
    if neighbours < _DIFFER * spread or seconds > _ALIKE * neighbours:
        return Doubling(False, False)
    pairs = teeth[len(teeth) % 2 :]
    return Doubling(True, _grew(0.5 * (pairs[0::2] - pairs[1::2])))


def _rms(values: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean(np.sum(values**2, axis=2))))


def _grew(alternation: NDArray[np.float64]) -> bool:
    """Whether the half difference of neighbours, (pairs, points, k), grew from little."""
    changes = deviations_of(alternation)
    if changes.rank == 0:
        return False
    sizes = np.sqrt(np.mean(np.sum(alternation**2, axis=2), axis=1))
    final = float(np.median(sizes[-max(len(sizes) // 4, 1) :]))
    lowest = np.hypot(np.minimum.accumulate(changes.sizes), changes.noise_size)
    largest = int(np.argmax(changes.sizes / lowest))
    return bool(
        changes.sizes[largest] > max(_GROWTH * lowest[largest], _NOTABLE * final)
        and sizes[: largest + 1].min() < _SMALL * final
    )
