"""The test machining centre of the examples: published frequencies and trends."""

import numpy as np
import pytest

import chatter
from chatter.compile.linearised_friction import linearised_frf
from chatter.compile.machine_parts import assembled_machine
from chatter.simulation.virtual_tests.frf import peaks
from chatter.simulation.virtual_tests.from_file import one_frf
from dynamics.frf.container import Frf
from dynamics.receptance.coupling import PointPort
from dynamics.reduction.modal_truncation import state_space, truncated, undamped_modes
from tests.places import EXAMPLES, example_module

EXAMPLE = EXAMPLES / "machine-drive-control" / "machine.toml"
BRAKES = {"X": "brake", "Y": "brake", "Z": "brake"}
S1 = {"X": 0.885, "Y": 0.327, "Z": 0.0}
S2 = {"X": 0.855, "Y": 0.373, "Z": 0.342}


@pytest.fixture(scope="module")
def machine():
    return chatter.load_machine(EXAMPLE)


def response(file, state, way="x", against="work", velocity=None, lowest=25.0):
    row = state.structure.port("tool", np.eye(3)["xyz".index(way)], against)
    lines = np.arange(lowest, 150.0, 0.25)
    values = linearised_frf(state, file.step, lines, row, row, velocity)
    return peaks(Frf(lines, values, "receptance"))


def nearest(found, frequency):
    return min(found, key=lambda one: abs(one["frequency_Hz"] - frequency))


@pytest.mark.parametrize(
    ("position", "way", "against", "published"),
    [
        (S1, "x", None, (74.0, 100.0)),
        (S1, "y", None, (55.0,)),
        (S2, "x", "work", (38.0, 75.0, 110.0, 122.0)),
    ],
)
def test_frequencies_with_brakes_on(machine, position, way, against, published):
    state = assembled_machine(machine, BRAKES, position).without_friction()
    found = response(machine, state, way, against)
    for frequency in published:
        # the publication's own model deviates by up to 4 Hz
        assert nearest(found, frequency)["frequency_Hz"] == pytest.approx(frequency, abs=2.0)


@pytest.mark.parametrize(
    ("conditions", "there"),
    [(BRAKES, True), ({"Y": "brake", "Z": "brake"}, True), ({"X": "brake", "Y": "brake"}, False),
     ({}, False)],
)  # fmt: skip
@pytest.mark.parametrize("way", ["x", "z"])
def test_the_control_of_z_takes_the_axial_mode_of_z_away(machine, conditions, there, way):
    found = response(machine, assembled_machine(machine, conditions, S2), way, lowest=105.0)
    assert any(118.0 < one["frequency_Hz"] < 126.0 for one in found) == there


def test_higher_velocity_gain_raises_the_first_mode_and_lowers_its_frequency(machine):
    key = "axis.X.control.velocity.proportional_gain"
    modes = []
    for gain in (30.0, 15.0, 7.5):
        state = assembled_machine(machine.patch({key: gain}), {}, S2)
        modes.append(nearest(response(machine, state, velocity={"X": 0.1 / 60.0}), 38.0))
    heights = [one["magnitude"] for one in modes]
    frequencies = [one["frequency_Hz"] for one in modes]
    assert heights[0] > heights[1] > heights[2]
    assert frequencies[0] < frequencies[1] < frequencies[2]


def test_lower_velocity_gain_raises_the_eigenvalue_of_the_second_mode(machine):
    found = example_module("machine-drive-control", "eigenvalues")
    key = "axis.X.control.velocity.proportional_gain"
    lines = np.linspace(28.0, 125.0, 400)
    second = []
    for gain in (30.0, 15.0, 7.5):
        state = assembled_machine(machine.patch({key: gain}), {}, S2)
        row = state.structure.port("tool", np.array([1.0, 0.0, 0.0]), "work")
        values = linearised_frf(state, machine.step, lines, row, row, {"X": 0.1 / 60.0})
        second.append(found.most_damped(found.eigenvalues(lines, values), 70.0, 95.0))
    frequencies = [one.frequency for one in second]
    assert frequencies[0] < frequencies[1] - 2.0
    assert frequencies[1] < frequencies[2]


def test_eigenvalues_of_a_response_in_closed_form():
    """Three vibrations, one of them damped until it is no peak beside the next."""
    found = example_module("machine-drive-control", "eigenvalues")
    frequency, damping = np.array([40.0, 90.0, 92.0]), np.array([0.03, 0.12, 0.015])
    lines = np.linspace(28.0, 125.0, 400)
    s, w = 2j * np.pi * lines[:, None], 2.0 * np.pi * frequency
    values = np.sum(1.0 / (s**2 + 2.0 * damping * w * s + w**2), axis=1) + 1e-6
    told = np.array(found.eigenvalues(lines, values, 6))
    np.testing.assert_allclose(told, np.column_stack([frequency, damping]), rtol=1e-8)
    assert found.most_damped([found.Eigenvalue(*one) for one in told], 70.0, 95.0)[0] > 89.0


def test_modal_state_space_below_200_hz_is_the_full_model(machine):
    full = assembled_machine(machine.patch({"highest_frequency": None}), BRAKES, S2).structure
    modal = truncated(full, undamped_modes(full, 200.0), residual_at=("tool", "work"))
    port = PointPort("tool", [1.0, 0.0, 0.0], "work")
    system = state_space(modal, [port], [port])
    row = port.row(full)
    for omega in 2.0 * np.pi * np.array([22.5, 38.0, 76.0, 109.0, 122.0]):
        dynamic = full.stiffness - omega**2 * full.mass + 1j * omega * full.damping
        exact = row @ np.linalg.solve(dynamic, row)
        inner = np.linalg.solve(1j * omega * np.eye(len(system.a)) - system.a, system.b)
        assert (system.c @ inner + system.d)[0, 0] == pytest.approx(exact, rel=0.01)


def test_the_shaker_shows_its_mode_and_adds_its_mass(machine):
    """On a rigid tool alone F/F_motor is 1 / (1 - (f / 250)^2); FRFs over the force keep peaks."""
    shaker = example_module("machine-drive-control", "shaker")
    tested = shaker.shaken(machine, S2, BRAKES)
    quiet = (tested.frequency > 45.0) & (tested.frequency < 65.0)
    wanted = 1.0 / (1.0 - (tested.frequency[quiet] / shaker.NATURAL) ** 2)
    assert tested.transmitted[quiet] == pytest.approx(wanted, rel=0.05)
    assert tested.transmitted[-1] > 1.5
    ideal = one_frf(machine, "brake", machine.frf["brake"]).tested
    for frequency in (38.0, 110.0):
        near = np.abs(tested.frequency / frequency - 1.0) < 0.04
        lines = np.abs(ideal.frequency / frequency - 1.0) < 0.04
        ratio = np.abs(tested.receptance[near]).max() / np.abs(ideal.values[lines]).max()
        assert ratio == pytest.approx(1.0, abs=0.15)
