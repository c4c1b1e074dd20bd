"""Chatter lines of like size, one beside a strong cut, and what the machine does at rest."""

import numpy as np
import pytest
from scipy.signal import lfilter

from chatter.detection.spectral.recording import Recording
from chatter.monitoring.detect import detect
from tests.chatter.detection.made_recordings import (
    RATE,
    clock,
    during,
    forced_cut,
    machine,
    noise,
    ringing,
)

REVOLUTION, TEETH = 40.0, 4
#: Hz, between harmonics of the spindle
LINES = (613.0, 931.3, 1454.6)


def found_in(values, revolution=REVOLUTION, teeth=TEETH):
    recording = Recording("made", 1.0 / RATE, ("a",), ("acceleration",), values[:, None])
    return detect(recording, f"{60.0 * revolution} rpm", teeth)


def verdicts(found):
    return [one.verdict for one in found.segments]


def bare_line(random, time, frequency, power):
    """A limit cycle without sidebands, which wanders a little."""
    slow = np.interp(time, np.linspace(0.0, time[-1], 25), random.standard_normal(25))
    return np.sqrt(2.0 * power) * (1.0 + 0.05 * slow) * np.cos(2.0 * np.pi * frequency * time)


def cut_and_air(random, time):
    """A cut of unit power from 1.5 s on, without chatter, and noise of the machine."""
    cut = during(time, 1.5, 9.0) * forced_cut(random, time, REVOLUTION, TEETH)
    return cut + noise(random, time, 0.05) + 0.03 * machine(random, time, REVOLUTION)


@pytest.mark.parametrize("lines", [LINES[:2], LINES, LINES[1:2]])
def test_lines_that_come_with_the_cut_are_chatter_without_sidebands(lines):
    # the power of each alone is less than that of the cut
    random = np.random.default_rng(len(lines))
    time = clock(5.0)
    values = cut_and_air(random, time)
    for line in lines:
        values = values + during(time, 1.5, 9.0) * bare_line(random, time, line, 0.75)
    found = found_in(values)
    assert verdicts(found) == ["idle", "chatter"]
    assert found.segments[1].begin == pytest.approx(1.5, abs=0.4)
    assert min(abs(found.chatter_frequency / line - 1.0) for line in lines) < 1e-3
    for line in lines:
        assert f"{line:.0f}"[:3] in found.segments[1].reason


@pytest.mark.parametrize("lines", [LINES[:1], LINES])
def test_the_same_lines_are_none_of_a_cut_where_they_are_there_at_rest(lines):
    random = np.random.default_rng(3)
    time = clock(5.0)
    values = cut_and_air(random, time)
    # of all the power at rest, so that the level as a whole hardly tells the cut
    values = values + sum(bare_line(random, time, line, 4.0 / len(lines)) for line in lines)
    found = found_in(values)
    assert verdicts(found) == ["idle", "stable"]
    assert found.segments[0].end == pytest.approx(1.5, abs=0.4)


@pytest.mark.parametrize("seed", range(3))
def test_modes_that_the_noise_of_the_cut_shakes_are_no_chatter(seed):
    random = np.random.default_rng(seed)
    time = clock(6.0)
    shaken = ringing(random, time, 613.0, 0.01) + ringing(random, time, 931.3, 0.006)
    values = cut_and_air(random, time) + 0.8 * during(time, 1.5, 9.0) * shaken
    assert "chatter" not in verdicts(found_in(values))


@pytest.mark.parametrize("seed", range(3))
def test_a_stable_cut_before_chatter_is_not_idle(seed):
    # 16 dB below the chatter: a step of depth from a stable cut into one that chatters
    random = np.random.default_rng(seed)
    time = clock(4.0)
    grown = 6.0 * during(time, 2.0, 9.0) * bare_line(random, time, 931.3, 1.0)
    values = forced_cut(random, time, REVOLUTION, TEETH) + noise(random, time, 0.05) + grown
    found = found_in(values)
    assert verdicts(found) == ["stable", "chatter"]
    assert found.segments[1].begin == pytest.approx(2.0, abs=0.4)


def test_a_step_of_depth_is_stable_on_both_sides():
    random = np.random.default_rng(5)
    time = clock(4.0)
    deeper = 0.25 + 0.75 * during(time, 2.0, 9.0)
    values = deeper * forced_cut(random, time, REVOLUTION, TEETH) + noise(random, time, 0.03)
    assert verdicts(found_in(values)) == ["stable"]


def test_a_bearing_that_is_heard_at_rest_does_not_speak_for_another_speed():
    random = np.random.default_rng(6)
    time = clock(6.0)
    struck = np.diff(np.floor(4.37 * REVOLUTION * time), prepend=0.0) > 0.0
    pole = 2.0 * np.pi * 3100.0 / RATE
    radius = np.exp(-0.02 * pole)
    rings = lfilter([1.0], [1.0, -2.0 * radius * np.cos(pole), radius**2], struck.astype(float))
    found = found_in(cut_and_air(random, time) + 0.8 * rings / rings.std())
    assert verdicts(found) == ["idle", "stable"]
    assert not any("speaks for" in note for note in found.notes)
