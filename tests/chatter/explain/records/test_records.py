"""Records as they come: what is not told is found, against an independent integration."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.blind_sets.milling_physics import SAMPLING, TURN, Cut, Plant, arc_of, run
from chatter.description.case import loads
from chatter.description.errors import InputError
from chatter.explain.checking import checked
from chatter.explain.comparison import compare
from chatter.explain.data_checks.finding import NOTE, RUN
from chatter.explain.measurement import Measurement, Run
from chatter.explain.records.case_axes import in_case_axes
from chatter.explain.records.description import Channel, RecordDescription, record_of
from chatter.explain.records.spindle import speed_by_repetition, tacho_reading
from chatter.explain.records.stages import stages_of
from chatter.explain.records.steady_cut import revolutions_to_settle, steady_cut

CASE = """
title = "steel"
[tool]
teeth = 3
diameter = "20 mm"
helix = "30 deg"
[material]
Ktc = "1600 MPa"
Krc = "700 MPa"
Kte = "24 N/mm"
Kre = "42 N/mm"
[cut]
mode = "down"
spindle_speed = "2000 rpm"
feed_per_tooth = "0.08 mm"
axial_depth = "0.6 mm"
radial_depth = "6 mm"
[[structure.mode]]
frequency = "560 Hz"
damping = 0.03
mass = "1.15 kg"
direction = [1, 0, 0]
[[structure.mode]]
frequency = "600 Hz"
damping = 0.03
mass = "1.2 kg"
direction = [0, 1, 0]
"""
#: conditions, and revolutions of the records after which a user kept them
CUTS = ((2000.0, 6e-3, 5.31), (2270.0, 9e-3, 6.77), (1710.0, 4.5e-3, 4.12))
TRUE_SPEED, NOISE = 1.003, 0.01
TURNED = math.radians(25.0)
CORNER = 3400.0


@pytest.fixture(scope="module")
def case():
    return loads(CASE, "case.toml")


def plant() -> Plant:
    """Structure and cutting of the case, integrated by another program."""
    return Plant(
        10e-3,
        math.tan(math.radians(30.0)) / 10e-3,
        np.arange(3) * TURN / 3.0,
        np.ones(3),
        np.array([560.0, 600.0]),
        np.array([0.03, 0.03]),
        np.array([1.15, 1.2]),
        np.eye(2),
        1600e6,
        700e6,
        24e3,
        42e3,
    )


@pytest.fixture(scope="module")
def cut_off():
    """Second halves of runs from rest, whose start angle nobody kept: signals, angles, speeds."""
    noise = np.random.default_rng(3)
    found = []
    for rpm, radial, kept in CUTS:
        speed = TRUE_SPEED * rpm * TURN / 60.0
        cut = Cut(speed, 0.08e-3 / TRUE_SPEED, 0.6e-3, radial, *arc_of("down", radial, 10e-3), 0.0)
        signals = run(plant(), cut, (kept + 7.0) * TURN / speed)
        first = int(kept * TURN / speed * SAMPLING)
        rows = signals.channels[:, first:]
        rows = rows + NOISE * rows.std(axis=1)[:, None] * noise.standard_normal(rows.shape)
        found.append(
            (signals.time[first:] - signals.time[first], rows, signals.angle[first], speed)
        )
    return found


#: speed, rpm, feed, axial and radial depth, m
SLOW_CUTS = ((756.0, 92e-6, 1.27e-3, 19.71e-3), (793.0, 172e-6, 1.46e-3, 27.39e-3))
SLOW_CASE = """
[tool]
teeth = 5
diameter = "50 mm"
helix = "14 deg"
[material]
Ktc = "1772.81 MPa"
Krc = "730.719 MPa"
Kte = "0 N/mm"
Kre = "0 N/mm"
[cut]
mode = "down"
spindle_speed = "756 rpm"
feed_per_tooth = "0.092 mm"
axial_depth = "1.27 mm"
radial_depth = "19.71 mm"
[[structure.mode]]
frequency = "52.4765 Hz"
damping = 0.044045
mass = "468.32 kg"
direction = [0, 1, 0]
[[structure.mode]]
frequency = "211.993 Hz"
damping = 0.046112
mass = "70.8736 kg"
direction = [1, 0, 0]
[[structure.mode]]
frequency = "257.713 Hz"
damping = 0.045321
mass = "49.5992 kg"
direction = [0, 1, 0]
"""


def slow_plant() -> Plant:
    """Slow structure with edge forces."""
    return Plant(
        25e-3,
        math.tan(math.radians(14.0)) / 25e-3,
        np.arange(5) * TURN / 5.0,
        np.ones(5),
        np.array([52.34, 210.4, 257.7]),
        np.array([0.0427, 0.0448, 0.0445]),
        np.array([473.1, 68.0, 49.7]),
        np.array([[0.0, 1.0], [1.0, 0.0], [0.0, 1.0]]),
        1860e6,
        741e6,
        47.2e3,
        49.6e3,
    )


def measurement(case, cut_off, tmp_path, signals_of, record) -> Measurement:
    runs = []
    for number, ((rpm, radial, _), (time, rows, _, _)) in enumerate(
        zip(CUTS, cut_off, strict=True)
    ):
        overrides = {"cut.spindle_speed": f"{rpm} rpm", "cut.radial_depth": radial}
        signals = {"time": time, **signals_of(rows)}
        described = tuple(record.channels) if record else ()
        runs.append(Run(f"run{number + 1}.csv", overrides, signals, described=described))
    return Measurement("milling", "records", tmp_path, case, tuple(runs), {}, record=record)


def as_in_the_case(rows):
    return dict(zip(("Fx", "Fy", "x", "y"), rows, strict=True))


def test_a_record_cut_off_in_the_cut_is_recognised(case, cut_off, tmp_path):
    usable = checked(measurement(case, cut_off, tmp_path, as_in_the_case, None))
    assert not usable.is_fatal
    assert any("do not begin from rest" in one.description for one in usable.findings)
    for one, (_, _, _, speed) in zip(usable.measurement.runs, cut_off, strict=True):
        own = one.of(case)
        assert own.cut.spindle_speed == pytest.approx(speed, rel=5e-5)
        predicted = one.record.predicted(own)
        for name in ("Fx", "Fy", "x", "y"):
            away = predicted[name] - one.signals[name]
            assert np.sqrt(np.mean(away**2)) < 0.025 * one.signals[name].std(), name


def test_the_start_angle_is_found(case, cut_off, tmp_path):
    usable = checked(measurement(case, cut_off, tmp_path, as_in_the_case, None))
    for one, (time, _, angle, speed) in zip(usable.measurement.runs, cut_off, strict=True):
        begin = int(np.searchsorted(time, one.signals["time"][0]))
        true = angle + speed * time[begin]
        apart = one.signals["spindle_angle"][0] - true
        # of three teeth alike nobody can tell which is the first
        apart = math.remainder(apart, TURN / 3.0)
        # nor a delay of the signals from a turn of the tool: a filter is sought, there is none
        assert abs(apart) < math.radians(1.2)


def test_runs_from_rest_stay_as_they_are(case, tmp_path):
    cut = Cut(2000.0 * TURN / 60.0, 0.08e-3, 0.6e-3, 6e-3, *arc_of("down", 6e-3, 10e-3), 0.0)
    signals = run(plant(), cut, 0.2)
    one = Run("run.csv", {}, {"time": signals.time, **as_in_the_case(signals.channels)})
    usable = checked(Measurement("milling", "rest", tmp_path, case, (one,)))
    assert usable.measurement.runs[0].record is None
    assert not usable.findings


@pytest.mark.parametrize("with_angle", [True, False])
def test_noise_and_a_missing_effect_do_not_hide_a_beginning_from_rest(tmp_path, with_angle):
    # edge forces that are not declared, on a slow structure that has not settled when a run ends
    declared, edges = loads(SLOW_CASE, "case.toml"), slow_plant()
    noise, runs = np.random.default_rng(8), []
    for number, (rpm, feed, axial, radial) in enumerate(SLOW_CUTS):
        speed = rpm * TURN / 60.0
        cut = Cut(speed, feed, axial, radial, *arc_of("down", radial, 25e-3), 0.0)
        signals = run(edges, cut, 0.5)
        scatter = np.array([0.04, 0.01, 0.12, 0.01]) * signals.channels.std(axis=1)
        rows = signals.channels + scatter[:, None] * noise.standard_normal(signals.channels.shape)
        columns = {"time": signals.time, **as_in_the_case(rows)}
        columns |= {"spindle_angle": signals.angle} if with_angle else {}
        overrides = {
            "cut.spindle_speed": f"{rpm} rpm",
            "cut.feed_per_tooth": feed,
            "cut.axial_depth": axial,
            "cut.radial_depth": radial,
        }
        runs.append(Run(f"run{number + 1}.csv", overrides, columns))
    usable = checked(Measurement("milling", "rest", tmp_path, declared, tuple(runs)))
    assert all(one.record is None for one in usable.measurement.runs)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_orientation_of_the_dynamometer_is_found(case, cut_off, tmp_path, sense):
    """Forces on the work, turned by 25 degrees, mirrored or not; nothing of that is told."""
    first = np.array([math.cos(TURNED), math.sin(TURNED)])
    second = sense * np.array([-math.sin(TURNED), math.cos(TURNED)])

    def turned(rows):
        return {"F1": -first @ rows[:2] + 5.0, "F2": -second @ rows[:2]}

    unknown = Channel("force", "workpiece")
    record = RecordDescription("cut", "unknown", 0.005, {"F1": unknown, "F2": unknown})
    usable = checked(measurement(case, cut_off, tmp_path, turned, record))
    assert not usable.is_fatal
    words = next(one.description for one in usable.findings if "orientation" in one.description)
    for one, (time, rows, _, _) in zip(usable.measurement.runs, cut_off, strict=True):
        begin = int(np.searchsorted(time, one.signals["time"][0]))
        for name, row in zip(("Fx", "Fy"), rows, strict=False):
            true = row[begin : begin + one.signals["time"].size]
            away = (one.signals[name] - one.signals[name].mean()) - (true - true.mean())
            assert np.sqrt(np.mean(away**2)) < 0.06 * rows[:2].std(), words


def test_offsets_and_drifts_are_estimated(case, cut_off, tmp_path):
    def drifting(rows):
        force = {"F1": -rows[0] + 20.0, "F2": -rows[1] + np.linspace(0.0, 10.0, rows.shape[1])}
        return {**force, "d1": rows[2], "d2": rows[3]}

    record = RecordDescription(
        "cut",
        "unknown",
        0.005,
        {
            "F1": Channel("force", "workpiece", (1.0, 0.0, 0.0)),
            "F2": Channel("force", "workpiece", (0.0, 1.0, 0.0)),
            "d1": Channel("displacement", "tool", (1.0, 0.0, 0.0)),
            "d2": Channel("displacement", "tool", (0.0, 1.0, 0.0)),
        },
    )
    found = compare(measurement(case, cut_off, tmp_path, drifting, record))
    assert {one.channel for one in found.errors} == {"Fx", "Fy", "x", "y"}
    assert all(one.relative < 0.03 for one in found.errors)


def test_a_run_that_chatters_is_set_aside(case, cut_off, tmp_path):
    made = measurement(
        case, cut_off, tmp_path, as_in_the_case, RecordDescription("cut", "unknown", 0.005)
    )
    last = made.runs[-1]
    wave = np.sin(TURN * 583.0 * last.signals["time"])
    louder = {k: v + 0.7 * v.std() * wave if k != "time" else v for k, v in last.signals.items()}
    usable = checked(made.with_runs([*made.runs[:-1], replace(last, signals=louder)]))
    assert [one.run for one in usable.findings if one.severity == RUN] == ["run3.csv"]


def change_from_rest(signals, turn, revolutions):
    """Change of the last channels, motions, from some revolutions after rest to the last one."""
    within = np.arange(400) / 400.0 * turn
    last = int(signals.time[-1] / turn) - 1
    early, late = (
        np.array([np.interp(within + k * turn, signals.time, one) for one in signals.channels[2:]])
        for k in (revolutions, last)
    )
    return np.linalg.norm(early - late) / np.linalg.norm(late)


@pytest.mark.parametrize(
    ("kept", "turns", "left_out"), [(45.6, 12, True), (60.6, 41, True), (60.6, 55, False)]
)
def test_a_cut_near_its_limit_is_set_aside_where_its_record_is_short(
    case, tmp_path, kept, turns, left_out
):
    """Of its transient 1 % are left 12 revolutions after rest, or 41, and not after 55.

    By the independent integration, against its last revolution.
    """
    runs, depths = [], (0.6e-3, 0.5e-3, 0.85 * 2.56e-3)
    for number, depth in enumerate(depths):
        speed = 2000.0 * TURN / 60.0
        cut = Cut(speed, 0.08e-3, depth, 6e-3, *arc_of("down", 6e-3, 10e-3), 0.0)
        signals = run(plant(), cut, (kept + turns) * TURN / speed)
        first = int(kept * TURN / speed * SAMPLING)
        changes = change_from_rest(signals, TURN / speed, turns)
        assert (changes > 0.01) == (left_out and depth == depths[-1])
        rows = as_in_the_case(signals.channels[:, first:])
        rows["time"] = signals.time[first:] - signals.time[first]
        overrides = {"cut.spindle_speed": "2000 rpm", "cut.axial_depth": depth}
        runs.append(Run(f"run{number + 1}.csv", overrides, rows))
    record = RecordDescription("cut", "unknown", 0.005)
    made = Measurement("milling", "records", tmp_path, case, tuple(runs), {}, record=record)
    found = [one for one in checked(made).findings if one.severity == RUN]
    assert [one.run for one in found] == (["run3.csv"] if left_out else [])
    assert all("stability limit" in one.description for one in found)


def test_settled_cut_is_extrapolated(case):
    """From a dozen revolutions as from a hundred, in a cut that settles slowly."""
    slow = case.patch({"cut.spindle_speed": "12000 rpm", "structure.mode[0].damping": 0.01})
    far, near = steady_cut(slow, 150), steady_cut(slow, revolutions_to_settle(slow))
    for one, other in ((far.force, near.force), (far.displacement, near.displacement)):
        away = one[:200] - other[:200]
        assert np.linalg.norm(away) < 5e-3 * np.linalg.norm(one[:200])


def test_speed_by_repetition_and_by_the_tacho():
    time = np.arange(4000) * 1e-4
    speed = 2.0 * math.pi * 61.37
    wave = sum(np.cos(k * speed * time + k) / k for k in (1, 3, 6, 9))
    signals = np.array([wave + 0.05 * np.random.default_rng(1).standard_normal(time.size)])
    found = speed_by_repetition(time, signals, 1.004 * speed, 0.005)
    assert found == pytest.approx(speed, rel=3e-5)
    tacho = np.where(np.mod(speed * time - 1.0, TURN) < 0.15, 5.0, 0.0)
    assert tacho_reading(time, tacho).speed == pytest.approx(speed, rel=1e-3)
    assert tacho_reading(time, 0.0 * time + 1.0) is None


def test_stages_are_recognised(case):
    """Air, a rise over the entry, the cut, a fall, air again."""
    case = case.patch({"cut.feed_per_tooth": "0.5 mm"})
    time = np.arange(12000) * 1e-4
    turn = TURN / case.cut.spindle_speed
    size = np.interp(time, [0.2, 0.21, 0.4, 0.9, 1.0, 1.001], [0.0, 0.3, 1.0, 1.0, 0.3, 0.0])
    noise = 0.01 * np.random.default_rng(2).standard_normal((2, time.size))
    wave = np.array([np.sin(TURN * time / turn), np.cos(3.0 * TURN * time / turn)])
    stages = stages_of(case, time, 100.0 * (size * wave + noise) + 7.0, "air")
    assert abs(time[stages.entry] - 0.2) < 0.03
    assert abs(time[stages.leave] - 1.0) < 0.03
    assert 0.35 < time[stages.settled.start] < time[stages.settled.stop] < 0.95


def a_cut_that_begins(case, contact):
    """Time and signals of a cut that grows for 0.2 s, over the entry, from a contact on."""
    time = np.arange(6000) * 1e-4
    turn = TURN / case.cut.spindle_speed
    size = np.interp(time, [contact, contact + 0.2], [0.2, 1.0]) * (time > contact)
    noise = 0.01 * np.random.default_rng(4).standard_normal((2, time.size))
    wave = np.array([np.sin(TURN * time / turn), np.cos(3.0 * TURN * time / turn)])
    return time, size * wave + noise


def test_a_contact_within_the_first_revolution_is_not_taken_for_full_immersion(case):
    """Less than a revolution in the air shows no swing of its own; the entry is left out still."""
    case = case.patch({"cut.feed_per_tooth": "0.5 mm"})
    time, signals = a_cut_that_begins(case, 0.5 * TURN / case.cut.spindle_speed)
    stages = stages_of(case, time, signals, "air")
    # the tool travels 0.2 R sin(...) ... R at 50 mm/s
    assert time[stages.settled.start] > 0.2
    assert stages.drift < 0.01


def test_a_cut_that_grows_throughout_drifts(case):
    time = np.arange(6000) * 1e-4
    wave = np.sin(case.cut.spindle_speed * time)
    grown = np.array([np.linspace(0.9, 1.1, time.size) * wave])
    stages = stages_of(case, time, grown, "cut")
    # of a part in which the size grows by d from half to half, over its deviation: d
    part = time[stages.settled]
    assert stages.drift == pytest.approx(0.2 / 0.6 * 0.5 * (part[-1] - part[0]), rel=0.15)
    assert stages_of(case, time, np.array([wave]), "cut").drift < 1e-3


def test_channels_come_into_the_axes_of_the_case():
    force = np.random.default_rng(0).standard_normal((3, 50))
    signals = {"time": np.arange(50.0), "a": -force[1], "b": force[0], "c": force[2], "d": force[0]}
    channels = {
        "a": Channel("force", "workpiece", (0.0, 1.0, 0.0)),
        "b": Channel("force", "workpiece", (-1.0, 0.0, 0.0)),
        "c": Channel("acceleration", "tool", (0.0, 0.0, 1.0)),
        "d": Channel("velocity", "tool", (0.6, 0.8, 0.0)),
    }
    turned, components = in_case_axes(Run("run", {}, signals), channels)
    np.testing.assert_allclose(turned.signals["Fx"], force[0])
    np.testing.assert_allclose(turned.signals["Fy"], force[1])
    np.testing.assert_allclose(turned.signals["az"], force[2])
    assert components["d"].direction == (0.6, 0.8, 0.0)
    assert "a" not in turned.signals


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ({"record": {"begins": "air", "angle": 1}}, "record.angle is not a key"),
        ({"record": {"begins": "middle"}}, '"rest", "air", "cut"'),
        ({"record": {"speed_tolerance": "40 %"}}, "share from 0 to 20 %"),
        ({"channels": {"F1": {"quantity": "forces"}}}, "none of force"),
        ({"channels": {"F1": {"quantity": "force"}}}, "channels.F1.direction"),
        ({"channels": {"F1": {"quantity": "force", "direction": [0, 0, 0]}}}, "axes of the case"),
    ],
)
def test_what_is_told_wrongly_is_refused(tmp_path, content, words):
    with pytest.raises(InputError, match=None) as refused:
        record_of(tmp_path / "measurement.toml", content)
    assert words in str(refused.value)


def test_notes_tell_the_stages(case, cut_off, tmp_path):
    record = RecordDescription("cut", "unknown", 0.005)
    usable = checked(measurement(case, cut_off, tmp_path, as_in_the_case, record))
    told = [one.description for one in usable.findings if one.severity == NOTE]
    assert any("settled from" in one and "rpm by the period of the signal" in one for one in told)
