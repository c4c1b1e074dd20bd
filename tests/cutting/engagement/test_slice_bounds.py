"""Heights between which the slices of an edge lie."""

import math

import numpy as np

from cutting.engagement.slice_bounds import SliceLimits, slice_bounds
from cutting.engagement.uncut_band import band_beside_wall
from cutting.tool.cutter import Cutter


def test_full_width_whatever_rounding_makes_of_the_corner():
    """A width of the diameter: the wall is as far out as the edge, where the corner ends."""
    rng = np.random.default_rng(1)
    for radius, share in zip(
        rng.uniform(1e-3, 2e-2, 200), rng.uniform(0.05, 0.9, 200), strict=True
    ):
        cutter = Cutter(
            diameter=2.0 * radius, helix=(0.0, 0.0), pitch=(math.pi, math.pi),
            corner_radius=share * radius,
        )  # fmt: skip
        wide = band_beside_wall("up", 2.0 * radius, radius)
        bounds = slice_bounds(cutter, 1.2 * radius, wide, SliceLimits(0.1, 0.1, 0.1))
        assert bounds[0] == 0.0
        assert bounds[-1] == 1.2 * radius
        assert np.all(np.diff(bounds) > 0.0)
