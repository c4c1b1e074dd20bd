"""Factor of the cutting force over the angle of the spindle and over the travel of the tool.

A term that was learnt from measurements, where no law is known, such as hard spots of a casting.
"""

import math
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from cutting.compiled import INLINED


class ForceFactor(NamedTuple):
    """Factors, linear between equally spaced entries. The group comes after the cut it acts on."""

    over_angle: NDArray[np.float64]  # (n+1,) from 0 to a revolution
    bins: float  # of a revolution
    over_travel: NDArray[np.float64]  # (m+1,)
    first: float  # travel of the first entry, m
    length: float  # travel from the first to the last, m
    repeats: bool  # whether the table over the travel repeats


@register_jitable(**INLINED)
def _between(table, share):
    """Entry at a share of the table, held beyond its ends."""
    last = table.size - 1
    position = min(max(share, 0.0), 1.0) * last
    index = min(int(position), last - 1)
    return table[index] + (position - index) * (table[index + 1] - table[index])


@register_jitable(**INLINED)
def factor_forces(group, rotation, point):
    """Scale what the cut has put on the tool point."""
    angle = (rotation.whole + rotation.part) / group.bins
    travel = (math.hypot(rotation.x, rotation.y) - group.first) / group.length
    if group.repeats:
        travel -= math.floor(travel)
    factor = _between(group.over_angle, angle) * _between(group.over_travel, travel)
    for axis in range(3):
        point.force[axis] *= factor
        point.sample[axis] *= factor
        point.jump[0, axis] *= factor
        point.jump[1, axis] *= factor
    for column in range(4):
        point.blur[column] *= factor
    point.torque[0] *= factor


@register_jitable(**INLINED)
def factor_commit(group, rotation, point):
    """Remember nothing: the factor has no memory."""
