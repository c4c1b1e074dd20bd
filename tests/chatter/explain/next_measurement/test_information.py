"""What a measurement is expected to say, against closed forms; the limits that a user gives."""

import math
from pathlib import Path

import numpy as np
import pytest

from chatter.description.case import loads
from chatter.description.errors import InputError
from chatter.explain.kinds.kind import Trial
from chatter.explain.measurement import Run
from chatter.explain.next_measurement.information import (
    information_of_signals,
    information_of_verdicts,
)
from chatter.explain.next_measurement.limits import is_within, limits_of
from chatter.explain.next_measurement.proposal import in_words

CASE = loads("""
title = "a cut"
[tool]
kind = "end mill"
teeth = 4
diameter = "16 mm"
[cut]
mode = "down"
spindle_speed = "6000 rpm"
feed_per_tooth = "0.05 mm"
axial_depth = "0.5 mm"
radial_depth = "6 mm"
""")
EVEN = np.array([0.5, 0.5])


def test_a_verdict_that_two_models_predict_surely_and_differently_gives_a_bit():
    assert information_of_verdicts(EVEN, np.array([0.0, 1.0])) == pytest.approx(1.0, abs=1e-9)
    assert information_of_verdicts(EVEN, np.array([0.7, 0.7])) == pytest.approx(0.0, abs=1e-9)


def test_a_verdict_says_less_where_one_model_is_likely_already():
    # entropy of 0.9 and 0.1
    expected = -(0.9 * math.log2(0.9) + 0.1 * math.log2(0.1))
    found = information_of_verdicts(np.array([0.9, 0.1]), np.array([0.0, 1.0]))
    assert found == pytest.approx(expected, abs=1e-9)


def test_a_signal_far_beyond_the_noise_gives_the_entropy_of_the_models():
    signals = [np.zeros(50), np.full(50, 30.0), np.full(50, -30.0)]
    weights = np.array([0.5, 0.25, 0.25])
    assert information_of_signals(weights, signals, 1.0) == pytest.approx(1.5, abs=1e-9)
    assert information_of_signals(weights, [signals[0]] * 3, 1.0) == pytest.approx(0.0, abs=1e-12)


def test_a_signal_within_the_noise_gives_less_than_the_true_information():
    """Two equal models, one reading two standard deviations apart: integrated numerically."""
    at = np.linspace(-10.0, 12.0, 20001)
    one, other = (np.exp(-0.5 * (at - m) ** 2) / math.sqrt(2.0 * math.pi) for m in (0.0, 2.0))
    mixed = 0.5 * (one + other)
    entropy = -np.sum(mixed * np.log2(mixed)) * (at[1] - at[0])
    true = entropy - 0.5 * math.log2(2.0 * math.pi * math.e)
    bound = information_of_signals(EVEN, [np.zeros(1), np.full(1, 2.0)], 1.0)
    assert 0.6 * true < bound < true


def test_limits_are_read_with_their_units():
    given = {"cut.spindle_speed": ["4000 rpm", "8000 rpm"], "cut.axial_depth": ["0.5 mm", "2 mm"]}
    found = limits_of(Path("measurement.toml"), given, CASE)
    assert found["cut.spindle_speed"] == pytest.approx((418.879, 837.758), rel=1e-5)
    assert found["cut.axial_depth"] == pytest.approx((0.5e-3, 2e-3))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("deep", "is not a table such as"),
        ({"cut.axial_depth": "2 mm"}, "is not a range such as"),
        ({"cut.axial_depth": ["2 mm", "1 mm"]}, "does not rise"),
        ({"cut.axial_depth": ["2 kg", "3 kg"]}, "axial_depth"),
        ({"cut.depht": ["1 mm", "2 mm"]}, "depht"),
    ],
)
def test_limits_that_are_none_are_refused(given, message):
    with pytest.raises(InputError, match=message):
        limits_of(Path("measurement.toml"), given, CASE)


@pytest.mark.parametrize(("depth", "within"), [(1e-3, True), (3e-3, False), (0.1e-3, False)])
def test_trials_beyond_the_limits_are_left_out(depth, within):
    limits = {"cut.axial_depth": (0.5e-3, 2e-3)}
    of_a_cut = Trial("", Run("", {"cut.axial_depth": depth}, {"time": np.zeros(2)}), {})
    point = {"spindle_speed": np.array([500.0]), "axial_depth": np.array([depth])}
    of_a_verdict = Trial("", Run("", {}, point), {})
    assert is_within(of_a_cut, limits, CASE) is within
    assert is_within(of_a_verdict, limits, CASE) is within


def test_words_name_the_measurement_and_what_it_decides():
    models = [{"model": "runout", "probability": 0.6}, {"model": "pitch", "probability": 0.4}]
    entry = {
        "between": models, "about": "model", "description": "a cut at 6000 rpm", "channel": "Fx",
        "expected_information_bit": 0.7, "worth_making": True,
    }  # fmt: skip
    words = in_words(entry)
    assert "a cut at 6000 rpm" in words
    assert "between runout and pitch" in words
    assert "expected to say more" in in_words({**entry, "worth_making": False})
    assert "is known that would say more" in in_words({"between": models, "about": "model"})
