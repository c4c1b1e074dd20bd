"""Chatter in made recordings: every line in them is known."""

import itertools
import math

import numpy as np
import pytest

from chatter.description.errors import InputError
from chatter.detection.spectral.frame_evidence import evidence_of
from chatter.detection.spectral.recording import Recording
from chatter.detection.spectral.segments import segments_of
from tests.chatter.detection.made_recordings import (
    RATE,
    chatter_line,
    clock,
    during,
    forced_cut,
    machine,
    noise,
    ringing,
)


def recording(values, quantity="acceleration", tacho=None):
    return Recording("made", 1.0 / RATE, ("a",), (quantity,), values[:, None], 0.0, tacho)


def detected(values, spindle_frequency, teeth, **given):
    evidence = evidence_of(recording(values, **given), spindle_frequency, teeth)
    return segments_of(evidence), evidence


def verdicts(segments):
    return {one.verdict for one in segments}


CUTS = [(25.0, 6), (50.0, 4), (83.3, 3), (150.0, 2)]


@pytest.mark.parametrize(("revolution", "teeth"), CUTS)
@pytest.mark.parametrize("known", ["speed and teeth", "speed 6 % off", "speed", "nothing"])
def test_a_forced_cut_is_stable_whatever_its_runout(revolution, teeth, known):
    random = np.random.default_rng(int(revolution))
    time = clock(4.0)
    cut = forced_cut(random, time, revolution, teeth, runout=0.4)
    values = cut + 0.4 * ringing(random, time, 870.0, 0.01) + noise(random, time)
    values = values + 0.1 * machine(random, time, revolution)
    speed = {"nothing": None, "speed 6 % off": 1.06 * revolution}.get(known, revolution)
    segments, evidence = detected(values, speed, teeth if "teeth" in known else None)
    assert verdicts(segments) == {"stable"}
    if speed is not None:
        assert evidence.revolution.mean == pytest.approx(revolution, rel=2e-3)


@pytest.mark.parametrize(("revolution", "teeth"), CUTS)
@pytest.mark.parametrize("known", ["speed and teeth", "speed 6 % off", "speed"])
def test_chatter_is_found_where_it_is(revolution, teeth, known):
    random = np.random.default_rng(10 + int(revolution))
    time = clock(6.0)
    frequency = (round(930.0 / revolution) + 0.37) * revolution
    chatter = chatter_line(random, time, frequency, teeth * revolution)
    values = during(time, 1.0, 5.5) * forced_cut(random, time, revolution, teeth)
    values = values + during(time, 2.5, 4.5) * 2.0 * chatter
    values = values + noise(random, time, 0.05) + 0.05 * machine(random, time, revolution)
    speed = 1.06 * revolution if "off" in known else revolution
    segments, _ = detected(values, speed, teeth if "teeth" in known else None)
    found = [one for one in segments if one.verdict == "chatter"]
    assert len(found) == 1
    assert found[0].chatter_frequency == pytest.approx(frequency, rel=2e-3)
    assert found[0].bifurcation == "hopf"
    # within half a frame of 24 revolutions, or a quarter of a second
    within = 0.5 * max(24.0 / revolution, 0.25)
    assert found[0].begin == pytest.approx(2.5, abs=within)
    assert found[0].end == pytest.approx(4.5, abs=within)
    assert segments[0].verdict == "idle"
    assert segments[0].end == pytest.approx(1.0, abs=within)
    assert (segments[0].begin, segments[-1].end) == (0.0, pytest.approx(6.0))
    assert all(a.end == b.begin for a, b in itertools.pairwise(segments))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("known", [(40.0, 4), (40.0, None), (None, None)])
def test_idle_noise_with_lines_of_the_machine_is_no_chatter(seed, known):
    random = np.random.default_rng(seed)
    time = clock(4.0)
    values = machine(random, time, 40.0) + noise(random, time)
    assert "chatter" not in verdicts(detected(values, *known)[0])


def test_a_line_that_is_there_at_rest_is_no_chatter():
    random = np.random.default_rng(3)
    time = clock(5.0)
    values = during(time, 1.5, 4.0) * forced_cut(random, time, 50.0, 4) + noise(random, time, 0.05)
    values += 2.0 * np.cos(2.0 * np.pi * 1234.0 * time)
    segments, _ = detected(values, 50.0, 4)
    assert verdicts(segments) <= {"idle", "stable", "not judged"}


def test_a_spindle_that_runs_up_is_no_chatter():
    random = np.random.default_rng(4)
    time = clock(4.0)
    sweep = np.cos(2.0 * np.pi * (500.0 * time + 300.0 * time**2)) * (time < 3.0)
    values = sweep + noise(random, time)
    assert "chatter" not in verdicts(detected(values, 50.0, 4)[0])


@pytest.mark.parametrize("teeth", [3, 5])
def test_half_the_tooth_passing_frequency_of_odd_teeth_is_a_flip(teeth):
    random = np.random.default_rng(5)
    time = clock(4.0)
    revolution, tooth = 60.0, 60.0 * teeth
    flip = chatter_line(random, time, 3.5 * tooth, tooth)
    values = during(time, 0.5, 4.0) * (forced_cut(random, time, revolution, teeth) + 2.0 * flip)
    segments, _ = detected(values + noise(random, time, 0.05), revolution, teeth)
    found = [one for one in segments if one.verdict == "chatter"]
    assert [one.bifurcation for one in found] == ["flip"]
    assert found[0].chatter_frequency == pytest.approx(3.5 * tooth, rel=1e-3)


def test_every_second_tooth_of_even_teeth_is_a_flip_only_where_it_grew():
    random = np.random.default_rng(6)
    time = clock(6.0)
    revolution, teeth, tooth = 60.0, 4, 240.0
    cut = forced_cut(random, time, revolution, teeth, runout=0.0) + noise(random, time, 0.05)
    alternating = chatter_line(random, time, 3.5 * tooth, tooth)
    grown, _ = detected(cut + during(time, 3.0, 6.0) * 2.0 * alternating, revolution, teeth)
    found = [one for one in grown if one.verdict == "chatter"]
    assert [one.bifurcation for one in found] == ["flip"]
    assert found[0].begin == pytest.approx(3.0, abs=0.3)
    throughout, _ = detected(cut + 2.0 * alternating, revolution, teeth)
    assert verdicts(throughout) == {"stable"}
    assert throughout[0].confidence <= 0.6
    assert "every second tooth" in throughout[0].reason


def test_unbalance_that_is_left_as_a_cut_of_two_teeth_ends_is_no_flip():
    random = np.random.default_rng(11)
    time = clock(4.0)
    # half the tooth passing frequency of two teeth is the revolution
    unbalance = 2.0 * np.cos(2.0 * np.pi * 70.0 * time) + np.cos(2.0 * np.pi * 140.0 * time)
    cut = 14.0 * during(time, 0.0, 2.5) * forced_cut(random, time, 70.0, 2, runout=0.0, mode=1500.0)
    values = cut + unbalance + noise(random, time)
    assert "chatter" not in verdicts(detected(values, 70.0, 2)[0])


def test_silence_of_a_recorder_is_idle():
    random = np.random.default_rng(12)
    time = clock(4.0)
    values = forced_cut(random, time, 50.0, 4) + noise(random, time)
    segments, _ = detected(np.where(time < 1.0, 0.0, values), 50.0, 4)
    assert [one.verdict for one in segments] == ["idle", "stable"]


def test_a_tacho_gives_the_speed_whatever_is_stated():
    random = np.random.default_rng(7)
    time = clock(4.0)
    tacho = (np.mod(50.0 * time, 1.0) < 0.05).astype(float)
    values = forced_cut(random, time, 50.0, 4) + noise(random, time)
    segments, evidence = detected(values, 70.0, 4, tacho=tacho)
    assert evidence.revolution.source == "tacho"
    assert evidence.revolution.mean == pytest.approx(50.0, rel=1e-3)
    assert verdicts(segments) == {"stable"}


def test_without_lines_there_is_no_speed_and_no_verdict():
    random = np.random.default_rng(8)
    segments, evidence = detected(random.standard_normal(40_000), None, None)
    assert evidence.revolution is None
    assert verdicts(segments) == {"not judged"}
    assert math.isnan(segments[0].chatter_frequency)


def test_few_revolutions_are_not_judged():
    random = np.random.default_rng(9)
    time = clock(0.1)
    segments, _ = detected(forced_cut(random, time, 50.0, 4), 50.0, 4)
    assert verdicts(segments) == {"not judged"}
    assert "5.0 revolutions" in segments[0].reason


@pytest.mark.parametrize(
    ("values", "message"),
    [(np.zeros(100), "100 samples"), (np.full(1000, np.nan), "a: sample 1 is not finite")],
)
def test_a_recording_of_no_use_is_refused(values, message):
    with pytest.raises(InputError, match=message):
        recording(values)
