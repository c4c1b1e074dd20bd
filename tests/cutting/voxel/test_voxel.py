"""Voxel workpiece against exact paths of the edge: thickness, noise, areas, walls, exit."""

import math

import numpy as np
import pytest
from numba import njit

from cutting.voxel.carving import voxel_carve, voxel_chip_thickness
from cutting.voxel.stock import (
    voxel_remaining_area,
    voxel_remove_path,
    voxel_stock,
    voxel_wall_profile,
)

R = 5e-3
FEED = 0.15e-3  # per tooth
TEETH = 2
WINDOW = 0.4e-3
PITCH = 2.0 * math.pi / TEETH


@njit
def _run(stock, axis, edge, thickness):
    area = 0.0
    for i in range(1, axis.shape[0]):
        (ax, ay), (bx, by) = axis[i - 1], axis[i]
        for tooth in range(edge.shape[1]):
            (px, py), (qx, qy) = edge[i - 1, tooth], edge[i, tooth]
            h = voxel_chip_thickness(stock, 0, tooth, ax, ay, px, py, bx, by, qx, qy)
            thickness[i, tooth] = h
            area += voxel_carve(stock, 0, tooth, ax, ay, px, py, bx, by, qx, qy)
    return area


class Cut:
    """Turns of a tool with feed along x, vibration added to its axis."""

    def __init__(self, turns, steps=720, start=0.013e-3, feed=FEED, vibration=None):
        self.turn = np.arange(round(turns * steps) + 1) / steps
        rotation = 2.0 * np.pi * self.turn
        self.axis = np.zeros((self.turn.size, 2))
        self.axis[:, 0] = start + feed * TEETH * self.turn
        if vibration is not None:
            self.axis += vibration(rotation)
        self.angle = rotation[:, None] - PITCH * np.arange(TEETH)
        radial = np.stack([np.sin(self.angle), np.cos(self.angle)], -1)
        self.edge = self.axis[:, None] + R * radial
        self.thickness = np.zeros(self.angle.shape)

    def carve(self, stock):
        """Area removed."""
        return _run(stock, self.axis, self.edge, self.thickness)


def _trochoid_thickness(angle):
    """Exact radial distance from a trochoid back to that of the tooth before (Newton)."""
    rate = FEED * TEETH / (2.0 * math.pi)
    before = angle.copy()
    for _ in range(30):
        back = rate * (PITCH + angle - before)  # movement of the axis since
        across = R * np.sin(before - angle) - back * np.cos(angle)
        slope = R * np.cos(before - angle) + rate * np.cos(angle)
        before -= across / slope
    back = rate * (PITCH + angle - before)
    return R - R * np.cos(before - angle) + back * np.sin(angle)


def _slot(cell=25e-6, rectangles=(((-6e-3, 9e-3, -6e-3, 6e-3), True),), window=WINDOW):
    """A block in which the tool has cut a slot up to x = 0."""
    stock = voxel_stock([list(rectangles)], 1, cell, TEETH, window)
    voxel_remove_path(stock, 0, -12e-3, 0.0, 0.0, 0.0, R)
    return stock


def _errors(cell):
    cut = Cut(turns=4)
    cut.carve(_slot(cell))
    settled = (cut.turn > 1.5)[:, None] & (np.sin(cut.angle) > 0.1)
    return (cut.thickness - _trochoid_thickness(cut.angle))[settled]


def test_thickness_scatters_about_the_distance_between_trochoids():
    error = _errors(25e-6)
    assert np.sqrt(np.mean(error**2)) < 0.25 * 25e-6
    assert abs(error.mean()) < 0.01 * FEED


def test_noise_falls_about_linearly_with_the_cell():
    rms = [np.sqrt(np.mean(_errors(d) ** 2)) for d in (50e-6, 25e-6, 12.5e-6)]
    order = math.log2(rms[0] / rms[2]) / 2.0
    assert 0.6 < order < 1.4


def test_short_steps_are_averaged():
    error = []
    for steps in (720, 7200):
        cut = Cut(turns=3, steps=steps)
        cut.carve(_slot())
        settled = (cut.turn > 1.5)[:, None] & (np.sin(cut.angle) > 0.1)
        difference = (cut.thickness - _trochoid_thickness(cut.angle))[settled]
        error.append(np.sqrt(np.mean(difference**2)))
    # a step of 7200 per turn is a sixth of a cell
    assert error[1] < 1.5 * error[0]


def test_nothing_is_counted_twice_or_left():
    stock = _slot()
    before = voxel_remaining_area(stock, 0)
    cut = Cut(turns=4)
    removed = cut.carve(stock)
    assert before - voxel_remaining_area(stock, 0) == pytest.approx(removed, rel=1e-12)
    assert cut.carve(stock) == 0.0


def test_no_thickness_behind_the_feed():
    cut = Cut(turns=4)
    cut.carve(_slot())
    # up to the averaging, which looks back by four cells
    late = (cut.turn > 1.5)[:, None]
    assert np.all(cut.thickness[late & (np.sin(cut.angle) < -0.05)] == 0.0)


def test_standing_tool_clears_a_disc_and_reports_depth():
    stock = voxel_stock([[((-6e-3, 6e-3, -6e-3, 6e-3), True)]], 1, 25e-6, TEETH, WINDOW)
    removed = Cut(turns=1, feed=0.0).carve(stock)
    assert removed == pytest.approx(math.pi * R**2, rel=1e-3)
    assert stock.deep[0] > 0


def test_slotting_removes_width_times_advance():
    stock = _slot()
    Cut(turns=2).carve(stock)
    turns = 10
    removed = Cut(turns, start=0.013e-3 + 2 * TEETH * FEED).carve(stock)
    assert removed == pytest.approx(turns * TEETH * FEED * 2.0 * R, rel=1e-3)
    assert stock.deep[0] == 0


def test_thickness_times_movement_is_the_area_removed():
    stock = _slot()
    Cut(turns=2).carve(stock)
    cut = Cut(turns=3, start=0.013e-3 + 2 * TEETH * FEED)
    removed = cut.carve(stock)
    rotation = 2.0 * math.pi / 720
    h = cut.thickness
    swept = h * R * rotation - 0.5 * h**2 * rotation
    swept += h * np.cos(cut.angle) * FEED * TEETH / 720
    assert swept.sum() == pytest.approx(removed, rel=3e-3)


@pytest.mark.parametrize(
    ("bottom", "top", "first", "last"),
    [(-6e-3, 0.0, 90.0, 180.0), (0.0, 6e-3, 0.0, 90.0)],
    ids=["half-down", "half-up"],
)
def test_entry_and_exit_angles(bottom, top, first, last):
    stock = _slot(rectangles=[((-6e-3, 9e-3, bottom, top), True)])
    cut = Cut(turns=4)
    cut.carve(stock)
    settled = (cut.turn > 1.5)[:, None] & (np.sin(cut.angle) > 0.1)
    degrees = np.degrees(cut.angle) % 360.0
    inside = settled & (degrees > first + 3.0) & (degrees < last - 3.0)
    outside = settled & ((degrees < first - 3.0) | (degrees > last + 3.0))
    error = cut.thickness - _trochoid_thickness(cut.angle)
    assert np.sqrt(np.mean(error[inside] ** 2)) < 0.25 * 25e-6
    assert np.all(cut.thickness[outside] == 0.0)


def test_step_in_the_stock_widens_the_cut():
    low, high = (-6e-3, 6e-3, -6e-3, -2e-3), (6e-3, 9e-3, -6e-3, 2e-3)
    stock = _slot(rectangles=[(low, True), (high, True)])
    cut = Cut(turns=9)
    cut.carve(stock)
    degrees = np.degrees(cut.angle) % 360.0
    at_85 = np.abs(degrees - 85.0) < 1.1
    tip = cut.edge[..., 0]
    assert np.all(cut.thickness[at_85 & (tip < 6e-3 - 50e-6)] == 0.0)
    met = at_85 & (tip > 6e-3 + 2.0 * FEED)
    error = (cut.thickness - _trochoid_thickness(cut.angle))[met]
    assert error.size > 10
    assert abs(error.mean()) < 0.02 * FEED


def test_corner_of_the_stock_is_cut_off():
    """Around a corner the tool leaves a quarter disc of its radius cut out of the block."""
    stock = voxel_stock([[((0.0, 6e-3, 0.0, 6e-3), True)]], 1, 25e-6, TEETH, 6e-3)
    removed = Cut(turns=2, feed=0.0, start=0.0).carve(stock)
    assert removed == pytest.approx(0.25 * math.pi * R**2, rel=1e-3)


def test_slot_leaves_walls_at_the_radius():
    stock = _slot()
    Cut(turns=6).carve(stock)
    x = np.linspace(-3e-3, 1e-3, 101)
    for side in (1, -1):
        distance = R - side * voxel_wall_profile(stock, 0, x, side)
        assert np.all(np.abs(distance) <= 25e-6)


def test_wall_keeps_the_path_of_a_vibrating_edge():
    def vibration(rotation):
        shift = 50e-6 * np.sin(4.3 * rotation)
        return np.stack([np.zeros_like(shift), shift], -1)

    stock = _slot(10e-6)
    cut = Cut(turns=10, vibration=vibration)
    cut.carve(stock)
    x = np.linspace(0.5e-3, 2e-3, 151)
    wall = np.full(x.size, -np.inf)
    for tooth in range(TEETH):
        for turn in range(11):  # the arc across the top, on which x grows
            arc = np.abs(cut.angle[:, tooth] - 2.0 * np.pi * turn) < 1.0
            if arc.sum() > 1:
                path = cut.edge[arc, tooth]
                on_arc = np.interp(x, *path.T, left=-np.inf, right=-np.inf)
                wall = np.maximum(wall, on_arc)
    assert np.ptp(wall) > 20e-6  # wavy
    assert np.abs(voxel_wall_profile(stock, 0, x, 1) - wall).max() <= 10e-6


def test_overlapping_rectangles_are_one_material():
    added = [((0.0, 4e-3, 0.0, 2e-3), True), ((3e-3, 6e-3, 1e-3, 3e-3), True)]
    pocket = ((1e-3, 2e-3, 0.5e-3, 1.5e-3), False)
    stock = voxel_stock([[*added, pocket], [added[0]]], 2, 50e-6, TEETH, WINDOW)
    assert voxel_remaining_area(stock, 0) == pytest.approx((8.0 + 6.0 - 1.0 - 1.0) * 1e-6)
    assert voxel_remaining_area(stock, 1) == pytest.approx(8e-6)


def test_removed_path_is_a_capsule():
    stock = voxel_stock([[((0.0, 20e-3, 0.0, 20e-3), True)]], 1, 50e-6, TEETH, WINDOW)
    voxel_remove_path(stock, 0, 6e-3, 7e-3, 13e-3, 11e-3, 3e-3)
    capsule = math.pi * 3e-3**2 + 6e-3 * math.hypot(7e-3, 4e-3)
    assert (20e-3) ** 2 - voxel_remaining_area(stock, 0) == pytest.approx(capsule, rel=1e-3)


def test_profile_off_the_material_is_not_a_number():
    stock = voxel_stock([[((0.0, 1e-3, 0.0, 1e-3), True)]], 1, 50e-6, TEETH, WINDOW)
    profile = voxel_wall_profile(stock, 0, [-0.1e-3, 0.5e-3, 1.1e-3], 1, -1e-3)
    np.testing.assert_allclose(profile, [np.nan, 0.0, np.nan], atol=1e-12)


def test_senseless_stock_is_refused():
    with pytest.raises(ValueError, match="window"):
        voxel_stock([[((0.0, 1e-3, 0.0, 1e-3), True)]], 1, 1e-4, 1, -1.0)
