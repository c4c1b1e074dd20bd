"""Axis moves, FRFs, points of stability: faults are said, healthy data pass."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from chatter.compile.structure import structure_of
from chatter.description.case import loads
from chatter.explain.checking import checked
from chatter.explain.explanation import explain
from chatter.explain.measurement import Measurement, Run
from dynamics.modal.modes import receptance_matrix

MODES = """
[tool]
kind = "end mill"
teeth = 2
diameter = "20 mm"
[material]
Ktc = "800 MPa"
Krc = "250 MPa"
[cut]
mode = "down"
spindle_speed = "9000 rpm"
feed_per_tooth = "0.1 mm"
axial_depth = "1 mm"
radial_depth = "5 mm"
[[structure.mode]]
frequency = "700 Hz"
damping = 0.03
mass = "0.6 kg"
direction = [1, 0, 0]
[[structure.mode]]
frequency = "550 Hz"
damping = 0.03
mass = "0.5 kg"
direction = [0, 1, 0]
"""


def axis_moves() -> Measurement:
    """Moves of 150 kg with viscous and Coulomb friction, to and fro, with noise."""
    case = loads('[axis]\nmoving_mass = "145 kg"\nviscous_friction = "700 N*s/m"\n')
    runs = []
    time = np.arange(0.0, 2.0, 1e-3)
    for number, stroke in enumerate((0.02, 0.05, 0.1)):
        random = np.random.default_rng(number)
        omega = 2.0 * np.pi * (1.5 - 0.3 * number)
        position = stroke * (1.0 - np.cos(omega * time)) / 2.0
        velocity = stroke * omega * np.sin(omega * time) / 2.0
        force = 150.0 * stroke * omega**2 * np.cos(omega * time) / 2.0
        force += 760.0 * velocity + 60.0 * np.sign(velocity)
        signals = {
            "time": time,
            "command": position,
            "position": position + 1e-8 * random.standard_normal(time.size),
            "velocity": velocity + 3e-5 * random.standard_normal(time.size),
            "force": force + 2.0 * random.standard_normal(time.size),
        }
        runs.append(Run(f"move{number + 1}.csv", {}, signals))
    return Measurement("axis", "moves", Path(), case, tuple(runs))


def tap_tests() -> Measurement:
    """Three FRFs in x and in y each, 2 % of noise."""
    case = loads(MODES)
    frequency = np.linspace(50.0, 1500.0, 600)
    matrix = receptance_matrix(structure_of(case).modes, frequency)
    random = np.random.default_rng(0)
    runs = []
    for axis, direction in enumerate("xy"):
        for number in range(3):
            noise = random.standard_normal((2, frequency.size)) @ np.diag(
                0.02 * np.abs(matrix[:, axis, axis])
            )
            values = matrix[:, axis, axis] + noise[0] + 1j * noise[1]
            signals = {"frequency": frequency, "real": values.real, "imag": values.imag}
            name = f"{direction}{number + 1}.csv"
            runs.append(Run(name, {}, signals, condition="idle", direction=direction))
    return Measurement("frf", "taps", Path(), case, tuple(runs))


def cutting_tests() -> Measurement:
    """Sixty points around the limits of the declared case."""
    from chatter.explain.stability_margin import stability_margins

    case = loads(MODES)
    random = np.random.default_rng(0)
    speeds = random.uniform(6000.0, 12000.0, 60) * np.pi / 30.0
    depths = 10.0 ** random.uniform(-3.6, -2.2, 60)
    stable = (stability_margins(case, speeds, depths) > 0.0).astype(np.float64)
    signals = {"spindle_speed": speeds, "axial_depth": depths, "stable": stable}
    return Measurement("stability", "tests", Path(), case, (Run("points.csv", {}, signals),))


MAKERS = {"axis": axis_moves, "frf": tap_tests, "stability": cutting_tests}


def changed(kind: str, edit, runs=None) -> Measurement:
    measurement = MAKERS[kind]()
    return replace(
        measurement,
        runs=tuple(
            replace(run, signals=edit(dict(run.signals))) if runs is None or k in runs else run
            for k, run in enumerate(measurement.runs)
        ),
    )


def scaled(factor, *channels):
    return lambda signals: {
        name: factor * values if name in channels else values for name, values in signals.items()
    }


@pytest.mark.parametrize("kind", MAKERS)
def test_healthy_data_pass(kind):
    assert checked(MAKERS[kind]()).findings == ()


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (scaled(-1.0, "force"), "sign of the force is turned in 3 of 3 runs"),
        (scaled(1000.0, "force"), "unit of force"),
        (scaled(1e-3, "velocity"), "contradict"),
        (scaled(-1.0, "velocity"), "contradict"),
        (scaled(60.0, "velocity"), "minutes"),
        (scaled(1000.0, "time"), "milliseconds"),
        (scaled(0.0, "position"), "position is dead"),
        (scaled(-1.0, "position", "velocity"), "contradicts the command"),
    ],
)
def test_faults_of_axis_moves(edit, words):
    finding = checked(changed("axis", edit)).findings[0]
    assert finding.severity == "fatal"
    assert words in finding.description


def test_a_gap_in_a_move_is_left_out_and_the_rest_explained():
    def edit(signals):
        force = signals["force"].copy()
        force[500:560] = np.nan
        return {**signals, "force": force}

    result = explain(changed("axis", edit, [0]))
    made = result.predictions.made
    summary = result.summary()
    # the verdict, the errors and the residuals ask again for what the search predicted
    assert result.predictions.made <= made + len(result.measurement.runs)
    assert [one["severity"] for one in summary["checks"]] == ["samples"]
    assert summary["verdict"] == "explained"
    assert summary["effects"][0]["name"] == "coulomb_friction"
    (told,) = summary["effects"][0]["parameters"].values()
    assert told["value"] == pytest.approx(60.0, rel=0.02)


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (scaled(1000.0, "real", "imag"), "unit is wrong by 1000"),
        (scaled(-1.0, "real", "imag"), "sign is turned"),
        (
            lambda s: {
                **s,
                "real": -s["imag"] * s["frequency"],
                "imag": s["real"] * s["frequency"],
            },
            "mobility",
        ),
        (
            lambda s: {
                **s,
                "real": -s["real"] * (2.0 * np.pi * s["frequency"]) ** 2,
                "imag": -s["imag"] * (2.0 * np.pi * s["frequency"]) ** 2,
            },
            "accelerance",
        ),
    ],
)
def test_faults_of_all_frfs(edit, words):
    finding = checked(changed("frf", edit)).findings[0]
    assert finding.severity == "fatal"
    assert words in finding.description


def test_exchanged_directions_are_said():
    measurement = tap_tests()
    other = {"x": "y", "y": "x"}
    runs = tuple(replace(run, direction=other[run.direction]) for run in measurement.runs)
    finding = checked(replace(measurement, runs=runs)).findings[0]
    assert finding.severity == "fatal"
    assert "exchanged" in finding.description


def test_an_frf_unlike_its_repetitions_is_left_out():
    looked_at = checked(changed("frf", scaled(1.8, "real", "imag"), [1]))
    (finding,) = looked_at.findings
    assert (finding.severity, finding.run) == ("run", "x2.csv")
    assert len(looked_at.measurement.runs) == 5


@pytest.mark.parametrize(
    ("edit", "severity", "words"),
    [
        (lambda s: {**s, "stable": 1.0 - s["stable"]}, "fatal", "turned round"),
        (scaled(30.0 / np.pi, "spindle_speed"), "fatal", "rpm taken as rad/s"),
        (scaled(np.pi / 30.0, "spindle_speed"), "fatal", "rad/s taken as rpm"),
        (lambda s: {**s, "axial_depth": np.r_[-1.0, s["axial_depth"][1:]]}, "samples", "sense"),
        (lambda s: {**s, "stable": np.ones(60)}, "note", "all 60 verdicts are stable"),
    ],
)
def test_faults_of_points(edit, severity, words):
    finding = checked(changed("stability", edit)).findings[0]
    assert finding.severity == severity
    assert words in finding.description
