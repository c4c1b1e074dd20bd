"""Excitation signals against their closed forms."""

import numpy as np
import pytest

from dynamics.frf.excitation.chirp import linear_chirp
from dynamics.frf.excitation.hammer import half_sine_blow, several_blows
from dynamics.frf.excitation.multisine import (
    full_lines,
    multisine,
    odd_lines,
    random_phases,
    schroeder_phases,
)
from dynamics.frf.excitation.signal import ExcitationError, pulses_at

STEP = 5e-5


def line_amplitudes(signal):
    return 2.0 * np.abs(np.fft.rfft(signal.values)) / signal.period


def test_half_sine_has_its_peak_impulse_and_spectral_zero():
    width, peak = 2e-3, 800.0
    blow = half_sine_blow(width, peak, STEP)
    assert blow.max() == pytest.approx(peak, rel=1e-12)
    assert blow[0] == 0.0
    assert blow[-1] == pytest.approx(0.0, abs=1e-9)
    # impulse 2/pi peak width; the sum of samples is short of it by (pi step / width)^2 / 12
    assert blow.sum() * STEP == pytest.approx(2.0 / np.pi * peak * width, rel=6e-4)
    time = STEP * np.arange(blow.size)
    at = [np.sum(blow * np.exp(-2j * np.pi * f * time)) for f in (0.0, 1.5 / width)]
    assert abs(at[1]) < 2e-3 * abs(at[0])


def test_blows_scatter_about_their_values_and_repeat_with_their_seed():
    first, again, other = (
        several_blows(2e-3, 500.0, STEP, 60, 0.02, 0.1, seed, rest=0.01) for seed in (3, 3, 4)
    )
    np.testing.assert_array_equal(first.values, again.values)
    assert np.any(first.values != other.values)
    np.testing.assert_array_equal(np.diff(first.starts), 400)
    assert first.starts[0] == 200
    assert first.values.size == 200 + 60 * 400
    peaks = [first.values[start : start + 400].max() for start in first.starts]
    assert np.mean(peaks) == pytest.approx(500.0, rel=0.05)  # 4 standard errors
    assert np.std(peaks) == pytest.approx(50.0, rel=0.35)


def test_chirp_sweeps_its_band():
    # the long-stroke shaker: 250 N, 1 to 200 Hz
    signal = linear_chirp(1.0, 200.0, 4.0, 250.0, STEP)
    turns = 4.0 * (1.0 / 2.0 + 199.0 / 8.0)  # integral of the frequency over half the period
    assert signal.peak == pytest.approx(250.0, rel=1e-3)
    assert signal.values[0] == 0.0
    assert abs(signal.values[-1]) < 0.01
    half = signal.values[1 : signal.period // 2]
    assert np.count_nonzero(np.diff(np.sign(half))) == pytest.approx(2.0 * turns, abs=1.0)
    assert signal.frequency[0] == pytest.approx(1.0)
    assert signal.frequency[-1] == pytest.approx(200.0)


def test_linear_chirp_keeps_its_power_in_the_band_evenly():
    signal = linear_chirp(10.0, 500.0, 4.0, 1.0, STEP)
    power = line_amplitudes(signal) ** 2
    assert power[signal.lines].sum() > 0.99 * power.sum()
    inside = power[signal.lines][(signal.frequency > 60.0) & (signal.frequency < 450.0)]
    # amplitude^2 / (lines in the band), by stationary phase, rippling by 10 % or so
    assert inside.mean() == pytest.approx(1.0 / signal.lines.size, rel=0.02)
    assert inside.min() > 0.5 / signal.lines.size


@pytest.mark.parametrize("phases", [schroeder_phases, lambda lines: random_phases(lines, 7)])
def test_multisine_is_flat_on_its_lines_and_empty_off_them(phases):
    lines = full_lines(10.0, 500.0, 1.0, STEP)
    np.testing.assert_array_equal(lines, np.arange(10, 501))
    signal = multisine(lines, phases(lines), 1.0, 30.0, STEP)
    assert signal.rms == pytest.approx(30.0, rel=1e-12)
    amplitude = line_amplitudes(signal)
    np.testing.assert_allclose(amplitude[lines], 30.0 * np.sqrt(2.0 / lines.size), rtol=1e-9)
    assert np.delete(amplitude, lines).max() < 1e-9


def test_schroeder_phases_keep_the_crest_low():
    lines = full_lines(10.0, 500.0, 1.0, STEP)
    low = multisine(lines, schroeder_phases(lines), 1.0, 1.0, STEP)
    high = multisine(lines, np.zeros(lines.size), 1.0, 1.0, STEP)
    # a sweep, sqrt(2), overshooting where it starts anew; sqrt(2 l) with all in phase
    assert np.sqrt(2.0) < low.peak / low.rms < 2.0
    assert high.peak / high.rms == pytest.approx(np.sqrt(2.0 * lines.size), rel=1e-3)


def test_odd_lines_make_half_the_period_the_negative_of_the_other():
    lines = odd_lines(10.0, 500.0, 1.0, STEP)
    values = multisine(lines, random_phases(lines, 1), 1.0, 1.0, STEP).with_peak(5.0).values
    np.testing.assert_allclose(values[: values.size // 2], -values[values.size // 2 :], atol=1e-9)
    assert np.abs(values).max() == pytest.approx(5.0)


def test_periods_repeat_behind_leading_ones():
    lines = full_lines(10.0, 50.0, 0.5, STEP)
    signal = multisine(lines, schroeder_phases(lines), 0.5, 1.0, STEP)
    values = signal.repeated(3, leading=2)
    assert values.size == 5 * 10000
    np.testing.assert_array_equal(values.reshape(5, -1)[4], signal.values)


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: half_sine_blow(5e-5, 1.0, STEP), "shorter than two steps"),
        (lambda: half_sine_blow(1e-3, np.nan, STEP), "peak is nan"),
        (lambda: several_blows(2e-3, 1.0, STEP, 2, 1e-3), "does not end before"),
        (lambda: several_blows(2e-3, 1.0, STEP, 2, 0.1, scatter=0.5), "scatter"),
        (lambda: linear_chirp(1.0, 2e4, 1.0, 1.0, STEP), "half the sampling"),
        (lambda: linear_chirp(1.0, 200.0, 1.0, 1.0, STEP, taper=0.7), "taper"),
        (lambda: linear_chirp(0.0, 200.0, 1.0, 1.0, STEP), "lowest frequency"),
        (lambda: full_lines(10.0, 11.0, 0.1, STEP), "fewer than two lines"),
        (lambda: full_lines(10.0, 100.0, 0.10003, STEP), "whole multiple"),
        (lambda: multisine(np.array([0, 1]), np.zeros(2), 0.1, 1.0, STEP), "lines 0 to 1"),
        (lambda: pulses_at([], [], 10, STEP), "0 starts"),
    ],
)
def test_senseless_excitations_are_told(make, told):
    with pytest.raises(ExcitationError, match=told):
        make()
