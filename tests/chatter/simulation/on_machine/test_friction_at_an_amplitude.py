"""Lobes with friction linearised at an amplitude against cuts that settle at that amplitude."""

import numpy as np
import pytest

import chatter
from chatter.compile.linearised_machine import machine_structure
from chatter.description.errors import InputError
from tests.places import EXAMPLES, example_module

EXAMPLE = EXAMPLES / "friction-amplitude"


@pytest.fixture(scope="module")
def example():
    return example_module("friction-amplitude")


@pytest.fixture(scope="module")
def case():
    return chatter.load(EXAMPLE / "case.toml")


@pytest.mark.parametrize("depth", [9.0, 10.0, 11.0])
def test_a_cut_settles_where_its_depth_is_the_limit(example, case, depth):
    amplitude = example.amplitude_reached(case, depth)
    # the chip, 0.2 mm thick at the most, is cut unevenly by vibration of 2 um
    assert example.limit_at(case, amplitude) == pytest.approx(depth, rel=0.02)


LUGRE = {
    "law": "lugre",
    "on": {"axis": "Y"},
    "bristle_stiffness": 4e6,
    "bristle_damping": 500.0,
    "viscous": 100.0,
    "coulomb": 10.0,
    "static": 12.0,
    "stribeck_velocity": 1e-3,
}


@pytest.mark.parametrize("depth", [10.5, 11.0])
def test_the_same_with_bristles(example, case, depth):
    """LuGre with more friction at rest than in motion, and with damping of its bristles."""
    rubbing = case.with_machine(case.machine_file().patch({"friction.guide": LUGRE}))
    amplitude = example.amplitude_reached(rubbing, depth)
    assert amplitude > 0.2
    assert example.limit_at(rubbing, amplitude) == pytest.approx(depth, rel=0.02)


def test_below_the_limit_at_rest_vibration_dies_out(example, case):
    assert example.amplitude_reached(case, 8.4) < 0.05


def test_between_rest_and_sliding(case):
    """At vanishing vibration a spring of 2 ah fc; far beyond 1/ah it hardly counts."""
    y = (slice(None), 1, 1)
    free = machine_structure(case.patch({"structure.friction": False})).receptance()
    for amplitude, spring in ((1e-8, 2 * 2e5 * 10.0), (2e-2, 0.0)):
        lines, values = machine_structure(
            case.patch({"structure.friction_amplitude": amplitude})
        ).receptance()
        freed = np.interp(lines, free[0], free[1][y].real) + 1j * np.interp(
            lines, free[0], free[1][y].imag
        )
        wanted = 1.0 / (1.0 / freed + spring)
        assert values[y] == pytest.approx(wanted, rel=2e-3)


def test_an_amplitude_without_friction(case):
    with pytest.raises(InputError) as error:
        case.patch({"structure.friction": False, "structure.friction_amplitude": "1 um"})
    assert "structure.friction_amplitude" in str(error.value)


def test_frictions_at_motors_move_by_the_transmission(case):
    """A friction at the motor, 1 N m over 10 mm/2 pi, is one of the axis in other units."""
    i = 10e-3 / (2 * np.pi)
    law = {"law": "tanh-hysteresis"}
    lines = {}
    machine = case.machine_file()
    for name, scale, on in (("axis", 1.0, {"axis": "Y"}), ("motor", i, {"motor": "Y"})):
        guide = {**law, "on": on, "coulomb": 10.0 * scale, "hysteresis_slope": 2e5 * scale}
        changed = case.patch({"structure.friction_amplitude": "3 um"})
        stiff = {"axis.Y.drive.nut_stiffness": 1e12, "axis.Y.brake.stiffness": 50.0}
        machine_file = machine.patch({**stiff, "friction.guide": guide})
        lines[name] = machine_structure(changed.with_machine(machine_file)).receptance()[1]
    assert lines["motor"] == pytest.approx(lines["axis"], rel=1e-3)
