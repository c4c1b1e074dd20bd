"""A cut of any tool on a modal structure: the flat arrays that the methods for any tool share."""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from chatter.description.arrays import Array
from chatter.stability.spindle_rotation import PeriodFit, SpeedVariation
from cutting.edge_segments.engaged_intervals import MOST_POINTS
from cutting.edge_segments.segments import EdgeSegments

#: modes whose resonance peak is below this share of the highest do not set the resolution
_RELEVANT_PEAK = 0.01
#: chatter rises above the natural frequency by about this much
CHATTER_ABOVE_NATURAL = 1.2


class CutArrays(NamedTuple):
    """A milling cut with speed and depth left open; n modes, r directions of motion."""

    natural_frequency: Array  # rad/s (n,)
    damping: Array  # ratio (n,)
    shape: Array  # displacement per modal coordinate (n, r)
    force_gain: Array  # modal acceleration per force, 1/kg (n, r)
    basis: Array  # directions of motion (3, r)
    segments: EdgeSegments
    period_angle: float  # after which the tool repeats itself, rad
    variation: SpeedVariation
    fit: PeriodFit
    fastest: float  # vibration to be resolved, with no cut, rad/s
    stiffening: float  # by which its square grows with depth, rad^2/s^2/m
    edge_position: Array  # Gauss points on [0, 1], row q for q of them (17, 16)
    edge_weight: Array  # (17, 16)


def relevant_frequency(
    natural_frequency: Array, damping: Array, shape: Array, force_gain: Array
) -> float:
    """Highest natural frequency (rad/s) among modes whose resonance peak matters."""
    reach = np.linalg.norm(shape, axis=1) * np.linalg.norm(force_gain, axis=1)
    peak = reach / (2.0 * np.maximum(damping, 1e-6) * natural_frequency**2)
    return float(natural_frequency[peak >= _RELEVANT_PEAK * peak.max()].max())


def _stiffening(modes: tuple[Array, ...], segments: EdgeSegments) -> float:
    """Square of the frequency that the stiffness of the cut adds for each depth, rad^2/s^2/m."""
    _, _, shape, force_gain = modes
    reach = float(np.max(np.linalg.norm(shape, axis=1) * np.linalg.norm(force_gain, axis=1)))
    if segments.bottom.size == 0:
        return 0.0
    arc = np.abs(segments.exit - segments.entry).max(axis=1)
    lean = segments.length / segments.thickness
    share = arc / (2.0 * math.pi) * np.linalg.norm(segments.cutting, axis=1) * lean
    # all edges that stand in the cut at a height, on average, and one at the least
    at_tip = segments.bottom <= segments.bottom.min()
    largest = np.linalg.norm(segments.cutting, axis=1).max()
    return 0.5 * reach * float(max(share[at_tip].sum(), largest))


@lru_cache(maxsize=1)
def _edge_rules() -> tuple[Array, Array]:
    """Places and weights of the Gauss quadratures of all orders on [0, 1], a row an order."""
    position = np.zeros((MOST_POINTS + 1, MOST_POINTS))
    weight = np.zeros_like(position)
    for count in range(1, MOST_POINTS + 1):
        nodes, weights = np.polynomial.legendre.leggauss(count)
        position[count, :count], weight[count, :count] = 0.5 * (nodes + 1.0), 0.5 * weights
    return position, weight


def cut_arrays(
    modes: tuple[Array, ...],
    basis: Array,
    segments: EdgeSegments,
    period_angle: float,
    variation: SpeedVariation,
) -> CutArrays:
    """Lay out a cut; modes as of `MillingModel.modal_arrays`, the period of the tool in rad."""
    natural, damping, shape, force_gain = modes
    fastest = CHATTER_ABOVE_NATURAL * relevant_frequency(*modes)
    position, weight = _edge_rules()
    return CutArrays(
        natural, damping, shape, force_gain, np.ascontiguousarray(basis), segments, period_angle,
        variation, PeriodFit(), fastest, _stiffening(modes, segments), position, weight,
    )  # fmt: skip
