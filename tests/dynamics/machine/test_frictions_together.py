"""Frictions that feel one another: the joint implicit problem, energy, momentum.

The kernels run as plain Python here, so that every step can be looked into.
"""

import copy

import numpy as np
import pytest
import scipy.linalg
import scipy.optimize

from dynamics.friction.coulomb_stribeck import CoulombStribeck
from dynamics.friction.lugre import LuGre, lugre_energy, lugre_force
from dynamics.friction.tanh_hysteresis import TanhHysteresis, tanh_force, tanh_stored
from dynamics.machine.description import Friction, Machine
from dynamics.machine.groups import friction_commit, friction_forces
from dynamics.machine.ports import correct, predict
from dynamics.machine.steps import begin_step, end_step
from dynamics.machine.tables import machine_tables
from dynamics.structure.linear_structure import LinearStructure

LUGRE = LuGre(2e7, 0.0, 300.0, 80.0, 120.0, 2e-3)
TANH = TanhHysteresis(90.0, 400.0, 3000.0, 300.0, 2e4)
DRY = CoulombStribeck(60.0, 85.0, 3e-3, 200.0)
LAWS = {"lugre": LUGRE, "tanh": TANH, "dry": DRY}
SOLVED = {"lugre": lugre_force, "tanh": tanh_force}


def slide(laws):
    """Slide of 200 kg on four carriages, 0.3 m by 0.2 m apart, that yaws and hangs on a spring."""
    mass = np.diag([200.0, 200.0, 12.0])
    stiffness = np.diag([2e6, 4e6, 8e5])
    places = [(0.3, 0.2), (0.3, -0.2), (-0.3, 0.2), (-0.3, -0.2)]
    # motion along x of a place (x, y): that of the middle less yaw times y
    rows = [np.array([1.0, 0.0, -y]) for _, y in places]
    frictions = tuple(
        Friction(f"carriage {i}", law, row)
        for i, (law, row) in enumerate(zip(laws, rows, strict=True))
    )
    return Machine(
        LinearStructure(mass, np.zeros((3, 3)), stiffness, {}), (), frictions, (), (), None
    )


def random_machine(rng, law, frictions=3, size=4):
    root = rng.normal(size=(size, size))
    mass = root @ root.T + size * np.eye(size)
    strain = rng.normal(size=(size - 1, size))
    stiffness = strain.T @ strain
    stiffness *= 1e6 / np.max(scipy.linalg.eigh(stiffness, mass, eigvals_only=True))
    rows = rng.normal(size=(frictions, size))
    return Machine(
        LinearStructure(mass, np.zeros((size, size)), stiffness, {}),
        (),
        tuple(Friction(f"f{i}", law, row) for i, row in enumerate(rows)),
        (),
        (),
        None,
    )


def all_of(machine):
    return {f"q{i}": row for i, row in enumerate(np.eye(machine.structure.size))}


def begin(tables):
    """Predict a step, and solve for its frictions."""
    begin_step(tables.bus)
    predict(tables.bus)
    correct(tables.bus)
    for group in tables.implicit:
        friction_forces(group, tables.bus, None)


def end(tables):
    for group in tables.implicit:
        friction_commit(group, tables.bus, None)
    end_step(tables.bus)


class Energy:
    """Kinetic and potential energy of a machine, and what its frictions store."""

    def __init__(self, machine, tables):
        self.machine, self.tables = machine, tables
        places = [tables.port[name] for name in all_of(machine)]
        self.u, self.v = (lambda: tables.bus.u[places]), (lambda: tables.bus.v[places])
        self.tanh_stored = 0.0

    def note(self):
        """To be called before a step ends."""
        s = self.tables.bus
        for group in self.tables.implicit[0].by_law:
            if isinstance(self.machine.frictions[0].law, TanhHysteresis):
                for i, p in enumerate(group.law.port):
                    motion = s.u[p] - s.u_before[p] + group.beyond[i]
                    self.tanh_stored += tanh_stored(group.law, i, motion)

    def total(self):
        u, v, structure = self.u(), self.v(), self.machine.structure
        energy = 0.5 * (v @ structure.mass @ v + u @ structure.stiffness @ u)
        if isinstance(self.machine.frictions[0].law, LuGre):
            law = self.tables.implicit[0].by_law[0].law
            energy += sum(lugre_energy(law, i) for i in range(len(law.port)))
        return energy + self.tanh_stored


def energies(machine, step, velocity, count):
    tables = machine_tables(machine, step, outputs=all_of(machine), velocity=velocity)
    book = Energy(machine, tables)
    course = [book.total()]
    for _ in range(count):
        begin(tables)
        book.note()
        end(tables)
        course.append(book.total())
    return np.array(course)


#: part of the first energy that a step may create: what the sweeps leave unsolved
ROUNDING = {"lugre": 1e-12, "tanh": 1e-7, "dry": 1e-4}


@pytest.mark.parametrize("factor", [1.0, 10.0])
@pytest.mark.parametrize("speed", [1e-5, 0.03])
@pytest.mark.parametrize("name", LAWS)
def test_energy_is_never_created(name, speed, factor):
    """From random motion, small within the presliding and wide, at steps right and too coarse."""
    rng = np.random.default_rng(int(factor))
    machine = random_machine(rng, LAWS[name])
    # 1000 rad/s is the fastest mode: 0.1 and 1 rad a step
    course = energies(machine, 1e-4 * factor, speed * rng.normal(size=4), 150)
    assert np.max(np.diff(course)) < ROUNDING[name] * course[0]
    assert np.max(course) <= (1.0 + ROUNDING[name]) * course[0]
    if speed == 0.03:
        assert course[-1] < 0.95 * course[0]


@pytest.mark.parametrize("name", LAWS)
def test_one_friction_creates_none_over_thousands_of_steps(name):
    rng = np.random.default_rng(8)
    machine = random_machine(rng, LAWS[name], frictions=1)
    course = energies(machine, 1e-3, 0.01 * rng.normal(size=4), 2500)
    assert np.max(np.diff(course)) < 1e-13 * course[0]
    assert course[-1] < 0.9 * course[0]


@pytest.mark.parametrize("name", SOLVED)
def test_carriages_of_a_slide_against_the_joint_problem(name):
    """Sliding steps end at the joint solution of all carriages, found by Newton's method."""
    other = {
        "lugre": LuGre(3e7, 0.0, 100.0, 50.0, 90.0, 1e-3),
        "tanh": TanhHysteresis(30.0, 100.0, 900.0, 100.0, 5e4),
    }
    machine = slide([LAWS[name], other[name], LAWS[name], other[name]])
    step = 2e-4
    tables = machine_tables(machine, step, velocity=np.array([0.004, 0.0, 0.05]))
    s, groups = tables.bus, tables.implicit[0].by_law
    law, compared = groups[0].law, 0
    for _ in range(30):
        before = copy.deepcopy(law)
        u_before = s.u.copy()
        held_before = s.state.copy()
        begin(tables)
        end(tables)
        g = s.step_compliance
        # without friction: the step made again with no forces
        free = structure_motion(machine, step, held_before, s)

        def unsolved(motion, before=before, away=free - u_before, g=g):
            force = [SOLVED[name](before, i, motion[i], step) for i in range(4)]
            return motion - (away - g @ force)

        motion = s.u - u_before
        joint = scipy.optimize.fsolve(unsolved, motion, xtol=1e-13)
        if np.all(motion * s.v > 0.0):  # in the mean form
            compared += 1
            assert motion == pytest.approx(joint, abs=3e-6 * np.max(np.abs(joint)))
            wanted = [SOLVED[name](before, i, joint[i], step) for i in range(4)]
            assert groups[0].force == pytest.approx(wanted, abs=1e-4 * np.max(np.abs(wanted)))
    assert compared > 10


def structure_motion(machine, step, state, s):
    """Displacements of the ports at the end of a step without forces, from a state."""
    steps = machine_tables(machine, step).bus
    steps.state[:] = state
    begin_step(steps)
    predict(steps)
    return steps.u


@pytest.mark.parametrize("name", LAWS)
def test_internal_friction_keeps_momentum(name):
    """Two free bodies with friction between them: the common momentum stays, and both stop."""
    relative = np.array([1.0, -1.0])
    structure = LinearStructure(np.diag([3.0, 7.0]), np.zeros((2, 2)), np.zeros((2, 2)), {})
    frictions = (Friction("between", LAWS[name], relative),)
    machine = Machine(structure, (), frictions, (), (), None)
    tables = machine_tables(machine, 1e-4, outputs=all_of(machine), velocity=np.array([0.2, 0.0]))
    places = [tables.port["q0"], tables.port["q1"]]
    for _ in range(600):
        begin(tables)
        end(tables)
        v = tables.bus.v[places]
        assert 3.0 * v[0] + 7.0 * v[1] == pytest.approx(0.6, rel=1e-12)
    # Coulomb friction alone stops them after 0.2 m/s * 2.1 kg / F, less than 10 ms
    swing = {"lugre": 0.02, "tanh": 0.02, "dry": 1e-9}[name]
    assert abs(v[0] - v[1]) < swing


def test_friction_of_a_moving_block_takes_its_kinetic_energy():
    """Block of 5 kg on dry friction: stops after v^2 m / (2 F), held for ever after."""
    law = CoulombStribeck(60.0, 60.0, 1e-3)
    structure = LinearStructure(np.array([[5.0]]), np.zeros((1, 1)), np.zeros((1, 1)), {})
    machine = Machine(structure, (), (Friction("floor", law, np.ones(1)),), (), (), None)
    tables = machine_tables(machine, 1e-4, velocity=np.array([0.3]))
    for _ in range(400):
        begin(tables)
        end(tables)
    assert tables.bus.u[0] == pytest.approx(0.3**2 * 5.0 / (2.0 * 60.0), rel=1e-4)
    assert tables.bus.v[0] == pytest.approx(0.0, abs=1e-12)
