"""Time-optimal motion: closed forms on lines, limits of each axis, feeds, stops."""

import math

import numpy as np
import pytest

from dynamics.trajectory.block_motion import Block, BlockMotion, PathLimits, eased
from dynamics.trajectory.spatial_path import SpatialArc, SpatialLine
from dynamics.trajectory.time_optimal import TimeOptimalMotion

LIMITS = PathLimits(0.5, 20.0, 800.0)


def line(length, feed=math.inf, **further):
    return Block(SpatialLine((0.0, 0.0, 0.0), (length, 0.0, 0.0)), feed, **further)


def corner(feed=math.inf):
    arc = SpatialArc((0.0, 5e-3, 0.0), (0.0, -5e-3, 0.0), (5e-3, 0.0, 0.0), 0.5 * math.pi)
    before = SpatialLine((-0.02, 0.0, 0.0), (0.0, 0.0, 0.0))
    after = SpatialLine((5e-3, 5e-3, 0.0), (5e-3, 25e-3, 0.0))
    return eased([Block(one, feed) for one in (before, arc, after)], 1e-6)


@pytest.mark.parametrize(
    ("length", "duration"),
    [
        # jerk alone: L = 2 j T^3, 4 T
        (1e-3, 4.0 * (1e-3 / 1600.0) ** (1.0 / 3.0)),
        # L / v + v / a + a / j
        (0.3, 0.3 / 0.5 + 0.5 / 20.0 + 20.0 / 800.0),
    ],
)
def test_a_line_takes_the_time_of_the_closed_form(length, duration):
    assert TimeOptimalMotion((line(length),), LIMITS).duration == pytest.approx(duration, rel=0.01)


def test_each_axis_keeps_its_limits_and_one_is_reached():
    motion = TimeOptimalMotion(tuple(corner()), LIMITS)
    # faster than the plan by blocks, which keeps the limits of the vectors
    assert motion.duration < 0.95 * BlockMotion(tuple(corner()), LIMITS).duration
    time = np.arange(0.0, motion.duration, 4e-4)
    moved = motion.at(time)
    assert np.abs(moved.velocity).max() < 0.5 * 1.001
    assert np.abs(moved.acceleration).max() < 20.0 * 1.02
    jerk = np.abs(np.diff(moved.acceleration[5:-5], axis=0)).max(axis=1) / 4e-4
    # the spline between the points swings where the jerk changes its sign
    assert np.percentile(jerk, 90) < 800.0 * 1.05
    assert jerk.max() < 800.0 * 1.45
    # bang-bang: some limit holds nearly everywhere
    busy = np.maximum(
        np.abs(moved.acceleration[5:-6]).max(axis=1) / 20.0,
        np.maximum(jerk / 800.0, np.abs(moved.velocity[5:-6]).max(axis=1) / 0.5),
    )
    assert np.percentile(busy, 10) > 0.8


@pytest.mark.parametrize(("share", "place", "speed"), [(0.0, 0.0, 0.0), (0.5, 0.15, 0.5)])
def test_a_line_at_one_time(share, place, speed):
    """At rest where it begins; by symmetry halfway, at the greatest speed, at half its time."""
    motion = TimeOptimalMotion((line(0.3),), LIMITS)
    moved = motion.at(share * motion.duration)
    assert moved.position == pytest.approx([place, 0.0, 0.0], abs=1e-4)
    assert moved.velocity == pytest.approx([speed, 0.0, 0.0], abs=1e-3)


def test_velocity_is_the_derivative_of_the_position():
    motion = TimeOptimalMotion(tuple(corner()), LIMITS)
    time = np.linspace(0.0, motion.duration, 20_001)
    moved = motion.at(time)
    rate = np.diff(moved.position, axis=0) / time[1]
    assert np.abs(rate - 0.5 * (moved.velocity[1:] + moved.velocity[:-1])).max() < 1e-4
    assert motion.path.distance(moved.position).max() < 1e-9
    assert moved.position[-1] == pytest.approx([5e-3, 25e-3, 0.0], abs=1e-9)


def test_feeds_are_kept():
    motion = TimeOptimalMotion(tuple(corner(0.05)), LIMITS)
    speed = motion.along(np.linspace(0.0, motion.duration, 5001))[1]
    assert speed.max() < 0.05 * 1.01
    assert np.median(speed) == pytest.approx(0.05, rel=1e-3)


def test_corners_and_dwells_are_stops():
    up = SpatialLine((0.02, 0.0, 0.0), (0.02, 0.02, 0.0))
    blocks = (line(0.02, dwell=0.1), Block(up, math.inf))
    motion = TimeOptimalMotion(blocks, LIMITS)
    alone = TimeOptimalMotion((line(0.02),), LIMITS).duration
    assert motion.duration == pytest.approx(2.0 * alone + 0.1, rel=1e-3)
    assert motion.begins[1] == pytest.approx(alone + 0.1, rel=1e-6)
    at_rest = motion.at(np.array([alone + 0.05]))
    assert at_rest.position[0] == pytest.approx([0.02, 0.0, 0.0], abs=1e-12)
    assert not at_rest.velocity.any()
