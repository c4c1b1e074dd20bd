"""Paths, motions along them, set points and contour errors against geometry."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit

from dynamics.trajectory.jerk_limited import JerkLimitedMove
from dynamics.trajectory.motion import TrajectoryError
from dynamics.trajectory.path import (
    Arc,
    Line,
    Path,
    circle,
    contour_error,
    polyline,
    square,
    tracking_error,
)
from dynamics.trajectory.path_motion import PathMotion
from dynamics.trajectory.periodic import CircleMotion, ConstantSpeedMove, SineMotion
from dynamics.trajectory.set_points import set_point_at, set_points

SIDE, RADIUS = 0.1, 0.008
FEED, ACCELERATION, JERK = 0.25, 4.0, 80.0


def test_square_has_the_length_of_its_sides_and_fillets():
    path = square(SIDE, RADIUS, (0.3, -0.1))
    assert path.length == pytest.approx(4 * SIDE - 8 * RADIUS + 2 * math.pi * RADIUS, rel=1e-14)
    position, tangent, curvature = path.at(np.linspace(0, path.length, 2001))
    assert np.abs(position - [0.3, -0.1]).max() == pytest.approx(SIDE / 2, rel=1e-9)
    np.testing.assert_allclose(np.linalg.norm(tangent, axis=-1), 1.0, rtol=1e-14)
    assert set(np.round(curvature, 6)) == {0.0, 1.0 / RADIUS}
    np.testing.assert_allclose(position[0], position[-1], atol=1e-15)
    # area by Green's theorem: the square less the four corners
    x, y = position[:-1].T
    area = 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)
    assert area == pytest.approx(SIDE**2 - (4 - math.pi) * RADIUS**2, rel=1e-5)


def test_tangent_turns_without_jumps_over_fillets():
    points = [(0, 0), (1, 0), (1.5, 0.8), (0.2, 1.0), (-1, 0.1), (-0.4, -0.9)]
    path = polyline(points, 0.1)
    s = np.linspace(0, path.length, 20001)
    position, tangent, _ = path.at(s)
    assert np.linalg.norm(np.diff(tangent, axis=0), axis=1).max() < 1.1 * (s[1] / 0.1)
    chord = np.diff(position, axis=0) / s[1]
    np.testing.assert_allclose(chord, 0.5 * (tangent[1:] + tangent[:-1]), atol=1e-3)


def test_collinear_points_and_sharp_corners():
    path = polyline([(0, 0), (1, 0), (2, 0), (2, 3)])
    assert path.elements == (Line((0, 0), (2, 0)), Line((2, 0), (2, 3)))
    motion = PathMotion(path, 1.0, 5.0, 50.0)
    one = JerkLimitedMove([0.0], [2.0], 1.0, 5.0, 50.0).duration
    two = JerkLimitedMove([0.0], [3.0], 1.0, 5.0, 50.0).duration
    assert motion.duration == pytest.approx(one + two, rel=1e-13)
    assert np.linalg.norm(motion.at(one).velocity) < 1e-6


@pytest.mark.parametrize("jerk", [JERK, 5000.0])
def test_square_keeps_its_limits(jerk):
    path = square(SIDE, RADIUS)
    motion = PathMotion(path, FEED, ACCELERATION, jerk)
    corner = min(FEED, math.sqrt(ACCELERATION * RADIUS), (jerk * RADIUS**2) ** (1 / 3))
    assert motion.corner_speed(RADIUS) == corner < FEED
    t = np.linspace(0, motion.duration, 40001)
    moved = motion.at(t)
    covered, speed, gain = motion.along(t)
    curvature = path.at(covered)[2]
    size = np.linalg.norm(moved.acceleration, axis=-1)
    np.testing.assert_allclose(size[curvature > 0], corner**2 / RADIUS, rtol=1e-9)
    assert size.max() <= ACCELERATION * (1 + 1e-9)
    np.testing.assert_allclose(np.linalg.norm(moved.velocity, axis=-1), speed, atol=1e-15)
    assert speed.max() <= FEED * (1 + 1e-9)
    assert (np.abs(np.diff(gain)) <= jerk * t[1] * (1 + 1e-6) + 1e-9).all()
    assert np.abs(np.diff(speed)).max() <= ACCELERATION * t[1] * (1 + 1e-9)
    np.testing.assert_allclose(np.diff(covered) / t[1], 0.5 * (speed[1:] + speed[:-1]), atol=1e-5)
    np.testing.assert_allclose(motion.at(motion.duration).position, moved.position[0], atol=1e-15)
    assert np.abs(contour_error(path, moved.position).error).max() < 1e-15


def test_path_of_one_line_is_the_jerk_limited_move():
    for length in (1.0, 0.05, 1e-3, 1e-5):
        move = JerkLimitedMove([0, 0], [0.6 * length, 0.8 * length], FEED, ACCELERATION, JERK)
        motion = PathMotion(polyline([(0, 0), move.end]), FEED, ACCELERATION, JERK)
        assert motion.duration == pytest.approx(move.duration, rel=1e-9)
        t = np.linspace(0, move.duration, 300)
        np.testing.assert_allclose(motion.at(t).position, move.at(t).position, atol=1e-9 * length)


def test_short_sides_slow_the_corners_down():
    # 1 mm steps: a corner's own speed cannot be reached, nor left in time
    steps = [(0.0, 0.0)] + [(0.002 * ((i + 1) // 2), 0.002 * (i // 2)) for i in range(1, 9)]
    motion = PathMotion(polyline(steps, 2e-4), 5.0, 200.0, 500.0)
    t = np.linspace(0, motion.duration, 60001)
    _, speed, gain = motion.along(t)
    assert np.abs(np.diff(speed)).max() <= 200.0 * t[1]
    assert np.abs(np.diff(gain)[1:-1]).max() <= 500.0 * t[1] * (1 + 1e-6)
    assert np.abs(np.diff(motion.along(t)[0])).max() <= 1.001 * speed.max() * t[1]
    assert speed[-2] < 1e-3


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.tuples(st.integers(-50, 50), st.integers(-50, 50)), min_size=2, max_size=7),
    st.sampled_from([0.0, 1e-4, 2e-3]),
    st.floats(0.01, 3.0),
    st.floats(0.1, 50.0),
    st.floats(1.0, 1e4),
)
def test_any_polyline_is_run_through_within_its_limits(points, radius, feed, acceleration, jerk):
    try:
        path = polyline(1e-3 * np.array(points), radius)
    except TrajectoryError:
        return
    motion = PathMotion(path, feed, acceleration, jerk)
    t = np.linspace(0, motion.duration, 4001)
    covered, speed, gain = motion.along(t)
    assert speed.min() >= -1e-9 * feed
    assert speed.max() <= feed * (1 + 1e-9)
    assert np.abs(gain).max() <= acceleration * (1 + 1e-9)
    curvature = path.at(covered)[2]
    assert np.max(curvature * speed**2) <= acceleration * (1 + 1e-6)
    assert np.diff(covered).min() >= -1e-9 * path.length
    # length, speed and acceleration run on from piece to piece without jumps
    p, ends = motion.pieces, np.array([*motion.pieces.time[1:], motion.duration])
    d = ends - p.time
    length = p.length + d * (p.speed + d * (p.acceleration / 2 + d * p.jerk / 6))
    np.testing.assert_allclose(length, [*p.length[1:], path.length], atol=1e-12)
    final = p.speed + d * (p.acceleration + d * p.jerk / 2)
    np.testing.assert_allclose(final, [*p.speed[1:], 0.0], atol=1e-9 * feed)
    gains = p.acceleration + d * p.jerk
    np.testing.assert_allclose(gains, [*p.acceleration[1:], 0.0], atol=1e-9 * acceleration)


def test_circle_motion_is_a_centripetal_acceleration():
    motion = CircleMotion((0.1, 0.2), 0.05, 0.1, revolutions=-2.0, start_angle=0.3)
    assert motion.duration == pytest.approx(2 * 2 * math.pi * 0.05 / 0.1)
    moved = motion.at(np.linspace(0, motion.duration, 1001))
    np.testing.assert_allclose(np.linalg.norm(moved.velocity, axis=-1), 0.1, rtol=1e-13)
    np.testing.assert_allclose(np.linalg.norm(moved.acceleration, axis=-1), 0.2, rtol=1e-13)
    errors = contour_error(circle((0.1, 0.2), 0.05, 0.3, -1), moved.position)
    assert np.abs(errors.error).max() < 1e-16
    outward = moved.position + 1e-3 * (moved.position - [0.1, 0.2]) / 0.05
    # clockwise, outside is on the left
    np.testing.assert_allclose(contour_error(circle((0.1, 0.2), 0.05, 0, -1), outward).error, 1e-3)
    np.testing.assert_allclose(contour_error(circle((0.1, 0.2), 0.05), outward).error, -1e-3)


def test_sine_and_constant_speed():
    sine = SineMotion([0.1], [0.015], 2.0, 3.0)
    assert sine.duration == 1.5
    moved = sine.at([0.0, 0.125, 1.5, 1.6, -0.1])
    np.testing.assert_allclose(moved.position[:, 0], [0.1, 0.115, 0.1, 0.1, 0.1], atol=1e-15)
    w = 4 * math.pi
    np.testing.assert_allclose(moved.velocity[:, 0], [w * 0.015, 0, w * 0.015, 0, 0], atol=1e-13)
    np.testing.assert_allclose(moved.acceleration[1, 0], -(w**2) * 0.015)
    move = ConstantSpeedMove([0.0, 1.0], [3.0, 5.0], 0.5)
    assert move.duration == 10.0
    moved = move.at([0.0, 5.0, 10.0, 11.0])
    np.testing.assert_allclose(moved.position, [[0, 1], [1.5, 3], [3, 5], [3, 5]])
    np.testing.assert_allclose(moved.velocity, [[0.3, 0.4]] * 3 + [[0, 0]])


def test_contour_error_is_signed_left_of_travel():
    path = polyline([(0, 0), (1, 0), (1, 1)])
    errors = contour_error(path, [(0.5, 0.1), (0.5, -0.1), (0.9, 0.7), (1.2, 0.7), (-3, -4)])
    np.testing.assert_allclose(errors.error, [0.1, -0.1, 0.1, -0.2, -5.0], rtol=1e-12)
    np.testing.assert_allclose(errors.length, [0.5, 0.5, 1.7, 1.7, 0.0], atol=1e-12)


def test_outside_of_an_acute_corner_is_on_its_outer_side():
    # turns left by 135 degrees: all the wedge beyond the corner is on the right
    path = polyline([(0, 0), (1, 0), (0, 1)])
    for angle in np.radians([-80.0, -45.0, 0.0, 30.0, 40.0]):
        point = (1 + 0.01 * math.cos(angle), 0.01 * math.sin(angle))
        assert contour_error(path, [point]).error[0] == pytest.approx(-0.01)


def test_contour_error_beside_arcs_is_radial():
    path = square(SIDE, RADIUS)
    s = np.linspace(0, path.length, 5000)
    position, tangent, _ = path.at(s)
    left = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
    for off in (2e-4, -2e-4, 0.9 * RADIUS):
        errors = contour_error(path, position + off * left)
        np.testing.assert_allclose(errors.error, off, rtol=1e-9)
        # (start and end of the closed path are the same place)
        np.testing.assert_allclose(errors.length[1:-1], s[1:-1], atol=1e-9)


def test_lagging_axes_of_equal_gain_cut_a_circle_by_the_known_amount():
    # first-order lag of both axes: radius shrinks by 1/sqrt(1 + (w T)^2)
    feed, radius, lag = 0.2, 0.05, 0.02
    w = feed / radius
    motion = CircleMotion((0, 0), radius, feed)
    t = np.linspace(0, motion.duration, 200)
    wanted = motion.at(t).position
    shrunk = radius / math.hypot(1, w * lag)
    angle = w * t - math.atan(w * lag)
    measured = shrunk * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    errors = contour_error(circle((0, 0), radius), measured)
    np.testing.assert_allclose(errors.error, radius - shrunk, rtol=1e-9)
    # counter-clockwise: inside is on the left
    behind = np.linalg.norm(tracking_error(wanted, measured), axis=1)
    np.testing.assert_allclose(behind, radius * w * lag / math.hypot(1, w * lag), rtol=1e-9)


def test_set_points_are_the_motion_at_each_cycle():
    motion = PathMotion(square(SIDE, RADIUS), FEED, ACCELERATION, JERK)
    points = set_points(motion, 2e-3, 125e-6, standstill=0.01)
    assert points.steps == 16
    count = 5 + math.ceil(motion.duration / 2e-3) + 1
    assert points.position.shape == points.velocity.shape == (count, 2)
    np.testing.assert_array_equal(points.position[:6], np.tile(motion.at(0).position, (6, 1)))
    np.testing.assert_array_equal(points.acceleration[25], motion.at(20 * 2e-3).acceleration)
    np.testing.assert_array_equal(points.position[-1], motion.at(motion.duration).position)
    assert (points.velocity[-1] == 0.0).all()

    @njit
    def read(points, axis, step_number):
        return set_point_at(points, axis, step_number)

    for row, step in ((0, 0), (0, 15), (1, 16), (40, 655)):
        expected = [column[row, 1] for column in points[:3]]
        assert list(read(points, 1, step)) == expected
    assert read(points, 0, 10**7) == (points.position[-1, 0], 0.0, 0.0)


def test_whole_cycles_of_duration_need_no_cycle_more():
    points = set_points(SineMotion([0.0], [1.0], 10.0, 3.0), 1e-3, 1e-3)
    assert len(points.position) == 301


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: set_points(SineMotion([0], [1], 1, 1), 2e-3, 0.3e-3), "0.002 s is not a whole"),
        (lambda: square(0.1, 0.06), "fillets of radius 0.06 m take 0.12 m of side 1"),
        (lambda: polyline([(0, 0), (0, 0), (1, 1)]), "points 0 and next are the same"),
        (lambda: polyline([(0, 0), (1, 0), (0.5, 0)], 0.01), "side"),
        (lambda: polyline([(0, 0)]), "two at least"),
        (lambda: Path((Line((0, 0), (1, 0)), Line((2, 0), (3, 0)))), "element 0 ends at"),
        (lambda: Path(()), "no element"),
        (lambda: PathMotion(circle((0, 0), 1.0), 1, 1, 1), "starts or ends with an arc"),
        (lambda: PathMotion(square(1.0, 0.1), 1, 0, 1), "acceleration is 0"),
        (
            lambda: PathMotion(
                Path(
                    (
                        Line((0, 0), (1, 0)),
                        Arc((2, 0), 1, math.pi, 1.0),
                        Line((2 - math.cos(1), -math.sin(1)), (4, 4)),
                    )
                ),
                1,
                1,
                1,
            ),
            "sharp corner at an arc behind element 0",
        ),
        (lambda: Arc((0, 0), 1.0, 0.0, 7.0), "a full turn at most"),
        (lambda: CircleMotion((0, 0), 1.0, 1.0, revolutions=0.0), "number of revolutions"),
        (lambda: ConstantSpeedMove([1.0], [1.0], 1.0), "length"),
        (lambda: contour_error(square(1, 0.1), [1.0, 2.0]), "finite"),
        (lambda: tracking_error(np.zeros((3, 2)), np.zeros((2, 2))), "shape"),
    ],
)
def test_nonsense_is_refused_by_name(build, message):
    with pytest.raises(TrajectoryError, match=message):
        build()
