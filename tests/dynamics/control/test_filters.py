"""Set-point filters, reference model and holds against their formulas."""

import math

import numpy as np
import pytest
from scipy import signal

from dynamics.control.current_loop import FirstOrderCurrentLoop, SecondOrderCurrentLoop
from dynamics.control.filters import (
    ReferenceModel,
    SecondOrderFilter,
    low_pass,
    notch,
    sampled_response,
    second_order_sample,
)
from dynamics.control.sampling import (
    ControlError,
    sample_and_hold_response,
    zero_order_hold_response,
)

T = 62.5e-6
FILTERS = [
    SecondOrderFilter(700.0, 0.05, 900.0, 0.5),
    notch(430.0, 0.0, 0.3),
    low_pass(1200.0, 0.6),
]


@pytest.mark.parametrize("spec", FILTERS)
def test_gain_at_rest_is_one(spec):
    b0, b1, b2, a1, a2 = spec.sampled(T)
    assert (b0 + b1 + b2) / (1.0 + a1 + a2) == pytest.approx(1.0, abs=1e-11)


def test_notch_is_as_deep_as_its_dampings_say_and_at_its_frequency():
    for f in (50.0, 800.0, 7900.0):
        at = sampled_response(notch(f, 0.02, 0.5).sampled(T), f, T)
        assert at == pytest.approx(0.02 / 0.5, abs=1e-9)
        assert abs(sampled_response(notch(f, 0.0, 0.5).sampled(T), f, T)) < 1e-9


def test_low_pass_at_its_natural_frequency_is_the_continuous_one():
    for f in (100.0, 5000.0):
        spec = low_pass(f, 0.7)
        at = sampled_response(spec.sampled(T), f, T)
        assert spec.continuous_response(f) == pytest.approx(1.0 / 1.4j)
        # numerator is zero at Nyquist and one at rest: bilinear image with prewarping
        assert at == pytest.approx(1.0 / 1.4j, abs=1e-9)


def test_equal_frequencies_give_the_bilinear_transform_with_prewarping():
    f, dz, dn = 1500.0, 0.1, 0.6
    w = 2 * math.pi * f
    rate = w / (2.0 * math.tan(w * T / 2.0))
    b, a = signal.bilinear([1 / w**2, 2 * dz / w, 1.0], [1 / w**2, 2 * dn / w, 1.0], rate)
    expected = [*(b / a[0]), *(a[1:] / a[0])]
    np.testing.assert_allclose(notch(f, dz, dn).sampled(T), expected, rtol=1e-10)


def test_sampled_filter_tends_to_the_continuous_one():
    spec, f = FILTERS[0], np.array([100.0, 650.0, 1400.0])
    fine = sampled_response(spec.sampled(1e-6), f, 1e-6)
    np.testing.assert_allclose(fine, spec.continuous_response(f), rtol=1e-4)


def test_leaf_is_the_difference_equation():
    coefficients = FILTERS[0].sampled(T)
    wave = np.random.default_rng(1).normal(size=300)
    first = second = 0.0
    output = np.zeros_like(wave)
    for n, value in enumerate(wave):
        output[n], first, second = second_order_sample(*coefficients, first, second, value)
    b, a = coefficients[:3], [1.0, *coefficients[3:]]
    np.testing.assert_allclose(output, signal.lfilter(b, a, wave), atol=1e-12)


def test_step_of_the_reference_model_is_that_of_a_second_order_lag():
    f, d, t = 90.0, 0.5, 50e-6
    model = ReferenceModel(f, d).sampled(t)
    n = np.arange(600)
    answer = signal.lfilter(model[:3], [1.0, *model[3:]], np.ones(600))
    w = 2 * math.pi * f
    wd = w * math.sqrt(1 - d * d)
    time = (n + 0.5) * t  # the transform takes the step as a ramp over a sample
    lag = 1 - np.exp(-d * w * time) * (
        np.cos(wd * time) + d / math.sqrt(1 - d * d) * np.sin(wd * time)
    )
    np.testing.assert_allclose(answer, lag, atol=5e-4)
    overshoot = math.exp(-math.pi * d / math.sqrt(1 - d * d))
    assert answer.max() - 1.0 == pytest.approx(overshoot, rel=1e-3)


def test_plants_are_discretised_exactly_for_held_input():
    transition, entry = FirstOrderCurrentLoop(3e-4).plant().sampled(1e-4)
    assert transition[0, 0] == pytest.approx(math.exp(-1.0 / 3.0), rel=1e-14)
    assert entry[0] == pytest.approx(1.0 - math.exp(-1.0 / 3.0), rel=1e-13)
    w, d, h = 2 * math.pi * 500.0, 0.4, 1e-4
    transition, _ = SecondOrderCurrentLoop(500.0, d).plant().sampled(h)
    pole = w * complex(-d, math.sqrt(1 - d * d))
    poles = np.linalg.eigvals(transition)
    assert np.abs(poles - np.exp(pole * h)).min() < 1e-13
    assert np.abs(poles - np.exp(pole.conjugate() * h)).min() < 1e-13


def test_hold_of_ever_finer_samples_is_the_continuous_hold():
    f, hold = np.array([30.0, 210.0, 640.0]), 2e-3
    fine = sample_and_hold_response(f, hold / 4000, 4000)
    np.testing.assert_allclose(fine, zero_order_hold_response(f, hold), atol=1e-3)
    assert zero_order_hold_response(0.0, hold) == 1.0


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: SecondOrderFilter(0.0, 0.1, 100.0, 0.1), "numerator frequency"),
        (lambda: SecondOrderFilter(100.0, -0.1, 100.0, 0.1), "numerator damping"),
        (lambda: SecondOrderFilter(100.0, 0.1, math.inf, 0.1), "denominator frequency"),
        (lambda: SecondOrderFilter(100.0, 0.1, 100.0, math.nan), "denominator damping"),
        (lambda: notch(9000.0, 0.1, 0.2).sampled(T), "Nyquist frequency 8000 Hz"),
        (lambda: ReferenceModel(0.0, 1.0), "natural frequency"),
        (lambda: FirstOrderCurrentLoop(-1.0), "time constant"),
    ],
)
def test_nonsense_is_refused_by_name(build, message):
    with pytest.raises(ControlError, match=message):
        build()
