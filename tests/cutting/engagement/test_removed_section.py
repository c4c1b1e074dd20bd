"""Cross-section that a tool removes: rectangles, circles and cones."""

import math

import numpy as np
import pytest

from cutting.engagement.immersion import removed_section
from cutting.tool.cutter import Cutter


def cutter(**more):
    return Cutter(12e-3, (0.0, 0.0), (math.pi, math.pi), **more)


def test_a_cylinder_removes_a_rectangle():
    depths = np.array([0.1e-3, 3e-3])
    assert removed_section(cutter(), "down", 4e-3, depths) == pytest.approx(4e-3 * depths)
    assert removed_section(cutter(), "slot", 1.0, depths) == pytest.approx(12e-3 * depths)


def test_a_ball_removes_a_segment_of_a_circle():
    ball = cutter(corner_radius=6e-3)
    r, h = 6e-3, 2e-3
    segment = r**2 * math.acos(1.0 - h / r) - (r - h) * math.sqrt(2.0 * r * h - h**2)
    depths = np.array([h, 6e-3])
    slot = removed_section(ball, "slot", 1.0, depths)
    assert slot == pytest.approx([segment, 0.5 * math.pi * r**2], rel=1e-4)
    # half of the stock: half of the tool; beside the ball: nothing
    half = removed_section(ball, "up", 6e-3, depths)
    assert half == pytest.approx(0.5 * slot, rel=1e-4)
    assert removed_section(ball, "up", 1e-3, np.array([1e-3])) == pytest.approx([0.0])
    # all of it is in the cut
    assert removed_section(ball, "up", 12e-3, depths) == pytest.approx(slot, rel=1e-4)


def test_a_cone_removes_a_trapezium():
    cone = cutter(edge_angle=math.radians(60.0))
    depth = np.array([3e-3])
    wanted = 2e-3 * 3e-3 + 0.5 * 3e-3**2 / math.tan(math.radians(60.0))
    assert removed_section(cone, "down", 2e-3, depth) == pytest.approx([wanted], rel=1e-5)
