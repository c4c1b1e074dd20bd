"""Tool geometry: radius, immersion angle, edge length, lag, pitch, runout, serration."""

import math
from dataclasses import replace

import numpy as np
import pytest

from cutting.engagement.slice_bounds import SliceLimits, slice_bounds
from cutting.engagement.uncut_band import band_beside_wall
from cutting.tool.cutter import Cutter, Serration, edge_slices, slice_counts, slices_between
from cutting.tool.edge_table import force_on_tool
from cutting.tool.tooth_passes import earlier_passes

TURN = 2.0 * math.pi
END_MILL = Cutter(16e-3, (math.radians(30.0),) * 4, (TURN / 4,) * 4)


def slices_of(cutter, depth, factor=1):
    corner, straight = slice_counts(cutter, depth)
    return edge_slices(cutter, depth, (factor * corner, factor * straight))


def test_end_mill_slices():
    found = edge_slices(END_MILL, 8e-3, (0, 10))
    assert np.allclose(found.height, 0.8e-3 * (np.arange(10) + 0.5))
    assert np.allclose(found.thickness, 0.8e-3)
    assert np.allclose(found.radius, 8e-3)
    assert np.allclose(found.immersion, 0.5 * math.pi)
    assert np.allclose(found.edge_length, 0.8e-3)
    # at the height of the radius the edge trails by tan(helix)
    assert np.allclose(found.lag.sum(axis=1), math.tan(math.radians(30.0)))
    top = found.angle[:, -1] - 0.5 * found.lag[:, -1]
    assert np.allclose(top, TURN / 4 * np.arange(4) - math.tan(math.radians(30.0)))


def test_ball_profile():
    ball = Cutter(10e-3, (0.2,) * 2, (math.pi,) * 2, corner_radius=5e-3)
    for depth in (1e-3, 5e-3, 8e-3):
        found = slices_of(ball, depth, 20)
        # r^2 + (R - z)^2 = R^2 on the ball, R above it
        low = found.height < 5e-3
        circle = found.radius[low] ** 2 + (5e-3 - found.height[low]) ** 2
        assert np.allclose(circle, 25e-6, rtol=1e-12)
        assert np.allclose(found.radius[~low], 5e-3)
        assert np.allclose(np.sin(found.immersion[low]), found.radius[low] / 5e-3)
        assert found.thickness.sum() == pytest.approx(depth, rel=1e-12)
        arc = 5e-3 * math.acos(1.0 - min(depth, 5e-3) / 5e-3) + max(0.0, depth - 5e-3)
        assert found.edge_length.sum() == pytest.approx(arc, rel=1e-12)


def test_bull_nose_profile():
    bull = Cutter(20e-3, (0.5,) * 3, (TURN / 3,) * 3, corner_radius=3e-3)
    found = slices_of(bull, 10e-3, 10)
    low = found.height < 3e-3
    centre = 10e-3 - 3e-3
    circle = (found.radius[low] - centre) ** 2 + (3e-3 - found.height[low]) ** 2
    assert np.allclose(circle, 9e-6, rtol=1e-12)
    assert np.all(found.immersion[~low] == 0.5 * math.pi)
    assert found.edge_length.sum() == pytest.approx(0.5 * math.pi * 3e-3 + 7e-3, rel=1e-12)
    assert np.allclose(found.edge_length[low], found.edge_length[low][0])


def test_depth_within_the_corner():
    bull = Cutter(20e-3, (0.5,) * 3, (TURN / 3,) * 3, corner_radius=3e-3)
    found = slices_of(bull, 1e-3)
    assert slice_counts(bull, 1e-3)[1] == 0
    assert found.edge_length.sum() == pytest.approx(3e-3 * math.acos(2.0 / 3.0), rel=1e-12)
    assert found.radius.max() < 10e-3


@pytest.mark.parametrize("degrees", [45.0, 70.0, 90.0])
def test_straight_edge_with_an_angle(degrees):
    # the face mill widens upwards by cot of the cutting edge angle
    kappa = math.radians(degrees)
    found = edge_slices(Cutter(50e-3, (0.0,) * 5, (TURN / 5,) * 5, 0.0, kappa), 3e-3, (0, 6))
    assert np.allclose(found.radius, 25e-3 + found.height / math.tan(kappa))
    assert np.allclose(found.immersion, kappa)
    assert found.edge_length.sum() == pytest.approx(3e-3 / math.sin(kappa), rel=1e-12)


def test_corner_of_an_insert_blends_into_its_edge():
    # the arc ends where its normal is that of the edge; radius and slope go over smoothly
    kappa = math.radians(60.0)
    cutter = Cutter(50e-3, (0.0,), (TURN,), corner_radius=1e-3, edge_angle=kappa)
    found = edge_slices(cutter, 2e-3, (400, 400))
    step = np.diff(found.radius) / np.diff(found.height)
    slope = 1.0 / np.tan(0.5 * (found.immersion[1:] + found.immersion[:-1]))
    assert np.allclose(step[20:], slope[20:], rtol=1e-2)
    assert found.immersion.max() == pytest.approx(kappa)
    assert 1e-3 * (1.0 - math.cos(kappa)) == pytest.approx(found.thickness[:400].sum(), rel=1e-12)


@pytest.mark.parametrize(
    ("corner", "angle"), [(0.0, 90.0), (6e-3, 90.0), (1e-3, 90.0), (1e-3, 50.0)]
)
def test_swept_height_of_the_slices_is_the_depth(corner, angle):
    cutter = Cutter(12e-3, (0.3,), (TURN,), corner, math.radians(angle))
    found = slices_of(cutter, 4.4e-3)
    assert found.thickness.sum() == pytest.approx(4.4e-3, rel=1e-12)
    ends = found.height + 0.5 * found.thickness
    # the middle of an arc is not the middle of its height, but lies within
    assert np.all(np.diff(found.height) > 0.0)
    assert np.all(found.height < ends)


def test_default_slices_keep_lag_and_turn_small():
    cutter = replace(END_MILL, helix=(math.radians(50.0),) * 4, corner_radius=2e-3)
    found = slices_of(cutter, 20e-3)
    assert np.abs(found.lag).max() <= 0.1
    assert np.diff(found.immersion).max() <= math.radians(5.0) + 1e-12
    straight = replace(END_MILL, helix=(0.0,) * 4)
    assert slice_counts(straight, 20e-3) == (0, 1)


def test_pitch_places_the_teeth():
    pitch = tuple(np.radians([80.0, 100.0, 85.0, 95.0]))
    cutter = replace(END_MILL, pitch=pitch)
    assert np.allclose(np.degrees(cutter.tooth_angles), [0.0, 80.0, 180.0, 265.0])
    found = edge_slices(replace(cutter, helix=(0.0,) * 4), 1e-3, (0, 1))
    assert np.allclose(found.angle[:, 0], cutter.tooth_angles)


def test_variable_helix_changes_the_pitch_along_the_edge():
    helix = tuple(np.radians([30.0, 34.0, 30.0, 34.0]))
    found = edge_slices(replace(END_MILL, helix=helix), 10e-3, (0, 50))
    closing = np.diff(found.angle[:2], axis=0)[0]
    rate = (math.tan(helix[1]) - math.tan(helix[0])) / 8e-3
    assert np.allclose(closing, TURN / 4 - rate * found.height)


def test_helix_of_either_hand():
    right = edge_slices(END_MILL, 5e-3, (0, 5))
    left = edge_slices(replace(END_MILL, helix=(-math.radians(30.0),) * 4), 5e-3, (0, 5))
    assert np.all(right.angle[0] < 0.0)
    assert np.allclose(left.angle[0], -right.angle[0])


def test_runout_moves_each_tooth_by_its_share():
    cutter = replace(END_MILL, runout_offset=10e-6, runout_angle=math.radians(90.0))
    # e cos(lambda - phi_j0) at 0, 90, 180 and 270 deg
    assert np.allclose(cutter.radial_offsets, [0.0, 10e-6, 0.0, -10e-6], atol=1e-18)
    found = edge_slices(cutter, 5e-3, (0, 3))
    assert np.allclose(found.normal_offset, cutter.radial_offsets[:, None])
    turned = replace(cutter, runout_angle=math.radians(30.0))
    wanted = 10e-6 * np.cos(np.radians([30.0, -60.0, -150.0, -240.0]))
    assert np.allclose(turned.radial_offsets, wanted)


def test_setting_errors_along_the_normal():
    kappa = math.radians(45.0)
    cutter = Cutter(
        50e-3, (0.0,) * 2, (math.pi,) * 2, edge_angle=kappa,
        radial_error=(0.0, 20e-6), axial_error=(30e-6, 0.0),
    )  # fmt: skip
    found = edge_slices(cutter, 1e-3, (0, 2))
    root = math.sqrt(0.5)
    assert np.allclose(found.normal_offset, [[30e-6 * root] * 2, [20e-6 * root] * 2])
    # a cylinder does not see an axial error
    flat = edge_slices(replace(END_MILL, axial_error=(1e-5, 0, 0, 0)), 1e-3, (0, 2))
    assert np.allclose(flat.normal_offset, 0.0, atol=1e-20)


def test_errors_and_runout_add_up():
    cutter = replace(
        END_MILL, runout_offset=10e-6, runout_angle=0.0, radial_error=(1e-6, 2e-6, 3e-6, 4e-6)
    )
    assert np.allclose(cutter.radial_offsets, [11e-6, 2e-6, -7e-6, 4e-6])


def test_serration_shifts_from_tooth_to_tooth():
    wave = Serration(0.3e-3, 2e-3)
    z = np.linspace(0.0, 4e-3, 2001)
    radii = np.array([wave.radius_change(z, tooth, 4) for tooth in range(4)])
    assert radii.max() == pytest.approx(0.0, abs=1e-12)
    assert radii.min() == pytest.approx(-0.3e-3)
    assert radii[0, 0] == 0.0
    # a quarter of a wave further for every tooth
    assert np.allclose(radii[1, :-250], radii[0, 250:], atol=1e-12)
    # the crests of four teeth leave no ridge: together they reach the nominal radius often
    assert radii.max(axis=0).min() > -0.3e-3 * (1.0 - math.cos(math.pi / 4)) / 2 - 1e-12
    cutter = replace(END_MILL, serration=wave)
    found = slices_of(cutter, 8e-3)
    assert found.height.size >= 4 * 16
    assert np.allclose(found.normal_offset[2], wave.radius_change(found.height, 2, 4))


def test_earlier_passes_of_equal_and_unequal_pitch():
    equal = edge_slices(replace(END_MILL, helix=(0.0,) * 4), 1e-3, (0, 1)).angle
    teeth, ahead = earlier_passes(equal)
    assert teeth[0, 0].tolist() == [1, 2, 3, 0]
    assert teeth[2, 0].tolist() == [3, 0, 1, 2]
    assert np.allclose(ahead[1, 0], TURN / 4 * np.array([1, 2, 3, 4]))
    pitch = tuple(np.radians([80.0, 100.0, 85.0, 95.0]))
    found = edge_slices(replace(END_MILL, helix=(0.0,) * 4, pitch=pitch), 1e-3, (0, 1)).angle
    _, ahead = earlier_passes(found)
    # the tooth that follows in the list stands ahead and passed last
    assert np.allclose(np.degrees(ahead[:, 0, 0]), [80.0, 100.0, 85.0, 95.0])
    assert np.allclose(np.degrees(ahead[3, 0]), [95.0, 175.0, 275.0, 360.0])


def test_single_tooth_meets_its_own_wave():
    teeth, ahead = earlier_passes(np.array([[0.3, 0.1]]))
    assert np.all(teeth == 0)
    assert np.allclose(ahead, TURN)


@pytest.mark.parametrize("kappa_deg", [20.0, 45.0, 90.0])
@pytest.mark.parametrize("phi_deg", [0.0, 35.0, 90.0, 160.0])
def test_forces_on_an_edge_are_orthogonal_and_keep_their_size(kappa_deg, phi_deg):
    phi, kappa = math.radians(phi_deg), math.radians(kappa_deg)
    normal, angle = (math.sin(kappa), math.cos(kappa)), (math.sin(phi), math.cos(phi))
    matrix = np.array([force_on_tool(*normal, *angle, *unit) for unit in np.eye(3)])
    assert np.allclose(matrix @ matrix.T, np.eye(3), atol=1e-14)
    outward = np.array(
        [math.sin(kappa) * math.sin(phi), math.sin(kappa) * math.cos(phi), -math.cos(kappa)]
    )
    motion = np.array([math.cos(phi), -math.sin(phi), 0.0])
    assert np.allclose(matrix[0], -motion, atol=1e-14)
    assert np.allclose(matrix[1], -outward, atol=1e-14)
    # the axial force lifts the tool
    assert matrix[2, 2] >= -1e-15


def test_slices_are_graded_over_what_is_engaged():
    ball = Cutter(20e-3, (0.0, 0.0), (0.5 * TURN, 0.5 * TURN), corner_radius=10e-3)
    limits = SliceLimits(lag=0.05, tilt=math.radians(5.0), arc=1.0 / 16.0)
    band = band_beside_wall("up", 8e-3, 10e-3)
    bounds = slice_bounds(ball, 1e-3, band, limits)
    # the edge is 2 mm from the axis at this height; below it nothing cuts
    lowest = 10e-3 - math.sqrt(10e-3**2 - 2e-3**2)
    assert bounds[:2] == pytest.approx([0.0, lowest])
    assert 16 <= bounds.size - 2 <= 20
    found = slices_between(ball, bounds)
    radius = np.append(found.radius - found.lower_radius, found.upper_radius - found.radius)
    assert np.all(radius > 0.0)
    arc = np.arccos(np.clip(2e-3 / np.sqrt(10e-3**2 - (10e-3 - bounds[1:]) ** 2), 0.0, 1.0))
    assert np.diff(arc).max() < 1.02 * arc.max() / 16.0
    assert slice_bounds(ball, 1e-3, band, limits, 5).size - 2 == 5
    assert slice_bounds(ball, 1e-3, None, limits, borders=[0.5e-3]).tolist().count(0.5e-3) == 1
