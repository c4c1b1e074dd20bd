"""The cubic spline is that of scipy, and a cubic is its own spline."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline as OfScipy

from cutting.cubic_spline import CubicSpline


@given(st.integers(4, 60), st.integers(1, 3), st.integers(0, 2**32 - 1))
def test_it_is_that_of_scipy(points, columns, seed):
    random = np.random.default_rng(seed)
    x = np.cumsum(random.uniform(0.1, 2.0, points))
    y = random.standard_normal((points, columns))
    places = random.uniform(x[0] - 1.0, x[-1] + 1.0, (7, 5))
    expected = OfScipy(x, y, axis=0)(places)
    np.testing.assert_allclose(CubicSpline(x, y)(places), expected, rtol=1e-13, atol=1e-13)


def test_a_cubic_is_its_own_spline_and_points_are_met():
    x = np.array([0.0, 0.5, 1.7, 2.0, 3.1, 4.0])
    y = (x**3 - 2.0 * x**2 + 5.0)[:, None]
    spline = CubicSpline(x, y)
    np.testing.assert_allclose(spline(x), y, rtol=1e-14)
    places = np.linspace(-1.0, 5.0, 50)
    np.testing.assert_allclose(
        spline(places)[:, 0], places**3 - 2.0 * places**2 + 5.0, rtol=1e-11, atol=1e-11
    )


def test_too_few_points_and_places_out_of_order_are_refused():
    with pytest.raises(ValueError, match="four are needed"):
        CubicSpline(np.arange(3.0), np.zeros((3, 1)))
    with pytest.raises(ValueError, match="increase"):
        CubicSpline(np.array([0.0, 1.0, 1.0, 2.0]), np.zeros((4, 1)))
