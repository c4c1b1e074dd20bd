"""Frictions on modes: Coulomb's linear decay, sticking, energy, and an independent integrator."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from dynamics.friction.coulomb_stribeck import CoulombStribeck
from dynamics.friction.laws import friction_groups
from dynamics.friction.smooth_coulomb import SmoothCoulomb
from dynamics.modal.modal_friction import hold, resist
from dynamics.modal.modal_steps import correct, modal_steps, predict, stored_energy, take_force
from dynamics.modal.modes import Mode

FREQUENCY, MASS = 100.0, 2.0
STIFFNESS = MASS * (2.0 * math.pi * FREQUENCY) ** 2


def tool_point():
    return SimpleNamespace(**{name: np.zeros(3) for name in ("displacement", "velocity", "force")})


def march(law, damping, forces, step, start=0.0, others=()):
    """Displacement (n,) along x of a mode with friction under forces (n,) along x."""
    listed = [*others, Mode(FREQUENCY, damping, MASS, (1.0, 0.0, 0.0))]
    modes = modal_steps(listed, step)
    modes.state[-1, 0] = start
    frictions = friction_groups([law], [len(listed) - 1])
    point, before = tool_point(), np.zeros((len(listed), 2))
    point.force[0] = forces[0]
    take_force(modes, point)
    place = np.empty(len(forces))
    place[0] = start
    for k in range(1, len(forces)):
        predict(modes, before, point)
        hold(frictions, modes, point)
        point.force[0] = forces[k]
        correct(modes, before, point)
        resist(frictions, modes, before, point)
        place[k] = modes.state[-1, 0]
        assert point.displacement[0] == pytest.approx(modes.state[:, 0].sum(), abs=1e-18)
    return place, modes


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
    _, modes = march(law, 0.01, np.zeros(1500), step, start)
    lost = 0.5 * STIFFNESS * start**2 - stored_energy(modes)
    assert modes.energy[1] == pytest.approx(lost, rel=2e-3)


def test_another_mode_does_not_feel_it():
    other = Mode(330.0, 0.03, 1.0, (1.0, 0.0, 0.0))
    forces = 30.0 * np.sin(np.arange(2000) * 0.02)
    law = CoulombStribeck(5.0, 5.0, 1.0)
    _, both = march(law, 0.02, forces, 2e-5, others=(other,))
    _, none = march(CoulombStribeck(0.0, 0.0, 1.0), 0.02, forces, 2e-5, others=(other,))
    assert both.state[0] == pytest.approx(none.state[0], rel=1e-12)
    assert abs(both.state[1, 0] - none.state[1, 0]) > 1e-7
