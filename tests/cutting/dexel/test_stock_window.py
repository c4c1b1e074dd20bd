"""Windows of a workpiece that move along with the tool, against one large workpiece."""

import itertools
import math

import numba
import numpy as np
import pytest
from numba import njit

from cutting.chip.discrete_chip import carve, chip_thickness
from cutting.dexel.carving import dexel_flush
from cutting.dexel.stock import (
    dexel_advanced,
    dexel_remaining_area,
    dexel_remove_path,
    dexel_stock,
    dexel_wall_profile,
    line_coordinates,
)
from cutting.voxel.stock import voxel_advanced, voxel_remaining_area, voxel_remove_path, voxel_stock

R, FEED, TEETH, WINDOW = 3e-3, 0.2e-3, 2, 0.4e-3
SIZE = 25e-6
LOW, HIGH = -4e-3, 4e-3
STEPS = 720


def box(x0, x1, layers=2):
    return [[((x0, x1, LOW, HIGH), True)]] * layers


def dexels(x0, x1):
    return dexel_stock(box(x0, x1), 2, SIZE, TEETH, WINDOW)


def voxels(x0, x1):
    return voxel_stock(box(x0, x1), 2, SIZE, TEETH, WINDOW)


@njit
def _carve(stock, axis, edge, thickness):
    area = 0.0
    for i in range(1, axis.shape[0]):
        (ax, ay), (bx, by) = axis[i - 1], axis[i]
        for tooth in range(edge.shape[1]):
            (px, py), (qx, qy) = edge[i - 1, tooth], edge[i, tooth]
            for layer in range(2):
                h = chip_thickness(stock, layer, tooth, ax, ay, px, py, bx, by, qx, qy)
                thickness[i, tooth] = h
                area += carve(stock, layer, tooth, ax, ay, px, py, bx, by, qx, qy)
    return area


def carved(stock, first, last):
    """Chip thickness and area of the steps of a tool with feed along x."""
    turn = np.arange(first, last + 1) / STEPS
    # vibration in the feed; waves along the wall would not fit into the lines of the large stock
    x = FEED * TEETH * turn + 1.3e-5 + 2e-5 * np.sin(15.0 * turn)
    axis = np.stack([x, np.zeros(turn.size)], axis=1)
    angle = 2.0 * np.pi * (turn[:, None] - np.arange(TEETH) / TEETH)
    edge = axis[:, None] + R * np.stack([np.sin(angle), np.cos(angle)], axis=-1)
    thickness = np.zeros(angle.shape)
    area = _carve(stock, axis, edge, thickness)
    return thickness[1:], area


@pytest.mark.parametrize("build", [dexels, voxels])
@pytest.mark.parametrize("chunk", [97, 700])
def test_chip_is_that_of_one_large_stock(build, chunk):
    remove, advanced, tolerance = {
        dexels: (dexel_remove_path, dexel_advanced, 1e-15),
        voxels: (voxel_remove_path, voxel_advanced, 0.0),
    }[build]
    window, large = build(-4e-3, 4.2e-3 + 1e-3), build(-4e-3, 4.2e-3 + 8e-3)
    for layer in range(2):
        remove(window, layer, -9e-3, 0.0, -FEED * TEETH, 0.0, R)
        remove(large, layer, -9e-3, 0.0, -FEED * TEETH, 0.0, R)
    steps = 14 * STEPS
    wanted, area = carved(large, 0, steps)
    found, places = [], [*range(0, steps, chunk), steps]
    kind, total, moves = numba.typeof(window), 0.0, 0
    for first, last in itertools.pairwise(places):
        rear = window.box[0] if build is dexels else window.x_min
        moved = advanced(window, FEED * TEETH * first / STEPS - 3.8e-3 - rear)
        moves += moved is not window
        window = moved
        thickness, removed = carved(window, first, last)
        found.append(thickness)
        total += removed
    assert moves > 2
    assert numba.typeof(window) == kind
    assert wanted.max() > 0.9 * FEED
    assert np.abs(np.concatenate(found) - wanted).max() <= tolerance
    assert total == pytest.approx(area, rel=1e-12)


def test_dexel_window_holds_what_a_large_stock_holds_there():
    window, large = dexels(0.0, 6e-3), dexels(0.0, 9e-3)
    for stock in (window, large):
        dexel_remove_path(stock, 0, -4e-3, 0.3e-3, 2e-3, -0.2e-3, 2e-3)
        dexel_remove_path(stock, 1, 3e-3, -4e-3, 3.5e-3, 4e-3, 0.4e-3)
    window = dexel_advanced(window, 3.01e-3)
    assert window.box == pytest.approx((3e-3, 9e-3, LOW, HIGH), abs=1e-15)
    x = line_coordinates(window, 1)
    assert x == pytest.approx(line_coordinates(large, 1)[120:], abs=1e-15)
    for layer in range(2):
        for side in (-1, 1):
            found = dexel_wall_profile(window, layer, x, side)
            assert found == pytest.approx(
                dexel_wall_profile(large, layer, x, side), abs=1e-15, nan_ok=True
            )
        behind = dexels(0.0, 3e-3)
        dexel_remove_path(behind, 0, -4e-3, 0.3e-3, 2e-3, -0.2e-3, 2e-3)
        dexel_remove_path(behind, 1, 3e-3, -4e-3, 3.5e-3, 4e-3, 0.4e-3)
        rest = dexel_remaining_area(large, layer) - dexel_remaining_area(behind, layer)
        assert dexel_remaining_area(window, layer) == pytest.approx(rest, rel=1e-12)
        count = np.count_nonzero(np.diff(window.interval[layer, 0, : window.lines[0]]), axis=1)
        assert count.max() <= 2


def test_material_ahead_that_is_cut_up_to_the_border_stays_cut():
    window = dexels(0.0, 6e-3)
    dexel_remove_path(window, 0, 5e-3, 0.0, 8e-3, 0.0, 1e-3)
    window = dexel_advanced(window, 2e-3)
    area = 6e-3 * (HIGH - LOW) - (0.5 * math.pi * 1e-6 + 1e-3 * 2e-3)
    assert dexel_remaining_area(window, 0) == pytest.approx(area, rel=1e-4)


@pytest.mark.parametrize("columns", [256, 300, 319])
def test_voxel_window_holds_what_a_large_stock_holds_there(columns):
    window, large = voxels(0.0, columns * SIZE), voxels(0.0, (columns + 128) * SIZE)
    for stock in (window, large):
        voxel_remove_path(stock, 1, -4e-3, 0.3e-3, 4e-3, -0.2e-3, 2e-3)
    words = window.words
    window = voxel_advanced(window, 191.5 * SIZE)
    assert window.words is words
    assert window.x_min == pytest.approx(128 * SIZE, rel=1e-12)
    assert np.array_equal(window.words, large.words[:, :, 2:])


@pytest.mark.parametrize("distance", [-1e-3, 0.0, 0.9 * SIZE])
def test_less_than_a_line_moves_nothing(distance):
    for stock, advanced in ((dexels(0.0, 1e-3), dexel_advanced), (voxels(0, 1e-3), voxel_advanced)):
        assert advanced(stock, distance) is stock


def test_voxels_move_by_whole_words():
    stock = voxels(0.0, 4e-3)
    assert voxel_advanced(stock, 63.0 * SIZE) is stock
    assert voxel_advanced(stock, 64.0 * SIZE).x_min == pytest.approx(64.0 * SIZE)


def test_beyond_its_own_length_all_is_fresh():
    window = dexels(0.0, 2e-3)
    dexel_remove_path(window, 0, 0.0, 0.0, 2e-3, 0.0, 1e-3)
    carved(window, 0, 3)
    window = dexel_advanced(window, 9e-3)
    dexel_flush(window)
    cells = voxels(0.0, 2e-3)
    voxel_remove_path(cells, 0, 0.0, 0.0, 2e-3, 0.0, 1e-3)
    cells = voxel_advanced(cells, 9e-3)
    for layer in range(2):
        assert dexel_remaining_area(window, layer) == pytest.approx(2e-3 * (HIGH - LOW), rel=1e-12)
        assert voxel_remaining_area(cells, layer) == pytest.approx(2e-3 * (HIGH - LOW), rel=1e-12)


def test_waiting_cuts_follow_their_lines_or_fall_off():
    stock = dexels(-6e-3, 6e-3)
    # a quarter turn into full material, all on the advancing side
    carved(stock, 0, STEPS // 8)
    queue, waiting = stock.queue[0, 0, 1], int(stock.queue[0, 0, 1, 1])
    assert waiting > 4
    ring = stock.pending.shape[3]
    places = (queue[0] + np.arange(waiting)) % ring
    x = stock.first[1] + SIZE * stock.pending[0, 0, 1, places, 0]
    middle = 0.5 * (x.min() + x.max())
    moved = dexel_advanced(stock, middle - stock.box[0])
    left = int(moved.queue[0, 0, 1, 1])
    assert left == np.count_nonzero(x > moved.box[0])
    places = (moved.queue[0, 0, 1, 0] + np.arange(left)) % ring
    held = moved.first[1] + SIZE * moved.pending[0, 0, 1, places, 0]
    assert held == pytest.approx(x[x > moved.box[0]], abs=1e-15)
    before = dexel_remaining_area(moved, 0) + dexel_remaining_area(moved, 1)
    removed = dexel_flush(moved)
    after = dexel_remaining_area(moved, 0) + dexel_remaining_area(moved, 1)
    assert before - after == pytest.approx(removed, rel=1e-9)
