"""The Mandelli M5 of solid elements: masses, statics of the saddle, and a cut with friction."""

import numpy as np
import pytest
import scipy.sparse.linalg

import chatter
from chatter.compile.linearised_friction import rigid_motion
from chatter.compile.machine_parts import assembled_machine, machine_parts
from dynamics.structure.bodies import rigid_motion as rigid_motion_of_body
from tests.places import EXAMPLES, example_module

EXAMPLE = EXAMPLES / "machine-mandelli-m5"
TRAVEL = 0.020 / (2.0 * np.pi)  # m/rad of the driving screw


@pytest.fixture(scope="module")
def file():
    return chatter.load_machine(EXAMPLE / "machine-of-solids.toml")


def shipped(file, name):
    return next(one for one in machine_parts(file).bodies if one.name == name)


@pytest.mark.parametrize(("axis", "inertia"), [("Y", 0.0192), ("Z", 0.0272)])
def test_inertia_at_the_driving_screw_is_that_of_table_1(file, axis, inertia):
    machine = assembled_machine(file)
    motion = rigid_motion(machine, {axis: TRAVEL})
    assert motion @ machine.structure.mass @ motion == pytest.approx(inertia, rel=1e-4)


def test_the_mass_of_the_saddle_is_that_of_the_drawing(file):
    saddle = shipped(file, "saddle")
    volume = 0.76 * 0.56 * 0.26 - 0.69 * 0.49 * 0.19
    lifted = saddle.rigid_motions[:, 1]
    assert lifted @ saddle.mass_matrix @ lifted == pytest.approx(7200.0 * volume, rel=1e-6)


def test_the_mass_of_the_column_is_that_of_the_drawing(file):
    """Volume by hand: boxes less their hollows; the bridge is solid between the uprights."""
    wall, web = 0.012, 0.006
    # hollows: across and along of a quarter of the foot, of an upright beside its web
    foot_hollow = (0.438 - web) * (0.488 - web)
    upright_hollow = 0.188 - wall - 2.0 * web
    # an upright goes on through the foot as walls
    through = 0.188 * (0.15 - web) - upright_hollow * (0.138 - web)
    foot = 0.9 * 0.24 * 1.0 - 4.0 * 0.216 * (foot_hollow - through)
    uprights = 2.0 * 1.13 * (0.2 * 0.3 - upright_hollow * 0.276)
    bridge = 0.9 * 0.16 * 0.3 - 2.0 * 0.136 * upright_hollow * 0.276
    rails = 2.0 * 0.04 * 0.02 * 1.08
    column = shipped(file, "column")
    lifted = column.rigid_motions[:, 1]
    mass = 7200.0 * (foot + uprights + bridge + rails)
    assert lifted @ column.mass_matrix @ lifted == pytest.approx(mass, rel=1e-6)


def test_the_saddle_moves_as_one_rigid_body_of_its_drawing(file):
    """Mass, centre of gravity and inertia of a hollow box, by hand."""
    saddle = shipped(file, "saddle")
    outer, inner = np.array([0.76, 0.56, 0.26]), np.array([0.69, 0.49, 0.19])
    solid, hollow = 7200.0 * np.prod(outer), 7200.0 * np.prod(inner)
    expected = [
        (solid * (outer**2).sum() - hollow * (inner**2).sum()) / 12.0
        - (solid * outer[way] ** 2 - hollow * inner[way] ** 2) / 12.0
        for way in range(3)
    ]
    first = next(iter(saddle.positions.values()))
    motions = saddle.rigid_motions @ np.linalg.inv(
        rigid_motion_of_body(np.array([0.0, 0.85, -0.30]) - first)
    )
    inertia = motions.T @ saddle.mass_matrix @ motions
    np.testing.assert_allclose(np.diag(inertia)[:3], solid - hollow, rtol=1e-6)
    np.testing.assert_allclose(np.diag(inertia)[3:], expected, rtol=1e-5)
    # about the centre of gravity turning takes no push
    np.testing.assert_allclose(inertia[:3, 3:], 0.0, atol=1e-5 * (solid - hollow))


def test_the_shipped_saddle_gives_way_as_its_full_mesh(file):
    pytest.importorskip("skfem")
    full = example_module("machine-mandelli-m5", "mandelli_parts").saddle().structure
    reduced = shipped(file, "saddle").structure
    answers = []
    for one in (full, reduced):
        # the seat pushed back against the four sliders: the forces balance
        push = one.points["seat_front"][2] - 0.25 * sum(
            one.points[f"{side}_{end}"][2] for side in ("left", "right") for end in ("low", "high")
        )
        mass = 10.0 * one.mass  # holds it softly
        held = one.stiffness + mass
        solved = (
            scipy.sparse.linalg.spsolve(held.tocsc(), push)
            if scipy.sparse.issparse(held)
            else np.linalg.solve(held, push)
        )
        answers.append(push @ solved)
    assert answers[1] == pytest.approx(answers[0], rel=1e-6)


@pytest.mark.nightly
def test_a_slot_with_friction_keeps_its_energy():
    case = chatter.load(EXAMPLE / "slot-upwards.toml").patch({"simulation.duration": "0.5 s"})
    result = chatter.simulate(case)
    assert any(note.startswith("the structure changes as the axes travel") for note in result.notes)
    energy = result.energy
    balance = energy["work"] + energy["travel"] - energy["dissipated"] - energy["stored"]
    assert abs(balance) < 1e-3 * energy["dissipated"]
    assert abs(energy["travel"]) > abs(balance)
    frozen = chatter.simulate(case, {"structure.travel_positions": 1})
    # over 3 mm the rails hardly change
    for axis in ("Fx", "Fy"):
        assert result.summary()["mean_force_N"][axis] == pytest.approx(
            frozen.summary()["mean_force_N"][axis], rel=2e-3
        )
