"""The filter before the converter: what it lets pass, and its order, told by the records."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.signal

from benchmarks.blind_sets.milling_physics import TURN, Cut, arc_of, run
from chatter.description.case import loads
from chatter.explain.checking import checked
from chatter.explain.comparison import compare
from chatter.explain.kinds.kind_list import KINDS
from chatter.explain.prediction import Predictions
from chatter.explain.records.alignment import Recorded, aligned, low_pass
from chatter.explain.records.description import RecordDescription
from tests.chatter.explain.records.test_records import (
    CASE,
    CORNER,
    CUTS,
    as_in_the_case,
    measurement,
    plant,
)


@pytest.fixture(scope="module")
def case():
    return loads(CASE)


def without_a_resonance(frequency, share, corner, **further):
    """Harmonics of a model that lacks a resonance, and a record of 21 revolutions with it."""
    sampling, speed = 1e4, 100.0 * TURN
    orders = np.arange(1, 301)
    time = np.arange(2100) / sampling
    harmonics = np.where(orders % 2 == 0, 1.0 / orders**0.5, 0.1) * np.exp(1j * orders**2)
    ratio = orders * speed / (TURN * frequency)
    cut = harmonics * (1.0 + share / (1.0 - ratio**2 + 0.1j * ratio))
    b, a = scipy.signal.butter(4, TURN * corner, analog=True)
    filtered = cut * scipy.signal.freqs(b, a, orders * speed)[1]
    signal = np.real(filtered @ np.exp(1j * np.outer(orders, speed * time + 1.1)))
    deviation, usable = np.full(1, 1e-3), np.ones(time.size)
    recorded = Recorded(time, signal[None, :], deviation, usable, speed, TURN, **further)
    return harmonics[None, : recorded.orders.size], recorded


def test_a_model_that_lacks_something_is_laid_as_well_as_any_angle_and_filter_would():
    """A filter delays as an angle does: on the way to the best of both, neither stops the other.

    The model lacks a resonance at 1.1 kHz; every angle and corner is tried beside it.
    """
    known, recorded = without_a_resonance(1100.0, 0.3, 2900.0)
    sampling = recorded.sampling
    found = aligned(known, recorded)

    def left(start, corner):
        shown = recorded.folded(
            known * low_pass(recorded.frequency, sampling / corner, sampling).gain
            * np.exp(1j * recorded.orders * start)
        )  # fmt: skip
        return float(np.sum(np.abs(recorded.content * 1e-3 - shown) ** 2))

    starts = found.start + np.linspace(-0.15, 0.15, 61)
    best = min(left(one, corner) for one in starts for corner in np.geomspace(2500.0, 8000.0, 30))
    assert left(found.start, found.corner) <= best


def test_a_model_that_lacks_something_is_laid_beside_its_record_in_a_few_steps(monkeypatch):
    """What the model lacks curves the misfit too: steps without that do not converge in 20."""
    known, recorded = without_a_resonance(1500.0, 0.3, 4500.0)
    folded, asked = Recorded.folded, []
    monkeypatch.setattr(Recorded, "folded", lambda *given: asked.append(1) or folded(*given))
    aligned(known, recorded)
    assert len(asked) < 8


def test_of_two_filters_that_fit_at_all_the_better_is_found_from_that_of_the_record():
    misfit = [
        aligned(*without_a_resonance(1500.0, 0.7, 4500.0, **further)).misfit
        for further in ({}, {"filter_ratio": 5.0})
    ]
    assert misfit[1] < 0.96 * misfit[0]


def test_to_fold_weights_back_is_the_adjoint_of_folding():
    """Excluded samples too: mean products of any two harmonics differ from nothing then."""
    _, recorded = without_a_resonance(1500.0, 0.3, 4500.0)
    recorded = replace(recorded, usable=(np.arange(2100) % 7 > 1).astype(float))
    random = np.random.default_rng(1)

    def drawn(count):
        return random.standard_normal((2, count)) + 1j * random.standard_normal((2, count))

    harmonics, weights = drawn(recorded.orders.size), drawn(recorded.in_band)
    shown = np.sum(weights * recorded.folded(harmonics)).real
    assert np.sum(recorded.unfolded(weights) * harmonics).real == pytest.approx(shown, rel=1e-9)


def test_what_the_filter_lets_pass_above_the_band_is_predicted():
    """A tooth passing at 450 Hz behind a Butterworth filter at 0.4 of the sampling frequency.

    Its twelfth harmonic lies at 5.4 kHz and is recorded at 4.6 kHz.
    """
    sampling, speed, corner = 1e4, 450.0 * TURN / 2.0, 4e3
    orders = np.arange(1, 67)
    harmonics = np.where(orders % 2 == 0, 1.0 / orders**0.3, 0.02) * np.exp(1j * orders)
    time = np.arange(1500) / sampling
    b, a = scipy.signal.butter(4, TURN * corner, analog=True)
    filtered = harmonics * scipy.signal.freqs(b, a, orders * speed)[1]
    signal = np.real(filtered @ np.exp(1j * np.outer(orders, speed * time + 0.3)))
    one = np.ones(1)
    recorded = Recorded(time, signal[None, :], one, np.ones(time.size), speed, TURN)
    known = np.zeros((1, recorded.orders.size), dtype=np.complex128)
    known[0, : orders.size] = harmonics
    found = aligned(known, recorded)
    # the record does not end with a revolution
    assert found.corner == pytest.approx(corner, rel=0.01)
    assert np.std(found.predicted[0] - signal) < 0.01 * np.std(signal)
    # without what is folded back a tenth is missing
    in_band = filtered * (orders <= recorded.in_band)
    missed = np.real(in_band @ np.exp(1j * np.outer(orders, speed * time + 0.3))) - signal
    assert np.std(missed) > 0.1 * np.std(signal)


@pytest.mark.parametrize("order", [2, 6, 8])
def test_low_passes_of_any_order_are_those_of_butterworth(order):
    frequency = np.linspace(10.0, 9e3, 50)
    b, a = scipy.signal.butter(order, TURN * 3600.0, analog=True)
    expected = scipy.signal.freqs(b, a, TURN * frequency)[1]
    ratio, change = 1e4 / 3600.0, 1e-6
    assert low_pass(frequency, ratio, 1e4, order).gain == pytest.approx(expected, rel=1e-9)
    low, high = (low_pass(frequency, ratio + one, 1e4, order) for one in (-change, change))
    here = low_pass(frequency, ratio, 1e4, order)
    assert here.slope * 2.0 * change == pytest.approx(np.log(high.gain / low.gain), rel=1e-6)
    assert here.bend * 2.0 * change == pytest.approx(high.slope - low.slope, rel=1e-6)


def behind_a_filter(order):
    """Cuts recorded at 10 kHz behind scipy's low pass of an order at 3.4 kHz."""
    low_pass_of_it = scipy.signal.butter(order, CORNER, fs=40e3, output="sos")
    noise = np.random.default_rng(order)
    found = []
    for rpm, radial, kept in CUTS:
        speed = rpm * TURN / 60.0
        cut = Cut(speed, 0.08e-3, 0.6e-3, radial, *arc_of("down", radial, 10e-3), 0.0)
        signals = run(plant(), cut, (kept + 9.0) * TURN / speed, sampling=40e3)
        rows = scipy.signal.sosfilt(low_pass_of_it, signals.channels, axis=1)
        first = int(kept * TURN / speed * 40e3)
        rows = rows[:, first::4]
        rows = rows + 0.005 * rows.std(axis=1)[:, None] * noise.standard_normal(rows.shape)
        time = signals.time[first::4] - signals.time[first]
        found.append((time, rows, signals.angle[first::4], speed))
    return found


@pytest.mark.parametrize("order", [4, 8])
def test_the_order_of_the_filter_is_told_by_all_the_records(case, order, tmp_path):
    """Another order is taken only where it fits all the records together clearly better."""
    record = RecordDescription("cut", "unknown", 0.005)
    made = measurement(case, behind_a_filter(order), tmp_path, as_in_the_case, record)
    usable = checked(made).measurement
    found = KINDS["milling"].with_records_by(usable, case)
    assert {run.record.filter_order for run in found.runs} == {order}
    assert (found is usable) == (order == 4)
    for one in found.runs:
        assert one.record.aligned(one.of(case)).corner == pytest.approx(CORNER, rel=0.03)


def test_the_same_run_behind_another_filter_is_predicted_anew(case, tmp_path):
    """A search that changes the filter keeps its predictions, by the order of each."""
    record = RecordDescription("cut", "unknown", 0.005)
    made = measurement(case, behind_a_filter(8), tmp_path, as_in_the_case, record)
    usable = checked(made).measurement
    predictions = Predictions(KINDS["milling"])
    behind_fourth = {run.name: predictions.of(case, run) for run in usable.runs}
    found = predictions.kind.with_records_by(usable, case)
    for one in found.runs:
        fourth, eighth = behind_fourth[one.name], predictions.of(case, one)
        missed = [
            sum(np.sum((values[name] - one.signals[name]) ** 2) for name in values)
            for values in (fourth, eighth)
        ]
        assert missed[1] < 0.9 * missed[0]


def test_compare_predicts_behind_the_filter_that_explain_finds(case, tmp_path):
    record = RecordDescription("cut", "unknown", 0.005)
    made = measurement(case, behind_a_filter(8), tmp_path, as_in_the_case, record)
    # white noise of 0.005 is all that a prediction behind the right filter misses
    assert max(one.relative for one in compare(made).errors) < 0.01
