"""A spindle speed that is stated wrong: mistyped, an override, the record of another cut."""

from dataclasses import replace

import numpy as np
import pytest

import chatter
from chatter.detection.spectral import frame_evidence
from chatter.detection.spectral.frame_evidence import evidence_at
from chatter.detection.spectral.recording import Recording
from chatter.detection.spectral.revolution_frequency import stated_alone
from chatter.detection.spectral.segments import Segment, segments_of
from chatter.detection.spectral.stated_speed import REFUTED, OtherSpeed
from chatter.detection.spectral.two_speeds import _joined, judged
from tests.chatter.detection.made_recordings import (
    RATE,
    chatter_line,
    clock,
    during,
    forced_cut,
    machine,
    noise,
)
from tests.places import EXAMPLES

FACTORS = (0.5, 0.8, 0.9, 1.1, 1.2, 1.5, 2.0)
#: speed, Hz, teeth and runout
CUTS = [
    (70.0, 1, 0.1), (50.0, 2, 0.1), (45.0, 3, 0.0), (50.0, 4, 0.1), (40.0, 5, 0.05), (30.0, 6, 0.2),
]  # fmt: skip


def cut(revolution, teeth, runout, chatters):
    """A cut that chatters throughout 0.37 revolutions off a harmonic, or that does not."""
    random = np.random.default_rng(int(revolution) + teeth)
    time = clock(3.0)
    values = forced_cut(random, time, revolution, teeth, runout) + noise(random, time)
    if chatters:
        frequency = (round(930.0 / revolution) + 0.37) * revolution
        values = values + 1.8 * chatter_line(random, time, frequency, teeth * revolution)
    return Recording("made", 1.0 / RATE, ("a",), ("sound",), values[:, None])


def detected(recording, frequency, teeth):
    return chatter.detect(recording, f"{60.0 * frequency} rpm", teeth)


@pytest.mark.parametrize(("revolution", "teeth", "runout"), CUTS)
def test_chatter_is_stable_at_no_speed(revolution, teeth, runout):
    recording = cut(revolution, teeth, runout, chatters=True)
    for factor in FACTORS:
        found = detected(recording, factor * revolution, teeth)
        assert found.verdict in ("chatter", "not judged"), (factor, found.segments)
        assert not any(one.verdict == "stable" for one in found.segments)
    assert detected(recording, revolution, teeth).verdict == "chatter"


@pytest.mark.parametrize(("revolution", "teeth", "runout"), CUTS)
def test_a_stable_cut_is_no_chatter_for_sure_at_a_wrong_speed(revolution, teeth, runout):
    recording = cut(revolution, teeth, runout, chatters=False)
    for factor in FACTORS:
        found = detected(recording, factor * revolution, teeth)
        for one in found.segments:
            assert one.verdict != "chatter" or one.confidence <= 0.5, (factor, one)
            # what lies half way between the harmonics of twice the speed are those of the speed
            assert factor != 2.0 or one.verdict != "chatter", one
    assert detected(recording, revolution, teeth).verdict == "stable"


@pytest.mark.parametrize(("factor", "override"), [(0.8, "125%"), (1.2, "83%"), (1.5, "67%")])
def test_both_speeds_and_the_override_are_named(factor, override):
    for teeth, chatters in ((4, False), (3, True)):
        found = detected(cut(50.0, teeth, 0.1, chatters), factor * 50.0, teeth)
        note = found.notes[0]
        assert "the record speaks for 3000 rpm" in note
        assert f"{3000.0 * factor:.0f} rpm were stated" in note
        assert f"an override of {override}" in note
        summary = found.summary()
        assert summary["spindle_speed_of_lines_rpm"] == pytest.approx(3000.0, rel=2e-3)
        assert all("3000 rpm" in one.reason for one in found.segments if one.verdict != "stable")


def test_the_picture_shows_the_harmonics_of_the_speed_that_the_lines_speak_for():
    figure = detected(cut(50.0, 4, 0.1, chatters=True), 60.0, 4).plot()
    assert figure.get_suptitle().endswith("3600 rpm as stated, 3000 rpm by the lines")
    (label,) = [
        one for axes in figure.axes for one in axes.get_legend_handles_labels()[1] if "harm" in one
    ]
    assert float(label.split()[2]) == pytest.approx(200.0, rel=2e-3)


@pytest.mark.parametrize("factor", [0.94, 1.0, 1.06])
def test_a_speed_near_the_true_one_is_not_spoken_against(factor):
    for chatters in (False, True):
        found = detected(cut(50.0, 4, 0.1, chatters), factor * 50.0, 4)
        assert found.verdict == ("chatter" if chatters else "stable")
        assert found.summary()["spindle_speed_of_lines_rpm"] is None


def test_a_record_without_a_comb_speaks_for_no_speed():
    random = np.random.default_rng(2)
    time = clock(3.0)
    recording = Recording("made", 1.0 / RATE, ("a",), ("sound",), noise(random, time)[:, None])
    found = detected(recording, 50.0, 4)
    assert found.verdict == "idle"
    assert found.evidence.other_speed is None


def test_idle_parts_stay_idle_at_a_wrong_speed():
    random = np.random.default_rng(3)
    time = clock(5.0)
    values = during(time, 1.5, 4.0) * forced_cut(random, time, 50.0, 4, 0.1)
    values = values + 0.02 * machine(random, time, 50.0) + noise(random, time, 0.03)
    recording = Recording("made", 1.0 / RATE, ("a",), ("sound",), values[:, None])
    found = detected(recording, 60.0, 4)
    assert [one.verdict for one in found.segments] == ["idle", "not judged", "idle"]
    assert found.segments[0].end == pytest.approx(1.5, abs=0.3)


@pytest.mark.parametrize(
    # five seconds of a slow spindle whose teeth may be alike: lines of either lie everywhere
    ("revolution", "teeth", "verdicts"),
    [(50.0, 4, {"chatter"}), (26.0, 6, {"chatter", "not judged"}), (120.0, 3, {"chatter"})],
)
def test_chatter_on_a_harmonic_of_the_stated_speed_is_found_at_that_of_the_lines(
    revolution, teeth, verdicts
):
    # after a spindle that turns in the air, whose lines are those of the true speed too
    random = np.random.default_rng(7)
    time = clock(5.0)
    frequency = (round(930.0 / revolution) + 0.37) * revolution
    line = chatter_line(random, time, frequency, teeth * revolution)
    cut = forced_cut(random, time, revolution, teeth, 0.1) + 4.0 * line
    turns = 0.1 * forced_cut(random, time, revolution, 1, 0.0)
    values = during(time, 1.5, 9.0) * cut + turns + noise(random, time, 0.03)
    recording = Recording("made", 1.0 / RATE, ("a",), ("sound",), values[:, None])
    for factor in (0.7, 1.25):
        stated = frequency / round(frequency / (factor * revolution))
        found = detected(recording, stated, teeth)
        assert found.verdict in verdicts, (factor, found.segments)
        if found.verdict == "chatter":
            assert found.chatter_frequency == pytest.approx(frequency, rel=2e-3)
        assert found.refuting_speed.frequency == pytest.approx(revolution, rel=5e-3)


def test_speeds_that_alike_teeth_leave_open_are_named():
    found = detected(cut(50.0, 4, 0.0, chatters=False), 33.0, 4)
    assert "200.0 Hz apart" in found.notes[0]
    assert "rpm where some of its 4 teeth are alike" in found.notes[0]
    assert "3000" in found.notes[0]


@pytest.mark.parametrize(("depth", "verdict"), [("1 mm", "stable"), ("3 mm", "chatter")])
def test_a_simulated_cut_is_stable_at_no_wrong_speed(depth, verdict):
    case = chatter.load(EXAMPLES / "chattering-cut" / "case.toml")
    result = chatter.simulate(case.patch({"cut.axial_depth": depth}))
    values = result.rows[:, [0, 1]]
    recording = Recording("cut", 0.6 / len(values), ("x", "y"), ("force",) * 2, values)
    for factor in (0.8, 1.0, 1.2, 1.5):
        found = chatter.detect(recording, f"{6000.0 * factor} rpm", 4).verdict
        assert found in ((verdict,) if factor == 1.0 else (verdict, "not judged", "idle"))


def test_a_speed_that_no_lines_confirm_calls_no_chatter_stable():
    # teeth pass so fast that few of their lines are heard; chatter is on a stated harmonic
    random = np.random.default_rng(1)
    time = clock(2.0)
    revolution, teeth = 199.5, 3
    stated = 1.2 * revolution
    values = forced_cut(random, time, revolution, teeth, 0.0) + noise(random, time)
    values = values + 2.3 * chatter_line(random, time, 4.0 * stated, teeth * revolution, 0.1)
    recording = Recording("made", 1.0 / RATE, ("a",), ("sound",), values[:, None])
    found = detected(recording, stated, teeth)
    assert "no spacing of lines confirms the spindle speed" in found.notes
    assert not any(one.verdict == "stable" for one in found.segments)
    assert any("check --spindle-speed and --teeth" in one.reason for one in found.segments)
    assert detected(recording, revolution, teeth).verdict == "chatter"


@pytest.mark.parametrize(("seed", "size", "hiss"), [(0, 3.0, 0.2), (1, 3.0, 0.6)])
def test_chatter_in_a_short_record_is_found_at_a_speed_that_its_other_lines_confirm(
    seed, size, hiss
):
    # a chatter line and its multiples are a spacing of their own, and may refute no true speed
    random = np.random.default_rng(seed)
    time = clock(1.5)
    revolution, teeth, frequency = 27.6, 6, 898.9
    forced = 0.6 * forced_cut(random, time, revolution, teeth, 0.3) + noise(random, time, hiss)
    multiples = ((1, 1.0), (2, 0.25), (3, 0.15), (4, 0.1))
    lines = [
        share * chatter_line(random, time, k * frequency, teeth * revolution, 0.1)
        for k, share in multiples
    ]
    for values, verdict in ((forced + size * sum(lines), "chatter"), (forced, "stable")):
        recording = Recording("made", 1.0 / RATE, ("a",), ("sound",), values[:, None])
        found = detected(recording, revolution, teeth)
        assert found.verdict == verdict
        assert found.evidence.revolution.mean == pytest.approx(revolution, rel=2e-3)


def test_a_wrong_speed_whose_harmonic_holds_the_chatter_is_not_stable():
    """Lines one revolution apart, taken for those of the teeth, and chatter at order 32.57."""
    rate, revolution, teeth = 10_000.0, 27.6, 6
    time = np.arange(int(3.0 * rate)) / rate
    angle = 2.0 * np.pi * revolution * time
    values = sum(0.3 * np.cos(k * angle + k * k) for k in range(1, 25))
    values = values + 2.0 * np.cos(32.57 * angle) * (1.0 + 0.6 * np.cos(teeth * angle))
    values = values + 0.05 * np.random.default_rng(1).standard_normal(time.size)
    recording = Recording("made", 1.0 / rate, ("a",), ("sound",), values[:, None])
    right = evidence_at(recording, revolution, teeth)
    stated = 0.987 * revolution  # its 33rd harmonic is the line of chatter
    wrong = frame_evidence._with_lines(
        recording, right.frames, stated_alone(right.frames, stated), teeth
    )
    other = OtherSpeed(revolution / teeth, revolution, REFUTED)
    assert {one.verdict for one in segments_of(wrong)} == {"stable"}
    verdicts = {one.verdict for one in judged(replace(wrong, other_speed=other))}
    assert "stable" not in verdicts


def test_segments_that_say_the_same_are_one_though_no_frequency_is_equal_to_itself():
    def idle(begin, end):
        return Segment(begin, end, "idle", float("nan"), "none", 0.9, 0.1, 50.0, "quiet")

    assert [(one.begin, one.end) for one in _joined([idle(0.0, 1.0), idle(1.0, 2.0)])] == [(0, 2)]
