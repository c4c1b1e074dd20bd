"""Peaks of FRFs: heavily damped modes are found, the noise of a test is not."""

import numpy as np
import pytest

from chatter.simulation.virtual_tests.frf import peaks, peaks_of_test
from dynamics.frf.container import Frf

LINES = np.linspace(5.0, 500.0, 1981)
MODES = ((60.0, 0.02, 1e8), (150.0, 0.05, 4e8), (320.0, 0.01, 3e9))


def receptance(modes, lines=LINES):
    return sum(1.0 / k / (1.0 - (lines / f) ** 2 + 2j * z * lines / f) for f, z, k in modes)


def places(found):
    return [one["frequency_Hz"] for one in found]


@pytest.mark.parametrize("damping", [0.1, 0.3, 0.45])
def test_a_heavily_damped_mode_has_a_peak(damping):
    values = receptance([(100.0, damping, 1e8)])
    (found,) = peaks(Frf(LINES, values, "receptance"))
    # m x'' + c x' + k x = f: its height over the static one is 1 / (2 z sqrt(1 - z^2))
    assert found["frequency_Hz"] == pytest.approx(100.0 * np.sqrt(1.0 - 2.0 * damping**2), rel=1e-4)
    height = 1e-8 / (2.0 * damping * np.sqrt(1.0 - damping**2))
    assert found["magnitude"] == pytest.approx(height, rel=1e-4)


def test_an_overdamped_mode_has_none():
    assert peaks(Frf(LINES, receptance([(100.0, 0.8, 1e8)]), "receptance")) == []


def test_a_few_lines_are_enough_for_a_smooth_curve():
    lines = np.linspace(5.0, 500.0, 12)
    found = peaks(Frf(lines, receptance([(140.0, 0.05, 1e8)], lines), "receptance"))
    assert len(found) == 1


@pytest.mark.parametrize("noise", [0.001, 0.02, 0.1])
@pytest.mark.parametrize("seed", range(5))
def test_the_noise_of_a_test_has_no_peaks(noise, seed):
    random = np.random.default_rng(seed)
    scatter = random.standard_normal((2, LINES.size)) * noise / np.sqrt(2.0)
    values = receptance(MODES) * (1.0 + scatter[0] + 1j * scatter[1])
    found = places(peaks_of_test(Frf(LINES, values, "receptance")))
    assert len(found) == len(MODES)
    for at, (f, _, _) in zip(found, MODES, strict=True):
        assert at == pytest.approx(f, rel=0.02)


def test_a_peak_that_the_coherence_does_not_bear_out_is_none():
    values = receptance([(60.0, 0.02, 1e8)])
    # a bump of half the height again, smooth, where hardly any of the response is the force's
    bump = np.exp(-(((LINES - 300.0) / 10.0) ** 2))
    coherence = np.where(bump > 1e-3, 0.7, 1.0)
    both = places(peaks_of_test(Frf(LINES, values * (1.0 + bump), "receptance")))
    sure = Frf(LINES, values * (1.0 + bump), "receptance", coherence=coherence)
    assert len(both) == 2
    assert places(peaks_of_test(sure)) == pytest.approx([60.0], rel=0.01)
