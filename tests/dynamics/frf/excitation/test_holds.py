"""What the hold of an input does to an FRF, against z-transforms known in closed form."""

import numpy as np
import pytest

from dynamics.frf.excitation.holds import (
    BAND_LIMITED,
    FIRST_ORDER_HOLD,
    ZERO_ORDER_HOLD,
    image_share,
    without_images,
)
from dynamics.frf.excitation.multisine import full_lines, multisine, schroeder_phases
from dynamics.frf.excitation.periodic import PeriodicRecord, frf_of_periods

T = 1e-3
S = np.concatenate([2j * np.pi * np.array([0.5, 20.0, 250.0, 490.0]), [7.0 + 600.0j, 0.3 + 0.1j]])
Z = np.exp(S * T)

#: sampled chains of integrators (Astrom and Wittenmark, table of sampled systems)
SAMPLED = [
    (ZERO_ORDER_HOLD, 0, 0.5 * (1.0 + 1.0 / Z)),  # in the middle of its jumps
    (ZERO_ORDER_HOLD, 1, T / (Z - 1.0)),
    (ZERO_ORDER_HOLD, 2, 0.5 * T**2 * (Z + 1.0) / (Z - 1.0) ** 2),
    (FIRST_ORDER_HOLD, 0, np.ones(Z.size)),
    (FIRST_ORDER_HOLD, 1, 0.5 * T * (Z + 1.0) / (Z - 1.0)),
    (FIRST_ORDER_HOLD, 2, T**2 / 6.0 * (Z**2 + 4.0 * Z + 1.0) / (Z - 1.0) ** 2),
]


@pytest.mark.parametrize(("hold", "slope", "sampled"), SAMPLED)
def test_hold_and_images_make_up_the_sampled_integrators(hold, slope, sampled):
    share = image_share(S, T, slope + hold.power)
    np.testing.assert_allclose(hold.transfer(S, T) * (1.0 + share) / S**slope, sampled, rtol=1e-9)


def test_holds_pass_the_static_force_and_have_no_images_there():
    for hold in (ZERO_ORDER_HOLD, FIRST_ORDER_HOLD, BAND_LIMITED):
        assert hold.transfer(0.0, T) == 1.0
    for power in (1, 2, 3, 4):
        assert image_share(0.0, T, power) == 0.0


@pytest.fixture(scope="module", params=[True, False], ids=["joined by lines", "held"])
def steady(request, two_masses):
    step, period = two_masses.step, 1.0
    lines = full_lines(2.0, 500.0, period, step)  # to a quarter of the sampling frequency
    signal = multisine(lines, schroeder_phases(lines), period, 20.0, step)
    force = signal.repeated(1, leading=3)
    motion = two_masses.response(force, request.param)
    hold = FIRST_ORDER_HOLD if request.param else ZERO_ORDER_HOLD
    return signal, force, motion, hold


@pytest.mark.parametrize("mass", [0, 1])
def test_receptance_is_the_analytic_one_to_a_quarter_of_the_sampling_frequency(
    two_masses, steady, mass
):
    signal, force, motion, hold = steady
    record = PeriodicRecord(force, motion[:, mass], signal.step, signal.period, signal.lines, 3)
    estimate = frf_of_periods([record], hold).frf
    truth = two_masses.receptance(2j * np.pi * estimate.frequency)[:, mass]
    inverse_mass = two_masses.inverse_mass if mass == 0 else 0.0
    clean = without_images(estimate, hold, signal.step, inverse_mass).values
    if mass == 0:
        assert np.abs(clean / truth - 1.0).max() < 1e-3
        # without knowing the mass, to a tenth
        low = estimate.frequency <= 200.0
        assert np.abs(estimate.values / truth - 1.0)[low].max() < 1e-3
    else:
        # falls by four powers of frequency beyond the modes, and its images with it
        low = estimate.frequency <= 200.0
        assert np.abs(clean / truth - 1.0)[low].max() < 1e-3


def test_velocity_recorded_is_the_mobility(two_masses, steady):
    signal, force, motion, hold = steady
    record = PeriodicRecord(
        force, motion[:, 2], signal.step, signal.period, signal.lines, 3, "mobility"
    )
    estimate = frf_of_periods([record], hold).frf
    truth = two_masses.receptance(2j * np.pi * estimate.frequency)[:, 0]
    truth = truth * 2j * np.pi * estimate.frequency
    clean = without_images(estimate, hold, signal.step, two_masses.inverse_mass).values
    assert np.abs(clean / truth - 1.0).max() < 1e-2
    low = estimate.frequency <= 200.0
    assert np.abs(clean / truth - 1.0)[low].max() < 5e-3


def test_a_wrong_hold_shows(two_masses, steady):
    signal, force, motion, hold = steady
    other = ZERO_ORDER_HOLD if hold is FIRST_ORDER_HOLD else FIRST_ORDER_HOLD
    record = PeriodicRecord(force, motion[:, 0], signal.step, signal.period, signal.lines, 3)
    estimate = frf_of_periods([record], other).frf
    truth = two_masses.receptance(2j * np.pi * estimate.frequency)[:, 0]
    at = np.searchsorted(estimate.frequency, 200.0)
    # half a sample of delay at a tenth of the sampling frequency: 18 degrees
    turn = np.degrees(np.abs(np.angle(estimate.values / truth)))[at]
    assert turn == pytest.approx(18.0, abs=0.5)
