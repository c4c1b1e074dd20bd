"""Motion along lines and arcs with feeds: times by hand, limits of the vectors, corners."""

import math
from itertools import pairwise

import numpy as np
import pytest

from dynamics.trajectory.block_motion import Block, BlockMotion, PathLimits, rounded
from dynamics.trajectory.motion import TrajectoryError
from dynamics.trajectory.recorded import RecordedMotion
from dynamics.trajectory.spatial_path import SpatialArc, SpatialLine, SpatialPath

LIMITS = PathLimits(0.5, 2.0, 50.0)
FEED = 0.1


def line(*points):
    return [
        Block(SpatialLine((*one, 0.0)[:3], (*two, 0.0)[:3]), FEED) for one, two in pairwise(points)
    ]


def quarter(radius=0.02):
    """From (0.1, 0) to the left, a quarter of a turn."""
    return SpatialArc((0.1, radius, 0.0), (0.0, -radius, 0.0), (radius, 0.0, 0.0), 0.5 * math.pi)


def motion(blocks, limits=LIMITS):
    return BlockMotion(tuple(blocks), limits)


def test_a_long_line_takes_the_time_of_its_pieces():
    """L / v + v / a + a / j, where the acceleration is reached: v j = 5 > a^2 = 4."""
    assert motion(line((0.0, 0.0), (0.3, 0.4))).duration == pytest.approx(
        0.5 / 0.1 + 0.1 / 2.0 + 2.0 / 50.0, rel=1e-12
    )


def test_a_short_line_is_jerk_alone():
    """Four pieces of T with L = 2 j T^3, while j T < a and j T^2 < v."""
    length = 1e-3
    assert motion(line((0.0, 0.0), (0.0, length))).duration == pytest.approx(
        4.0 * (length / (2.0 * 50.0)) ** (1.0 / 3.0), rel=1e-9
    )


def test_rapid_traverse_is_as_fast_as_the_limit():
    block = Block(SpatialLine((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)), math.inf)
    wanted = 1.0 / 0.5 + 0.5 / 2.0 + 2.0 / 50.0
    assert motion([block]).duration == pytest.approx(wanted, rel=1e-12)


def test_lengths_of_arcs_and_helices():
    assert quarter().length == pytest.approx(0.02 * math.pi / 2.0, rel=1e-12)
    helix = SpatialArc(
        (0.0, 0.0, 0.0), (0.03, 0.0, 0.0), (0.0, 0.03, 0.0), 4.0 * math.pi, (0.0, 0.0, -0.01)
    )
    assert helix.length == pytest.approx(math.hypot(4.0 * math.pi * 0.03, 0.01), rel=1e-12)
    end = helix.at(np.array(helix.length))
    assert end.position == pytest.approx([0.03, 0.0, -0.01], abs=1e-12)
    assert np.linalg.norm(end.tangent) == pytest.approx(1.0, rel=1e-12)


def test_derivatives_of_a_helix_are_those_of_its_positions():
    helix = SpatialArc((0.01, 0.0, 0.0), (0.03, 0.0, 0.0), (0.0, 0.0, 0.03), 2.0, (0.0, 0.005, 0.0))
    step = 1e-5
    at = helix.at(np.array([0.02 - step, 0.02, 0.02 + step]))
    tangent = (at.position[2] - at.position[0]) / (2.0 * step)
    bend = (at.position[2] - 2.0 * at.position[1] + at.position[0]) / step**2
    assert at.tangent[1] == pytest.approx(tangent, abs=1e-6)
    assert at.bend[1] == pytest.approx(bend, abs=1e-3)
    assert np.linalg.norm(at.bend[1]) == pytest.approx(helix.bend, rel=1e-9)


def test_a_tangent_arc_is_passed_at_the_feed():
    blocks = [
        *line((0.0, 0.0), (0.1, 0.0)),
        Block(quarter(), FEED),
        *line((0.12, 0.02), (0.12, 0.2)),
    ]
    found = motion(blocks)
    # sqrt(a r / sqrt 2) = 0.168 m/s and cbrt(j r^2 / 4) = 0.171 m/s are above the feed
    length = 0.1 + 0.01 * math.pi + 0.18
    assert found.duration == pytest.approx(length / 0.1 + 0.1 / 2.0 + 2.0 / 50.0, rel=1e-12)
    time = np.linspace(1.05, 1.3, 26)
    assert np.linalg.norm(found.at(time).velocity, axis=1) == pytest.approx(0.1, rel=1e-12)


def test_a_corner_is_a_stop():
    single = 0.1 / 0.1 + 0.1 / 2.0 + 2.0 / 50.0
    blocks = line((0.0, 0.0), (0.1, 0.0), (0.1, 0.1))
    found = motion(blocks)
    assert found.duration == pytest.approx(2.0 * single, rel=1e-12)
    assert found.begins[1] == pytest.approx(single, rel=1e-12)
    assert found.at(single).velocity == pytest.approx(np.zeros(3), abs=1e-9)


def test_an_exact_stop_and_a_dwell_cost_their_time():
    two = line((0.0, 0.0), (0.1, 0.0), (0.2, 0.0))
    passed = motion(two).duration
    stopped = motion([Block(two[0].element, FEED, stops=True), two[1]]).duration
    assert stopped - passed == pytest.approx(0.1 / 2.0 + 2.0 / 50.0, rel=1e-9)
    dwelt = motion([Block(two[0].element, FEED, dwell=0.3), two[1]])
    assert dwelt.duration - stopped == pytest.approx(0.3, rel=1e-9)
    resting = dwelt.at(np.linspace(1.1, 1.38, 8))
    assert np.max(np.abs(resting.velocity)) == 0.0
    assert resting.position[:, 0] == pytest.approx(0.1, abs=1e-12)


def test_vectors_stay_within_the_limits_along_an_arc():
    """A circle from rest to rest, fast enough for the acceleration and the jerk to matter."""
    circle = SpatialArc((0.0, 0.0, 0.0), (0.02, 0.0, 0.0), (0.0, 0.02, 0.0), 2.0 * math.pi)
    found = motion([Block(circle, 1.0)])
    time = np.linspace(0.0, found.duration, 40001)
    moved = found.at(time)
    step = time[1] - time[0]
    velocity = np.gradient(moved.position, step, axis=0)
    assert np.max(np.abs(velocity - moved.velocity)) < 1e-6
    assert np.linalg.norm(moved.acceleration, axis=1).max() <= 2.0 * (1.0 + 1e-9)
    jerk = np.linalg.norm(np.diff(moved.acceleration, axis=0), axis=1) / step
    assert jerk.max() <= 50.0 * (1.0 + 1e-6)
    # and it is not slower than the square root of 2 asks for
    assert np.linalg.norm(moved.velocity, axis=1).max() > 0.95 * math.sqrt(
        2.0 * 0.02 / math.sqrt(2.0)
    )
    assert np.linalg.norm(moved.position, axis=1) == pytest.approx(0.02, rel=1e-12)


def test_a_block_too_short_to_brake_in_is_looked_ahead_to():
    """1 mm before a corner: braking begins in the block before, and the limits hold."""
    blocks = [*line((0.0, 0.0), (0.1, 0.0), (0.101, 0.0)), *line((0.101, 0.0), (0.101, 0.1))]
    found = motion(blocks)
    time = np.linspace(0.0, found.duration, 20001)
    moved = found.at(time)
    assert np.linalg.norm(moved.acceleration, axis=1).max() <= 2.0 * (1.0 + 1e-9)
    assert np.linalg.norm(moved.velocity, axis=1).max() <= 0.1 * (1.0 + 1e-9)
    # the greatest speed from which 1 mm is enough: v = L^(2/3) j^(1/3) / 1 of one pair of ramps
    reached = np.linalg.norm(found.at(found.begins[1]).velocity)
    assert reached == pytest.approx((1e-3 * math.sqrt(50.0)) ** (2.0 / 3.0), rel=1e-9)


@pytest.mark.parametrize("tolerance", [2e-6, 2e-5])
def test_corners_of_short_lines_are_rounded_within_the_tolerance(tolerance):
    """A circle of 30 mm in lines of two degrees, as from a CAM program."""
    angle = np.radians(np.arange(0.0, 362.0, 2.0))
    points = [(0.03 * math.cos(one), 0.03 * math.sin(one)) for one in angle]
    sharp = motion(line(*points))
    smooth = motion(rounded(line(*points), tolerance, LIMITS))
    assert smooth.duration < 0.25 * sharp.duration
    off = sharp.path.distance(smooth.at(np.linspace(0.0, smooth.duration, 4001)).position)
    assert 0.2 * min(tolerance, 4.6e-6) < off.max() <= tolerance
    # half a line is all that an arc may take: its middle is r (1 / cos 1 deg - 1) off the corner
    assert off.max() <= 0.03 * (1.0 / math.cos(math.radians(1.0)) - 1.0) * 1.01


def test_a_corner_is_not_rounded_where_a_stop_is_quicker():
    corner = line((0.0, 0.0), (0.1, 0.0), (0.1, 0.1))
    assert len(rounded(corner, 1e-7, LIMITS)) == 2
    assert len(rounded(corner, 2e-3, LIMITS)) == 3


def test_distances_from_a_path_by_hand():
    first = line((0.0, 0.0), (0.1, 0.0))[0].element
    path = SpatialPath((first, quarter()))
    aside = 0.025 / math.sqrt(2.0)
    points = [
        [0.05, 0.01, 0.0],
        [-0.03, 0.04, 0.0],
        [0.1 + aside, 0.02 - aside, 0.0],
        [0.1, 0.02, 0.0],
        [0.12, 0.03, 0.002],
    ]
    wanted = [0.01, 0.05, 0.005, 0.02, math.hypot(0.01, 0.002)]
    assert path.distance(np.array(points)) == pytest.approx(wanted, rel=1e-9)


def test_wrong_paths_are_refused():
    with pytest.raises(TrajectoryError, match=r"element 1 starts 0\.1 m off the end"):
        motion([*line((0.0, 0.0), (0.1, 0.0)), *line((0.2, 0.0), (0.3, 0.0))])
    with pytest.raises(TrajectoryError, match="nothing moves"):
        motion([])
    with pytest.raises(TrajectoryError, match="not perpendicular"):
        SpatialArc((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), 1.0)
    with pytest.raises(TrajectoryError, match="jerk is 0"):
        PathLimits(1.0, 1.0, 0.0)


def test_recorded_set_points_are_met_and_smooth_between():
    time = np.linspace(3.0, 4.0, 51)
    position = np.column_stack((1.0 - np.cos(np.pi * (time - 3.0)), np.zeros(51)))
    found = RecordedMotion(time, position)
    assert found.duration == pytest.approx(1.0)
    assert found.at(time - 3.0).position == pytest.approx(position, abs=1e-12)
    between = np.linspace(0.0, 1.0, 501)
    moved = found.at(between)
    assert moved.velocity[:, 0] == pytest.approx(np.pi * np.sin(np.pi * between), abs=1e-4)
    assert moved.acceleration[1:-1, 0] == pytest.approx(
        np.pi**2 * np.cos(np.pi * between[1:-1]), abs=0.05
    )
    assert found.at(2.0).position == pytest.approx([2.0, 0.0])
    assert found.at(2.0).velocity == pytest.approx([0.0, 0.0])


@pytest.mark.parametrize(
    ("time", "told"),
    [([0.0, 1.0, 1.0, 2.0], "does not rise at 1 s"), ([0.0, 1.0, 2.0], "4 at least"),
     ([0.0, 1.0, math.nan, 2.0], "not finite")],
)  # fmt: skip
def test_wrong_records_are_refused(time, told):
    with pytest.raises(TrajectoryError, match=told):
        RecordedMotion(np.array(time), np.zeros((len(time), 1)))
