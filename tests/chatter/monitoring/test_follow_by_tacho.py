"""A file that grows is followed by the pulses of its tacho."""

import time as clock_time

import numpy as np
import pytest

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
from tests.command_line import chatter_command

REVOLUTION, TEETH, FREQUENCY = 50.0, 4, 1230.0


def pulses_of(turned, pulses=1):
    """Signal of a tacho that is high for a tenth of each pulse, turned so many revolutions."""
    return 5.0 * ((pulses * turned) % 1.0 < 0.1)


def made(begin, seconds, turned):
    """Cut of a spindle that has turned so many revolutions at each time; chatter from a time on."""
    random, time = np.random.default_rng(1), clock(seconds)
    even = forced_cut(random, time, REVOLUTION, TEETH)
    cut = np.interp(turned / REVOLUTION, time, even)
    chatters = chatter_line(random, time, FREQUENCY, TEETH * REVOLUTION)
    return 0.05 * (cut + noise(random, time) + 4.0 * during(time, begin, seconds) * chatters)


def observed(values, tacho, stated=None, *, once=False):
    """Observations of samples that come no faster than windows are judged together."""
    start = Recording(
        "made", 1.0 / RATE, ("a",), ("sound",), values[:20000, None], 0.0, tacho[:20000], None, once
    )
    running = RunningDetection(start, stated, TEETH)
    found = []
    for part in np.array_split(np.column_stack([values, tacho]), 40):
        found += running.take(part)
        deadline = clock_time.monotonic() + 20.0
        while running.judges_together and clock_time.monotonic() < deadline:
            clock_time.sleep(0.005)
    return found


@pytest.mark.parametrize(("begin", "verdict"), [(9.0, "stable"), (1.5, "chatter")])
def test_the_speed_is_that_of_the_tacho(begin, verdict):
    turned = REVOLUTION * clock(4.0)
    found = observed(made(begin, 4.0, turned), pulses_of(turned))
    assert found[-1].spindle_frequency == pytest.approx(REVOLUTION, rel=1e-3)
    assert found[-1].verdict == verdict
    assert not any(one.speed_is_refuted or one.speed_is_corrected for one in found)
    if verdict == "chatter":
        assert found[-1].chatter_frequency == pytest.approx(FREQUENCY, rel=1e-3)
        assert "chatter" not in {one.verdict for one in found if one.time < begin}


def test_a_speed_that_rises_by_a_sixth_is_followed():
    """By its lines it would have to be within 12 % of what was stated."""
    time = clock(5.0)
    frequency = REVOLUTION * (0.86 + 0.14 * np.clip((time - 1.5) / 2.0, 0.0, 1.0))
    turned = np.cumsum(frequency) / RATE
    found = observed(made(9.0, 5.0, turned), pulses_of(turned))
    first = next(one for one in found if one.time > 1.0)
    assert first.spindle_frequency == pytest.approx(0.86 * REVOLUTION, rel=2e-3)
    assert found[-1].spindle_frequency == pytest.approx(REVOLUTION, rel=2e-3)
    assert found[-1].verdict == "stable"
    assert "chatter" not in {one.verdict for one in found}


@pytest.mark.parametrize("stated", [REVOLUTION, 1.06 * REVOLUTION])
def test_a_stated_speed_tells_the_pulses_of_a_revolution(stated):
    turned = REVOLUTION * clock(2.0)
    found = observed(made(9.0, 2.0, turned), pulses_of(turned, 3), stated)
    assert found[0].spindle_frequency == pytest.approx(REVOLUTION, rel=2e-3)
    assert not any(one.speed_is_corrected for one in found)


def test_the_lines_tell_the_pulses_of_a_revolution():
    turned = REVOLUTION * clock(4.0)
    found = observed(made(9.0, 4.0, turned), pulses_of(turned, 5))
    assert found[-1].spindle_frequency == pytest.approx(REVOLUTION, rel=2e-3)
    assert found[-1].speed_is_corrected
    assert found[-1].verdict == "stable"
    assert "chatter" not in {one.verdict for one in found}


def table(folder, heading, *columns):
    rows = "".join(
        ",".join(f"{one:.6g}" for one in row) + "\n" for row in zip(*columns, strict=True)
    )
    path = folder / "cut.csv"
    path.write_text(f"{heading}\n{rows}", encoding="utf-8")
    return path


def test_a_table_with_a_tacho_needs_no_speed(tmp_path):
    time = clock(2.0)
    turned = REVOLUTION * time
    values = made(0.8, 2.0, turned)
    heading = "time [s],tacho [V],ax [m/s^2]"
    path = table(tmp_path, heading, time, pulses_of(turned), values)
    found = list(follow(path, teeth=TEETH, patience=0.05))
    assert found[0].spindle_frequency == pytest.approx(REVOLUTION, rel=2e-3)
    assert found[-1].verdict == "chatter"


def test_a_table_with_a_measured_speed_needs_none(tmp_path):
    time = clock(2.0)
    speed = np.full(time.size, 60.0 * REVOLUTION)
    values = made(9.0, 2.0, REVOLUTION * time)
    path = table(tmp_path, "time [s],spindle speed [rpm],ax [m/s^2]", time, speed, values)
    found = list(follow(path, teeth=TEETH, patience=0.05))
    assert found[0].spindle_frequency == pytest.approx(REVOLUTION, rel=2e-3)
    assert found[-1].verdict == "stable"


def test_a_tacho_without_pulses_asks_for_the_speed(tmp_path):
    time = clock(1.0)
    path = table(
        tmp_path, "time [s],tacho [V],ax [m/s^2]", time, np.zeros(time.size), made(9.0, 1.0, time)
    )
    done = chatter_command("detect", path, "--follow")
    assert done.exit_code == 2
    assert "no pulses of a tacho" in done.stderr
