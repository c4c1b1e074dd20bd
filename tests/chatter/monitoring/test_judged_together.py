"""What several windows of a recording that goes on show together, and how long a verdict holds."""

import time as clock_time

import numpy as np
import pytest
import scipy.io.wavfile

from chatter.detection.spectral.recording import Recording
from chatter.detection.spectral.running_detection import RunningDetection
from chatter.monitoring.follow import follow
from tests.chatter.detection.made_recordings import (
    RATE,
    chatter_line,
    clock,
    during,
    forced_cut,
    noise,
)
from tests.chatter.detection.test_several_lines import (
    LINES,
    REVOLUTION,
    TEETH,
    bare_line,
    cut_and_air,
)

#: s that a look at all windows may take
PATIENCE = 60.0


def observed(values, revolution=REVOLUTION, teeth=TEETH, rate=RATE):
    """Observations of a recording that comes in parts, no faster than it is judged."""
    start = Recording("made", 1.0 / rate, ("a",), ("acceleration",), values[:256, None])
    running = RunningDetection(start, revolution, teeth)
    found = []
    for part in np.array_split(values[:, None], 40):
        found += running.take(part)
        deadline = clock_time.monotonic() + PATIENCE
        while running.judges_together and clock_time.monotonic() < deadline:
            clock_time.sleep(0.005)
    return found


def test_two_lines_without_sidebands_are_seen_together():
    random = np.random.default_rng(2)
    time = clock(9.0)
    values = cut_and_air(random, time)
    for line in LINES[:2]:
        values = values + during(time, 1.5, 9.0) * bare_line(random, time, line, 0.75)
    last = observed(values)[-1]
    assert last.verdict == "chatter"
    assert min(abs(last.chatter_frequency / line - 1.0) for line in LINES[:2]) < 1e-3
    assert last.share > 0.3


def test_the_same_lines_at_rest_are_not():
    random = np.random.default_rng(3)
    time = clock(9.0)
    values = cut_and_air(random, time)
    values = values + sum(bare_line(random, time, line, 2.0) for line in LINES[:2])
    assert "chatter" not in {one.verdict for one in observed(values)}


@pytest.mark.parametrize("revolution", [100.0, 300.0])
def test_chatter_as_steady_as_a_line_of_the_mains_goes_on_as_long_as_it_lasts(revolution):
    # longer than what is remembered of the time before it
    random = np.random.default_rng(4)
    time = clock(10.0)
    frequency = 8.37 * revolution
    line = 4.0 * np.cos(2.0 * np.pi * frequency * time)
    values = forced_cut(random, time, revolution, TEETH) + noise(random, time)
    found = observed(values + during(time, 3.0, 8.0) * line, revolution)
    assert "chatter" not in {one.verdict for one in found if one.time < 3.0}
    assert {one.verdict for one in found if 4.0 < one.time < 8.0} == {"chatter"}
    assert found[-1].verdict != "chatter"


def test_fast_spindles_are_judged_every_20_ms():
    random = np.random.default_rng(5)
    time = clock(3.0)
    revolution = 400.0
    values = forced_cut(random, time, revolution, TEETH) + noise(random, time)
    chatter_part = chatter_line(random, time, 8.37 * revolution, TEETH * revolution)
    found = observed(values + 4.0 * during(time, 1.5, 3.0) * chatter_part, revolution)
    np.testing.assert_allclose(np.diff([one.time for one in found]), 0.02, atol=1.0 / RATE)
    first = next(one for one in found if one.verdict == "chatter")
    # the window is a quarter of a second, and five a quarter of it apart have to show the line
    assert 1.5 < first.time < 1.5 + 0.25 * (1.0 + 5.0 / 4.0)
    assert found[-1].chatter_frequency == pytest.approx(8.37 * revolution, rel=1e-3)


def test_verdicts_that_take_long_are_no_end_of_the_file(tmp_path, monkeypatch):
    path = tmp_path / "cut.wav"
    random = np.random.default_rng(6)
    time = clock(2.0)
    values = forced_cut(random, time, REVOLUTION, TEETH) + noise(random, time)
    scipy.io.wavfile.write(path, int(RATE), (1000.0 * values).astype(np.int16))
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    now = [0.0]
    take = RunningDetection.take

    def slow_take(running, samples):
        now[0] += 100.0
        path.write_bytes(whole)
        return take(running, samples)

    def ticking():
        now[0] += 0.1
        return now[0]

    monkeypatch.setattr(RunningDetection, "take", slow_take)
    last = list(follow(path, f"{60.0 * REVOLUTION} rpm", TEETH, patience=1.0, clock=ticking))[-1]
    assert last.time == pytest.approx(2.0, abs=1.0 / REVOLUTION)
