"""Stability of sampled loops against closed forms, and their steady motion in the z-domain."""

import numpy as np
import pytest

from chatter.compile.machine_parts import assembled_machine
from chatter.description.errors import InputError
from chatter.description.machine.machine_file import load_machine
from chatter.engine.loop_stability import least_stable_motion, refuse_unstable_control
from chatter.simulation.virtual_tests.run import RunInputs, run_machine
from dynamics.trajectory.set_points import SetPoints
from tests.places import EXAMPLES

STEP = 1e-4
MANDELLI = EXAMPLES / "machine-mandelli-m5" / "machine.toml"
J, T = 0.01, 2e-4


def velocity_loop(controller, share, delay=0, **keys):
    """Loop of a rigid inertia with K T / J as given."""
    keys = {"position_gain": 0.0, "integral_time": np.inf, "transmission": 1.0} | keys
    times = (10 * T, T, T)
    return controller(gain=share * J / T, times=times, computing=delay, on="encoder", **keys)


# v(k+1) = (1 - a) v(k): stable below a = 2, then each sample swaps the sign.
# One sample late, z^2 - z + a = 0: stable below a = 1, then at a sixth of the sampling rate.
@pytest.mark.parametrize(("delay", "limit", "samples"), [(0, 2.0, 2), (1, 1.0, 6)])
def test_limit_of_a_velocity_loop(controller, rigid_motor, delay, limit, samples):
    below = rigid_motor(velocity_loop(controller, 0.99 * limit, delay), J)
    above = rigid_motor(velocity_loop(controller, 1.01 * limit, delay), J)
    assert least_stable_motion(below, STEP).stable
    motion = least_stable_motion(above, STEP)
    assert not motion.stable
    assert motion.drive == "Y"
    assert motion.frequency == pytest.approx(1.0 / (samples * T), rel=0.01)
    # a = 1.01 limit: |z| = a - 1, or sqrt(a)
    factor = 1.01 * limit - 1.0 if delay == 0 else np.sqrt(1.01)
    assert motion.growth_rate == pytest.approx(np.log(factor) / T, rel=1e-6)


def test_rate_of_decay(controller, rigid_motor):
    """Position loop around a fast velocity loop: the slowest motion is that of a sampled lag.

    With T = T_p and x(k+1) = x + T/2 (v + v'), v' = v + a (u - v), u = -K_v x.
    """
    a, k_v = 0.5, 40.0
    control = controller(
        position_gain=k_v, gain=a * J / T, integral_time=np.inf, times=(T, T, T), on="encoder",
        transmission=1.0,
    )  # fmt: skip
    rate = np.array([[1.0 - 0.5 * T * a * k_v, T * (1.0 - 0.5 * a)], [-a * k_v, 1.0 - a]])
    wanted = np.log(np.max(np.abs(np.linalg.eigvals(rate)))) / T
    assert least_stable_motion(rigid_motor(control, J), STEP).growth_rate == pytest.approx(wanted)
    assert least_stable_motion(rigid_motor(control, J), T).growth_rate == pytest.approx(wanted)


def test_refused_by_name_before_it_runs(controller, rigid_motor):
    machine = rigid_motor(velocity_loop(controller, 2.05), J)
    with pytest.raises(InputError, match=r'axis "Y".*unstable.*velocity gain 102\.5'):
        refuse_unstable_control(machine, STEP)
    refuse_unstable_control(rigid_motor(velocity_loop(controller, 1.95), J), STEP)


def test_limits_do_not_hide_instability(controller, rigid_motor):
    """A torque limit would keep the motion small; the loop is refused all the same."""
    limited = velocity_loop(controller, 2.05, torque_limit=1e-9)
    free = velocity_loop(controller, 2.05)
    growth = [least_stable_motion(rigid_motor(one, J), STEP).growth_rate for one in (limited, free)]
    assert growth[0] == pytest.approx(growth[1])
    assert growth[0] > 0.0


def test_without_control_there_is_nothing_to_judge(screw_axis):
    assert least_stable_motion(screw_axis(), STEP) is None


@pytest.mark.parametrize("frequency", [20.0, 130.0, 700.0])
def test_sine_of_the_set_point_in_the_z_domain(controller, rigid_motor, frequency):
    """P/PI cascade on an inertia: x(z), v(z) from held torque, sums that include the sample."""
    gain, k_v, t_n, lead = 12.0, 60.0, 8e-3, 1.6e-3
    control = controller(
        position_gain=k_v, gain=gain, integral_time=t_n, times=(T, T, T), on="encoder",
        transmission=lead,
    )  # fmt: skip
    machine = rigid_motor(control, J)
    # a whole number of periods in 2000 samples
    periods = round(frequency * 2000 * T)
    z = np.exp(2j * np.pi * periods / 2000)
    speed = T / J / (z - 1.0)
    angle = T**2 / (2.0 * J) * (z + 1.0) / (z - 1.0) ** 2
    regulator = gain * (1.0 + T / t_n / (1.0 - 1.0 / z))
    wanted = angle * regulator * k_v / lead
    wanted /= 1.0 + regulator * (speed + k_v * angle)
    sample = np.arange(10_000)
    course = np.real(z**sample)[:, None] * 1e-3
    points = SetPoints(course, np.zeros_like(course), np.zeros_like(course), 2)
    run = run_machine(machine, STEP, RunInputs(10_000 * T, points, stride=2))
    # row k is read at the end of sample k
    steady = run.displacement["drive Y"][-2001:-1]
    found = 2.0 * np.mean(steady * z ** -(sample[-2001:-1] + 1.0))
    assert found == pytest.approx(1e-3 * wanted, rel=1e-6)


@pytest.mark.parametrize("axis", ["Y", "Z"])
@pytest.mark.parametrize(
    "change", [("velocity.proportional_gain", 80.0), ("position.gain", 1000.0)]
)
def test_the_axis_that_is_unstable_is_named(axis, change):
    """Of two axes on one structure, the one whose gain is too high."""
    file = load_machine(MANDELLI)
    machine = assembled_machine(file.patch({f"axis.{axis}.control.{change[0]}": change[1]}))
    motion = least_stable_motion(machine, file.step)
    assert not motion.stable
    assert motion.drive == axis
