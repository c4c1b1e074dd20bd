"""The machining centre with the published friction of its guides and screws."""

import numpy as np
import pytest

import chatter
from chatter.compile.linearised_friction import linearised_frictions
from chatter.compile.machine_parts import assembled_machine
from chatter.simulation.virtual_tests.frf import peaks
from chatter.simulation.virtual_tests.from_file import one_frf
from dynamics.frf.container import Frf
from dynamics.machine.harmonic import receptance
from tests.places import EXAMPLES, example_module

EXAMPLE = EXAMPLES / "machine-coupled-milling" / "machine.toml"
Y_MOVES = {"Y": 0.42 / 60.0}
#: Table 1: f_c, C, C_v, a_v, a_h
ROTATION = {
    "x": (0.188, 3.2e-3, 0.03, 2.0, 1.15e4),
    "y": (0.113, 3.2e-3, 0.25, 2.0, 1.15e4),
    "z": (0.046, 1.3e-3, 0.35, 2.75, 1.15e4),
}
TRANSLATION = {
    "x": (98.6, 856.2, 3000.0, 500.0, 1.15e4),
    "y": (99.2, 426.7, 6000.0, 500.0, 1.15e4),
    "z": (17.95, 189.3, 6000.0, 800.0, 1.15e4),
}


@pytest.fixture(scope="module")
def machine():
    return chatter.load_machine(EXAMPLE)


def peak_near_50(frf):
    near = [one for one in peaks(frf) if 40.0 < one["frequency_Hz"] < 65.0]
    highest = max(near, key=lambda one: one["magnitude"])
    return highest["frequency_Hz"], highest["magnitude"]


def in_motion(machine, in_cut=False, friction=True):
    frictions = linearised_frictions(assembled_machine(machine, {}), Y_MOVES) if friction else {}
    state = assembled_machine(machine, {}, in_cut=in_cut)
    row = state.structure.port("table", [0.0, 1.0, 0.0])
    lines = np.arange(40.0, 65.0, 0.1)
    values = receptance(state, lines, [row], machine.step, frictions)[:, 0, 0]
    return peak_near_50(Frf(lines, 2j * np.pi * lines * values, "mobility"))


def test_thirty_three_freedoms_and_three_axes_that_move_freely(machine):
    structure = assembled_machine(machine, {}).structure
    assert structure.size == 33
    frequency = structure.natural_frequencies()
    assert np.all(frequency[:3] < 1e-3)
    assert frequency[3] > 10.0


@pytest.mark.parametrize("kind", ["rotation", "translation"])
@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_friction_of_table_1(machine, kind, axis):
    law = machine.friction[f"{kind}_{axis}"].spec()
    low = law.low_speed_viscous, law.low_speed_decay
    given = (law.coulomb, law.viscous, *low, law.hysteresis_slope)
    assert given == pytest.approx({"rotation": ROTATION, "translation": TRANSLATION}[kind][axis])


def test_contact(machine):
    assert machine.get("contact.stiffness") == pytest.approx(2.5e6)
    assert machine.get("contact.damping") == pytest.approx(3350.0)


def test_calibrated_in_motion_and_to_the_shift_by_the_contact(machine):
    frequency, height = in_motion(machine)
    assert frequency == pytest.approx(50.0, abs=0.2)
    assert height == pytest.approx(4.2e-4, rel=0.01)
    assert in_motion(machine, in_cut=True)[0] - frequency == pytest.approx(2.0, abs=0.1)


def test_motion_is_nearly_as_without_friction(machine):
    moving, without = in_motion(machine), in_motion(machine, friction=False)
    assert without[0] == pytest.approx(moving[0], abs=0.5)
    # published: identical; here the axes at rest still hold their motors
    assert without[1] == pytest.approx(moving[1], rel=0.2)


def test_friction_at_rest_takes_the_peak_to_less_than_half(machine):
    section = machine.frf["rest"].model_copy(update={"averages": 1, "period": 2.0})
    frequency, height = peak_near_50(
        one_frf(machine, "rest", section).as_quantity("mobility").tested
    )
    assert frequency == pytest.approx(50.0, abs=1.5)
    # published 1.6e-4, by a blow of unknown level
    assert height == pytest.approx(1.6e-4, rel=0.2)


@pytest.mark.parametrize("speed", [0.5, 10.0])
def test_torque_at_constant_speed_is_that_of_both_frictions(machine, speed):
    lead = machine.get("axis.Y.drive.lead") / (2.0 * np.pi)
    velocity = speed * lead
    asked = {"move.speed.velocity": velocity, "move.speed.travel": [3.0 * velocity]}
    went = chatter.move(machine.patch(asked), "speed")
    f, c, cv, av, _ = ROTATION["y"]
    screw = f + (c + cv * np.exp(-av * speed)) * speed
    f, c, cv, av, _ = TRANSLATION["y"]
    guide = f + (c + cv * np.exp(-av * velocity)) * velocity
    last = went.time > went.time[-1] - 0.3
    assert np.mean(went.effort[last, 0]) == pytest.approx(screw + lead * guide, rel=1e-3)


def test_y_reverses_along_one_branch_of_about_300_um(machine):
    went = chatter.move(machine.patch({"move.circle.turns": 1.0}), "circle")
    turn = np.argmin(went.motor[:, 0])
    way, torque = went.motor[turn:, 0] - went.motor[turn, 0], went.effort[turn:, 0]
    at = dict(
        zip((30e-6, 150e-6, 300e-6), np.interp((30e-6, 150e-6, 300e-6), way, torque), strict=True)
    )
    sliding = np.interp(350e-6, way, torque)
    # the screw has turned over after 300 urad, half a micrometre; the guide is on its way
    assert at[30e-6] < 0.6 * sliding
    assert 0.85 * sliding < at[150e-6] < sliding
    assert at[300e-6] == pytest.approx(sliding, rel=0.02)


def test_the_face_mill_cuts_on_the_same_machine():
    """But for the spindle, which the end of its file adds."""
    milled = EXAMPLE.parents[1] / "face-mill-chatter" / "machine.toml"
    same, spindle = milled.read_text().split("\n# The spindle of this example alone")
    assert same.rstrip() == EXAMPLE.read_text().rstrip()
    assert "[axis.S]" in spindle


def test_contact_is_identified_from_the_pair_of_responses(machine):
    """What is found raises the frequency by 2 Hz and leaves 62.7 % of the peak, near 2.50 N/um."""
    example = example_module("machine-coupled-milling")
    stiffness, damping = example.identified_contact(machine)
    found = machine.patch({"contact.stiffness": stiffness, "contact.damping": damping})
    tested = chatter.frf(found, list(example.BORING))
    free, held = (example.peak_near_50(tested[name].tested) for name in example.BORING)
    assert held[0] - free[0] == pytest.approx(2.0, abs=0.05)
    assert held[1] / free[1] == pytest.approx(0.627, rel=0.01)
    assert stiffness == pytest.approx(2.50e6, rel=0.15)


def test_boring_trial_shows_the_spike_of_figure_6(machine):
    trial = example_module("machine-coupled-milling", "boring").boring_trial(machine)
    # the insert is at +y, after whole revolutions
    assert trial.released * 3.0 == pytest.approx(round(trial.released * 3.0), abs=1e-3)
    assert trial.released == pytest.approx(4.7, abs=0.05)
    assert trial.residual == pytest.approx(0.2, rel=0.15)
    assert trial.spike > 1.0
    behind = trial.time > trial.released
    before = (trial.time > 3.5) & ~behind
    assert (
        np.abs(trial.acceleration[behind]).max() > 20.0 * np.abs(trial.acceleration[before]).max()
    )


def test_the_force_of_boring_turns_with_the_insert(machine):
    """Without contact: 1800 MPa on 2.5 by 0.1 mm and 40 N/mm on 2.5 mm make 550 N."""
    boring = example_module("machine-coupled-milling", "boring")
    free = machine.patch({"contact.stiffness": 1e-3, "contact.damping": 1e-3})
    trial = boring.boring_trial(free)
    before = (trial.time > 1.0) & (trial.time < trial.released)
    size = np.hypot(*trial.force[before].T)
    assert size == pytest.approx(np.full(size.size, 550.0), rel=1e-6)
    assert trial.angle_of_largest_fx == pytest.approx(0.0, abs=0.5)
