"""A cut laid out for elements of a given resolution."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from chatter.stability.cut_arrays import CutArrays
from chatter.stability.methods.collocation.element_response import (
    ElementPoints,
    ResponseTable,
    element_points,
    response_table,
)
from chatter.stability.model import MillingModel
from chatter.stability.spindle_rotation import PeriodFit
from cutting.edge_segments.segment_ends import WITHIN_WAVES

#: Gauss points per element and chatter wavelengths that it holds, as a rule
RESOLUTION = (8, 1.0)
#: on a serrated edge elements have so many Gauss points less, and are shorter by this factor
_FEWER_POINTS, _SHORTER = 2, 0.75
_SMALLEST_RESIDUAL = 1e-9


class ElementCut(NamedTuple):
    """A cut, and elements for it."""

    arrays: CutArrays
    points: ElementPoints
    response: ResponseTable
    longest: float  # element, s
    residual: float  # of the dominant eigenpair, relative, at which its search stops

    def with_fit(self, fit: PeriodFit) -> ElementCut:
        """The cut with the period of a varying speed fitted in another way."""
        return self._replace(arrays=self.arrays._replace(fit=fit))


#: angle, rad, that any mode turns through in an element at the most, as far as elements become no
#: shorter than a share for it
_MOST_TURNED, _SHORTEST_SHARE = 400.0, 1.0 / 16.0
#: angle, rad, up to which the turning of a mode is tabulated; what is stiffer follows the force
_MOST_TABULATED = 1600.0

#: a cut at a resolution: Gauss points and wavelengths per element
CutAt = Callable[[int, float], ElementCut]


def element_cut(
    model: MillingModel,
    max_depth: float,
    points: int = RESOLUTION[0],
    wavelengths: float = RESOLUTION[1],
) -> ElementCut:
    """Lay out the cut of a model, with depths up to `max_depth`, m.

    An element has as many Gauss points as given and holds at the most that many wavelengths of the
    fastest chatter; edge segments shrink along.
    """
    arrays = model.cut(max_depth, wavelengths)
    longest = wavelengths * 2.0 * math.pi / arrays.fastest
    if np.any(arrays.segments.turning == WITHIN_WAVES):
        # its borders make most elements far shorter than a wavelength
        points, longest = points - _FEWER_POINTS, longest * _SHORTER
    # modes far above chatter: a table over all that they turn through would cost more than elements
    share = _MOST_TURNED / max(longest * float(np.max(arrays.natural_frequency)), _MOST_TURNED)
    longest *= max(share, _SHORTEST_SHARE)
    arrays = _with_modes_below(arrays, _MOST_TABULATED / longest)
    of_element = element_points(points)
    response = response_table(arrays.natural_frequency, arrays.damping, of_element, longest)
    # no better than the elements are
    residual = max(_SMALLEST_RESIDUAL, 10.0 ** (4.0 - 1.5 * points))
    return ElementCut(arrays, of_element, response, longest, residual)


def _with_modes_below(arrays: CutArrays, highest: float) -> CutArrays:
    """Cut in which modes above a frequency far above chatter, rad/s, act by their compliance."""
    lowered = np.minimum(arrays.natural_frequency, highest)
    # displacement per force at rest is that of the gain over the square of the frequency
    share = (lowered / arrays.natural_frequency) ** 2
    return arrays._replace(natural_frequency=lowered, force_gain=arrays.force_gain * share[:, None])


def element_cuts(model: MillingModel, max_depth: float) -> CutAt:
    """The cut of a model at any resolution, down to a depth (m)."""
    return partial(element_cut, model, max_depth)
