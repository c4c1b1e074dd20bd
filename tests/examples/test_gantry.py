"""The gantry of the examples against what Moten et al. publish."""

import numpy as np
import pytest

import chatter
from chatter.compile.machine_parts import assembled_machine
from chatter.engine.loop_stability import least_stable_motion
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


@pytest.mark.parametrize(
    ("axis", "way", "head", "bending"),
    [("X", "x", "middle", 98.0), ("X", "x", "left", 112.0), ("Y", "y", "middle", 98.0)],
)
def test_bending_has_no_peak_in_x_and_y(machine, run, axis, way, head, bending):
    place = run.LEFT if head == "left" else 0.0
    assert run.peaks_between(run.from_motor(machine, "X", "z", place), 95.0, 115.0) != "none"
    frf = run.from_motor(machine, axis, way, place)
    assert run.peaks_between(frf, 0.95 * bending, 1.05 * bending) == "none"


def test_the_time_optimal_square_is_off_as_published(machine):
    assert least_stable_motion(assembled_machine(machine), machine.step).stable
    move = chatter.move(machine, "planned")
    assert np.max(np.abs(move.contour)) == pytest.approx(30e-6, rel=0.15)
