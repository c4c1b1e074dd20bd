"""The Mandelli M5 of the examples: Tables 1 and 3, and its closed loops."""

import numpy as np
import pytest
from scipy.optimize import least_squares

import chatter
from chatter.compile.linearised_friction import linearised_frf, linearised_frictions, rigid_motion
from chatter.compile.machine_parts import assembled_machine
from chatter.description.errors import InputError
from chatter.simulation.virtual_tests.frf import peaks
from chatter.simulation.virtual_tests.loop_response import (
    LoopSweep,
    loop_by_sweep,
    loop_response,
    velocity_controlled,
)
from dynamics.frf.container import Frf
from dynamics.friction.identification.filtering import LowPass
from dynamics.friction.identification.linear_fit import fit_linear
from dynamics.friction.identification.record import DriveRecord
from dynamics.machine.harmonic import receptance
from tests.places import EXAMPLES

EXAMPLE = EXAMPLES / "machine-mandelli-m5" / "machine.toml"
TRAVEL = 0.020 / (2.0 * np.pi)  # m/rad of the driving screw
TABLE_1 = {"Y": (3.57, 0.0105, 0.0192), "Z": (3.87, 0.075, 0.0272)}
SPEED = 0.03
LATERAL = {
    "Y": ("connector.sliders_y_left.stiffness.x", "connector.sliders_y_right.stiffness.x"),
    "Z": ("connector.sliders_z.stiffness.x",),
}


@pytest.fixture(scope="module")
def file():
    return chatter.load_machine(EXAMPLE)


@pytest.fixture(scope="module")
def machine(file):
    return assembled_machine(file)


@pytest.mark.parametrize("axis", ["Y", "Z"])
def test_inertia_and_friction_at_the_driving_screw_are_those_of_table_1(file, machine, axis):
    coulomb, viscous, inertia = TABLE_1[axis]
    motion = rigid_motion(machine, {axis: TRAVEL})
    assert motion @ machine.structure.mass @ motion == pytest.approx(inertia, rel=1e-4)
    assert file.get(f"friction.{axis}.coulomb") * TRAVEL == pytest.approx(coulomb, rel=1e-4)
    assert file.get(f"friction.{axis}.viscous") * TRAVEL**2 == pytest.approx(viscous, rel=1e-4)


def test_the_sliders_are_those_of_table_3(file):
    for side in ("left", "right"):
        slider = f"connector.sliders_y_{side}"
        assert file.get(f"{slider}.stiffness.z") == 3e8
        assert file.get(f"{slider}.stiffness.x") == 1.5e8
        assert file.get(f"{slider}.damping.x") == file.get(f"{slider}.damping.z") == 12e3
    assert file.get("connector.sliders_z.stiffness.y") == 4e8
    assert file.get("connector.sliders_z.stiffness.x") == 2.5e8
    assert file.get("connector.sliders_z.damping.x") == 8e3


def test_lateral_stiffness_comes_back_from_a_frf_in_x(file):
    frequency = np.linspace(10.0, 200.0, 40)

    def in_x(logarithms):
        stiffness = dict(zip("YZ", np.exp(logarithms), strict=True))
        changed = file.patch({path: stiffness[axis] for axis in "YZ" for path in LATERAL[axis]})
        whole = assembled_machine(changed).without_friction()
        row = whole.structure.port("tool", (1.0, 0.0, 0.0))
        return np.log(np.abs(linearised_frf(whole, file.step, frequency, row, row)))

    wanted = in_x(np.log([1.5e8, 2.5e8]))
    start = np.log([1.7e8, 2.8e8])
    found = least_squares(
        lambda x: in_x(x) - wanted,
        start,
        diff_step=1e-3,
        f_scale=0.3,
        loss="soft_l1",
        xtol=1e-3,
        max_nfev=6,
    )
    assert np.exp(found.x) == pytest.approx([1.5e8, 2.5e8], rel=1e-2)


@pytest.mark.parametrize(("loop", "amplitude"), [("position", 3e-7), ("velocity", 5e-4)])
def test_the_loops_in_closed_form_are_those_of_a_sweep_in_time(file, machine, loop, amplitude):
    sweep = LoopSweep(loop, (5.0, 400.0), amplitude, 0.5, SPEED, leading=2)
    lines, swept = loop_by_sweep(machine, file.step, "Y", sweep)
    sliding = linearised_frictions(machine, {"Y": SPEED})
    exact = getattr(loop_response(machine, file.step, "Y", lines, sliding), loop)
    inside = (lines > 8.0) & (lines < 380.0)
    assert np.count_nonzero(inside) > 150
    assert np.max(np.abs(swept / exact - 1.0)[inside]) < 0.01


def test_slow_set_points_are_followed(file, machine):
    found = loop_response(machine, file.step, "Y", [0.5, 1.0])
    assert np.abs(found.position) == pytest.approx([1.0, 1.0], abs=1e-2)
    assert np.abs(found.velocity) == pytest.approx([1.0, 1.0], abs=1e-2)


def test_without_feedforward_the_position_loop_is_a_lag_of_its_gain(file):
    plain = {"axis.Y.control.feedforward.velocity": 0.0, "axis.Y.control.position.gain": 2.0}
    machine = assembled_machine(file.patch(plain))
    lines = np.array([0.2, 0.5, 1.0])
    found = loop_response(machine, file.step, "Y", lines).position
    lag = 1.0 / (1.0 + 2j * np.pi * lines / 2.0)
    delay = np.exp(-2j * np.pi * lines * 0.003)  # of the set point, three samples
    assert np.abs(found / (lag * delay) - 1.0) == pytest.approx(np.zeros(3), abs=2e-2)


def test_the_velocity_loop_has_the_anti_resonance_of_the_load_on_a_held_screw(file, machine):
    lines = np.linspace(10.0, 150.0, 1401)
    sliding = linearised_frictions(machine, {"Y": SPEED})
    found = loop_response(machine, file.step, "Y", lines, sliding)
    valleys = [one["frequency_Hz"] for one in peaks(Frf(lines, 1.0 / found.velocity, "receptance"))]
    # a motor that stands still is a motor whose brake is on, belt and screw behind it elastic
    held = assembled_machine(file, {"Y": "brake"})
    row = held.structure.port("saddle", (0.0, 1.0, 0.0))
    clamped = receptance(held, lines, row[None], file.step, sliding)[:, 0, 0]
    resonances = [one["frequency_Hz"] for one in peaks(Frf(lines, clamped, "receptance"))]
    assert len(valleys) == 2
    for valley in valleys:
        assert min(abs(valley - one) for one in resonances) < 3.0


def test_an_axis_without_control_has_no_loops(file):
    braked = assembled_machine(file, {"Y": "brake"})
    with pytest.raises(InputError, match='"Y" is not under control'):
        loop_response(braked, file.step, "Y", [10.0])
    with pytest.raises(InputError, match="above 0 Hz"):
        loop_response(assembled_machine(file), file.step, "Y", [0.0, 10.0])
    with pytest.raises(InputError, match="is not under control"):
        velocity_controlled(braked, "W")
    with pytest.raises(InputError, match="chirp"):
        loop_by_sweep(
            assembled_machine(file), file.step, "Y", LoopSweep("position", (5.0, 900.0), 1e-6)
        )


def test_dry_friction_at_rest_holds_the_axis(file, machine):
    # where it holds, nothing moves along it: the nut is as still as a pin
    axis = next(one for one in machine.frictions if one.name == "Y")
    nose = machine.structure.port("tool", (0.0, 1.0, 0.0))
    lines = np.array([10.0, 40.0, 90.0])
    held = linearised_frf(machine, file.step, lines, nose, axis.row)
    free = linearised_frf(machine.without_friction(), file.step, lines, nose, axis.row)
    assert np.all(np.abs(held) < 1e-5 * np.abs(free))


@pytest.mark.parametrize("axis", ["Y", "Z"])
def test_table_1_comes_back_from_noisy_torque_records(file, axis):
    coulomb, viscous, inertia = TABLE_1[axis]
    random = np.random.default_rng(3)
    records = []
    for name in ("slow_forward", "slow_backward", "fast_forward", "fast_backward"):
        run = chatter.move(file.patch({f"move.{name}.axes": [axis]}), name)
        # the torque is the mean over a cycle: motion of its middle
        time, angle, speed = (
            0.5 * (one[1:] + one[:-1])
            for one in (run.time, run.motor[:, 0] / TRAVEL, run.velocity[:, 0] / TRAVEL)
        )
        torque = run.effort[1:, 0] + 0.2 * random.standard_normal(speed.size)
        records.append(DriveRecord(time, angle, speed, torque))
    fit = fit_linear(records, low_pass=LowPass(30.0), minimum_speed=3.0)
    assert fit.value("coulomb") == pytest.approx(coulomb, rel=0.02)
    assert fit.value("viscous") == pytest.approx(viscous, rel=0.05)
    assert fit.value("inertia") == pytest.approx(inertia, rel=0.02)
