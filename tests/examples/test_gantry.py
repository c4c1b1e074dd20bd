"""The gantry of the examples against what Moten et al. publish."""

import numpy as np
import pytest

import chatter
from chatter.compile.machine_parts import assembled_machine
from chatter.engine.loop_stability import least_stable_motion
from dynamics.trajectory.path import square
from tests.places import EXAMPLES, example_module

EXAMPLE = EXAMPLES / "machine-gantry"


@pytest.fixture(scope="module")
def machine():
    return chatter.load_machine(EXAMPLE / "machine.toml")


@pytest.fixture(scope="module")
def run():
    return example_module("machine-gantry", "run")


def test_masses(machine):
    whole = assembled_machine(machine, {"X": "free", "Y": "free"})
    # receptance far below the first mode is that of the published masses and the motors' inertia
    lines = np.array([0.05])
    frequency = 2.0 * np.pi * lines[0]
    row = whole.structure.port("tcp", (1.0, 0.0, 0.0))
    moved = whole.structure.receptance(lines, row[None])[0, 0, 0]
    motors = 2.0 * 0.0008 / 0.005**2
    assert -1.0 / (moved.real * frequency**2) == pytest.approx(330.0 + motors, rel=2e-4)
    row = whole.structure.port("tcp", (0.0, 1.0, 0.0))
    moved = whole.structure.receptance(lines, row[None])[0, 0, 0]
    assert -1.0 / (moved.real * frequency**2) == pytest.approx(50.0, rel=2e-4)


def test_bracket_and_bending_are_the_published_ones(machine, run):
    assert run.clamped_bracket(machine) == pytest.approx(182.0, abs=0.2)
    middle = run.from_motor(machine, "X", "z", 0.0)
    assert run.peak_near(middle, 98.0) == pytest.approx(98.0, abs=1.0)
    left = run.from_motor(machine, "X", "z", run.LEFT)
    assert run.peak_near(left, 112.0) == pytest.approx(112.0, abs=3.0)


def test_bending_is_not_seen_in_the_plane(machine, run):
    along_x = run.from_motor(machine, "X", "x", 0.0)
    assert run.peaks_between(along_x, 20.0, 150.0) == "none"
    assert run.peak_near(along_x, 185.0) == pytest.approx(185.0, rel=0.05)


def test_calibration_repeats(machine):
    found = example_module("machine-gantry", "calibrate").calibrated(machine)
    for path in (
        "connector.bracket_root.stiffness.ry",
        "beam.front.segments[0].inner",
        "body.left.mass",
    ):
        assert found.get(path) == pytest.approx(machine.get(path), rel=1e-3)


def test_square_with_stops_keeps_the_limits_of_each_axis(run):
    motion = run.PathWithStops(square(0.05, 0.005), 0.5, 20.0, 800.0)
    time = np.linspace(0.0, motion.duration, 20_001)
    at = motion.at(time)
    jerk = np.diff(at.acceleration, axis=0) / np.diff(time)[:, None]
    assert np.max(np.abs(at.velocity)) <= 0.5 + 1e-9
    assert np.max(np.abs(at.acceleration)) <= 20.0 + 1e-6
    assert np.max(np.abs(jerk)) <= 800.0 * (1.0 + 1e-3)
    # velocity is the derivative of position, and the path is closed
    rate = np.diff(at.position, axis=0) / np.diff(time)[:, None]
    assert np.max(np.abs(rate - 0.5 * (at.velocity[1:] + at.velocity[:-1]))) < 1e-5
    assert at.position[0] == pytest.approx(at.position[-1], abs=1e-12)


def test_square_is_run_within_the_published_order(machine, run):
    assert least_stable_motion(assembled_machine(machine), machine.step).stable
    move = run.square_with_stops(machine)
    largest = np.max(np.abs(move.contour))
    assert 15e-6 < largest < 48e-6  # simulated 30 um, measured 48 um
