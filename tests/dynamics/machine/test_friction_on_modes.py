"""Frictions on modes: Coulomb's linear decay, sticking, energy, and an independent integrator."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from dynamics.friction.coulomb_stribeck import CoulombStribeck
from dynamics.friction.smooth_coulomb import SmoothCoulomb
from dynamics.machine.groups import friction_commit, friction_forces
from dynamics.machine.modal_structure import modal_energy_forces, stored_energy
from dynamics.machine.ports import correct, predict
from dynamics.machine.steps import begin_step, end_step
from dynamics.machine.tables import modal_tables
from dynamics.modal.modes import Mode

FREQUENCY, MASS = 100.0, 2.0
STIFFNESS = MASS * (2.0 * math.pi * FREQUENCY) ** 2


def march(law, damping, forces, step, start=0.0, others=()):
    """Displacement (n,) along x of a mode with friction under forces (n,) along x."""
    listed = [*others, Mode(FREQUENCY, damping, MASS, (1.0, 0.0, 0.0))]
    tables = modal_tables(listed, step, [law], [len(listed) - 1])
    bus, (account, frictions) = tables.bus, tables.implicit
    bus.state[-2] = bus.u[3] = start
    bus.next_force[0] = forces[0]
    place = np.empty(len(forces))
    place[0] = start
    for k in range(1, len(forces)):
        begin_step(bus)
        predict(bus)
        bus.change[0] = forces[k] - bus.next_force[0]
        correct(bus)
        modal_energy_forces(account, bus, None)
        friction_forces(frictions, bus, None)
        friction_commit(frictions, bus, None)
        bus.next_force[0] = forces[k]
        end_step(bus)
        place[k] = bus.state[-2]
        assert bus.u[0] == pytest.approx(bus.state[0::2].sum(), abs=1e-18)
    return place, tables


def test_coulomb_friction_takes_the_same_from_every_swing():
    friction, start, step = 20.0, 4.2e-4, 1.0 / FREQUENCY / 2000
    law = CoulombStribeck(friction, friction, 1.0)
    place, _ = march(law, 1e-9, np.zeros(6001), step, start)
    lost = 4.0 * friction / STIFFNESS
    for cycle in (1, 2, 3):
        # Den Hartog: 4 F / k a cycle, until the spring no longer overcomes the friction
        assert place[2000 * cycle] == pytest.approx(start - cycle * lost, abs=2e-3 * lost)


def test_sticks_where_the_force_does_not_overcome_it():
    law = CoulombStribeck(20.0, 20.0, 1.0)
    place, _ = march(law, 0.02, 19.9 * np.ones(3000), 1e-5)
    assert np.abs(place).max() < 1e-3 * 20.0 / STIFFNESS
    place, _ = march(law, 0.02, 40.0 * np.ones(30000), 1e-5)
    # comes to rest within the band of friction about the static displacement
    assert abs(place[-1] - 40.0 / STIFFNESS) <= 20.0 / STIFFNESS * 1.001


@pytest.mark.parametrize("velocity", [3e-2, 2e-3])
def test_smooth_friction_is_that_of_an_independent_integration(velocity):
    law, damping = SmoothCoulomb(25.0, velocity), 0.02
    step = 2e-6
    time = step * np.arange(20001)
    forces = 150.0 * np.sin(2.0 * math.pi * 130.0 * time)
    place, _ = march(law, damping, forces, step)

    def rate(t, y):
        drive = 150.0 * math.sin(2.0 * math.pi * 130.0 * t)
        rub = 25.0 * math.tanh(y[1] / velocity)
        viscous = 2.0 * damping * math.sqrt(STIFFNESS * MASS) * y[1]
        return [y[1], (drive - rub - viscous - STIFFNESS * y[0]) / MASS]

    found = solve_ivp(
        rate, (0.0, time[-1]), [0.0, 0.0], rtol=1e-9, atol=1e-13, method="LSODA", t_eval=time[::500]
    )
    assert np.abs(place[::500] - found.y[0]).max() < 2e-3 * np.abs(found.y[0]).max()


def test_what_is_lost_is_accounted():
    start, step = 3e-4, 1e-5
    law = CoulombStribeck(20.0, 20.0, 1.0)
    _, tables = march(law, 0.01, np.zeros(1500), step, start)
    account, frictions = tables.implicit
    lost = 0.5 * STIFFNESS * start**2 - stored_energy(account, tables.bus)
    assert account.energy[1] + frictions.work[0] == pytest.approx(lost, rel=2e-3)


def test_another_mode_does_not_feel_it():
    other = Mode(330.0, 0.03, 1.0, (1.0, 0.0, 0.0))
    forces = 30.0 * np.sin(np.arange(2000) * 0.02)
    law = CoulombStribeck(5.0, 5.0, 1.0)
    _, both = march(law, 0.02, forces, 2e-5, others=(other,))
    _, none = march(CoulombStribeck(0.0, 0.0, 1.0), 0.02, forces, 2e-5, others=(other,))
    assert both.bus.state[:2] == pytest.approx(none.bus.state[:2], rel=1e-12)
    assert abs(both.bus.state[2] - none.bus.state[2]) > 1e-7
