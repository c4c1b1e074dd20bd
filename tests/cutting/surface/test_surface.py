"""The surface of passing edges against its geometry, and the texture numbers of known profiles."""

import math

import numpy as np
import pytest

from cutting.surface.envelope import (
    ToolMotion,
    WallPasses,
    floor_height,
    wall_reach,
    width_of_influence,
)
from cutting.surface.texture import (
    cut_off_for,
    height_parameters,
    location_error,
    mean_line,
    texture,
)

RADIUS = 10e-3
FEED = 0.2e-3  # a tooth
TURN = 2.0 * math.pi


def wall(displacement, side=1.0, teeth=4, offsets=None, feed=FEED, lift=0.0, points=40):
    """Deviation of the wall from R for a displacement (n, 3) given over the spindle angle (n,)."""
    angle = np.linspace(0.0, 24.0 * TURN, 24 * 720 + 1)
    place = np.array(displacement(angle), dtype=float).T.copy()
    place[:, 0] += feed * teeth * angle / TURN
    motion = ToolMotion(angle, place)
    edges = TURN * np.arange(teeth) / teeth
    passes_angle, edge = motion.passes(edges, 0.0 if side > 0 else math.pi, 0.65)
    offsets = np.zeros(teeth) if offsets is None else np.asarray(offsets)
    passes = WallPasses(passes_angle, RADIUS + offsets[edge], lift, side)
    width = width_of_influence(motion, passes)
    middle, _ = passes.reach_at_pass(motion)
    spacing = feed / points
    x = np.arange(middle[0] + width, middle[-1] - width, spacing)
    return x, wall_reach(motion, passes, x, width) - RADIUS


def still(angle):
    return np.zeros((3, angle.size))


def up(way, axis):
    """A constant displacement along an axis."""
    return way * (np.arange(3) == axis)[:, None]


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_rigid_tool_leaves_cusps_of_the_feed(side):
    _, deviation = wall(still, side, points=400)
    cusp = RADIUS - math.sqrt(RADIUS**2 - 0.25 * FEED**2)
    # the path is a trochoid: its curve at the wall differs from the circle by 1 -+ f N / (2 pi R)
    trochoid = 4.0 * FEED / (TURN * RADIUS)
    assert np.ptp(deviation) == pytest.approx(cusp, rel=2.5 * trochoid)
    assert deviation.mean() == pytest.approx(-cusp / 3.0, rel=2.5 * trochoid)
    assert deviation.max() == pytest.approx(0.0, abs=1e-4 * cusp)


def test_cusps_of_up_and_down_milling_differ_by_the_trochoid():
    # radius of curvature at the wall: (R +- c)^2 / R with c the feed a radian (Martellotti 1941)
    per_radian = 4.0 * FEED / TURN
    up, down = (np.ptp(wall(still, side, points=1000)[1]) for side in (1.0, -1.0))
    expected = ((RADIUS - per_radian) / (RADIUS + per_radian)) ** 2
    assert up / down == pytest.approx(expected, rel=1e-4)


def test_one_tooth_standing_out_marks_the_wall_once_a_turn():
    _, deviation = wall(still, offsets=[50e-6, 0.0, 0.0, 0.0])
    per_turn = 4.0 * FEED
    cusp = per_turn**2 / (8.0 * RADIUS)
    assert np.ptp(deviation) == pytest.approx(cusp, rel=0.05)
    assert deviation.mean() == pytest.approx(50e-6 - cusp / 3.0, rel=0.01)
    spectrum = np.abs(np.fft.rfft(deviation - deviation.mean()))
    strongest = np.argmax(spectrum) / (deviation.size * FEED / 40)
    assert strongest == pytest.approx(1.0 / per_turn, rel=0.05)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_deflection_moves_the_wall_by_itself(side):
    _, still_wall = wall(still, side)
    _, moved = wall(lambda angle: still(angle) + up(30e-6, 1), side)
    assert moved.mean() - still_wall.mean() == pytest.approx(side * 30e-6, abs=1e-9)


@pytest.mark.parametrize("phase", [0.3, 2.0, 4.5])
def test_vibration_with_the_teeth_moves_the_wall_by_its_value_at_the_passing(phase):
    """Schmitz and Ziegert 1999: the location error is the motion sampled when the tooth passes."""
    amplitude, teeth = 20e-6, 4

    def motion(angle):
        place = still(angle)
        place[1] = amplitude * np.cos(teeth * angle + phase)
        return place

    # fine feed, so that each point is cut close to the passing
    _, deviation = wall(motion, teeth=teeth, feed=0.02e-3)
    # within the arc that reaches furthest the motion changes a little:
    # max over t of A cos(N t + p) - R t^2 / 2
    turned = np.linspace(-0.1, 0.1, 20001)
    expected = amplitude * np.cos(teeth * turned + phase) - RADIUS * (1.0 - np.cos(turned))
    assert deviation.mean() == pytest.approx(expected.max(), abs=5e-9)
    assert deviation.mean() == pytest.approx(amplitude * math.cos(phase), abs=0.02 * amplitude)


def test_wall_is_the_reach_of_a_dense_cloud_of_edge_points():
    """Independent: sweep every edge over all angles and take the highest point in each bin."""
    frequency, amplitude, teeth = 2.37, 60e-6, 3

    def motion(angle):
        place = still(angle)
        place[0] = 0.5 * amplitude * np.sin(1.7 * angle)
        place[1] = amplitude * np.sin(frequency * angle + 1.0)
        return place

    offsets = np.array([10e-6, -15e-6, 5e-6])
    x, deviation = wall(motion, teeth=teeth, offsets=offsets)
    angle = np.linspace(0.0, 24.0 * TURN, 2_000_001)
    centre = motion(angle)
    centre[0] += FEED * teeth * angle / TURN
    spacing = x[1] - x[0]
    highest = np.full(x.size, -np.inf)
    for tooth in range(teeth):
        phi = angle + TURN * tooth / teeth
        radius = RADIUS + offsets[tooth]
        near = np.cos(phi) > 0.8
        place = centre[0] + radius * np.sin(phi)
        height = centre[1] + radius * np.cos(phi) - RADIUS
        cell = np.round((place - x[0]) / spacing)
        known = near & (cell >= 0) & (cell < x.size)
        np.maximum.at(highest, cell[known].astype(int), height[known])
    known = np.isfinite(highest)
    assert known.mean() > 0.99
    # points of the cloud lie up to half a cell off, where the wall is a little higher or lower
    slope = np.abs(np.gradient(deviation, spacing)).max()
    assert np.abs(highest - deviation)[known].max() < 0.6 * slope * spacing + 1e-9
    assert np.median(np.abs(highest - deviation)[known]) < 1e-7


def test_lift_of_a_leaning_edge_moves_the_wall():
    # an edge at 45 degrees on a tool lifted by z reaches less by z at a fixed height
    _, deviation = wall(lambda angle: still(angle) + up(7e-6, 2), lift=-1.0)
    _, unlifted = wall(still, lift=-1.0)
    assert deviation.mean() - unlifted.mean() == pytest.approx(-7e-6, rel=1e-3)


def test_round_corners_leave_scallops():
    corner, x = 1e-3, np.linspace(2e-3, 4e-3, 20001)
    place = np.arange(0.0, 6e-3, FEED)
    floor = floor_height(x, place, np.zeros(place.size), corner, 0.0)
    assert floor.max() == pytest.approx(corner - math.sqrt(corner**2 - 0.25 * FEED**2), rel=1e-3)
    assert floor.max() == pytest.approx(FEED**2 / (8.0 * corner), rel=0.01)
    assert floor.min() == pytest.approx(0.0, abs=1e-12)


def test_deeper_corner_wins_over_shallow_ones():
    x = np.linspace(4e-3, 8e-3, 4001)
    place = np.arange(0.0, 12e-3, FEED)
    height = np.where(np.arange(place.size) % 4 == 0, -50e-6, 0.0)
    round_floor = floor_height(x, place, height, 3e-3, 0.0)
    assert np.ptp(round_floor) == pytest.approx((4 * FEED) ** 2 / (8.0 * 3e-3), rel=0.02)
    # ends of the teeth that are flat over a revolution wipe the floor clean
    assert np.all(floor_height(x, place, height, 0.0, 4 * FEED) == -50e-6)


def test_heights_of_a_sine():
    amplitude, waves = 3e-6, 20
    x = np.linspace(0.0, 1.0, 8000, endpoint=False)
    found = height_parameters(amplitude * np.sin(TURN * waves * x) + 5e-6, 400)
    assert found.mean == pytest.approx(2.0 * amplitude / math.pi, rel=1e-4)
    assert found.rms == pytest.approx(amplitude / math.sqrt(2.0), rel=1e-4)
    assert found.depth == pytest.approx(2.0 * amplitude, rel=1e-3)


@pytest.mark.parametrize(
    ("ratio", "passed"), [(1.0, 0.5), (2.0, 0.5**0.25), (0.5, 0.5**4), (5.0, 0.5**0.04)]
)
def test_gaussian_filter_passes_what_the_standard_says(ratio, passed):
    """ISO 16610-21: transmission exp(-pi (alpha cut_off / wavelength)^2) = 0.5^((lc/l)^2)."""
    cut_off, spacing = 0.8e-3, 4e-6
    x = np.arange(20000) * spacing
    wave = np.sin(TURN * x / (ratio * cut_off))
    smooth = mean_line(wave, spacing, cut_off)
    kept = slice(5000, 15000)
    assert np.ptp(smooth[kept]) / np.ptp(wave[kept]) == pytest.approx(passed, abs=2e-3)


def test_mean_line_of_a_constant_is_the_constant_up_to_the_ends():
    assert mean_line(np.full((2, 50), 3.0), 1e-3, 8e-3) == pytest.approx(3.0)
    assert mean_line(np.full(3, 3.0), 1e-3, 8e-3) == pytest.approx(3.0)


def test_texture_tells_marks_from_waves():
    spacing, cut_off = 5e-6, 0.8e-3
    x = np.arange(4000) * spacing
    profile = 1e-6 * np.sin(TURN * x / 0.1e-3) + 4e-6 * np.sin(TURN * x / 6e-3)
    found = texture(profile[None, :], np.ones(1), spacing, cut_off)
    assert found.roughness.mean == pytest.approx(2e-6 / math.pi, rel=0.02)
    assert found.waviness.depth == pytest.approx(8e-6, rel=0.03)
    assert found.length == pytest.approx(4000 * spacing - cut_off)


def test_texture_of_a_short_profile_is_not_split():
    profile = np.sin(np.linspace(0.0, 20.0 * TURN, 1000))
    found = texture(profile[None, :], np.ones(1), 1e-6, 0.8e-3)
    assert found.waviness is None
    assert found.roughness.mean == pytest.approx(2.0 / math.pi, rel=0.01)


def test_cut_off_follows_the_spacing_of_marks():
    """ISO 4288, table 3: RSm above 0.13 to 0.4 mm is measured with 0.8 mm."""
    assert cut_off_for(0.1e-3) == pytest.approx(0.25e-3)
    assert cut_off_for(0.4e-3) == pytest.approx(0.8e-3)
    assert cut_off_for(0.41e-3) == pytest.approx(2.5e-3)
    assert cut_off_for(3e-3) == pytest.approx(8e-3)


def test_location_error_weighs_the_heights():
    deviation = np.array([[1.0, 3.0], [6.0, 6.0]])
    by_height, mean = location_error(deviation, np.array([3.0, 1.0]))
    assert by_height == pytest.approx([2.0, 6.0])
    assert mean == pytest.approx(3.0)
