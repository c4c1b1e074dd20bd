"""Search for changes of stability, on growth functions whose roots are known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from chatter.stability.crossings import find_crossings, growth_rate_on_grid

DEPTHS = np.linspace(0.0, 10e-3, 101)[1:]
#: of the search: brackets to 1e-7 of the depth, growth to 1e-9
TOLERANCE = 3e-7


class CountedGrowth:
    """Growth at each speed by a function of depth; counts what it is asked for."""

    def __init__(self, *functions):
        self.functions = functions
        self.batches = 0
        self.points = 0

    def __call__(self, speed, depth):
        self.batches += 1
        self.points += depth.size
        return np.array([self.functions[i](b) for i, b in zip(speed, depth, strict=True)])


def with_roots(*roots):
    """Growth that is below zero at zero depth and changes sign at each root."""
    return lambda depth: -np.prod([1.0 - depth / root for root in roots])


def crossings(*functions, depths=DEPTHS):
    growth = CountedGrowth(*functions)
    net = growth_rate_on_grid(len(functions), depths, growth, growth)
    return find_crossings(net, depths, growth), growth


def test_one_root_at_each_speed():
    roots = [0.13e-3, 2.5e-3, 9.99e-3]
    found, _ = crossings(*(with_roots(root) for root in roots))
    assert [part.size for part in found] == [1, 1, 1]
    np.testing.assert_allclose(np.concatenate(found), roots, rtol=TOLERANCE)


def test_an_island_and_a_stretch_above_it():
    roots = (1.234e-3, 3.71e-3, 3.93e-3, 8.0001e-3)
    found, _ = crossings(with_roots(*roots))
    np.testing.assert_allclose(found[0], roots, rtol=TOLERANCE)


def test_no_root():
    found, _ = crossings(lambda depth: -1.0 - depth, with_roots(20e-3))
    assert [part.size for part in found] == [0, 0]


def test_unstable_from_the_first_depth_on():
    # at zero depth a damped structure is stable: the root lies in the first interval
    found, _ = crossings(with_roots(0.01e-3))
    np.testing.assert_allclose(found[0], [0.01e-3], rtol=TOLERANCE)


def test_root_on_the_net():
    root = DEPTHS[40]
    found, _ = crossings(with_roots(root))
    np.testing.assert_allclose(found[0], [root], rtol=TOLERANCE)


@pytest.mark.parametrize("power", [1.0, 3.0, 9.0])
def test_steep_and_flat_roots(power):
    root = 4.4321e-3

    def growth(depth):
        return np.sign(depth - root) * abs(depth / root - 1.0) ** (1.0 / power)

    found, counted = crossings(growth)
    np.testing.assert_allclose(found[0], [root], rtol=TOLERANCE)
    assert counted.batches < 70


def test_jump_of_growth():
    # where one multiplier overtakes another the growth may be almost a step
    root = 4.4321e-3
    found, _ = crossings(lambda depth: -1.0 if depth < root else 1e-3)
    np.testing.assert_allclose(found[0], [root], rtol=TOLERANCE)


def test_few_batches_for_many_speeds():
    roots = np.linspace(1.01e-3, 8.97e-3, 300)
    found, counted = crossings(*(with_roots(root) for root in roots))
    np.testing.assert_allclose(np.concatenate(found), roots, rtol=TOLERANCE)
    # one batch for the net, two for the ends, the rest for the refinement of all at once
    assert counted.batches <= 12


@given(st.lists(st.integers(2, 98), min_size=1, max_size=7, unique=True), st.floats(0.05, 0.95))
def test_any_number_of_roots_in_different_intervals(places, share):
    roots = DEPTHS[np.sort(places)] + share * (DEPTHS[1] - DEPTHS[0])

    def growth(depth):
        return -np.prod(np.tanh(40.0 * (1.0 - depth / roots)))

    found, _ = crossings(growth)
    np.testing.assert_allclose(found[0], roots, rtol=2e-6)


def test_doubtful_values_on_the_net_are_refined():
    def true(depth):
        return (depth - 5e-3) * 40.0

    # the plain value is off by as much as half a net width around the root
    def plain(speed, depth):
        return np.array([true(b) + 0.02 for b in depth])

    refined = CountedGrowth(true)
    net = growth_rate_on_grid(1, DEPTHS, plain, refined)
    assert np.array_equal(net[0] > 0.0, DEPTHS > 5e-3 + 1e-12)
    assert 0 < refined.points < DEPTHS.size / 2
    np.testing.assert_allclose(find_crossings(net, DEPTHS, refined)[0], [5e-3], rtol=TOLERANCE)


def test_a_peak_that_nearly_reaches_zero_is_refined():
    # an island whose tip the plain value misses
    def true(depth):
        return 0.01 - abs(depth - 4e-3) / 0.1e-3 * 0.006

    def plain(speed, depth):
        return np.array([true(b) - 0.02 for b in depth])

    refined = CountedGrowth(true)
    found = find_crossings(growth_rate_on_grid(1, DEPTHS, plain, refined), DEPTHS, refined)
    half = 0.1e-3 * 0.01 / 0.006
    np.testing.assert_allclose(found[0], [4e-3 - half, 4e-3 + half], rtol=TOLERANCE)


def test_a_valley_that_nearly_reaches_zero_is_refined():
    # a narrow stable stretch inside the chatter
    def true(depth):
        return max(-1.0, min((depth - 1e-3) * 1e3, -0.01 + abs(depth - 6e-3) / 0.1e-3 * 0.006))

    def plain(speed, depth):
        return np.array([true(b) + 0.02 if b > 5e-3 else true(b) for b in depth])

    refined = CountedGrowth(true)
    found = find_crossings(growth_rate_on_grid(1, DEPTHS, plain, refined), DEPTHS, refined)
    half = 0.1e-3 * 0.01 / 0.006
    np.testing.assert_allclose(found[0], [1e-3, 6e-3 - half, 6e-3 + half], rtol=TOLERANCE)


def test_a_change_that_the_refinement_takes_back():
    # the plain value says chatter at one depth; the truth does not
    def plain(speed, depth):
        return np.where(np.isclose(depth, DEPTHS[30]), 0.01, -0.3)

    def refined(speed, depth):
        return np.full(depth.size, -0.3)

    net = growth_rate_on_grid(1, DEPTHS, plain, refined)
    assert np.all(net < 0.0)
    assert find_crossings(net, DEPTHS, refined)[0].size == 0
