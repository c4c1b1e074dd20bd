"""Harmonics of the spindle: sums over samples against sums written out, even turning or not."""

import numpy as np
import pytest

from chatter.explain.residuals.spindle_harmonics import EvenPhases, Phases, phases_of

COUNT = 40
STEP = 0.041  # rad a sample


def angles(uneven: float) -> np.ndarray:
    """Angles of 1200 samples, rad, evenly spaced but for a slow wave."""
    n = np.arange(1200)
    return 0.7 + STEP * n + uneven * np.sin(2.0 * np.pi * n / 500.0)


@pytest.mark.parametrize("uneven", [0.0, 0.02])
def test_sums_are_those_written_out(uneven):
    angle, rng = angles(uneven), np.random.default_rng(3)
    values = rng.normal(size=angle.size)
    amplitudes = rng.normal(size=COUNT) + 1j * rng.normal(size=COUNT)
    turns = phases_of(angle, COUNT)
    powers = np.exp(1j * np.outer(np.arange(2 * COUNT + 1), angle))
    of_orders = powers[1 : COUNT + 1]
    np.testing.assert_allclose(turns.powers_summed(), powers.sum(axis=1), atol=1e-8 * angle.size)
    np.testing.assert_allclose(turns.products(values), of_orders @ values, atol=1e-7)
    np.testing.assert_allclose(turns.combined(amplitudes), amplitudes @ of_orders, atol=1e-8)


@pytest.mark.parametrize(
    ("uneven", "kind"), [(0.0, EvenPhases), (1e-5, EvenPhases), (1e-3, Phases)]
)
def test_a_spindle_turns_evenly_where_no_harmonic_shows_otherwise(uneven, kind):
    assert type(phases_of(angles(uneven), COUNT)) is kind
