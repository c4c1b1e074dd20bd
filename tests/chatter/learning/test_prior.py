"""Prior of values that are uncertain before any cut, against its closed form."""

import numpy as np
import pytest
import scipy

from chatter.explain.parameters import Parameter
from chatter.learning.prior import Prior

FREEDOM, SCALES = 4.0, np.geomspace(0.25, 2.0, 4)


def prior(lower=-np.inf):
    """Two deviations of modes with a scale in common, and one value beside them."""
    return Prior(
        tuple(Parameter(name, 1.0, 0.1) for name in ("frequency", "damping", "force")),
        np.full(3, lower),
        np.full(3, np.inf),
        np.zeros(3, dtype=bool),
        np.zeros(3),
        np.array([True, True, False]),
    )


def mixture(at, lower=-np.inf):
    """Distribution of one deviation: the mean over scales of Student's t beyond a bound."""
    below = scipy.stats.t.cdf(lower / SCALES, FREEDOM)
    return np.mean((scipy.stats.t.cdf(at / SCALES, FREEDOM) - below) / (1.0 - below))


@pytest.mark.parametrize("lower", [-np.inf, -0.6])
def test_deviations_of_modes_are_drawn_from_the_mean_over_scales(lower):
    drawn = prior(lower).draws(8000, np.random.default_rng(1))
    for at in (-0.4, 0.1, 0.5, 1.5):
        assert np.mean(drawn[:, 0] <= at) == pytest.approx(mixture(at, lower), abs=0.01)
    # the third knows no scale
    below = scipy.stats.t.cdf(lower, FREEDOM)
    expected = (scipy.stats.t.cdf(0.5, FREEDOM) - below) / (1.0 - below)
    assert np.mean(drawn[:, 2] <= 0.5) == pytest.approx(expected, abs=0.01)


def test_density_of_modes_is_the_derivative_of_their_distribution():
    lower, at, step = -0.6, np.array([-0.3, 0.0, 0.7, 2.0]), 1e-4
    points = np.column_stack([at, np.zeros((4, 2))])
    # of the first alone: the density of both, summed over the second
    second = np.linspace(lower, 60.0, 60001)
    found = [
        scipy.integrate.simpson(
            np.exp(
                prior(lower).log_density(
                    np.column_stack([np.full(second.size, x), second, np.zeros(second.size)])
                )
            ),
            x=second,
        )
        for x in points[:, 0]
    ]
    expected = [(mixture(x + step, lower) - mixture(x - step, lower)) / (2.0 * step) for x in at]
    assert np.array(found) == pytest.approx(np.array(expected), rel=2e-3)


def test_a_mode_that_is_far_off_makes_the_others_likelier_to_be():
    """By Bayes' rule over the scales; independent values would not tell of each other."""
    drawn = prior().draws(40000, np.random.default_rng(2))
    near, far = (
        np.abs(np.abs(drawn[:, 0]) - middle) < width for middle, width in ((0.1, 0.1), (2.0, 0.5))
    )
    assert np.median(np.abs(drawn[far, 1])) > 1.5 * np.median(np.abs(drawn[near, 1]))
    assert np.median(np.abs(drawn[far, 2])) == pytest.approx(
        np.median(np.abs(drawn[near, 2])), rel=0.1
    )


def test_nothing_is_possible_beyond_the_bounds():
    assert prior(-0.6).log_density(np.array([[-0.7, 0.0, 0.0]]))[0] == -np.inf
