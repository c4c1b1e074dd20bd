"""A cut of any tool on a modal structure, as the collocation kernels see it."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.stability.methods.collocation.element_response import (
    ElementPoints,
    ResponseTable,
    element_points,
    response_table,
)
from chatter.stability.spindle_rotation import SpeedVariation
from cutting.edge_segments.engaged_intervals import MOST_POINTS
from cutting.edge_segments.segments import EdgePieces

#: modes whose resonance peak is below this share of the highest do not set the resolution
_RELEVANT_PEAK = 0.01
#: chatter rises above the natural frequency by about this much
_CHATTER_ABOVE_NATURAL = 1.2
#: Gauss points of an element and chatter waves that it holds, for every day
RESOLUTION = (8, 1.0)
#: an element turns the spindle by no more than this, rad
LONGEST_ANGLE = 0.9
_SMALLEST_RESIDUAL = 1e-9


class Resolution(NamedTuple):
    """How long an element may be."""

    longest: float  # s
    fastest: float  # vibration that elements resolve, with no cut, rad/s
    stiffening: float  # by which its square grows with depth, rad^2/s^2/m
    longest_angle: float  # rad
    residual: float  # of the dominant eigenpair, relative, at which its search stops


class CutArrays(NamedTuple):
    """A milling cut with speed and depth left open; n modes, r directions of motion."""

    natural_frequency: NDArray[np.float64]  # rad/s (n,)
    damping: NDArray[np.float64]  # ratio (n,)
    shape: NDArray[np.float64]  # displacement per modal coordinate (n, r)
    force_gain: NDArray[np.float64]  # modal acceleration per force, 1/kg (n, r)
    basis: NDArray[np.float64]  # directions of motion (3, r)
    pieces: EdgePieces
    period_angle: float  # after which the tool looks the same again, rad
    variation: SpeedVariation
    points: ElementPoints
    response: ResponseTable
    resolution: Resolution
    edge_place: NDArray[np.float64]  # Gauss points on [0, 1], row q for q of them (17, 16)
    edge_weight: NDArray[np.float64]  # (17, 16)


def relevant_frequency(
    natural_frequency: NDArray[np.float64],
    damping: NDArray[np.float64],
    shape: NDArray[np.float64],
    force_gain: NDArray[np.float64],
) -> float:
    """Highest natural frequency (rad/s) among modes whose resonance peak matters."""
    reach = np.linalg.norm(shape, axis=1) * np.linalg.norm(force_gain, axis=1)
    peak = reach / (2.0 * np.maximum(damping, 1e-6) * natural_frequency**2)
    return float(natural_frequency[peak >= _RELEVANT_PEAK * peak.max()].max())


def _stiffening(modes: tuple[NDArray[np.float64], ...], pieces: EdgePieces) -> float:
    """Square of the frequency that the stiffness of the cut adds for each depth, rad^2/s^2/m."""
    _, _, shape, force_gain = modes
    reach = float(np.max(np.linalg.norm(shape, axis=1) * np.linalg.norm(force_gain, axis=1)))
    if pieces.bottom.size == 0:
        return 0.0
    arc = np.abs(pieces.exit - pieces.entry).max(axis=1)
    lean = pieces.length / pieces.thickness
    share = arc / (2.0 * math.pi) * np.linalg.norm(pieces.cutting, axis=1) * lean
    # all edges that stand in the cut at a height, on average, and one at the least
    at_tip = pieces.bottom <= pieces.bottom.min()
    largest = np.linalg.norm(pieces.cutting, axis=1).max()
    return 0.5 * reach * float(max(share[at_tip].sum(), largest))


@lru_cache(maxsize=1)
def _edge_rules() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Places and weights of the Gauss quadratures of all orders on [0, 1], a row an order."""
    place = np.zeros((MOST_POINTS + 1, MOST_POINTS))
    weight = np.zeros_like(place)
    for count in range(1, MOST_POINTS + 1):
        nodes, weights = np.polynomial.legendre.leggauss(count)
        place[count, :count], weight[count, :count] = 0.5 * (nodes + 1.0), 0.5 * weights
    return place, weight


def cut_arrays(
    modes: tuple[NDArray[np.float64], ...],
    basis: NDArray[np.float64],
    pieces: EdgePieces,
    period_angle: float,
    variation: SpeedVariation,
    points: int,
    waves: float,
) -> CutArrays:
    """Lay out a cut for elements of a given resolution.

    Parameters
    ----------
    modes : tuple of arrays
        Natural frequency (n,) rad/s, damping ratio (n,), shape (n, r), force gain (n, r).
    basis : (3, r) array of float
    pieces : EdgePieces
    period_angle : float
        rad.
    variation : SpeedVariation
    points : int
        Gauss points of an element.
    waves : float
        Chatter waves that an element holds at the most.
    """
    natural_frequency, damping, shape, force_gain = modes
    fastest = _CHATTER_ABOVE_NATURAL * relevant_frequency(*modes)
    longest = waves * 2.0 * math.pi / fastest
    place, weight = _edge_rules()
    of_element = element_points(points)
    # no better than the elements are
    residual = max(_SMALLEST_RESIDUAL, 10.0 ** (4.0 - 1.5 * points))
    return CutArrays(
        natural_frequency=natural_frequency,
        damping=damping,
        shape=shape,
        force_gain=force_gain,
        basis=np.ascontiguousarray(basis),
        pieces=pieces,
        period_angle=period_angle,
        variation=variation,
        points=of_element,
        response=response_table(natural_frequency, damping, of_element, longest),
        resolution=Resolution(
            longest, fastest, _stiffening(modes, pieces), LONGEST_ANGLE, residual
        ),
        edge_place=place,
        edge_weight=weight,
    )
