"""From blows to an FRF: exact round trips, bias of H1 and H2, windows and what they add."""

from dataclasses import replace

import numpy as np
import pytest

from dynamics.frf.container import MeasurementError, Point, without_added_decay
from dynamics.frf.hammer.hit import locate_hit
from dynamics.frf.hammer.spectra import (
    Spectra,
    averaged_spectra,
    coherence,
    frf_from_records,
    h1,
    h2,
    usable_band,
)
from dynamics.frf.hammer.windows import choose_windows, force_window
from tests.dynamics.frf.hammer import hammer_records as made

NO_NOISE = made.Noise(0.0, 0.0)
CLOSE = made.CLOSE
ONE = made.Structure(((450.0, 0.03, 0.8),))
SLOW = made.Structure(((120.0, 0.004, 2.0),))


def records(structure, noise, count=3, seed=0, samples=12800):
    rng = np.random.default_rng(seed)
    return [
        made.record_of(
            rng, structure, [replace(made.random_hit(rng), exponent=2.0)], noise, f"tap{i}", samples
        )
        for i in range(count)
    ]


@pytest.mark.parametrize("structure", [ONE, CLOSE], ids=["one mode", "three modes"])
@pytest.mark.parametrize("estimator", [h1, h2])
def test_round_trip_without_noise(structure, estimator):
    frf = frf_from_records(records(structure, NO_NOISE), estimator).band(300.0, 2500.0)
    exact = structure.accelerance(frf.frequency)
    assert frf.quantity == "accelerance"
    assert frf.added_decay == 0.0
    assert np.max(np.abs(frf.values - exact)) < 1e-3 * np.max(np.abs(exact))
    assert np.min(frf.coherence) > 0.9999


def test_round_trip_to_receptance():
    frf = frf_from_records(records(CLOSE, NO_NOISE)).receptance().band(300.0, 2500.0)
    omega = 2 * np.pi * frf.frequency
    exact = CLOSE.accelerance(frf.frequency) / -(omega**2)
    assert np.max(np.abs(frf.values - exact)) < 1e-3 * np.max(np.abs(exact))


def test_closer_lines_by_zero_padding_agree():
    blows = records(CLOSE, NO_NOISE)
    spectra = averaged_spectra(blows)
    length = round(made.SAMPLING_RATE / spectra.frequency[1])
    fine = frf_from_records(blows, transform_length=4 * length).values[::4]
    coarse = frf_from_records(blows).values
    np.testing.assert_allclose(fine[:200], coarse[:200], rtol=1e-9)


def noisy_spectra(force_noise, response_noise, count=20000, seed=1):
    """Spectra of one line repeated, with known signal to noise in both channels."""
    rng = np.random.default_rng(seed)

    def normal(scale):
        return np.sqrt(scale / 2) * (
            rng.standard_normal((count, 8)) + 1j * rng.standard_normal((count, 8))
        )

    truth = 2.0 - 3.0j
    force = normal(1.0)
    response = truth * force + normal(abs(truth) ** 2 * response_noise)
    force = force + normal(force_noise)
    spectra = Spectra(
        frequency=np.arange(8.0),
        force_power=np.mean(np.abs(force) ** 2, axis=0),
        response_power=np.mean(np.abs(response) ** 2, axis=0),
        cross=np.mean(response * force.conj(), axis=0),
        count=count,
        noise_power=0.0,
        force_noise_power=0.0,
        quantity="accelerance",
        added_decay=0.0,
        response=Point(),
        reference=Point(),
    )
    return truth, spectra


@pytest.mark.parametrize(("n", "m"), [(0.2, 0.0), (0.0, 0.3), (0.2, 0.3)])
def test_bias_of_the_estimators_and_coherence(n, m):
    # Bendat and Piersol 2010, section 6.1: H1 = H / (1 + n), H2 = H (1 + m), and
    # coherence 1 / ((1 + n)(1 + m)) for noise-to-signal n of the force and m of the response
    truth, spectra = noisy_spectra(n, m)
    scatter = 0.02  # 20000 averages
    np.testing.assert_allclose(h1(spectra), truth / (1 + n), rtol=scatter)
    np.testing.assert_allclose(h2(spectra), truth * (1 + m), rtol=scatter)
    np.testing.assert_allclose(coherence(spectra), 1 / ((1 + n) * (1 + m)), rtol=scatter)
    np.testing.assert_allclose(h1(spectra) / h2(spectra), coherence(spectra), rtol=1e-12)


def test_force_window_leaves_the_blow_alone():
    (record,) = records(ONE, made.Noise(0.003, 0.002), count=1)
    hit = locate_hit(record)
    windows = choose_windows([record], [hit])
    first = hit.onset - windows.lead
    window = force_window(hit, first, windows)
    clean = made.response_to(
        ONE, [replace(made.random_hit(np.random.default_rng(0)), exponent=2.0)], 12800
    )[0]
    blow = np.flatnonzero(clean > 1e-9)
    assert np.all(window[blow - first] == 1.0)
    assert np.sum(window > 0.0) < blow.size + 40


def test_windows_lower_the_noise_of_the_estimate():
    noise = made.Noise(0.006, 0.008)
    blows = records(CLOSE, noise, count=6)
    frf = frf_from_records(blows).band(400.0, 1800.0)
    error = np.linalg.norm(frf.values - CLOSE.accelerance(frf.frequency)) / np.sqrt(
        frf.frequency.size
    )
    force = np.fft.rfft([record.force for record in blows])
    response = np.fft.rfft([record.response for record in blows])
    plain = np.sum(response * force.conj(), axis=0) / np.sum(np.abs(force) ** 2, axis=0)
    lines = np.fft.rfftfreq(12800, 1 / made.SAMPLING_RATE)
    inside = (lines > 400.0) & (lines < 1800.0)
    plain_error = np.linalg.norm((plain - CLOSE.accelerance(lines))[inside]) / np.sqrt(inside.sum())
    assert error < 0.5 * plain_error


def fitted_pole(frf, start):
    """Frequency and damping of one mode by iterated linear least squares on the receptance."""
    s = 2j * np.pi * frf.frequency
    matrix = np.stack([np.ones_like(s), -s * frf.values, -(s**2) * frf.values], axis=1)
    weight = 1.0 / np.abs(frf.values)
    for _ in range(8):
        a = np.concatenate([(matrix * weight[:, None]).real, (matrix * weight[:, None]).imag])
        b = np.concatenate([(frf.values * weight).real, (frf.values * weight).imag])
        scale = np.linalg.norm(a, axis=0)
        _, p, q = np.linalg.lstsq(a / scale, b, rcond=None)[0] / scale
        weight = 1.0 / np.abs(1 + p * s + q * s**2)
    natural = 1 / np.sqrt(q)
    assert natural / (2 * np.pi) == pytest.approx(start, rel=0.05)
    return natural / (2 * np.pi), p * natural / 2


def test_exponential_window_is_used_and_corrected_where_the_ringing_outlasts_the_record():
    frf = frf_from_records(records(SLOW, NO_NOISE, samples=8192))
    assert frf.added_decay > 5.0
    frequency, damping = fitted_pole(frf.receptance().band(90.0, 150.0), 120.0)
    assert damping > 3 * 0.004  # as windowed
    frequency, damping = without_added_decay(frequency, damping, frf.added_decay)
    assert frequency == pytest.approx(120.0, rel=1e-3)
    assert damping == pytest.approx(0.004, rel=5e-3)


def test_no_exponential_window_where_the_ringing_dies_away():
    frf = frf_from_records(records(CLOSE, made.Noise()))
    assert frf.added_decay == 0.0


def test_usable_band_holds_the_modes_and_ends_with_the_force():
    spectra = averaged_spectra(records(CLOSE, made.Noise(), count=6))
    lowest, highest = usable_band(spectra)
    assert lowest < 400.0
    assert 2000.0 < highest < 9000.0
    at_end = np.searchsorted(spectra.frequency, highest)
    assert spectra.force_power[at_end] < 0.1 * spectra.force_power.max()


def test_one_record_has_no_coherence_but_a_band():
    (record,) = records(CLOSE, made.Noise(), count=1)
    assert frf_from_records([record]).coherence is None
    lowest, highest = usable_band(averaged_spectra([record]))
    assert lowest < 500.0 < 1600.0 < highest


def test_records_must_be_of_one_kind():
    first, second = records(ONE, made.Noise(), count=2)
    with pytest.raises(MeasurementError, match="sampled at"):
        frf_from_records([first, replace(second, sampling_rate=51200.0)])
    with pytest.raises(MeasurementError, match="mobility"):
        frf_from_records([first, replace(second, quantity="mobility")])
    with pytest.raises(MeasurementError, match="no hit"):
        frf_from_records([replace(first, force=np.random.default_rng(0).normal(size=12800))])
    with pytest.raises(MeasurementError, match="no hammer record"):
        frf_from_records([])
