"""Energy of moves, and how moves at speed begin."""

import numpy as np
import pytest
import scipy

from chatter.description.errors import InputError
from chatter.description.machine.machine_file import load_machine
from chatter.simulation.virtual_tests.from_file import move
from dynamics.friction.coulomb_stribeck import CoulombStribeck
from tests.chatter.simulation.virtual_tests.conftest import FILE, MOTOR, TABLE, TRANSMISSION

#: another machine: a linear motor that carries 40 kg on dry friction, without springs in its way
LINEAR = """
title = "a linear axis"
damping_ratio = 0.02
step = "100 us"

[body.bed]
mass = "400 kg"
size = ["1 m", "1 m", "0.5 m"]
centre = ["0 mm", "0 mm", "0 mm"]

[body.slide]
mass = "40 kg"
size = ["0.2 m", "0.2 m", "0.2 m"]
centre = ["0 mm", "0 mm", "0 mm"]

[connector.feet]
between = ["bed", "ground"]
at = ["0 mm", "0 mm", "0 mm"]
stiffness = { x = 2e7, y = 1e9, z = 1e9, rx = 1e9, ry = 1e9, rz = 1e9 }

[connector.rail]
between = ["slide", "bed"]
at = ["0 mm", "0 mm", "0 mm"]
stiffness = { y = 1e9, z = 1e9, rx = 1e9, ry = 1e9, rz = 1e9 }

[axis.X]
direction = "x"
moving = "slide"
carrying = "bed"
at = ["0 mm", "0 mm", "0 mm"]
drive = { kind = "linear motor" }

[axis.X.control]
position = { gain = "40 1/s", sample_time = "1 ms" }
velocity = { proportional_gain = "8 kN*s/m", integral_time = "20 ms", sample_time = "200 us" }
current = { sample_time = "100 us" }
feedforward = { velocity = 1.0 }

[friction.rail]
law = "coulomb-stribeck"
on = { axis = "X" }
coulomb = "60 N"
static = "60 N"
stribeck_velocity = "5 mm/s"
viscous = "300 N*s/m"

[move.fast]
kind = "constant speed"
axes = ["X"]
travel = ["150 mm"]
velocity = "0.5 m/s"
acceleration = "4 m/s^2"
jerk = "100 m/s^3"
afterwards = "0 s"
"""
#: file -> axis, travel of the axis per motion of its motor, m/rad or 1, and mass that stops, kg
MACHINES = {
    "screw": (FILE, TRANSMISSION, TABLE + MOTOR / TRANSMISSION**2),
    "linear": (LINEAR, 1.0, 40.0),
}


def moved(folder, name, changes=None):
    path = folder / f"{name}.toml"
    path.write_text(MACHINES[name][0], encoding="utf-8")
    return move(
        load_machine(path).patch({"move.fast.travel_positions": 1, **(changes or {})}), "fast"
    )


def imbalance(energy):
    return energy["work"] + energy["travel"] - energy["dissipated"] - energy["stored"]


@pytest.mark.parametrize("name", MACHINES)
def test_the_drive_pays_for_friction_damping_and_what_is_stored(name, tmp_path):
    energy = moved(tmp_path, name).energy
    paid = energy["friction"] + energy["dissipated"] + energy["kinetic"] + energy["elastic"]
    assert energy["drives"] == pytest.approx(paid, rel=1e-4)
    assert energy["work"] == pytest.approx(energy["drives"] - energy["friction"], abs=1e-9)
    assert energy["stored"] == pytest.approx(energy["kinetic"] + energy["elastic"], abs=1e-12)


@pytest.mark.parametrize("name", MACHINES)
def test_works_against_sums_over_the_record(name, tmp_path):
    result = moved(tmp_path, name, {"move.fast.cycle": "200 us"})
    travel, mass = MACHINES[name][1:]
    went = np.diff(result.motor[:, 0], prepend=0.0)
    driven = np.sum(result.effort[:, 0] * went) / travel
    assert result.energy["drives"] == pytest.approx(driven, rel=0.01)
    (force,) = result.friction.values()
    assert result.energy["friction"] == pytest.approx(np.sum(force * went), rel=0.01)
    left = 0.5 * mass * result.velocity[-1, 0] ** 2
    assert result.energy["kinetic"] == pytest.approx(left, rel=0.05, abs=1e-4)


def test_friction_takes_what_its_law_says_of_the_planned_motion(tmp_path):
    energy = moved(tmp_path, "linear").energy
    # up to 0.5 m/s and down again, and 150 mm at that speed
    ramp = 0.5 / 4.0 + 4.0 / 100.0
    time = np.linspace(0.0, ramp, 2001)
    speed = 0.5 * ease(time / ramp, 4.0 / 100.0 / ramp)
    law = CoulombStribeck(60.0, 60.0, 5e-3, 300.0)
    ends = 2.0 * scipy.integrate.trapezoid(law.steady_state_force(speed) * speed, time)
    between = 0.15 * float(law.steady_state_force(np.array(0.5)))
    assert energy["friction"] == pytest.approx(ends + between, rel=0.01)


def ease(share, corner):
    """Speed over its change where the acceleration rises and falls in a share of the time."""
    rising = np.interp(share, [0.0, corner, 1.0 - corner, 1.0], [0.0, 1.0, 1.0, 0.0])
    grown = scipy.integrate.cumulative_trapezoid(rising, share, initial=0.0)
    return grown / grown[-1]


@pytest.mark.parametrize("name", MACHINES)
def test_the_balance_closes_with_the_square_of_the_step(name, tmp_path):
    errors = []
    for step in ("100 us", "50 us", "25 us"):
        found = moved(tmp_path, name, {"step": step}).energy
        errors.append(abs(imbalance(found)))
        assert errors[-1] < 1e-4 * found["drives"]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(np.abs(orders - 2.0) < 0.5)


def test_a_move_at_speed_begins_with_a_step_that_is_told_or_with_a_run_in(tmp_path):
    file = load_machine(written(tmp_path, FILE))
    stepped = move(file, "slow")
    assert stepped.notes == (
        "the set points begin with a step of the velocity, from rest to 20 mm/s; acceleration and "
        "jerk of [move.slow] make a run-in",
    )
    assert stepped.notes[0] in stepped.sentences()
    led = move(
        file.patch({"move.slow.acceleration": "1 m/s^2", "move.slow.jerk": "50 m/s^3"}), "slow"
    )
    assert led.notes == ()
    # 0.2 mm at either end: v (v / j)^0.5 with v j <= a^2, at half the speed
    assert led.wanted[-1, 0] == pytest.approx(1e-3 + 2.0 * 20e-3 * (20e-3 / 50.0) ** 0.5, rel=1e-9)
    assert np.max(np.abs(led.effort)) < 0.25 * np.max(np.abs(stepped.effort))


def test_a_run_in_needs_both_limits(tmp_path):
    file = load_machine(written(tmp_path, FILE))
    with pytest.raises(InputError, match=r"move\.slow\.jerk: is missing: a run-in needs both"):
        file.patch({"move.slow.acceleration": "1 m/s^2"})


def written(folder, text):
    path = folder / "machine.toml"
    path.write_text(text, encoding="utf-8")
    return path
