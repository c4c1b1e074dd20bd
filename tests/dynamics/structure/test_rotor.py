"""Rotor: one absolute angle about an axis."""

import numpy as np
import pytest

from dynamics.structure.assembly import assembly
from dynamics.structure.bodies import Body, Connector
from dynamics.structure.linear_structure import StructureError
from dynamics.structure.rotor import Rotor
from dynamics.structure.spring_coupling import Coupling, Term


def test_motion_is_its_turning_wherever_the_place():
    rotor = Rotor("motor", 2e-3, [0.0, 3.0, 4.0])
    for place in ([0.0, 0.0, 0.0], [5.0, -1.0, 2.0]):
        assert rotor.motion_at(place)[:, 0] == pytest.approx([0, 0, 0, 0, 0.6, 0.8])
    assert rotor.mass_matrix == pytest.approx(np.array([[2e-3]]))
    assert not rotor.stiffness_matrix.any()
    assert not rotor.damping_matrix.any()


def test_two_rotors_on_a_shaft_swing_against_one_another():
    """w^2 = k (1/J1 + 1/J2), and a free common rotation."""
    shaft = Coupling(
        "shaft", [Term("one", [0, 0, 0, 0, 0, 1]), Term("two", [0, 0, 0, 0, 0, -1])], 500.0
    )
    rotors = [Rotor("one", 2e-3, [0, 0, 1]), Rotor("two", 5e-3, [0, 0, 1])]
    whole = assembly([], [], [], allowed_rigid_motions=1, rotors=rotors, couplings=[shaft])
    frequency = whole.structure.natural_frequencies()
    assert frequency[0] == pytest.approx(0.0, abs=1e-3)
    wanted = np.sqrt(500.0 * (1 / 2e-3 + 1 / 5e-3)) / (2.0 * np.pi)
    assert frequency[1] == pytest.approx(wanted, rel=1e-9)


def test_reaction_of_a_motor_turns_its_housing():
    """Torque between rotor and body: equal and opposite, so that angular momentum stays."""
    body = Body("head", 10.0, [0.4, 0.5, 0.3], [0.1, 0.2, 0.3])
    feet = Connector("feet", "head", "ground", [0, 0, 0], [1e5] * 6)
    whole = assembly(
        [body], [feet], [], rotors=[Rotor("motor", 1e-3, [0, 1, 0])], allowed_rigid_motions=1
    )
    row = whole.row("motor", [Term("motor", [0, 0, 0, 0, 1, 0]), Term("head", [0, 0, 0, 0, -1, 0])])
    start = np.linalg.solve(whole.structure.mass, row)
    assert start == pytest.approx([0, 0, 0, 0, -1 / 0.5, 0, 1 / 1e-3])


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        (("ground", 1.0, [0, 0, 1]), '"ground" is what does not move'),
        (("motor", 0.0, [0, 0, 1]), 'rotor "motor".*inertia is 0.0'),
        (("motor", -1.0, [0, 0, 1]), "must be positive"),
        (("motor", np.nan, [0, 0, 1]), "must be positive"),
        (("motor", 1.0, [0, 0, 0]), "no length"),
        (("motor", 1.0, [0, np.inf, 0]), "axis"),
    ],
)
def test_refused(keys, words):
    with pytest.raises(StructureError, match=words):
        Rotor(*keys)
