"""The exact step of a modal model against closed-form motion."""

import math

import numpy as np
import pytest

from dynamics.machine.modal_structure import (
    modal_energy,
    modal_energy_forces,
    modal_structure,
    stored_energy,
)
from dynamics.machine.ports import correct, predict
from dynamics.machine.steps import begin_step, end_step
from dynamics.modal.modes import Mode

MODE = Mode(120.0, 0.03, 0.8, (1.0, 0.0, 0.0), "tool")
OMEGA, ZETA, MASS = 2.0 * math.pi * 120.0, 0.03, 0.8
STIFFNESS = MASS * OMEGA**2
DAMPED = OMEGA * math.sqrt(1.0 - ZETA**2)


class Modes:
    """Modes on the ports of the tool point, their energy, and a step under forces on it."""

    def __init__(self, modes, step):
        self.bus, self.account = modal_structure(modes, step), modal_energy(modes)
        self.shape = self.account.shape

    @property
    def state(self):
        return self.bus.state.reshape(-1, 2)

    @property
    def energy(self):
        return self.account.energy

    def step(self, force):
        begin_step(self.bus)
        predict(self.bus)
        self.bus.change[:3] = force - self.bus.next_force[:3]
        correct(self.bus)
        modal_energy_forces(self.account, self.bus, None)
        self.bus.next_force[:3] = force
        end_step(self.bus)


def march(modes, forces):
    """Displacement and velocity (n, 3) under forces (n, 3) at the steps."""
    modes.bus.next_force[:3] = forces[0]
    place, rate = np.zeros(forces.shape), np.zeros(forces.shape)
    place[0] = modes.shape.T @ modes.state[:, 0]
    rate[0] = modes.shape.T @ modes.state[:, 1]
    for i in range(1, len(forces)):
        modes.step(forces[i])
        place[i], rate[i] = modes.bus.u[:3], modes.bus.v[:3]
    return place, rate


def free_decay(t, q0, v0):
    a, b = q0, (v0 + ZETA * OMEGA * q0) / DAMPED
    decay = np.exp(-ZETA * OMEGA * t)
    return decay * (a * np.cos(DAMPED * t) + b * np.sin(DAMPED * t))


def step_response(t):
    """To a force of 1 N."""
    decay = np.exp(-ZETA * OMEGA * t)
    swing = np.cos(DAMPED * t) + ZETA * OMEGA / DAMPED * np.sin(DAMPED * t)
    return (1.0 - decay * swing) / STIFFNESS


def ramp_response(t):
    """To a force of 1 N/s."""
    lag = 2.0 * ZETA / OMEGA
    return (t - lag) / STIFFNESS + free_decay(t, lag / STIFFNESS, -1.0 / STIFFNESS)


# up to four turns of the oscillation within one step
@pytest.mark.parametrize("step", [1e-5, 3.7e-4, 5e-3, 3.3e-2])
def test_free_decay_is_exact(step):
    modes = Modes([MODE], step)
    modes.state[0] = 2e-5, -0.04
    t = step * np.arange(40)
    place, _ = march(modes, np.zeros((40, 3)))
    wanted = free_decay(t, 2e-5, -0.04)
    assert np.all(np.abs(place[:, 0] - wanted) < 1e-12 * np.abs(wanted).max())


@pytest.mark.parametrize("step", [1e-5, 3.7e-4, 5e-3, 3.3e-2])
def test_step_response_is_exact(step):
    t = step * np.arange(50)
    place, _ = march(Modes([MODE], step), np.tile([1.0, 0.0, 0.0], (50, 1)))
    wanted = step_response(t)
    assert np.all(np.abs(place[:, 0] - wanted) < 1e-12 * np.abs(wanted).max())


@pytest.mark.parametrize("step", [1e-5, 3.7e-4, 5e-3, 3.3e-2])
def test_ramp_response_is_exact(step):
    t = step * np.arange(50)
    place, rate = march(Modes([MODE], step), np.outer(t, [1.0, 0.0, 0.0]))
    wanted = ramp_response(t)
    assert np.all(np.abs(place[:, 0] - wanted) < 2e-12 * np.abs(wanted).max())
    # the velocity to a ramp is the step response
    assert np.all(np.abs(rate[:, 0] - step_response(t)) < 1e-12 * 2.0 / STIFFNESS)


def test_step_size_does_not_matter_for_a_piecewise_linear_force():
    modes = [
        MODE,
        Mode(410.0, 0.012, 0.3, (0.6, 0.8, 0.0), "workpiece"),
        Mode(77.0, 0.2, 2.0, (0.0, 0.0, 1.0), "tool"),
    ]
    knots = np.array([[0, 0, 0], [40, -10, 5], [10, 30, -9], [0, 0, 0], [0, 0, 0], [-7, 5, 1]])
    coarse, _ = march(Modes(modes, 2e-3), knots.astype(float))
    fine = np.array([np.interp(np.arange(0, 5.0001, 1 / 64), np.arange(6), k) for k in knots.T]).T
    dense, _ = march(Modes(modes, 2e-3 / 64), fine)
    assert np.all(np.abs(coarse - dense[::64]) < 1e-12 * np.abs(dense).max())


def test_direction_enters_twice_and_side_does_not_count():
    # displacement along e of a force along e: d d^T / k, whichever side the mode is on
    direction = np.array([0.48, 0.6, 0.64])
    force = np.array([3.0, -2.0, 5.0])
    slow = np.linspace(0.0, 1.0, 4001)[:, None] * force
    for side in ("tool", "workpiece"):
        modes = Modes([Mode(50.0, 0.4, 1.0, tuple(direction), side)], 5e-4)
        place, _ = march(modes, np.vstack([slow, np.tile(force, (2000, 1))]))
        wanted = direction * (direction @ force) / (2.0 * math.pi * 50.0) ** 2
        assert np.allclose(place[-1], wanted, rtol=1e-9)


def test_modes_add_up():
    pair = [MODE, Mode(300.0, 0.02, 0.5, (1.0, 0.0, 0.0), "workpiece")]
    forces = np.outer(np.sin(np.arange(200) * 0.1), [10.0, 0.0, 0.0])
    together, _ = march(Modes(pair, 2e-4), forces)
    alone = sum(march(Modes([mode], 2e-4), forces)[0] for mode in pair)
    assert np.allclose(together, alone, rtol=0.0, atol=1e-14 * np.abs(together).max() + 1e-18)


def test_no_modes_at_all():
    place, _ = march(Modes([], 1e-4), np.ones((5, 3)))
    assert np.all(place == 0.0)


def test_prediction_holds_the_force():
    bus = modal_structure([MODE], 4e-4)
    bus.next_force[0] = 1.0
    begin_step(bus)
    predict(bus)
    assert bus.u[0] == pytest.approx(step_response(4e-4), rel=1e-12)
    assert np.all(bus.state == 0.0)


def test_free_vibration_loses_what_the_damper_takes():
    modes = Modes([MODE], 2e-5)
    modes.state[0] = 1e-4, 0.0
    march(modes, np.zeros((2001, 3)))
    work, dissipated = modes.energy
    assert work == 0.0
    start = 0.5 * STIFFNESS * 1e-8
    assert start - stored_energy(modes.account, modes.bus) == pytest.approx(dissipated, rel=1e-8)
    assert 0.5 * start < dissipated < start


def test_work_of_a_constant_force_is_force_times_way():
    modes = Modes([MODE], 1e-4)
    place, _ = march(modes, np.tile([2.0, 0.0, 0.0], (777, 1)))
    assert modes.energy[0] == pytest.approx(2.0 * place[-1, 0], rel=1e-12)


def test_work_at_resonance_is_that_of_the_damper():
    # steady state: the mean power of F sin(wt) at w_n is F^2/(2c)
    damping = 2.0 * ZETA * MASS * OMEGA
    a_period = 2.0 * math.pi / OMEGA / 200
    periods = 100
    phase = 2.0 * math.pi * np.arange(200 * periods + 1) / 200
    modes = Modes([MODE], a_period)
    march(modes, np.outer(np.sin(phase), [5.0, 0.0, 0.0]))
    before = modes.energy.copy()
    march(modes, np.outer(np.sin(phase[: 200 * 10 + 1]), [5.0, 0.0, 0.0]))
    gained = modes.energy - before
    wanted = 25.0 / (2.0 * damping) * 10 * 2.0 * math.pi / OMEGA
    # a piecewise linear sine is weaker by (wh)^2/12
    assert gained == pytest.approx(wanted, rel=5e-4)


def energy_error(steps):
    """Relative imbalance of a smooth forced motion over a fixed time in so many steps."""
    pair = [MODE, Mode(300.0, 0.02, 0.5, (0.6, 0.8, 0.0), "workpiece")]
    modes = Modes(pair, 0.02 / steps)
    t = np.linspace(0.0, 0.02, steps + 1)
    force = np.outer(np.sin(900.0 * t) + t * 50.0, [10.0, 7.0, 0.0])
    march(modes, force)
    work, dissipated = modes.energy
    return abs(work - dissipated - stored_energy(modes.account, modes.bus)) / work


def test_energy_balances_to_fourth_order():
    errors = [energy_error(steps) for steps in (50, 100, 200, 400)]
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert np.all(np.abs(orders - 4.0) < 0.3)
    assert errors[-1] < 1e-7
