"""FRFs of blows and single chirps on a structure known analytically."""

import numpy as np
import pytest

from dynamics.frf.container import MeasurementError
from dynamics.frf.excitation.angle_triggered import angle_at_constant_speed, angle_triggered_pulses
from dynamics.frf.excitation.chirp import linear_chirp
from dynamics.frf.excitation.hammer import half_sine_blow, several_blows
from dynamics.frf.excitation.holds import (
    BAND_LIMITED,
    FIRST_ORDER_HOLD,
    ZERO_ORDER_HOLD,
    without_images,
)
from dynamics.frf.excitation.signal import pulses_at
from dynamics.frf.excitation.transient import cut_at_pulses, frf_of_transients
from dynamics.frf.hammer.record import HammerRecord
from dynamics.frf.hammer.spectra import h1, h2

BAND = (1.0, 200.0)  # to a tenth of the sampling frequency
WITHIN = 1e-3


def error(two_masses, frf, mass=0):
    s = frf.added_decay + 2j * np.pi * frf.frequency
    return np.abs(frf.values / two_masses.receptance(s)[:, mass] - 1.0).max()


def test_one_blow_joined_by_lines_gives_the_analytic_receptances(two_masses):
    train = pulses_at([10], [half_sine_blow(4e-3, 500.0, two_masses.step)], 8000, two_masses.step)
    states = two_masses.response(train.values, joined_by_lines=True)
    for mass in (0, 1):
        records = cut_at_pulses(train, train.values, 1e-4 + states[:, mass], "receptance")
        frf = frf_of_transients(records, FIRST_ORDER_HOLD, BAND, left_at_end=1e-5)
        assert error(two_masses, frf, mass) < WITHIN
        assert frf.coherence is None


def test_blow_of_constant_force_held(two_masses):
    step = two_masses.step
    train = pulses_at([0], [np.full(round(1e-3 / step), 500.0)], 8000, step)
    states = two_masses.response(train.values, joined_by_lines=False)
    records = cut_at_pulses(train, train.values, states[:, 0], "receptance")
    frf = frf_of_transients(records, ZERO_ORDER_HOLD, BAND, left_at_end=1e-5)
    frf = without_images(frf, ZERO_ORDER_HOLD, step, two_masses.inverse_mass)
    assert error(two_masses, frf) < WITHIN


def test_single_chirp_and_the_ringing_behind_it(two_masses):
    step = two_masses.step
    force = np.concatenate([linear_chirp(1.0, 200.0, 4.0, 250.0, step).values, np.zeros(6000)])
    states = two_masses.response(force, joined_by_lines=True)
    record = HammerRecord("chirp", 1.0 / step, force, states[:, 0], "receptance")
    frf = frf_of_transients([record], FIRST_ORDER_HOLD, (5.0, 190.0), left_at_end=1e-3)
    assert error(two_masses, frf) < WITHIN


def test_short_record_with_added_decay_is_the_function_beside_the_axis(two_masses):
    step = two_masses.step
    train = pulses_at([0], [half_sine_blow(4e-3, 500.0, step)], 1000, step)
    states = two_masses.response(train.values, joined_by_lines=True)
    records = cut_at_pulses(train, train.values, states[:, 0], "receptance")
    with pytest.raises(MeasurementError, match=r"pulse 1: .* left at the end"):
        frf_of_transients(records, FIRST_ORDER_HOLD, BAND, left_at_end=1e-4)
    frf = frf_of_transients(records, FIRST_ORDER_HOLD, BAND, added_decay=20.0, left_at_end=1e-4)
    assert frf.added_decay == 20.0
    assert error(two_masses, frf) < WITHIN


def test_blows_with_noise_h1_low_of_h2_and_coherence_between(two_masses):
    step = two_masses.step
    train = several_blows(4e-3, 500.0, step, 8, 3.0, scatter=0.1, seed=1, rest=0.01)
    states = two_masses.response(train.values, joined_by_lines=True)
    records = cut_at_pulses(train, train.values, states[:, 0], "receptance")
    frf = frf_of_transients(records, FIRST_ORDER_HOLD, BAND)
    assert len(records) == 8
    assert error(two_masses, frf) < WITHIN
    np.testing.assert_allclose(frf.coherence, 1.0, atol=1e-6)
    noise = 1e-3 * np.abs(states[:, 0]).max()
    noisy = states[:, 0] + noise * np.random.default_rng(5).standard_normal(len(states))
    records = cut_at_pulses(train, train.values, noisy, "receptance")
    low, high = (
        frf_of_transients(records, FIRST_ORDER_HOLD, (10.0, 60.0), estimator, left_at_end=0.05)
        for estimator in (h1, h2)
    )
    np.testing.assert_allclose(np.abs(low.values / high.values), low.coherence, rtol=1e-9)
    truth = two_masses.receptance(2j * np.pi * low.frequency)[:, 0]
    # of the response noise: power n sigma^2 a line, over the power of the force
    spectrum = np.fft.rfft(np.stack([record.force for record in records]))
    power = np.mean(np.abs(spectrum) ** 2, axis=0)
    kept = (np.fft.rfftfreq(6000, step) >= 10.0) & (np.fft.rfftfreq(6000, step) <= 60.0)
    expected = 6000 * noise**2 / power[kept] / 8.0
    seen = np.abs(low.values - truth) ** 2 / expected
    assert seen.mean() == pytest.approx(1.0, rel=0.4)  # 151 lines: standard error 8 %


def test_pulses_at_a_spindle_angle_give_the_frf_of_the_held_torque(two_masses):
    step = two_masses.step
    samples = 24000
    angle = angle_at_constant_speed(2.0 * np.pi * 4.01, samples, step, start=0.3)
    train = angle_triggered_pulses(angle, 0.5 * np.pi, np.full(4, 200.0), step, revolutions=12)
    assert train.starts.size == 4
    # a first-passage sample lies less than a step behind the angle
    behind = (angle[train.starts] - 0.5 * np.pi) % (2.0 * np.pi)
    assert behind.max() < 2.0 * np.pi * 4.01 * step
    states = two_masses.response(train.values, joined_by_lines=False)
    records = cut_at_pulses(train, train.values, states[:, 0], "receptance")
    frf = frf_of_transients(records, ZERO_ORDER_HOLD, BAND)
    frf = without_images(frf, ZERO_ORDER_HOLD, step, two_masses.inverse_mass)
    assert error(two_masses, frf) < WITHIN


def test_unusable_transients_are_told(two_masses):
    step = two_masses.step
    quiet = HammerRecord("quiet", 1.0 / step, np.zeros(100), np.zeros(100), "receptance")
    with pytest.raises(MeasurementError, match="quiet: the force is zero"):
        frf_of_transients([quiet], BAND_LIMITED, BAND)
    train = pulses_at([0], [half_sine_blow(4e-3, 500.0, step)], 100, step)
    with pytest.raises(MeasurementError, match="100 samples"):
        cut_at_pulses(train, train.values, np.zeros(99), "receptance")
    blow = HammerRecord("blow", 1.0 / step, train.values, train.values, "receptance")
    with pytest.raises(MeasurementError, match="fewer than two lines"):
        frf_of_transients([blow], BAND_LIMITED, (1.0, 2.0))
    with pytest.raises(MeasurementError, match="added decay"):
        frf_of_transients([blow], BAND_LIMITED, BAND, added_decay=-1.0)
