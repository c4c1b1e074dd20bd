"""Step of a structure on its ports against the exponential of its whole state matrix."""

import numpy as np
import pytest
import scipy.linalg
import scipy.optimize

from dynamics.machine.blocks import blocks
from dynamics.machine.ports import correct, predict
from dynamics.machine.steps import begin_step, end_step, structure_steps
from dynamics.structure.linear_structure import LinearStructure


def random_structure(rng, size, rigid=0, damping=1.0):
    """Structure of random coupling, its fastest motion near 1000 rad/s."""
    root = rng.normal(size=(size, size))
    mass = root @ root.T + size * np.eye(size)
    strain = rng.normal(size=(size - rigid, size))
    stiffness = strain.T @ strain
    stiffness *= 1e6 / np.max(scipy.linalg.eigh(stiffness, mass, eigvals_only=True))
    loss = rng.normal(size=(size, size))
    loss = damping * loss @ loss.T
    return LinearStructure(mass, loss, stiffness, {})


def repeated_frequencies(rng):
    """Three pairs of the same frequencies, damped so that they stay apart or not."""
    turn = scipy.linalg.qr(rng.normal(size=(6, 6)))[0]
    omega = np.array([200.0, 200.0, 200.0, 700.0, 700.0, 0.0])
    stiffness = turn @ np.diag(omega**2) @ turn.T
    return LinearStructure(np.eye(6), 0.02 * stiffness / 200.0, stiffness, {})


def critically_damped():
    """One motion on the border between vibrating and creeping: a double real rate."""
    omega = np.diag([100.0, 300.0])
    return LinearStructure(np.eye(2), 2.0 * omega, omega**2, {})


def almost_defective(away):
    """Two damped vibrations, coupled so that they are one but for `away`.

    One of two equal oscillators is damped; where coupling and damping balance, both motions
    have the same rate and the same shape (an exceptional point).
    """

    def matrices(coupling, detuning):
        k = 200.0**2
        stiffness = np.array(
            [[k * (1.0 + detuning) + coupling, -coupling], [-coupling, k + coupling]]
        )
        return np.diag([20.0, 0.0]), stiffness

    def gap(unknown):
        damping, stiffness = matrices(unknown[0] * 1e3, unknown[1] * 1e-3)
        rate = np.block([[np.zeros((2, 2)), np.eye(2)], [-stiffness, -damping]])
        values = np.linalg.eigvals(rate)
        values = values[values.imag > 0.0]
        square = (values[0] - values[1]) ** 2
        return [square.real, square.imag]

    # two complex rates to be equal: two real unknowns
    coupling, detuning = scipy.optimize.fsolve(gap, [2.0, 0.0], xtol=1e-10)
    assert np.hypot(*gap([coupling, detuning])) < 1e-6
    damping, stiffness = matrices(coupling * 1e3 * (1.0 + away), detuning * 1e-3)
    return LinearStructure(np.eye(2), damping, stiffness, {})


RNG = np.random.default_rng(3)
STRUCTURES = {
    "held": random_structure(RNG, 5),
    "one rigid motion": random_structure(RNG, 5, 1),
    "six rigid motions": random_structure(RNG, 9, 6),
    "undamped": random_structure(RNG, 4, 1, damping=0.0),
    "rigid motion undamped": LinearStructure(
        np.diag([1.0, 2.0]), np.zeros((2, 2)), 1e4 * np.array([[1.0, -1.0], [-1.0, 1.0]]), {}
    ),
    "overdamped": random_structure(RNG, 5, 1, damping=1e3),
    "some overdamped": random_structure(RNG, 6, 2, damping=60.0),
    "repeated": repeated_frequencies(RNG),
    "critically damped": critically_damped(),
    "defective": almost_defective(0.0),
    "almost defective": almost_defective(1e-8),
    "nearly defective": almost_defective(1e-4),
    "nothing but mass": LinearStructure(
        np.diag([2.0, 5.0]), np.zeros((2, 2)), np.zeros((2, 2)), {}
    ),
}


def exact(structure, ports, forces, step, start):
    """Displacement and velocity of the ports at the ends of steps, forces linear over each.

    forces : (n, 2, p), at the beginning and the end of each step
    """
    n, p = structure.size, len(ports)
    per_mass = np.linalg.solve(
        structure.mass, np.hstack([structure.stiffness, structure.damping, ports.T])
    )
    # state, force and rate of the force
    whole = np.zeros((2 * n + 2 * p, 2 * n + 2 * p))
    whole[:n, n : 2 * n] = np.eye(n)
    whole[n : 2 * n, :n], whole[n : 2 * n, n : 2 * n] = -per_mass[:, :n], -per_mass[:, n : 2 * n]
    whole[n : 2 * n, 2 * n : 2 * n + p] = per_mass[:, 2 * n :]
    whole[2 * n : 2 * n + p, 2 * n + p :] = np.eye(p)
    over = scipy.linalg.expm(whole * step)
    state = np.concatenate([np.zeros(n), start])
    moved = []
    for before, after in forces:
        everything = over @ np.concatenate([state, before, (after - before) / step])
        state = everything[: 2 * n]
        moved.append([ports @ state[:n], ports @ state[n:]])
    return np.array(moved)


def stepped(structure, ports, forces, step, start):
    s = structure_steps(structure, ports, step, start)
    moved = []
    for before, after in forces:
        begin_step(s)
        s.force[:] = before
        s.change[:] = after - before
        predict(s)
        correct(s)
        end_step(s)
        moved.append([s.u.copy(), s.v.copy()])
    return np.array(moved)


def largest(moved):
    """Scale of displacements and velocities of each port."""
    return np.max(np.abs(moved), axis=0)


# steps that resolve the fastest motion, and steps within which it turns several times
@pytest.mark.parametrize("step", [1e-4, 1.3e-3, 2e-2])
@pytest.mark.parametrize("name", STRUCTURES)
def test_held_and_growing_forces(name, step):
    structure = STRUCTURES[name]
    rng = np.random.default_rng(7)
    ports = rng.normal(size=(3, structure.size))
    held = np.repeat(rng.normal(size=(60, 1, 3)), 2, axis=1)
    growing = rng.normal(size=(60, 2, 3))
    forces = 100.0 * np.concatenate([held, growing])
    start = rng.normal(size=structure.size)
    wanted = exact(structure, ports, forces, step, start)
    found = stepped(structure, ports, forces, step, start)
    error = np.max(np.abs(found - wanted) / largest(wanted))
    # rounding moves almost equal motions by its square root, whatever the method; six rigid motions
    # add up 1.2e-10 with some libraries of linear algebra
    bound = 1e-9 if "defective" in name else 2e-10 if name == "six rigid motions" else 1e-10
    assert error < bound, error


@pytest.mark.parametrize("name", STRUCTURES)
def test_two_half_steps_are_one(name):
    structure, step = STRUCTURES[name], 2e-3
    rng = np.random.default_rng(11)
    ports = rng.normal(size=(2, structure.size))
    force = np.repeat(rng.normal(size=(40, 1, 2)), 2, axis=1)
    start = rng.normal(size=structure.size)
    whole = stepped(structure, ports, force, step, start)
    halves = stepped(structure, ports, np.repeat(force, 2, axis=0), 0.5 * step, start)[1::2]
    assert np.max(np.abs(halves - whole) / largest(whole)) < 1e-9


def test_what_stays_whole():
    """Vibrations apart are pairs; rigid, creeping and almost equal motions stay together."""

    def dense(name):
        structure = STRUCTURES[name]
        return blocks(structure, np.eye(structure.size)).dense

    assert dense("undamped") == 2
    assert dense("critically damped") == 4
    assert dense("defective") == dense("almost defective") == 4
    assert dense("nearly defective") == 0
    assert dense("nothing but mass") == 4
    assert 0 < dense("some overdamped") < 12


@pytest.mark.parametrize("name", ["one rigid motion", "some overdamped", "repeated", "undamped"])
def test_work_is_energy(name):
    """Work of the loads is kinetic and potential energy and what the dampers take."""
    structure, step, count = STRUCTURES[name], 5e-5, 2000
    size = structure.size
    rng = np.random.default_rng(5)
    held = np.repeat(200.0 * rng.normal(size=(count // 200, size)), 200, axis=0)
    moved = stepped(
        structure, np.eye(size), np.repeat(held[:, None], 2, axis=1), step, np.zeros(size)
    )
    u = np.vstack([np.zeros(size), moved[:, 0]])
    v = np.vstack([np.zeros(size), moved[:, 1]])
    work = np.einsum("ip,ip->", held, np.diff(u, axis=0))
    kept = 0.5 * (v[-1] @ structure.mass @ v[-1] + u[-1] @ structure.stiffness @ u[-1])
    power = np.einsum("ip,pq,iq->i", v, structure.damping, v)
    # Simpson over pieces of held force, smooth within
    lost = (
        step / 3.0 * sum(power[i] + 4.0 * power[i + 1] + power[i + 2] for i in range(0, count, 2))
    )
    assert kept + lost == pytest.approx(work, rel=1e-6)
    assert work > 0.0
