"""A period doubled within a turn of a tool with an even number of teeth, runout unknown.

Runout makes teeth differ too. It does so from the first turn on, and by turns the forced motion
only settles; a flip starts from what the transient leaves and grows before it saturates.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from chatter.judgement.deviations import Deviations
from chatter.judgement.record import CutRecord
from chatter.judgement.sections import cut_into_periods

#: difference of neighbouring teeth, share of the rms of the motion, from which they differ
_DIFFER = 0.1
#: difference of every second tooth, as a share of that of neighbours, up to which they are alike
_ALIKE = 0.1
#: factor by which the change from turn to turn has to grow
_GROWTH = 3.0
#: share of the rms of the motion that the change from turn to turn has to reach again
_NOTABLE = 0.1


def grew_to_doubled_period(record: CutRecord, deviations: Deviations) -> bool:
    """Whether neighbouring teeth came to differ by growth, every second one staying alike.

    Parameters
    ----------
    record : CutRecord
        Equal pitch, even number of teeth.
    deviations : Deviations
        From turn to turn.

    Returns
    -------
    bool
    """
    teeth = cut_into_periods(record, record.teeth).values
    last = teeth[-4 * record.teeth :]
    spread = np.sqrt(np.mean(np.sum((last - last.mean(axis=(0, 1))) ** 2, axis=2)))
    # averages over turns, to keep noise out
    mean = last.reshape(4, record.teeth, *last.shape[1:]).mean(axis=0)
    neighbours = _rms(mean - np.roll(mean, 1, axis=0))
    seconds = _rms(mean - np.roll(mean, 2, axis=0))
    if neighbours < _DIFFER * spread or seconds > _ALIKE * neighbours:
        return False
    return _grew(deviations.sizes, spread)


def _rms(values: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean(np.sum(values**2, axis=2))))


def _grew(sizes: NDArray[np.float64], spread: float) -> bool:
    """Whether the sizes rise to a good part of the motion, well above what they were before."""
    lowest = np.minimum.accumulate(sizes)
    return bool(np.any((sizes > _GROWTH * lowest) & (sizes > _NOTABLE * spread)))
