"""Chatter of a small share of the power, and what looks like it: shaken modes, other lines."""

import numpy as np
import pytest

from chatter.detection.spectral.recording import Recording
from chatter.monitoring.detect import detect
from tests.chatter.detection.made_recordings import RATE, clock, forced_cut, noise, ringing

REVOLUTION, TEETH, LINE = 40.0, 4, 931.3
TOOTH = REVOLUTION * TEETH
TIME = clock(3.0)


def modulated(random, wave):
    """A wave that is louder while a tooth cuts: with sidebands one tooth apart."""
    phase = 2.0 * np.pi * TOOTH * TIME + random.uniform(0.0, 6.0)
    signal = np.exp(3.0 * (np.cos(phase) - 1.0)) * wave
    return signal / signal.std()


def limit_cycle(random):
    """A line of an amplitude that wanders a little."""
    slow = np.interp(TIME, np.linspace(0.0, TIME[-1], 20), random.standard_normal(20))
    return (1.0 + 0.1 * slow) * np.cos(2.0 * np.pi * LINE * TIME)


def found_in(random, beside, power, teeth=TEETH):
    """Verdict on a cut of unit power with another wave of some power."""
    values = forced_cut(random, TIME, REVOLUTION, TEETH) + np.sqrt(power) * beside
    values += noise(random, TIME, 0.02)
    recording = Recording("made", 1.0 / RATE, ("a",), ("acceleration",), values[:, None])
    return detect(recording, f"{60.0 * REVOLUTION} rpm", teeth)


@pytest.mark.parametrize("power", [0.05, 0.2])
def test_a_small_limit_cycle_with_sidebands_at_the_teeth_is_chatter(power):
    random = np.random.default_rng(3)
    found = found_in(random, modulated(random, limit_cycle(random)), power)
    assert found.verdict == "chatter"
    apart = (found.chatter_frequency - LINE) / TOOTH  # a sideband may be as large
    assert abs(apart - round(apart)) * TOOTH < 1.0
    assert "sidebands at the teeth" in found.segments[0].reason


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("power", [0.1, 0.5])
def test_a_mode_that_the_noise_of_the_cut_shakes_is_none(seed, power):
    random = np.random.default_rng(seed)
    found = found_in(random, modulated(random, ringing(random, TIME, LINE, 0.004)), power)
    assert found.verdict != "chatter"


def test_a_line_of_the_machine_is_none():
    random = np.random.default_rng(1)
    line = np.sqrt(2.0) * np.cos(2.0 * np.pi * LINE * TIME)
    assert found_in(random, line, 0.1).verdict == "stable"
