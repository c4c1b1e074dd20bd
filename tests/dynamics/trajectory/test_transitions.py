"""Clothoids between lines and arcs: geometry against its definition, limits of the motion."""

import math

import numpy as np
import pytest

from dynamics.trajectory.block_motion import Block, BlockMotion, PathLimits, eased
from dynamics.trajectory.motion import TrajectoryError
from dynamics.trajectory.spatial_path import SpatialArc, SpatialLine, SpatialPath
from dynamics.trajectory.transition import Clothoid

LIMITS = PathLimits(0.5, 20.0, 800.0)
RADIUS, TOLERANCE = 5e-3, 1e-6


def corner(sweep=0.5 * math.pi, radius=RADIUS):
    """A line along x, an arc to the left, and the tangent line behind it."""
    arc = SpatialArc((0.0, radius, 0.0), (0.0, -radius, 0.0), (radius, 0.0, 0.0), sweep)
    end = arc.at(np.array(arc.length))
    before = SpatialLine((-0.04, 0.0, 0.0), (0.0, 0.0, 0.0))
    after = SpatialLine(tuple(end.position), tuple(end.position + 0.04 * end.tangent))
    return [Block(one, math.inf, source=k) for k, one in enumerate((before, arc, after))]


def test_a_clothoid_is_the_fresnel_integrals():
    """From curvature 0 to 1 / R: x = L (1 - t^2/10 + ...), y = L t (1/3 - t^2/42), t = L / 2R."""
    length, radius = 1e-3, 5e-3
    curve = Clothoid((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), length, (0.0, 1.0 / radius))
    t = 0.5 * length / radius
    end = curve.at(np.array(length))
    x = length * (1.0 - t**2 / 10.0 + t**4 / 216.0)
    y = length * t * (1.0 / 3.0 - t**2 / 42.0 + t**4 / 1320.0)
    assert end.position == pytest.approx([x, y, 0.0], rel=1e-9)
    assert end.tangent == pytest.approx([math.cos(t), math.sin(t), 0.0], rel=1e-12)
    assert np.linalg.norm(end.bend) == pytest.approx(1.0 / radius, rel=1e-12)
    with pytest.raises(TrajectoryError, match="unit vectors"):
        Clothoid((0.0,) * 3, (1.0, 0.0, 0.0), (1.0, 0.0, 0.0), length, (0.0, 1.0))


@pytest.mark.parametrize("sweep", [0.4, 0.5 * math.pi, 2.4])
def test_an_eased_arc_is_smooth_and_within_the_tolerance(sweep):
    blocks = corner(sweep)
    exact = SpatialPath(tuple(one.element for one in blocks))
    found = eased(blocks, TOLERANCE)
    assert [one.source for one in found] == [0, 1, 1, 1, 2]
    path = SpatialPath(tuple(one.element for one in found))
    along = np.linspace(0.0, path.length, 20001)
    place = path.at(along)
    off = exact.distance(place.position)
    assert 0.9 * TOLERANCE < off.max() <= TOLERANCE
    # position, tangent and curvature go on, and are each other's derivatives
    step = along[1]
    assert np.abs(np.diff(place.bend, axis=0)).max() < 0.05 / RADIUS
    middle = 0.5 * (place.tangent[1:] + place.tangent[:-1])
    assert np.abs(np.diff(place.position, axis=0) / step - middle).max() < 1e-4
    assert np.linalg.norm(place.tangent, axis=1) == pytest.approx(np.ones(len(along)), rel=1e-9)


def test_the_jerk_of_an_eased_corner_stays_within_its_limit():
    """As differences of the acceleration; unless eased, it jumps by v^2 / r in one step."""
    worst = {}
    for name, blocks in (("exact", corner()), ("eased", eased(corner(), TOLERANCE))):
        motion = BlockMotion(tuple(blocks), LIMITS)
        time = np.arange(0.0, motion.duration, 2e-5)
        moved = motion.at(time)
        assert np.linalg.norm(moved.acceleration, axis=1).max() < 20.0 * (1.0 + 1e-9)
        jerk = np.linalg.norm(np.diff(moved.acceleration, axis=0), axis=1) / 2e-5
        worst[name] = jerk.max()
    assert worst["exact"] > 1e5
    assert worst["eased"] < 800.0 * 1.001
    assert worst["eased"] > 0.7 * 800.0


def test_what_stays_as_it_is():
    line, arc, after = corner()
    assert eased([line, arc], TOLERANCE) == [line, arc]
    stops = Block(line.element, math.inf, stops=True)
    assert eased([stops, arc, after], TOLERANCE) == [stops, arc, after]
    tiny = corner(radius=2e-6)
    assert eased(tiny, TOLERANCE) == tiny


def test_distance_from_a_clothoid():
    curve = Clothoid((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), 1e-3, (0.0, 200.0))
    s = np.linspace(0.0, 1e-3, 50)
    place = curve.at(s)
    across = np.stack([-place.tangent[:, 1], place.tangent[:, 0], 0.0 * s], axis=-1)
    assert curve.distance(place.position + 3e-5 * across) == pytest.approx(np.full(50, 3e-5))
    assert curve.distance(place.position) == pytest.approx(np.zeros(50), abs=1e-12)
