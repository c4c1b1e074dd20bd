"""Couplings: springs and dampers along sums of motions, and the matrix of a screw and its nut."""

import numpy as np
import pytest

from dynamics.structure.assembly import assembly
from dynamics.structure.bodies import Body, Connector
from dynamics.structure.linear_structure import StructureError
from dynamics.structure.rotor import Rotor
from dynamics.structure.spring_coupling import Coupling, Term, reversed_terms, screw_nut_matrix


def rack(stiffness=2e7, damping=300.0, radius=0.05):
    """Pinion on ground that drives a slide through its teeth."""
    slide = Body("slide", 80.0, [1.0, 2.0, 3.0], [0, 0, 0])
    guide = Connector("guide", "slide", "ground", [0, 0, 0], [0, 1e8, 1e8, 1e7, 1e7, 1e7])
    terms = [Term("slide", [1, 0, 0]), Term("pinion", [0, 0, 0, 0, 0, -radius])]
    return assembly(
        [slide], [guide], [], rotors=[Rotor("pinion", 0.02, [0, 0, 1])],
        couplings=[Coupling("teeth", terms, stiffness, damping)], allowed_rigid_motions=1,
    )  # fmt: skip


def test_rolling_strains_nothing():
    structure = rack().structure
    rolling = np.zeros(7)
    rolling[0], rolling[6] = 0.05, 1.0
    assert structure.stiffness @ rolling == pytest.approx(np.zeros(7), abs=1e-6)
    assert structure.damping @ rolling == pytest.approx(np.zeros(7), abs=1e-9)


def test_frequency_of_pinion_against_slide():
    """k (1/m + r^2/J) = w^2."""
    frequency = rack().structure.natural_frequencies()
    wanted = np.sqrt(2e7 * (1 / 80.0 + 0.05**2 / 0.02)) / (2.0 * np.pi)
    assert np.min(np.abs(frequency - wanted)) < 1e-6 * wanted


def test_force_and_damping_of_a_strained_coupling():
    structure = rack().structure
    motion = np.zeros(7)
    motion[0] = 1e-3
    assert (structure.stiffness @ motion)[[0, 6]] == pytest.approx([2e4, -2e4 * 0.05])
    assert (structure.damping @ motion)[[0, 6]] == pytest.approx([0.3, -0.3 * 0.05])


def test_lever_arm_of_a_term():
    """A force beside the centre of gravity turns the body: r x F."""
    body = Body("slide", 80.0, [1.0, 2.0, 3.0], [0.1, 0.2, 0.3])
    feet = Connector("feet", "slide", "ground", [0, 0, 0], [1e6] * 6)
    whole = assembly([body], [feet], [])
    row = whole.row("f", [Term("slide", [0.0, 2.0, 0.0], [0.6, 0.1, 0.9])])
    assert row[:3] == pytest.approx([0, 2, 0])
    assert row[3:] == pytest.approx(np.cross([0.5, -0.1, 0.6], [0, 2, 0]))


def test_reversed_terms_are_the_opposite_motion():
    whole = rack()
    terms = [
        Term("slide", [1, 2, 3, 4, 5, 6], [0.3, 0.1, -0.2]),
        Term("pinion", [0, 0, 0, 0, 0, 7]),
    ]
    there, back = (whole.row("x", one) for one in (terms, reversed_terms(terms)))
    assert there == pytest.approx(-back)
    assert np.any(there)


def test_screw_nut_matrix_against_its_springs():
    """Energy of five springs, the axial one stretched by travel less lead times turns."""
    lead, values = 0.012, ((2e8, 3e8), 4e8, (1e5, 2e5))
    matrix = screw_nut_matrix(*values, lead)
    rng = np.random.default_rng(2)
    x, y, z, psi, theta, phi = motion = rng.normal(size=6)
    stretch = z - lead * phi / (2.0 * np.pi)
    energy = 2e8 * x**2 + 3e8 * y**2 + 4e8 * stretch**2 + 1e5 * psi**2 + 2e5 * theta**2
    assert motion @ matrix @ motion == pytest.approx(energy)
    assert matrix == pytest.approx(matrix.T)
    # a full turn and the lead: nothing strained
    assert matrix @ [0, 0, lead, 0, 0, 2.0 * np.pi] == pytest.approx(np.zeros(6), abs=1e-6)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        (("teeth", [], 1.0), 'coupling "teeth" ties nothing'),
        (("teeth", [Term("a", [1, 0, 0])], -1.0), "stiffness is -1"),
        (("teeth", [Term("a", [1, 0, 0])], np.nan), "stiffness is nan"),
        (("teeth", [Term("a", [1, 0, 0])], 1.0, -2.0), "damping is -2"),
    ],
)
def test_refused(keys, words):
    with pytest.raises(StructureError, match=words):
        Coupling(*keys)


def test_term_of_two_numbers():
    with pytest.raises(StructureError, match="3 or 6 numbers"):
        Term("a", [1.0, 2.0])


def test_unknown_part_is_named():
    with pytest.raises(StructureError, match=r'coupling "teeth".*no body or beam "slid"'):
        assembly(
            [Body("slide", 1, [1, 1, 1], [0, 0, 0])],
            [],
            [],
            couplings=[Coupling("teeth", [Term("slid", [1, 0, 0])], 1.0)],
        )
