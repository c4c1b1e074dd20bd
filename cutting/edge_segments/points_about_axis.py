"""Points of edges about an inclined axis, and the work there: tables of the kernels."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: angles about the axis run from here once around: behind the tool, where only a plunge cuts
FIRST_ANGLE = -0.5 * math.pi


class EdgePoints(NamedTuple):
    """Points of edges (P,) and what the N passes before have left of the chip there."""

    height: Array  # above the tip, m
    radius: Array  # m
    sine: Array  # of the axial immersion angle
    cosine: Array
    rise: Array  # (P, N), m: chip against a pass where the normal points along the feed
    offset: Array  # (P, N), m: by which the edge of a pass reaches further out


class Work(NamedTuple):
    """Work about an inclined tool, as `InclinedEngagement` has it."""

    frame: Array  # (3, 3)
    along_feed: float
    along_axis: float
    surface: float  # height of the uncut surface, m
    outwards: float  # 1, -1: the work lies towards +y, -y; 0: nothing lies beside
    rise: Array  # (m,), rising heights, m
    bound: Array  # (m,), what lies beside ends there, outwards, m
