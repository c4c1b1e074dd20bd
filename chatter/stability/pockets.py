"""Pockets of a stability diagram: speeds at which a deep cut is stable, with a margin."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from chatter.description.arrays import Array
from chatter.stability.neglected_effects import NeglectedEffect, lowest_factor

#: part of the critical depth that is kept in hand
DEPTH_MARGIN = 0.15
#: spindle speed and natural frequency may be off by this much
SPEED_MARGIN = 0.015


def depth_margin(neglected: Sequence[NeglectedEffect]) -> float:
    """Part of a limit that is kept in hand: the usual one, or what is left out where that is more.

    Only effects whose bound holds at every speed.
    """
    return max(DEPTH_MARGIN, 1.0 - lowest_factor(neglected))


class Pocket(NamedTuple):
    """A speed and depth worth using.

    The depth is the lowest limit within the speed margin on either side, less the depth margin.
    """

    spindle_speed: float  # rad/s
    axial_depth: float  # m
    critical_depth: float  # m, at the speed itself; inf where none was found as far as searched
    removal_rate: float  # m^3/s


def find_pockets(
    speeds: Array,
    limits: Array,
    max_depth: float,
    removal_rate_per_depth_and_speed: float,
    most: int = 5,
    depth_margin: float = DEPTH_MARGIN,
    known_to: float = 0.0,
) -> tuple[Pocket, ...]:
    """Find the pockets with the highest removal rate, the highest first, `most` of them.

    Critical depths (n,), m, inf where none was found, at speeds (n,), rad/s, ascending; no pocket
    is deeper than `max_depth`, m, to which was searched. The removal rate over depth and speed,
    m^2, has radial depth, teeth and feed per tooth in it. The depth margin is the part of the limit
    that is kept in hand; one that was not found lies above `known_to`, m. A depth that is stable at
    every speed is no pocket.
    """
    lowest, kept = limits.min(), 1.0 - depth_margin
    if not kept > 0.0:
        return ()
    # what is left of the lowest limit, too, where more than the usual margin is kept
    lowest = lowest * min(1.0, kept / (1.0 - DEPTH_MARGIN))
    # of limits that are alike everywhere, any speed is as good
    anywhere = -np.inf if not lowest < np.max(limits) else lowest
    beyond = min(kept * max(known_to, max_depth), (1.0 - DEPTH_MARGIN) * max_depth)
    robust = lowest_within_margin(speeds, np.where(limits <= max_depth, kept * limits, beyond))
    indices = _local_maxima(robust)
    pockets = [
        Pocket(
            float(speeds[i]),
            float(robust[i]),
            float(limits[i]) if limits[i] <= max_depth else np.inf,
            float(robust[i] * speeds[i] * removal_rate_per_depth_and_speed),
        )
        for i in indices
        if robust[i] > anywhere
    ]
    return tuple(sorted(pockets, key=lambda pocket: -pocket.removal_rate)[:most])


def lowest_within_margin(speeds: Array, limits: Array) -> Array:
    """Lowest limit (n,), m, within the speed margin on either side of every speed (rad/s)."""
    near = np.abs(speeds / speeds[:, None] - 1.0) <= SPEED_MARGIN * (1.0 + 1e-9)
    return np.where(near, limits, np.inf).min(axis=1)


def _local_maxima(values: Array) -> list[int]:
    """Middle of every plateau that is higher than what surrounds it.

    At an end of the range a lone point does not count: what lies beyond is not known.
    """
    indices = []
    first = 0
    for i in range(1, len(values) + 1):
        if i < len(values) and np.isclose(values[i], values[first], rtol=1e-9, atol=0.0):
            continue
        is_plateau = i - first > 1
        rises = values[first - 1] < values[first] if first > 0 else is_plateau
        falls = values[i] < values[first] if i < len(values) else is_plateau
        if rises and falls:
            indices.append((first + i - 1) // 2)
        first = i
    return indices
