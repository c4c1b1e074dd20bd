"""A spindle that changes its speed in the record: its harmonics are no chatter."""

import numpy as np
import pytest

from chatter.detection.spectral.recording import Recording
from chatter.detection.spectral.varied_speed import varied_speed
from chatter.monitoring.detect import detect
from tests.chatter.detection.made_recordings import RATE, clock, during, noise

SPEED, TEETH, DURATION = 50.0, 4, 4.0  # Hz, and s
#: relative speed over time, s: of an override that is turned, and of a spindle that runs up or down
COURSES = {
    "override of 108 % halfway": lambda time: 1.0 + 0.08 * np.clip((time - 2.0) / 0.1, 0.0, 1.0),
    "override of 92 % for a second": lambda time: 1.0 - 0.08 * during(time, 1.5, 2.5),
    "run up by 5 %": lambda time: 1.0 + 0.05 * time / DURATION,
    "run down by 10 %": lambda time: 1.0 - 0.1 * time / DURATION,
}
CHATTER = 818.0


def record(course, chatter=0.0, seed=1):
    """Harmonics of a cutter with runout over the spindle angle, and chatter from 2.6 s on."""
    random, time = np.random.default_rng(seed), clock(DURATION)
    angle = 2.0 * np.pi * SPEED * np.cumsum(course(time)) / RATE
    heights = 1.0 + 0.2 * random.standard_normal(TEETH)
    cut = np.zeros_like(time)
    for order in range(1, 60):
        line = np.sum(heights * np.exp(-2j * np.pi * order * np.arange(TEETH) / TEETH))
        cut += np.real(line * np.exp(-((order / 20.0) ** 2) + 1j * order * angle))
    cut /= cut.std()
    sidebands = 1.0 + 0.4 * np.cos(TEETH * angle) + 0.2 * np.cos(2.0 * TEETH * angle)
    line = sidebands * np.cos(2.0 * np.pi * CHATTER * time) * during(time, 2.6, 3.8)
    values = cut * during(time, 0.4, 3.8) + chatter * line + noise(random, time)
    return Recording("made", 1.0 / RATE, ("a",), ("sound",), values[:, None])


def found_in(recording):
    return detect(recording, 2.0 * np.pi * SPEED, TEETH)


@pytest.mark.parametrize("name", COURSES)
def test_a_stable_cut_is_so_whatever_its_speed_does(name):
    found = found_in(record(COURSES[name]))
    assert {one.verdict for one in found.segments} == {"stable", "idle"}
    assert any("the spindle changes its speed" in note for note in found.notes)


def test_the_speed_of_every_segment_is_its_own():
    course = COURSES["override of 108 % halfway"]
    speed = varied_speed(record(course), SPEED, TEETH)
    time = np.array([0.8, 1.6, 2.5, 3.4])
    assert speed.at(time) == pytest.approx(SPEED * course(time), rel=2e-3)


@pytest.mark.parametrize("name", COURSES)
def test_chatter_is_found_at_its_frequency_and_time(name):
    found = found_in(record(COURSES[name], chatter=3.0))
    assert found.verdict == "chatter"
    assert found.chatter_frequency == pytest.approx(CHATTER, rel=0.01)
    (begin,) = {one.begin for one in found.segments if one.verdict == "chatter"}
    # a frame of 24 revolutions is 0.48 s long
    assert begin == pytest.approx(2.6, abs=0.25)


def test_a_speed_that_stays_is_one_speed():
    assert varied_speed(record(np.ones_like), SPEED, TEETH) is None
    assert varied_speed(record(np.ones_like, chatter=3.0), SPEED, TEETH) is None
