"""A line off the harmonics: of a cut that chatters throughout, or of the machine."""

import numpy as np
import pytest

from chatter.detection.spectral.envelope import envelope_kurtosis
from chatter.detection.spectral.frame_evidence import evidence_of
from chatter.detection.spectral.recording import Recording
from chatter.detection.spectral.running_detection import RunningDetection
from chatter.detection.spectral.segments import segments_of
from tests.chatter.detection.made_recordings import (
    RATE,
    chatter_line,
    clock,
    forced_cut,
    machine,
    noise,
    ringing,
)

REVOLUTION, TEETH = 40.0, 4


def recording(values):
    return Recording("made", 1.0 / RATE, ("a",), ("sound",), values[:, None])


def verdicts(values, revolution=REVOLUTION, teeth=TEETH):
    """Of the whole, and of the same while it goes on."""
    start = recording(values)
    whole = segments_of(evidence_of(start, revolution, teeth))
    running = RunningDetection(start, revolution, teeth).take(values[:, None])
    return whole, [one.verdict for one in running]


@pytest.mark.parametrize("seed", range(2))
def test_a_cut_that_chatters_throughout_is_chatter_in_both(seed):
    # 90 % of the power at one line and its sidebands, no idle part, no growth, as steady as can be
    random = np.random.default_rng(seed)
    time = clock(3.0)
    modulated = 1.0 + 0.3 * np.cos(2.0 * np.pi * TEETH * REVOLUTION * time + 0.4)
    modulated += 0.15 * np.cos(4.0 * np.pi * TEETH * REVOLUTION * time + 1.1)
    line = np.sqrt(2.0) * np.cos(2.0 * np.pi * 931.3 * time)
    values = 3.0 * modulated * line + forced_cut(random, time, REVOLUTION, TEETH)
    whole, running = verdicts(values + noise(random, time))
    assert [one.verdict for one in whole] == ["chatter"]
    assert whole[0].chatter_frequency == pytest.approx(931.3, rel=1e-3)
    assert running.count("chatter") > 0.9 * len(running)


def test_a_limit_cycle_needs_no_sidebands_where_teeth_cut():
    random = np.random.default_rng(5)
    time = clock(4.0)
    phase = 2.0 * np.pi * np.cumsum(931.3 + 0.8 * np.sin(2.0 * np.pi * 0.6 * time)) / RATE
    line = np.abs(1.0 + 0.15 * np.sin(9.0 * time)) * np.cos(phase)
    values = 2.0 * line + forced_cut(random, time, REVOLUTION, TEETH) + noise(random, time)
    whole, _ = verdicts(values)
    assert [one.verdict for one in whole] == ["chatter"]


@pytest.mark.parametrize("seed", range(2))
def test_a_mode_that_noise_shakes_is_no_chatter_in_either(seed):
    random = np.random.default_rng(10 + seed)
    time = clock(3.0)
    cut = forced_cut(random, time, REVOLUTION, TEETH)
    values = cut + 2.0 * ringing(random, time, 871.0, 0.01) + noise(random, time)
    whole, running = verdicts(values)
    assert "chatter" not in {one.verdict for one in whole}
    assert "chatter" not in running


def test_digital_silence_does_not_say_what_the_machine_sounds_like():
    random = np.random.default_rng(3)
    time = clock(5.0)
    idle = 2.0 * ringing(random, time, 1423.0, 0.003) + machine(random, time, REVOLUTION)
    values = np.where(time < 1.5, 0.0, idle + noise(random, time))
    whole, _ = verdicts(values)
    assert (whole[0].verdict, whole[0].reason) == ("idle", "nothing was recorded")
    assert whole[0].end == pytest.approx(1.5, abs=0.4)
    assert "chatter" not in {one.verdict for one in whole}


@pytest.mark.parametrize("mains", [50.0, 60.0])
def test_hum_of_the_mains_that_is_clipped_is_no_chatter(mains):
    # 14.286 Hz: 3.5 revolutions from one harmonic of 50 Hz to the next, as sidebands lie
    random = np.random.default_rng(4)
    time = clock(4.0)
    hum = sum(np.cos(2.0 * np.pi * k * mains * time + k) / np.sqrt(k) for k in (1, 2, 3, 5, 7))
    values = np.clip(hum, -0.9, 0.9) + noise(random, time)
    whole, running = verdicts(values, revolution=mains / 3.5, teeth=6)
    assert "chatter" not in {one.verdict for one in whole}
    assert "chatter" not in running


def test_a_line_near_a_harmonic_is_told_from_it_by_longer_frames():
    # 0.06 of a revolution off: frames of 24 revolutions have lines half as wide as 0.083
    random = np.random.default_rng(6)
    time = clock(6.0)
    frequency = 9.06 * 100.0
    values = forced_cut(random, time, 100.0, 4, mode=2000.0) + noise(random, time)
    values += 2.0 * chatter_line(random, time, frequency, 400.0)
    whole, _ = verdicts(values, revolution=100.0)
    found = [one for one in whole if one.verdict == "chatter"]
    assert len(found) == 1
    assert found[0].chatter_frequency == pytest.approx(frequency, rel=1e-3)


def test_the_envelope_of_a_limit_cycle_and_of_shaken_noise():
    # Rice 1944: the envelope of narrow-band Gaussian noise is Rayleigh's, E[A^4] = 2 E[A^2]^2;
    # of A (1 + m cos wt): (1 + 3 m^2 + 3 m^4 / 8) / (1 + m^2 / 2)^2
    random = np.random.default_rng(7)
    time = clock(60.0)
    steady = recording(np.cos(2.0 * np.pi * 900.5 * time))
    assert envelope_kurtosis(steady, 0.0, 60.0, 900.5, 50.0) == pytest.approx(1.0, abs=1e-3)
    shaken = recording(ringing(random, time, 917.0, 0.002))
    assert envelope_kurtosis(shaken, 0.0, 60.0, 917.0, 50.0) == pytest.approx(2.0, abs=0.15)
    slow = recording((1.0 + 0.5 * np.cos(2.0 * np.pi * time)) * np.cos(2.0 * np.pi * 917.0 * time))
    expected = (1.0 + 3.0 * 0.25 + 3.0 * 0.0625 / 8.0) / (1.0 + 0.125) ** 2
    assert envelope_kurtosis(slow, 0.0, 60.0, 917.0, 50.0) == pytest.approx(expected, rel=0.01)
