"""Milling runs: faults of the set-up are said with numbers; effects of physics are not faults."""

from __future__ import annotations

import numpy as np
import pytest

from chatter.explain.checking import checked
from chatter.explain.comparison import compare
from chatter.explain.explanation import explain
from chatter.explain.measurement_file import read_measurement
from tests.chatter.explain.data_checks import simulated
from tests.places import DATA

SETS = DATA / "measurements"


def scaled(channel, factor):
    return lambda signals: {**signals, channel: factor * signals[channel]}


def swapped(one, other):
    return lambda signals: {**signals, one: signals[other], other: signals[one]}


def with_samples(channel, where, value):
    def edit(signals):
        values = signals[channel].copy()
        values[where] = value
        return {**signals, channel: values}

    return edit


def without(channel):
    return lambda signals: {k: v for k, v in signals.items() if k != channel}


def clipped(signals):
    level = 0.9 * signals["Fy"].max()
    return {**signals, "Fy": np.minimum(signals["Fy"], level)}


def interrupted(signals):
    kept = np.ones(signals["time"].size, dtype=bool)
    kept[600:640] = False
    return {name: values[kept] for name, values in signals.items()}


def shaken(signals):
    random = np.random.default_rng(3)
    time = signals["time"] + 0.2 / simulated.RATE * random.uniform(-1.0, 1.0, signals["time"].size)
    return {**signals, "time": time}


def with_teeth(teeth):
    measurement = simulated.healthy()
    return measurement.with_case(measurement.case.patch({"tool.teeth": teeth}))


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"tool__runout": {"offset": "15 um", "angle": "60 deg"}},
        {"tool__pitch": ["84 deg", "96 deg", "84 deg", "96 deg"]},
        {"process_damping": {"coefficient": "2e5 N/m"}},
        {"material__Kte": "60 N/mm"},
        {"dynamometer": {"frequency": "1500 Hz", "damping": 0.03}},
        {"structure__mode[0].frequency": "620 Hz"},
    ],
    ids=["nothing", "runout", "pitch", "process-damping", "edge", "dynamometer", "mode"],
)
def test_effects_of_physics_are_no_faults(changes):
    assert checked(simulated.milling(**changes)).findings == ()


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (scaled("Fx", -1.0), "sign of Fx is turned"),
        (scaled("y", -1.0), "sign of y is turned"),
        (swapped("Fx", "Fy"), "Fx and Fy are swapped"),
        (swapped("x", "y"), "x and y are swapped"),
        (scaled("Fy", 1000.0), "Fy is off by a factor of 1000"),
        (scaled("x", 1e-3), "x is off by a factor of 1000"),
        (scaled("time", 1000.0), "milliseconds"),
        (scaled("spindle_angle", 180.0 / np.pi), "spindle speed is wrong in 4 of 4 runs"),
        (with_samples("Fx", slice(None), 3.0), "Fx is dead"),
    ],
)
def test_a_fault_in_every_run_is_fatal(edit, words):
    finding = simulated.worst(simulated.edited(simulated.healthy(), edit))
    assert finding.severity == "fatal"
    assert words in finding.description


@pytest.mark.parametrize("teeth", [2, 3, 5, 8])
def test_teeth_are_counted(teeth):
    finding = simulated.worst(with_teeth(teeth))
    assert finding.severity == "fatal"
    assert "repeat 4 times a revolution" in finding.description
    assert f"the case declares {teeth}" in finding.description


def test_teeth_are_counted_in_spite_of_runout():
    measurement = simulated.milling(tool__runout={"offset": "25 um", "angle": "60 deg"})
    finding = simulated.worst(measurement.with_case(measurement.case.patch({"tool.teeth": 3})))
    assert finding.severity == "fatal"
    assert "repeat 4 times a revolution; the case declares 3" in finding.description


def test_a_tooth_that_cuts_for_all_contradicts_nothing():
    """Radii of two teeth differ by 0.14 mm, more than the feed: the second never meets the work."""
    measurement = simulated.milling(tool__teeth=2, tool__runout={"offset": "70 um"})
    declared = measurement.case.patch({"tool.runout": None})
    usable = checked(measurement.with_case(declared))
    assert not usable.is_fatal
    (told,) = [one for one in usable.findings if "repeat once" in one.description]
    assert told.severity == "note"
    assert "runout lets one cut for all" in told.description


@pytest.mark.parametrize("with_angle", [True, False])
@pytest.mark.parametrize("factor", [1.03, 0.96])
def test_a_wrong_spindle_speed_is_said(factor, with_angle):
    measurement = (
        simulated.healthy()
        if with_angle
        else simulated.edited(simulated.healthy(), without("spindle_angle"))
    )
    for place, rpm in enumerate((4000.0, 3300.0, 4700.0, 3600.0)):
        speed = f"{factor * rpm} rpm"
        measurement = simulated.declared(measurement, [place], cut__spindle_speed=speed)
    finding = simulated.worst(measurement)
    assert finding.severity == "fatal"
    times = float(finding.description.split("turned at ")[1].split()[0])
    assert times == pytest.approx(1.0 / factor, abs=0.004)


def test_the_other_mode_of_milling_is_said():
    finding = simulated.worst(simulated.declared(simulated.healthy(), cut__mode="up"))
    assert finding.severity == "fatal"
    assert "down-milling, not up-milling" in finding.description


def test_a_radial_depth_grossly_off_is_said():
    finding = simulated.worst(
        simulated.declared(simulated.healthy(), [1], cut__radial_depth="4 mm")
    )
    assert finding.severity == "run"
    assert "radial depth" in finding.description


@pytest.mark.parametrize(
    ("made", "severity", "words"),
    [
        (
            lambda: simulated.edited(simulated.healthy(), scaled("Fy", -1.0), [2]),
            "run",
            "run3.csv: the sign of Fy",
        ),
        (
            lambda: simulated.edited(simulated.healthy(), swapped("x", "y"), [2]),
            "run",
            "run3.csv: x and y are swapped",
        ),
        (
            lambda: simulated.declared(simulated.healthy(), [1], cut__spindle_speed="3400 rpm"),
            "run",
            "declares 3400 rpm",
        ),
        (
            lambda: simulated.declared(simulated.healthy(), [1], cut__axial_depth="3 mm"),
            "run",
            "times what the other runs",
        ),
        (
            lambda: simulated.edited(simulated.healthy(), scaled("y", 1e-3), [0]),
            "channel",
            "wrong by 1000",
        ),
        (
            lambda: simulated.edited(simulated.healthy(), with_samples("x", slice(None), 0.0), [0]),
            "channel",
            "x is dead",
        ),
        (
            lambda: simulated.edited(
                simulated.healthy(), with_samples("Fx", slice(90, 99), np.nan), [0]
            ),
            "samples",
            "9 s",
        ),
        (
            lambda: simulated.edited(
                simulated.healthy(), with_samples("Fy", slice(300, 320), 0.0), [0]
            ),
            "samples",
            "zero",
        ),
        (lambda: simulated.edited(simulated.healthy(), clipped, [0]), "samples", "cut off"),
        (
            lambda: simulated.edited(simulated.healthy(), interrupted, [3]),
            "samples",
            "40 samples are missing",
        ),
        (lambda: simulated.edited(simulated.healthy(), shaken, [3]), "note", "jitters"),
        (
            lambda: simulated.edited(
                simulated.healthy(), with_samples("time", slice(9, 12), 0.0), [1]
            ),
            "run",
            "not rise",
        ),
    ],
)
def test_a_fault_of_one_run_costs_that_alone(made, severity, words):
    looked_at = checked(made())
    (finding,) = looked_at.findings
    assert finding.severity == severity
    assert words in finding.description
    assert finding.run
    left = {run.name: run for run in looked_at.measurement.runs}
    assert (finding.run in left) == (severity != "run")
    if severity == "channel":
        assert finding.channel not in left[finding.run].signals
    if severity == "samples":
        run = left[finding.run]
        assert 0.0 < np.mean(run.usable) < 1.0
        assert all(np.all(np.isfinite(values)) for values in run.signals.values())


def test_copies_of_a_run_declared_otherwise_are_both_left_out():
    first = simulated.healthy().runs[0].signals
    looked_at = checked(simulated.edited(simulated.healthy(), lambda _: first, [2]))
    assert {one.run for one in looked_at.findings} == {"run1.csv", "run3.csv"}
    assert len(looked_at.measurement.runs) == 2


def test_nothing_is_explained_beside_a_fatal_fault(tmp_path):
    result = explain(with_teeth(3))
    summary = result.summary()
    assert summary["verdict"] == "unexplained"
    assert summary["effects"] == []
    assert set(summary["checks"][0]) == {"severity", "run", "channel", "description"}
    written = {path.name for path in result.save(tmp_path)}
    assert written == {"explanation.json", "report.html", "case-updated.toml"}
    assert "repeat 4 times a revolution" in (tmp_path / "report.html").read_text()


def test_samples_left_out_do_not_count_in_the_error(tmp_path):
    clean = compare(simulated.healthy()).summary()["nrmse"]
    spoiled = simulated.edited(simulated.healthy(), with_samples("Fy", slice(300, 320), 0.0), [0])
    result = compare(spoiled)
    assert result.summary()["nrmse"] == pytest.approx(clean, rel=0.02)
    assert "zero" in result.summary()["checks"][0]["description"]
    result.save(tmp_path)


@pytest.mark.parametrize("path", sorted(SETS.glob("set-*")), ids=lambda path: path.name)
def test_no_false_alarm_on_sets_without_faults(path):
    assert checked(read_measurement(path)).findings == ()
