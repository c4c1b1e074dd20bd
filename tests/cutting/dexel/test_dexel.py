"""Dexel workpiece against exact paths of the edge: thickness, areas, walls, entry and exit."""

import math

import numpy as np
import pytest
from numba import njit

from cutting.dexel.carving import dexel_carve, dexel_chip_thickness, dexel_flush
from cutting.dexel.stock import (
    dexel_remaining_area,
    dexel_remove_path,
    dexel_stock,
    dexel_wall_profile,
    line_coordinates,
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
            h = dexel_chip_thickness(stock, 0, tooth, ax, ay, px, py, bx, by, qx, qy)
            thickness[i, tooth] = h
            area += dexel_carve(stock, 0, tooth, ax, ay, px, py, bx, by, qx, qy)
    return area


@njit
def _flush(stock):
    return dexel_flush(stock)


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
        """Area removed, waiting cuts included."""
        return _run(stock, self.axis, self.edge, self.thickness) + _flush(stock)


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


def _slot(spacing=50e-6, rectangles=(((-6e-3, 9e-3, -6e-3, 6e-3), True),)):
    """A block in which the tool has cut a slot up to x = 0."""
    stock = dexel_stock([list(rectangles)], 1, spacing, TEETH, WINDOW)
    dexel_remove_path(stock, 0, -12e-3, 0.0, 0.0, 0.0, R)
    return stock


def _errors(spacing):
    cut = Cut(turns=3)
    cut.carve(_slot(spacing))
    settled = (cut.turn > 1.5)[:, None] & (np.sin(cut.angle) > 0.1)
    return (cut.thickness - _trochoid_thickness(cut.angle))[settled]


def test_thickness_is_the_distance_between_consecutive_trochoids():
    assert np.abs(_errors(50e-6)).max() < 1e-4 * FEED


def test_thickness_converges_with_the_square_of_the_spacing():
    rms = [np.sqrt(np.mean(_errors(d) ** 2)) for d in (200e-6, 100e-6, 50e-6)]
    order = np.log2(np.array(rms[:-1]) / rms[1:])
    np.testing.assert_allclose(order, 2.0, atol=0.15)


def test_thickness_barely_depends_on_the_time_step():
    fine, coarse = Cut(turns=3, steps=2880), Cut(turns=3, steps=180)
    for cut in (fine, coarse):
        cut.carve(_slot())
    cutting = (coarse.turn > 1.5)[:, None] & (np.sin(coarse.angle) > 0.1)
    difference = (fine.thickness[::16] - coarse.thickness)[cutting]
    assert np.abs(difference).max() < 1e-4 * FEED


def test_no_thickness_behind_the_feed():
    cut = Cut(turns=3)
    cut.carve(_slot())
    assert np.all(cut.thickness[np.sin(cut.angle) < -0.05] == 0.0)


def test_standing_tool_clears_a_disc():
    stock = dexel_stock([[((-6e-3, 6e-3, -6e-3, 6e-3), True)]], 1, 50e-6, TEETH, WINDOW)
    removed = Cut(turns=1, feed=0.0).carve(stock)
    assert removed == pytest.approx(math.pi * R**2, rel=1e-4)
    assert dexel_remaining_area(stock, 0) == pytest.approx((12e-3) ** 2 - math.pi * R**2, rel=1e-4)


def test_slotting_removes_width_times_advance():
    stock = _slot()
    Cut(turns=2).carve(stock)
    before = dexel_remaining_area(stock, 0)
    turns = 10
    removed = Cut(turns, start=0.013e-3 + 2 * TEETH * FEED).carve(stock)
    assert before - dexel_remaining_area(stock, 0) == pytest.approx(removed, rel=1e-12)
    assert removed == pytest.approx(turns * TEETH * FEED * 2.0 * R, rel=1e-4)


def test_thickness_times_movement_is_the_area_removed():
    stock = _slot()
    Cut(turns=2).carve(stock)
    cut = Cut(turns=3, start=0.013e-3 + 2 * TEETH * FEED)
    removed = cut.carve(stock)
    rotation = 2.0 * math.pi / 720
    h = cut.thickness
    # ring sector, turning about an axis that itself moves along x
    swept = h * R * rotation - 0.5 * h**2 * rotation
    swept += h * np.cos(cut.angle) * FEED * TEETH / 720
    assert swept.sum() == pytest.approx(removed, rel=5e-4)


def _in_rectangle(cut, x0, x1, y0, y1):
    """Exact length of the radial chip inside a rectangle: the ray is clipped."""
    chip = np.where(np.sin(cut.angle) > 0.0, _trochoid_thickness(cut.angle), 0.0)
    low, high = np.zeros_like(chip), np.maximum(chip, 0.0)
    inward = -np.stack([np.sin(cut.angle), np.cos(cut.angle)], -1)
    for place, way, (a, b) in zip(
        np.moveaxis(cut.edge, -1, 0), np.moveaxis(inward, -1, 0), ((x0, x1), (y0, y1)), strict=True
    ):
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = np.sort(np.stack([(a - place) / way, (b - place) / way]), axis=0)
        low, high = np.fmax(low, ends[0]), np.fmin(high, ends[1])
    return np.maximum(high - low, 0.0)


@pytest.mark.parametrize(
    ("bottom", "top", "first", "last"),
    [
        (-6e-3, 0.0, 90.0, 180.0),
        (0.0, 6e-3, 0.0, 90.0),
        (0.4 * R, 6e-3, 0.0, 66.42),
        (-0.4 * R, 6e-3, 0.0, 113.58),
        (-6e-3, 0.4 * R, 66.42, 180.0),
    ],
    ids=["half-down", "half-up", "less-up", "more-up", "more-down"],
)
def test_entry_and_exit_angles(bottom, top, first, last):
    block = (-6e-3, 9e-3, bottom, top)
    stock = _slot(rectangles=[(block, True)])
    cut = Cut(turns=3, steps=1440)
    cut.carve(stock)
    settled = (cut.turn > 1.5)[:, None] & (np.sin(cut.angle) > 0.1)
    degrees = np.degrees(cut.angle) % 360.0
    inside = settled & (degrees > first + 2.0) & (degrees < last - 2.0)
    outside = settled & ((degrees < first - 2.0) | (degrees > last + 2.0))
    expected = _in_rectangle(cut, *block)
    assert np.abs(cut.thickness - expected)[inside].max() < 1e-4 * FEED
    assert np.all(cut.thickness[outside] == 0.0)
    # while the radius runs across the border of the stock too, unless along it
    oblique = settled & (np.abs(np.cos(cut.angle)) > 0.02)
    assert np.abs(cut.thickness - expected)[oblique].max() < 0.02 * FEED


@pytest.mark.parametrize("top", [6e-3, 3e-3], ids=["face", "corner"])
def test_entering_a_block(top):
    block = (0.0, 9e-3, -6e-3, top)
    stock = dexel_stock([[(block, True)]], 1, 25e-6, TEETH, WINDOW)
    cut = Cut(turns=5, start=-R - 0.3e-3)
    cut.carve(stock)
    expected = _in_rectangle(cut, *block)
    error = np.abs(cut.thickness - expected)
    assert np.all(cut.thickness[cut.axis[:, 0] < -R] == 0.0)
    assert error.max() < 0.05 * FEED
    assert error[expected > 0.0].mean() < 1e-3 * FEED


def test_step_in_the_stock_widens_the_cut():
    low, high = (-6e-3, 6e-3, -6e-3, -2e-3), (6e-3, 9e-3, -6e-3, 2e-3)
    stock = _slot(rectangles=[(low, True), (high, True)])
    cut = Cut(turns=9)
    cut.carve(stock)
    degrees = np.degrees(cut.angle) % 360.0
    at_85 = np.abs(degrees - 85.0) < 0.26
    tip = cut.edge[..., 0]
    assert np.all(cut.thickness[at_85 & (tip < 6e-3)] == 0.0)
    met = at_85 & (tip > 6e-3 + 2.0 * FEED)
    exact = _trochoid_thickness(cut.angle)
    assert met.sum() > 3
    np.testing.assert_allclose(cut.thickness[met], exact[met], atol=1e-4 * FEED)


def test_pocket_in_the_stock_is_not_cut():
    pocket = (5.2e-3, 5.8e-3, -1e-3, 1e-3)
    stock = _slot(rectangles=[((-6e-3, 9e-3, -6e-3, 6e-3), True), (pocket, False)])
    cut = Cut(turns=4)
    cut.carve(stock)
    x, y = np.moveaxis(cut.edge, -1, 0)
    margin = 2.0 * FEED
    air = (x > pocket[0] + margin) & (x < pocket[1]) & (np.abs(y) < 0.9e-3)
    assert air.sum() > 20
    assert np.all(cut.thickness[air] == 0.0)


def test_no_sliver_is_left_where_the_axis_passes():
    """A line loses one side of the axis, then the other, and the axis moves in between."""
    stock = dexel_stock([[((-6e-3, 9e-3, -6e-3, 6e-3), True)]], 1, 50e-6, TEETH, WINDOW)
    cut = Cut(turns=0.75)  # one tooth has passed the top, the other the bottom, once
    cut.carve(stock)
    place = line_coordinates(stock, 0)
    lines = np.flatnonzero(np.abs(place) < R - 50e-6)
    interval = stock.interval[0, 0, lines]
    assert np.all((interval[..., 0] < interval[..., 1]).sum(axis=1) == 2)


def test_slot_leaves_walls_at_the_radius():
    stock = _slot()
    Cut(turns=6).carve(stock)
    x = np.linspace(-3e-3, 1e-3, 101)
    cusp = FEED**2 / (8.0 * R)
    for side in (1, -1):
        distance = R - side * dexel_wall_profile(stock, 0, x, side)
        assert np.all(distance > -1e-9)
        assert np.all(distance < 1.1 * cusp)


def test_wall_keeps_the_path_of_a_vibrating_edge():
    def vibration(rotation):
        shift = 20e-6 * np.sin(4.3 * rotation)
        return np.stack([np.zeros_like(shift), shift], -1)

    stock = _slot()
    cut = Cut(turns=14, vibration=vibration)
    cut.carve(stock)
    x = line_coordinates(stock, 1)
    x = x[(x > 0.5e-3) & (x < 2.5e-3)]
    wall = np.full(x.size, -np.inf)
    path, angle = cut.edge, cut.angle
    for tooth in range(TEETH):
        for turn in range(15):  # the arc across the top, on which x grows
            arc = np.abs(angle[:, tooth] - 2.0 * np.pi * turn) < 1.0
            if arc.sum() > 1:
                on_arc = np.interp(x, *path[arc, tooth].T, left=-np.inf, right=-np.inf)
                wall = np.maximum(wall, on_arc)
    profile = dexel_wall_profile(stock, 0, x, 1)
    assert np.ptp(profile) > 5e-6  # wavy
    # the chords of this reference lie up to (step)^2/(8 R) below the arc
    np.testing.assert_allclose(profile, wall, atol=(R * 2.0 * math.pi / 720) ** 2 / (8.0 * R))


def test_thickness_of_a_tool_that_leaves_the_cut():
    """The largest reach of the passes before bounds the chip, also where some missed."""

    def vibration(rotation):
        return 80e-6 * np.stack([np.sin(7.3 * rotation), 0.7 * np.cos(7.3 * rotation)], -1)

    steps = 2000
    cut = Cut(turns=5, steps=steps, vibration=vibration)
    cut.carve(_slot(25e-6))
    error, air = [], 0
    for i in range(3 * steps, cut.turn.size, 37):
        tooth = int(np.argmax(np.sin(cut.angle[i])))
        if np.sin(cut.angle[i, tooth]) < 0.15:
            continue
        reach = [
            _reach(cut, i, tooth, i - k * steps // TEETH, (tooth + k) % TEETH) for k in range(1, 6)
        ]
        expected = max(R - max(reach), 0.0)
        error.append(cut.thickness[i, tooth] - expected)
        air += expected == 0.0
    assert 0.1 < air / len(error) < 0.6
    assert np.sqrt(np.mean(np.square(error))) < 0.2e-6


def _reach(cut, i, tooth, middle, other):
    """Distance along the radius of an edge to where the path of another crosses it."""
    path = cut.edge[middle - 300 : middle + 300, other] - cut.axis[i]
    normal = np.array([np.sin(cut.angle[i, tooth]), np.cos(cut.angle[i, tooth])])
    along, across = path @ normal, path[:, 0] * normal[1] - path[:, 1] * normal[0]
    (k,) = np.flatnonzero((across[:-1] > 0.0) != (across[1:] > 0.0))
    return along[k] + across[k] / (across[k] - across[k + 1]) * (along[k + 1] - along[k])


def test_overlapping_rectangles_are_one_material():
    added = [((0.0, 4e-3, 0.0, 2e-3), True), ((3e-3, 6e-3, 1e-3, 3e-3), True)]
    pocket = ((1e-3, 2e-3, 0.5e-3, 1.5e-3), False)
    stock = dexel_stock([[*added, pocket], [added[0]]], 2, 50e-6, TEETH, WINDOW)
    assert dexel_remaining_area(stock, 0) == pytest.approx((8.0 + 6.0 - 1.0 - 1.0) * 1e-6)
    assert dexel_remaining_area(stock, 1) == pytest.approx(8e-6)


def test_removed_path_is_a_capsule():
    stock = dexel_stock([[((0.0, 20e-3, 0.0, 20e-3), True)]], 1, 50e-6, TEETH, WINDOW)
    dexel_remove_path(stock, 0, 6e-3, 7e-3, 13e-3, 11e-3, 3e-3)
    capsule = math.pi * 3e-3**2 + 6e-3 * math.hypot(7e-3, 4e-3)
    assert (20e-3) ** 2 - dexel_remaining_area(stock, 0) == pytest.approx(capsule, rel=1e-4)


def test_dropped_intervals_are_counted():
    stock = dexel_stock([[((0.0, 20e-3, 0.0, 4e-3), True)]], 1, 100e-6, TEETH, WINDOW)
    for x in np.arange(2e-3, 20e-3, 2e-3):
        dexel_remove_path(stock, 0, x, -1.0, x, 1.0, 0.2e-3)
    assert stock.overflow[0] > 0
    assert np.isfinite(dexel_wall_profile(stock, 0, 1e-3, -1, 5e-3))


def test_senseless_stock_is_refused():
    block = [((0.0, 1e-3, 0.0, 1e-3), True)]
    for arguments, words in (
        (([block], 2, 1e-4, 1, 1e-3), "2 layers"),
        (([block], 1, 0.0, 1, 1e-3), "resolution"),
        (([block], 1, 1e-4, 0, 1e-3), "teeth"),
        (([block], 1, 1e-4, 1, math.nan), "window"),
        (([[((0.0, 0.0, 0.0, 1e-3), True)]], 1, 1e-4, 1, 1e-3), "rectangle"),
        (([[]], 1, 1e-4, 1, 1e-3), "no rectangle"),
    ):
        with pytest.raises(ValueError, match=words):
            dexel_stock(*arguments)
