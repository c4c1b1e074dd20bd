"""Averages over periods and realisations, their variances, and closed loops."""

import numpy as np
import pytest

from dynamics.frf.container import MeasurementError
from dynamics.frf.excitation.chirp import linear_chirp
from dynamics.frf.excitation.holds import BAND_LIMITED, FIRST_ORDER_HOLD, ZERO_ORDER_HOLD
from dynamics.frf.excitation.multisine import full_lines, multisine, odd_lines, random_phases
from dynamics.frf.excitation.periodic import PeriodicRecord, frf_of_periods, joint_input_output_frf

STEP = 5e-4


def realisations(count, lines, rms, periods, answer):
    """Records of a memoryless answer to multisines of other phases."""
    records = []
    for seed in range(count):
        signal = multisine(lines, random_phases(lines, seed), 0.5, rms, STEP)
        force = signal.repeated(periods, leading=1)
        records.append(
            PeriodicRecord(force, answer(force), STEP, signal.period, lines, name=f"phase {seed}")
        )
    return records


def test_periodic_chirp_gives_the_analytic_receptance(two_masses):
    signal = linear_chirp(2.0, 200.0, 1.0, 250.0, STEP)
    force = signal.repeated(1, leading=3)
    motion = two_masses.response(force, joined_by_lines=True)[:, 0]
    record = PeriodicRecord(force, motion, STEP, signal.period, signal.lines, leading=3)
    frf = frf_of_periods([record], FIRST_ORDER_HOLD).frf
    truth = two_masses.receptance(2j * np.pi * frf.frequency)[:, 0]
    assert np.abs(frf.values / truth - 1.0).max() < 1e-3


def test_noise_variance_foretells_the_error():
    lines = full_lines(10.0, 500.0, 0.5, STEP)
    noise = np.random.default_rng(2)
    (record,) = realisations(1, lines, 1.0, 6, lambda u: 2.0 * u + noise.normal(0.0, 0.1, u.size))
    result = frf_of_periods([record], BAND_LIMITED)
    # line amplitude sqrt(2 / l) rms, transform n / 2 of it; noise power n sigma^2 a period
    size = record.period
    expected = size * 0.1**2 / (0.25 * size**2 * 2.0 / lines.size) / 6.0
    assert result.noise_variance.mean() == pytest.approx(expected, rel=0.15)  # s.e. 3 %
    assert np.mean(np.abs(result.frf.values - 2.0) ** 2) == pytest.approx(expected, rel=0.3)
    assert result.total_variance is None
    with pytest.raises(MeasurementError, match="two realisations"):
        _ = result.distortion_variance


def test_linear_system_shows_no_distortion_and_a_cube_shows_it():
    lines = odd_lines(4.0, 300.0, 0.5, STEP)
    noise = np.random.default_rng(3)
    linear, cube = (
        frf_of_periods(
            realisations(
                20, lines, 1.0, 4, lambda u, a=a: u + a * u**3 + noise.normal(0.0, 0.05, u.size)
            ),
            BAND_LIMITED,
        )
        for a in (0.0, 0.1)
    )
    assert linear.total_variance.mean() == pytest.approx(linear.noise_variance.mean(), rel=0.25)
    assert cube.total_variance.mean() > 5.0 * cube.noise_variance.mean()
    assert cube.distortion_variance.mean() == pytest.approx(
        20.0 * (cube.total_variance - cube.noise_variance).mean(), rel=0.1
    )


def test_best_linear_approximation_of_a_cube_grows_with_the_force():
    # Bussgang: y = u + a u^3 under Gaussian u is 1 + 3 a sigma^2 of it
    lines = odd_lines(4.0, 300.0, 0.5, STEP)
    for rms in (0.5, 1.0, 2.0):
        records = realisations(30, lines, rms, 1, lambda u: u + 0.1 * u**3)
        gain = frf_of_periods(records, BAND_LIMITED).frf.values.mean()
        # less by 3 a sigma^2 / l or so: l lines are not quite Gaussian
        assert gain.real == pytest.approx(1.0 + 0.3 * rms**2, rel=0.01)
        assert abs(gain.imag) < 0.01


@pytest.fixture(scope="module")
def loop(two_masses):
    """Position of the first mass under a held force r - K (x + noise), sampled at each step."""
    gain, noise_level, period, leading = 3.0e4, 4e-5, 0.5, 4
    lines = full_lines(4.0, 120.0, period, STEP)
    signals = [multisine(lines, random_phases(lines, seed), period, 1.0, STEP) for seed in (0, 1)]
    move, held, _ = two_masses.transition()
    random = np.random.default_rng(11)
    records = []
    for signal in signals:
        reference = signal.repeated(240, leading)
        noise = noise_level * random.standard_normal(reference.size)
        force, measured = np.zeros(reference.size), np.zeros(reference.size)
        state = np.zeros(4)
        for k, injected in enumerate(reference):
            measured[k] = state[0] + noise[k]
            force[k] = injected - gain * measured[k]
            state = move @ state + held * force[k]
        records.append(
            PeriodicRecord(
                force, measured, STEP, signal.period, lines, leading, reference=reference
            )
        )
    return records


def test_in_a_noisy_loop_neither_estimate_is_biased(two_masses, loop):
    records = loop
    frequency = records[0].frequency
    truth = two_masses.receptance(2j * np.pi * frequency)[:, 0]
    joint = joint_input_output_frf(records, ZERO_ORDER_HOLD)
    averaged = frf_of_periods(records, ZERO_ORDER_HOLD)
    low = frequency <= 20.0  # below resonance a bias would point one way
    # they are off by their scatter alone, to all sides
    scatter = np.sqrt(np.sum(averaged.noise_variance[low] / np.abs(truth[low]) ** 2)) / low.sum()
    assert scatter < 0.02
    for frf in (joint, averaged.frf):
        assert np.abs(np.mean((frf.values / truth - 1.0)[low])) < 3.0 * scatter
    normalised = np.abs(averaged.frf.values - truth) ** 2 / averaged.noise_variance
    assert normalised.mean() == pytest.approx(1.0, rel=0.4)
    assert joint.coherence[low].min() > 0.0
    assert joint.coherence[low].max() < 1.0


def test_unusable_periodic_records_are_told():
    lines = full_lines(10.0, 100.0, 0.5, STEP)
    (record,) = realisations(1, lines, 1.0, 2, lambda u: u)
    force = record.force

    def made(**changes):
        values = {"force": force, "response": force, "step": STEP, "period": 1000, "lines": lines}
        return PeriodicRecord(**{**values, **changes})

    for changes, told in [
        ({"response": force[1:]}, "response has shape"),
        ({"response": np.where(np.arange(force.size) == 7, np.nan, force)}, "sample 7"),
        ({"leading": 3}, "hold no period"),
        ({"lines": [3, 2]}, "rising"),
        ({"lines": [1, 500]}, "from 1 to 499"),
        ({"step": 0.0}, "step"),
    ]:
        with pytest.raises(MeasurementError, match=told):
            made(**changes)
    with pytest.raises(MeasurementError, match="no reference"):
        joint_input_output_frf([record], BAND_LIMITED)
    with pytest.raises(MeasurementError, match="nothing was excited at 102 Hz"):
        frf_of_periods([made(lines=np.arange(40, 60))], BAND_LIMITED)
    with pytest.raises(MeasurementError, match="realisations must share"):
        frf_of_periods([record, made(lines=lines[:-1])], BAND_LIMITED)
    with pytest.raises(MeasurementError, match="no periodic record"):
        frf_of_periods([], BAND_LIMITED)
