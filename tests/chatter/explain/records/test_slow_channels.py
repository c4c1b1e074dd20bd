"""Spindle power beside forces: the mean of a cut, whatever the meter makes of its ripple."""

import math
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.blind_sets.milling_physics import TURN, arc_of
from chatter.description.case import load
from chatter.explain.comparison import compare
from chatter.explain.data_checks.finding import NOTE
from chatter.explain.measurement import Run
from chatter.explain.records.description import Channel, RecordDescription
from chatter.explain.records.from_rest import predicted_signal
from chatter.explain.records.slow_channels import over_revolution, with_torques
from tests.chatter.explain.records.test_records import (
    CUTS,
    TRUE_SPEED,
    as_in_the_case,
    case,
    cut_off,
    measurement,
)
from tests.places import EXAMPLES

__all__ = ["case", "cut_off"]

IDLE = 310.0
KTC, KTE, DEPTH, RADIUS, FEED = 1600e6, 24e3, 0.6e-3, 10e-3, 0.08e-3 / TRUE_SPEED


def powers(radial: float, rpm: float) -> tuple[float, float]:
    """Mean powers, W, of cutting by Ktc and the removal rate, and of rubbing by Kte and the arc.

    Altintas (2012), Manufacturing Automation, section 2.8; three teeth.
    """
    speed = TRUE_SPEED * rpm * TURN / 60.0
    entry, leave = arc_of("down", radial, RADIUS)
    removal = DEPTH * radial * 3 * FEED * speed / TURN
    engaged = 3 * (leave - entry) / TURN
    return KTC * removal, KTE * engaged * DEPTH * RADIUS * speed


def recorded(case, cut_off, tmp_path, idle):
    """Records in the cut with a power that ripples with the teeth."""
    noise = np.random.default_rng(6)
    record = RecordDescription("cut", "unknown", 0.005, {"P": Channel("spindle power")})
    made = measurement(case, cut_off, tmp_path, as_in_the_case, record)
    runs = []
    for run, (rpm, radial, _) in zip(made.runs, CUTS, strict=True):
        time, power = run.signals["time"], sum(powers(radial, rpm))
        ripple = np.sin(3 * TRUE_SPEED * rpm * TURN / 60.0 * time + 1.0)
        read = IDLE + power * (1.0 + 0.4 * ripple + 0.05 * noise.standard_normal(time.size))
        runs.append(replace(run, signals={**run.signals, "P": read}))
    return replace(made.with_runs(runs), idle_power=idle)


def of_power(found):
    return [one for one in found.errors if one.channel == "spindle_power"]


def test_mean_power_is_that_of_removal_and_rubbing(case, cut_off, tmp_path):
    errors = of_power(compare(recorded(case, cut_off, tmp_path, IDLE)))
    assert len(errors) == len(CUTS)
    for one, (rpm, radial, _) in zip(errors, CUTS, strict=True):
        # ends of the record hold parts of a revolution, over which the ripple does not vanish
        assert one.error < 0.05 * sum(powers(radial, rpm))
        assert one.over_noise < 1.0


def test_a_power_that_is_off_is_seen(case, cut_off, tmp_path):
    """A cutting coefficient that is a fifth off moves the power of cutting by a fifth."""
    whole = recorded(case, cut_off, tmp_path, IDLE)
    right = of_power(compare(whole))
    wrong = of_power(compare(whole, case.patch({"material.Ktc": "1920 MPa"})))
    for one, other, (rpm, radial, _) in zip(right, wrong, CUTS, strict=True):
        cutting, rubbing = powers(radial, rpm)
        moved = 0.2 * cutting / (cutting + rubbing)
        assert other.relative == pytest.approx(moved, abs=0.2 * moved + one.relative)
        assert other.relative > 3.0 * one.relative


def test_without_a_level_the_power_is_noted(case, cut_off, tmp_path):
    found = compare(recorded(case, cut_off, tmp_path, None))
    assert of_power(found) == []
    notes = [one.description for one in found.checks if one.severity == NOTE]
    assert any("the power in the air is not known" in words for words in notes)


def test_a_mean_over_a_revolution_forgets_its_ripple():
    time = np.arange(4000) * 1e-4
    speed = 100.0 * math.pi  # 200 samples a revolution
    values = 5.0 + 2.0 * time + np.cos(3 * speed * time)
    mean = over_revolution(values, time, speed)
    inner = slice(150, -150)
    # a window of 200 samples begins at its first: half a sample early
    assert mean[inner] == pytest.approx(5.0 + 2.0 * (time[inner] - 0.5e-4), abs=1e-9)


class Machine:
    """What a cut on a machine tells of its drives."""

    time = np.linspace(0.0, 1.0, 101)

    def torque_of(self, drive):
        return {"Y": 3.0 * self.time}[drive]


def test_torques_are_those_of_the_drives_of_a_machine():
    """On modes, or of a drive that the machine has not, there is none to predict."""
    on_machine = load(EXAMPLES / "face-mill-chatter" / "case.toml")
    channels = {"M": Channel("drive torque", axis="Y"), "other": Channel("drive torque", axis="Q")}
    run = Run("run", {}, {"time": Machine.time, "M": Machine.time, "other": Machine.time})
    components = with_torques(run, channels, on_machine).components
    assert list(components) == ["M"]
    assert predicted_signal(Machine(), components["M"], 100.0) == pytest.approx(3.0 * Machine.time)
    modes = on_machine.model_copy(update={"structure": None})
    assert with_torques(run, channels, modes).components == {}
