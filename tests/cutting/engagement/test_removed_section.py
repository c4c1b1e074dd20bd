"""Cross-section that a tool removes: rectangles, circles and cones."""

import math

import numpy as np
import pytest
import scipy.integrate

from cutting.engagement.immersion import removed_section
from cutting.engagement.uncut_band import band_beside_pass, band_beside_wall
from cutting.tool.cutter import Cutter


def beside(mode, radial_depth):
    return band_beside_wall(mode, radial_depth, 6e-3)


def cutter(**more):
    return Cutter(12e-3, (0.0, 0.0), (math.pi, math.pi), **more)


def test_a_cylinder_removes_a_rectangle():
    depths = np.array([0.1e-3, 3e-3])
    assert removed_section(cutter(), beside("down", 4e-3), depths) == pytest.approx(4e-3 * depths)
    assert removed_section(cutter(), beside("slot", 1.0), depths) == pytest.approx(12e-3 * depths)


def test_a_ball_removes_a_segment_of_a_circle():
    ball = cutter(corner_radius=6e-3)
    r, h = 6e-3, 2e-3
    segment = r**2 * math.acos(1.0 - h / r) - (r - h) * math.sqrt(2.0 * r * h - h**2)
    depths = np.array([h, 6e-3])
    slot = removed_section(ball, beside("slot", 1.0), depths)
    assert slot == pytest.approx([segment, 0.5 * math.pi * r**2], rel=1e-4)
    # half of the stock: half of the tool; beside the ball: nothing
    half = removed_section(ball, beside("up", 6e-3), depths)
    assert half == pytest.approx(0.5 * slot, rel=1e-4)
    assert removed_section(ball, beside("up", 1e-3), np.array([1e-3])) == pytest.approx([0.0])
    # all of it is in the cut
    assert removed_section(ball, beside("up", 12e-3), depths) == pytest.approx(slot, rel=1e-4)


def test_a_cone_removes_a_trapezium():
    cone = cutter(edge_angle=math.radians(60.0))
    depth = np.array([3e-3])
    wanted = 2e-3 * 3e-3 + 0.5 * 3e-3**2 / math.tan(math.radians(60.0))
    assert removed_section(cone, beside("down", 2e-3), depth) == pytest.approx([wanted], rel=1e-5)


def test_a_pass_beside_another_removes_the_stepover_by_the_depth():
    """A ball: what it takes between two passes is their distance times the depth, less the cusp."""
    ball, r, step, depth = cutter(corner_radius=6e-3), 6e-3, 0.8e-3, 0.5e-3
    found = removed_section(ball, band_beside_pass("up", step), np.array([depth]))
    segment = r**2 * math.acos(1.0 - depth / r) - (r - depth) * math.sqrt(2 * r * depth - depth**2)

    def common(half):
        """Area between two circles and below the height depth: twice the half beyond the middle."""
        heights = np.linspace(0.0, depth, 200001)
        wide = np.sqrt(np.maximum(r**2 - (r - heights) ** 2, 0.0))
        return scipy.integrate.trapezoid(2.0 * np.maximum(wide - half, 0.0), heights)

    assert found == pytest.approx([segment - common(0.5 * step)], rel=1e-4)
