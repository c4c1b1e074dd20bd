"""The followed boundary against what a full net finds."""

import numpy as np
import pytest

from chatter.stability.boundary_continuation import continued_crossings

SPEEDS = np.linspace(0.0, 1.0, 201)
DEPTHS = np.linspace(0.0, 1.0, 41)[1:]


class Landscape:
    """Growth with lobes and a closed island; counts what is asked for."""

    def __init__(self, island):
        self.island, self.asked = island, 0

    def __call__(self, index, depth):
        self.asked += len(index)
        speed = SPEEDS[index]
        lobes = depth - 0.6 - 0.3 * np.sin(9.0 * speed)
        x, y, width, height = self.island
        island = 1.0 - ((speed - x) / width) ** 2 - ((depth - y) / height) ** 2
        return np.maximum(lobes, 0.3 * island)


def exact(landscape, speed):
    x, y, width, height = landscape.island
    inside = 1.0 - ((speed - x) / width) ** 2
    limits = [0.6 + 0.3 * np.sin(9.0 * speed)]
    if inside > 0.0:
        reach = height * np.sqrt(inside)
        limits = [y - reach, y + reach, *limits]
    return np.array([limit for limit in limits if limit < 1.0])


def test_lobes_and_an_island_are_found_at_every_speed():
    landscape = Landscape((0.19, 0.3, 0.06, 0.12))
    found = continued_crossings(SPEEDS.size, DEPTHS, landscape, 1e-4, 8)
    for speed, crossings in zip(SPEEDS, found, strict=True):
        wanted = exact(landscape, speed)
        narrow = wanted.size == 3 and wanted[1] - wanted[0] < 2.0 / 40.0
        if not narrow:
            assert crossings == pytest.approx(wanted, rel=2e-4)


def test_it_asks_for_a_fraction_of_the_net():
    landscape = Landscape((0.19, 0.3, 0.06, 0.12))
    continued_crossings(SPEEDS.size, DEPTHS, landscape, 5e-3, 8)
    assert landscape.asked < 0.35 * SPEEDS.size * DEPTHS.size


def test_miss_rate_of_small_islands():
    """Islands wider than the coarse net in both directions are never missed."""
    rng = np.random.default_rng(3)
    missed = 0
    for _ in range(100):
        island = (rng.uniform(0.15, 0.25), rng.uniform(0.2, 0.6), 0.03, 0.03)
        landscape = Landscape(island)
        found = continued_crossings(SPEEDS.size, DEPTHS, landscape, 5e-3, 8)
        middle = round(island[0] * (SPEEDS.size - 1))
        missed += found[middle].size < exact(landscape, SPEEDS[middle]).size
    assert missed == 0


def test_progress_goes_up_and_begins_before_the_screening_ends():
    reported = []
    landscape = Landscape((0.19, 0.3, 0.06, 0.12))
    continued_crossings(
        SPEEDS.size, DEPTHS, landscape, 5e-3, 8, lambda *parts: reported.append(parts)
    )
    done = [one for one, _ in reported]
    assert done == sorted(done)
    assert 0 < done[0] < 0.3 * SPEEDS.size
    # the refinement of limits comes after the last level
    assert 0.8 * SPEEDS.size < done[-1] < SPEEDS.size
    assert {total for _, total in reported} == {SPEEDS.size}


@pytest.mark.parametrize(("steep", "deepest"), [(60.0, 0.4), (6.0, 1.0)])
def test_a_column_ends_far_beyond_its_limit(steep, deepest):
    """A serrated edge took minutes for depths at which vibration grew 1e16 times a turn."""
    asked = []

    def growth(index, depth):
        asked.extend(depth)
        return steep * (depth - 0.1)

    depths = np.linspace(0.0, 1.0, 321)[1:]
    found = continued_crossings(1, depths, growth, 1e-4, 1)
    assert found[0] == pytest.approx([0.1], rel=1e-4)
    assert max(asked) <= deepest


def test_an_island_below_what_grows_slowly_is_found():
    def growth(index, depth):
        return 4.0 * np.sin(9.0 * depth - 0.9)

    depths = np.linspace(0.0, 1.0, 321)[1:]
    found = continued_crossings(1, depths, growth, 1e-5, 1)
    assert found[0] == pytest.approx((0.9 + np.pi * np.arange(3)) / 9.0, rel=1e-4)
