"""Sampler against distributions that are known in closed form."""

import numpy as np
import pytest

from chatter.explain.parameters import Parameter
from chatter.learning.diagram import ParticleDiagram
from chatter.learning.next_cut import INFORMATION, METAL, expected_information, next_cut
from chatter.learning.posterior import Particles, updated


class WidePrior:
    """Uniform over +- 30 sizes."""

    parameters = tuple(Parameter(name, 0.0, 1.0) for name in "ab")
    names = ("a", "b")

    def log_density(self, counted):
        return np.where(np.all(np.abs(counted) < 30.0, axis=1), 0.0, -np.inf)

    def fixed(self, counted):
        return np.zeros(counted.shape, dtype=bool)


class GaussianReadings:
    """Readings that are linear in two parameters, with normal scatter."""

    def __init__(self, slopes, measured, scatter, test):
        self.slopes, self.measured, self.scatter = slopes, measured, scatter
        self.test = np.array(test)

    def predictions(self, counted):
        return counted @ self.slopes.T

    def of(self, predictions, counted):
        return -0.5 * ((predictions - self.measured) / self.scatter) ** 2


SLOPES = np.array([[1.0, 0.3], [0.2, -1.0], [0.7, 0.7]])
MEASURED, SCATTER = np.array([2.0, -1.0, 2.5]), np.array([0.3, 0.5, 0.4])


def least_squares(rows):
    weighted = SLOPES[rows] / SCATTER[rows, None]
    covariance = np.linalg.inv(weighted.T @ weighted)
    return covariance @ weighted.T @ (MEASURED[rows] / SCATTER[rows]), covariance


def spread_particles(count=3000):
    counted = np.random.default_rng(3).uniform(-30.0, 30.0, (count, 2))
    return Particles(WidePrior(), counted)


def test_particles_have_the_mean_and_covariance_of_least_squares():
    likelihood = GaussianReadings(SLOPES, MEASURED, SCATTER, [0, 1, 2])
    found = updated(spread_particles(), likelihood, np.random.default_rng(1))
    mean, covariance = least_squares([0, 1, 2])
    assert found.tests == 3
    assert found.counted.mean(axis=0) == pytest.approx(mean, abs=0.04)
    assert np.cov(found.counted, rowvar=False) == pytest.approx(covariance, rel=0.15, abs=0.01)


def test_tests_one_after_another_count_once_each():
    first = GaussianReadings(SLOPES[:2], MEASURED[:2], SCATTER[:2], [0, 1])
    every = GaussianReadings(SLOPES, MEASURED, SCATTER, [0, 1, 2])
    generator = np.random.default_rng(1)
    found = updated(updated(spread_particles(), first, generator), every, generator)
    mean, covariance = least_squares([0, 1, 2])
    assert found.counted.mean(axis=0) == pytest.approx(mean, abs=0.04)
    assert np.cov(found.counted, rowvar=False) == pytest.approx(covariance, rel=0.15, abs=0.01)


class Curved(GaussianReadings):
    """The same readings of the squares of the parameters: the regression is wrong."""

    def predictions(self, counted):
        return np.sign(counted) * counted**2 @ self.slopes.T


def test_a_regression_that_is_wrong_biases_nothing():
    """Both parameters squared are normal: their density has a factor |2 x| in the parameters."""
    slopes, measured, scatter = np.eye(2), np.array([4.0, 9.0]), np.array([0.8, 1.5])
    found = updated(
        spread_particles(6000), Curved(slopes, measured, scatter, [0, 1]), np.random.default_rng(1)
    )
    at = np.linspace(0.0, 6.0, 6001)
    for column, middle, width in zip(found.counted.T, measured, scatter, strict=True):
        density = np.exp(-0.5 * ((at**2 - middle) / width) ** 2)
        mean = np.sum(at * density) / density.sum()
        deviation = np.sqrt(np.sum((at - mean) ** 2 * density) / density.sum())
        assert column.mean() == pytest.approx(mean, abs=0.1 * deviation)
        assert column.std() == pytest.approx(deviation, rel=0.1)


def test_information_is_what_is_not_scatter():
    # two particles that contradict each other: a bit; that agree on a toss of a coin: nothing
    assert expected_information(np.array([[0.0], [1.0]])) == pytest.approx([1.0], abs=1e-9)
    assert expected_information(np.array([[0.5], [0.5]])) == pytest.approx([0.0], abs=1e-9)
    # binary symmetric channel: 1 - H(0.1)
    entropy = -(0.1 * np.log2(0.1) + 0.9 * np.log2(0.9))
    assert expected_information(np.array([[0.1], [0.9]])) == pytest.approx([1.0 - entropy])


class SpikeBesideSlab(WidePrior):
    """The second parameter is none in half of the particles."""

    def fixed(self, counted):
        return (counted[:, 1] == 0.0)[:, None] & np.array([False, True])


def test_particles_are_dealt_out_by_the_evidence_of_an_effect_and_of_none():
    """Bayes factor of none by its ratio of densities (Dickey 1971, Ann. Math. Stat. 42:204)."""
    likelihood = GaussianReadings(np.eye(2), np.array([1.0, 1.7]), np.array([0.5, 1.0]), [0, 1])
    counted = np.random.default_rng(3).uniform(-30.0, 30.0, (6000, 2))
    counted[::2, 1] = 0.0
    found = updated(Particles(SpikeBesideSlab(), counted), likelihood, np.random.default_rng(1))
    none = np.exp(-0.5 * 1.7**2)
    slab = np.sqrt(2.0 * np.pi) / 60.0
    absent = found.counted[:, 1] == 0.0
    assert absent.mean() == pytest.approx(none / (none + slab), abs=0.03)
    assert found.counted[~absent, 1].mean() == pytest.approx(1.7, abs=0.1)
    assert found.counted[:, 0].mean() == pytest.approx(1.0, abs=0.05)


def diagram():
    speeds, depths = np.array([100.0, 200.0]), np.array([1e-3, 2e-3, 3e-3])
    # limits of the particles: 1.5 mm and 2.5 mm at the first speed, 1.5 mm at the second
    limits = np.array([[1.5e-3, 1.5e-3], [2.5e-3, 1.5e-3]])
    margins = (limits[:, :, None] - depths) / depths
    return ParticleDiagram(speeds, depths, margins, np.array([0.01, 0.01]))


def test_the_most_telling_cut_is_where_particles_disagree():
    chosen = next_cut(diagram(), INFORMATION, 1.0)
    assert (chosen.spindle_speed, chosen.axial_depth) == (100.0, 2e-3)
    assert chosen.probability == pytest.approx(0.5, abs=1e-6)
    assert chosen.information == pytest.approx(1.0, abs=1e-3)


def test_the_most_metal_is_within_the_risk():
    safe = next_cut(diagram(), METAL, 0.1)
    assert (safe.spindle_speed, safe.axial_depth) == (200.0, 1e-3)
    bold = next_cut(diagram(), METAL, 0.6)
    assert (bold.spindle_speed, bold.axial_depth) == (100.0, 2e-3)


def test_no_cut_is_proposed_where_all_are_beyond_the_risk():
    every = diagram()
    deep = ParticleDiagram(every.speeds, every.depths + 9e-3, every.margins - 3.0, every.scatter)
    assert next_cut(deep, METAL, 0.5) is None


def test_limits_of_particles_follow_from_margins_that_are_shares_of_the_depth():
    assert diagram().limits == pytest.approx(np.array([[1.5e-3, 1.5e-3], [2.5e-3, 1.5e-3]]))


def test_the_evidence_is_the_integral_of_the_likelihood_over_the_prior():
    """A flat prior over 60 by 60: the integral of the normal density of two readings."""
    likelihood = GaussianReadings(SLOPES[:2], MEASURED[:2], SCATTER[:2], [0, 1])
    found = updated(spread_particles(6000), likelihood, np.random.default_rng(1))
    volume = 2.0 * np.pi * np.prod(SCATTER[:2]) / abs(np.linalg.det(SLOPES[:2]))
    assert found.log_evidence == pytest.approx(np.log(volume / 3600.0), abs=0.12)
