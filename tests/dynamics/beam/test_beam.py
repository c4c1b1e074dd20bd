"""Beam elements and lines against exact solutions and published frequencies."""

import numpy as np
import pytest
import scipy.linalg

from dynamics.beam.element import element_mass, element_stiffness
from dynamics.beam.shaft import BeamLine, Bearing, Disc, Material, Segment, cowper, hutchinson
from dynamics.structure.assembly import assemble
from dynamics.structure.bodies import Body, Connector, Point
from dynamics.structure.linear_structure import StructureError

TIMOSHENKO_TOOL = Material(young=200e9, density=7800.0, poisson=0.29)
ROTOR_STEEL = Material(young=211e9, density=7810.0, poisson=211.0 / (2.0 * 81.2) - 1.0)


def clamped_frequencies(line, count):
    """Natural frequencies, Hz, with the first node held exactly."""
    squared = scipy.linalg.eigh(
        line.stiffness_matrix[6:, 6:], line.mass_matrix[6:, 6:], eigvals_only=True
    )
    return np.sqrt(squared[:count]) / (2.0 * np.pi)


def clamped_motion(line, place, load):
    """Motion (6,) of a place under a force and moment (6,) there, with the first node held."""
    motion = line.motion_at(place)[:, 6:]
    return motion @ np.linalg.solve(line.stiffness_matrix[6:, 6:], motion.T @ load)


def tool(elements):
    return BeamLine(
        "tool",
        [Segment(0.125, 0.010, TIMOSHENKO_TOOL, elements=elements, shear_coefficient=hutchinson)],
    )


def one_plane(matrix):
    """Rows and columns of displacements along z and rotations about y: one plane on its own."""
    rows = np.sort(np.concatenate([np.arange(2, len(matrix), 6), np.arange(4, len(matrix), 6)]))
    return matrix[np.ix_(rows, rows)]


def clamped_plane_frequencies(elements):
    """Bending frequencies, Hz, of the tool along x held at its first node."""
    line = BeamLine("tool", tool(elements).segments, axis=(1.0, 0.0, 0.0))
    squared = scipy.linalg.eigh(
        one_plane(line.stiffness_matrix)[2:, 2:],
        one_plane(line.mass_matrix)[2:, 2:],
        eigvals_only=True,
    )
    return np.sqrt(squared[:3]) / (2.0 * np.pi)


@pytest.mark.parametrize(
    ("elements", "published"),
    [
        (5, [451.80308, 2777.53903, 7597.07959]),
        (25, [451.78726, 2774.08876, 7533.25453]),
        (125, [451.78685, 2773.99560, 7531.41125]),
    ],
)
def test_timoshenko_cantilever_has_the_published_fe_frequencies(elements, published):
    np.testing.assert_allclose(clamped_plane_frequencies(elements), published, atol=1e-5)


def test_both_planes_of_a_cantilever_are_alike():
    # Torsion, sqrt(G/rho)/(4 L) and a little more, is the fifth.
    found = clamped_frequencies(tool(25), 7)
    np.testing.assert_allclose(found[[0, 2, 5]], found[[1, 3, 6]], rtol=1e-8)
    torsion = np.sqrt(TIMOSHENKO_TOOL.shear_modulus / 7800.0) / (4 * 0.125)
    assert found[4] == pytest.approx(torsion, rel=1e-3)


def test_timoshenko_cantilever_tends_to_the_exact_frequencies():
    # Four times closer with twice the elements, and a little of higher order yet.
    exact = np.array([451.7868377, 2773.9917998, 7531.3359004])
    coarse, fine = clamped_plane_frequencies(20) - exact, clamped_plane_frequencies(40) - exact
    assert np.all(fine > 0.0)
    np.testing.assert_allclose(fine[1:] / exact[1:], 0.0, atol=2e-4)
    np.testing.assert_allclose(coarse / fine, 4.0, rtol=0.05)


def slender(elements=20):
    material = Material(young=200e9, density=7800.0, poisson=0.3)
    return BeamLine("rod", [Segment(1.0, 0.002, material, elements=elements)])


def euler_bernoulli(line, numbers):
    segment = line.segments[0]
    rigidity = segment.material.young * segment.second_moment
    inertia = segment.material.density * segment.area
    speed = np.sqrt(rigidity / inertia)
    return np.array(numbers) ** 2 * speed / (2.0 * np.pi * line.length**2)


def test_slender_beam_has_euler_bernoulli_frequencies():
    line = slender()
    cantilever = [1.8751040687119178, 4.694091132974175, 7.854757438237325, 10.995540734875467]
    found = clamped_frequencies(line, 8)[::2]
    np.testing.assert_allclose(found, euler_bernoulli(line, cantilever), rtol=1.5e-4)
    free = [4.730040744862704, 7.853204624095503, 10.995607838001671]
    structure = assemble([], [], [], [line], allowed_rigid_motions=6)
    found = structure.natural_frequencies(12)
    assert np.all(found[:6] < 0.05)
    np.testing.assert_allclose(found[6::2], euler_bernoulli(line, free), rtol=1.5e-4)


def test_axial_and_torsional_frequencies():
    material = Material(young=200e9, density=8000.0, poisson=0.25)
    line = BeamLine("rod", [Segment(0.5, 0.3, material, elements=24)])
    # The mass and stiffness of pure stretching and of pure twisting, held at the first end.
    for freedom, modulus in ((2, material.young), (5, material.shear_modulus)):
        rows = np.arange(6 + freedom, len(line.mass_matrix), 6)
        squared = scipy.linalg.eigh(
            line.stiffness_matrix[np.ix_(rows, rows)],
            line.mass_matrix[np.ix_(rows, rows)],
            eigvals_only=True,
        )
        expected = np.sqrt(modulus / material.density) / (4.0 * 0.5)
        assert np.sqrt(squared[0]) / (2.0 * np.pi) == pytest.approx(expected, rel=5e-4)


@pytest.mark.parametrize(
    ("elements", "published"),
    [
        (6, [82.65303734, 254.52047828, 679.48903239, 1032.39153176, 1667.66988949]),
        (96, [82.65294763, 254.51561937, 679.29613306, 1031.75774023, 1666.26316867]),
    ],
)
def test_rotor_with_discs_has_the_published_frequencies(elements, published):
    discs = [
        Disc.from_size(0.5, width=0.07, inner=0.05, outer=0.28, density=7810.0),
        Disc.from_size(1.0, width=0.07, inner=0.05, outer=0.35, density=7810.0),
    ]
    line = BeamLine(
        "rotor",
        [Segment(1.5, 0.05, ROTOR_STEEL, elements=elements)],
        axis=(1.0, 0.0, 0.0),
        discs=discs,
        bearings=[
            Bearing("left", 0.0, radial=(1.0e6, 0.8e6), axial=1e9, torsion=1e7),
            Bearing("right", 1.5, radial=(1.0e6, 0.8e6)),
        ],
    )
    assert len(line.nodes) == elements + 1
    structure = assemble([], [], [], [line])
    # z is the softer radial direction; with 96 elements rounding takes the last digit.
    squared = scipy.linalg.eigh(
        one_plane(structure.stiffness), one_plane(structure.mass), eigvals_only=True
    )
    np.testing.assert_allclose(np.sqrt(squared[:5]), published, rtol=3e-8)


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, -2, 0.5)])
def test_static_deflection_with_shear_is_exact_along_any_axis(axis):
    material = Material(young=210e9, density=7850.0, poisson=0.3)
    segment = Segment(0.2, 0.05, material, inner_diameter=0.02, elements=1)
    line = BeamLine("quill", [segment], axis=axis, origin=(0.3, 0.1, -0.2))
    along, across, third = line.axes
    np.testing.assert_allclose(np.cross(along, across), third, atol=1e-14)
    area, second = np.pi * (0.05**2 - 0.02**2) / 4, np.pi * (0.05**4 - 0.02**4) / 64
    bending, length = 210e9 * second, 0.2
    shear = cowper(0.3, 0.4) * 210e9 / 2.6 * area
    tip = line.position(length)
    moved = clamped_motion(line, tip, np.concatenate([1e3 * across, np.zeros(3)]))
    expected = 1e3 * (length**3 / (3 * bending) + length / shear)
    np.testing.assert_allclose(moved[:3], expected * across, atol=1e-12 * expected)
    slope = 1e3 * length**2 / (2 * bending)
    np.testing.assert_allclose(moved[3:], slope * third, atol=1e-11 * slope)
    moved = clamped_motion(line, tip, np.concatenate([1e5 * along, 50.0 * along]))
    np.testing.assert_allclose(moved[:3], 1e5 * length / (210e9 * area) * along, atol=1e-18)
    twist = 50.0 * length / (210e9 / 2.6 * 2 * second)
    np.testing.assert_allclose(moved[3:], twist * along, atol=1e-15)
    moved = clamped_motion(line, tip, np.concatenate([np.zeros(3), 50.0 * across]))
    np.testing.assert_allclose(moved[3:], 50.0 * length / bending * across, atol=1e-14)
    np.testing.assert_allclose(moved[:3], -50.0 * length**2 / (2 * bending) * third, atol=1e-15)


def test_stepped_cantilever_deflects_as_by_castigliano():
    material = Material(young=210e9, density=7850.0, poisson=0.3)
    thick = Segment(0.1, 0.04, material, elements=2)
    thin = Segment(0.06, 0.02, material, elements=3, shear_coefficient=0.85)
    line = BeamLine("tool", [thick, thin])
    moved = clamped_motion(line, (0.0, 0.0, 0.16), np.array([1.0, 0, 0, 0, 0, 0]))
    shear = material.shear_modulus
    expected = (
        (0.16**3 - 0.06**3) / (3 * 210e9 * thick.second_moment)
        + 0.06**3 / (3 * 210e9 * thin.second_moment)
        + 0.1 / (cowper(0.3, 0.0) * shear * thick.area)
        + 0.06 / (0.85 * shear * thin.area)
    )
    assert moved[0] == pytest.approx(expected, rel=1e-10)


def test_motion_between_nodes_is_that_of_the_loaded_beam():
    # Under an end load the static shape functions are the solution at every place.
    material = Material(young=210e9, density=7850.0, poisson=0.3)
    segment = Segment(0.2, 0.05, material, elements=1)
    line = BeamLine("quill", [segment])
    load = line.motion_at((0.0, 0.0, 0.2)).T @ np.array([1.0, 0, 0, 0, 0, 0])
    nodes = np.concatenate([np.zeros(6), np.linalg.solve(line.stiffness_matrix[6:, 6:], load[6:])])
    place = 0.07
    bending = 210e9 * segment.second_moment
    shear = segment.kappa * material.shear_modulus * segment.area
    across = (3 * 0.2 * place**2 - place**3) / (6 * bending) + place / shear
    turn = (0.2 * place - place**2 / 2) / bending
    radius = np.array([0.01, -0.02, 0.0])
    expected = np.array([across, 0, 0, 0, turn, 0])
    np.testing.assert_allclose(line.motion_at((0, 0, place)) @ nodes, expected, atol=1e-20)
    expected[:3] += np.cross(expected[3:], radius)
    np.testing.assert_allclose(
        line.motion_at(np.array([0, 0, place]) + radius) @ nodes, expected, atol=1e-20
    )


def test_rigid_motion_has_the_mass_and_inertia_of_the_cylinders_and_no_strain():
    material = Material(young=210e9, density=7850.0, poisson=0.3)
    first = Segment(0.3, 0.08, material, inner_diameter=0.03, elements=3)
    second = Segment(0.2, 0.05, material, elements=2)
    disc = Disc(0.41, mass=2.0, polar_inertia=0.01, diametral_inertia=0.006)
    line = BeamLine("shaft", [first, second], axis=(1, 2, 2), discs=[disc], origin=(1, 1, 1))
    rigid = line.rigid_motions
    scale = np.max(np.abs(line.stiffness_matrix))
    np.testing.assert_allclose(line.stiffness_matrix @ rigid, 0.0, atol=1e-12 * scale)
    moved = rigid.T @ line.mass_matrix @ rigid
    masses = [7850.0 * 0.3 * first.area, 7850.0 * 0.2 * second.area, 2.0]
    np.testing.assert_allclose(moved[:3, :3], sum(masses) * np.eye(3), atol=1e-9)
    turned = line.axes @ moved[3:, 3:] @ line.axes.T
    polar = masses[0] * (0.08**2 + 0.03**2) / 8 + masses[1] * 0.05**2 / 8 + 0.01
    own = [
        masses[0] * ((0.08**2 + 0.03**2) / 16 + 0.3**2 / 12 + 0.15**2),
        masses[1] * (0.05**2 / 16 + 0.2**2 / 12 + 0.4**2),
        0.006 + 2.0 * 0.41**2,
    ]
    np.testing.assert_allclose(turned, np.diag([polar, sum(own), sum(own)]), rtol=1e-9, atol=1e-9)
    leaning = line.axes @ moved[3:, :3] @ line.axes.T
    static = masses[0] * 0.15 + masses[1] * 0.4 + 2.0 * 0.41
    expected = static * np.array([[0, 0, 0], [0, 0, -1], [0, 1, 0]])
    np.testing.assert_allclose(leaning, expected, atol=1e-9)


def test_element_without_shear_is_the_textbook_one():
    # Euler-Bernoulli: 12, 6L, 4L^2, 2L^2 and 156, 22L, 54, -13L; a large kappa removes shear.
    material = Material(young=1.0, density=1.0, poisson=0.0)
    segment = Segment(2.0, 1e-3, material, shear_coefficient=1e12)
    bending = element_stiffness(segment, 2.0)[np.ix_([1, 5, 7, 11], [1, 5, 7, 11])]
    expected = np.array(
        [[12, 12, -12, 12], [12, 16, -12, 8], [-12, -12, 12, -12], [12, 8, -12, 16]]
    )
    np.testing.assert_allclose(bending, segment.second_moment / 8 * expected, rtol=1e-6)
    mass = element_mass(segment, 2.0)[np.ix_([1, 5, 7, 11], [1, 5, 7, 11])]
    expected = np.array(
        [[156, 44, 54, -26], [44, 16, 26, -12], [54, 26, 156, -44], [-26, -12, -44, 16]]
    )
    np.testing.assert_allclose(mass, segment.area * 2 / 420 * expected, rtol=1e-5)


def test_shear_coefficients():
    assert cowper(0.3, 0.0) == pytest.approx(6 * 1.3 / (7 + 6 * 0.3))
    assert cowper(0.3, 1.0) == pytest.approx(2 * 1.3 / (4 + 3 * 0.3))  # thin tube, Cowper 1966
    assert hutchinson(0.29, 0.0) == pytest.approx(6 * 1.29**2 / (7 + 12 * 0.29 + 4 * 0.29**2))
    assert hutchinson(0.3, 1.0) == pytest.approx(1.3 / 2.3)  # thin tube, (1+nu)/(2+nu)


def test_bearing_between_line_and_body_carries_both():
    # A rigid-like shaft in two springs on a body in two springs: springs in series.
    material = Material(young=1e16, density=7850.0, poisson=0.3)
    line = BeamLine(
        "spindle",
        [Segment(0.4, 0.08, material)],
        origin=(0.0, 0.0, 1.0),
        bearings=[
            Bearing("front", 0.1, (1e7, 2e7), 4e7, body="head", radial_damping=(10.0, 20.0)),
            Bearing("rear", 0.3, (1e7, 2e7), torsion=1e5, body="head"),
        ],
    )
    head = Body("head", 50.0, (2.0, 2.0, 2.0), (0.0, 0.0, 1.2))
    feet = Connector("feet", "head", "ground", (0, 0, 1.2), (3e7, 5e7, 6e7, 1e9, 1e9, 1e9))
    structure = assemble([head], [feet], [Point("middle", "spindle", (0, 0, 1.2))], [line])
    compliance = structure.points["middle"] @ np.linalg.solve(
        structure.stiffness, structure.points["middle"].T
    )
    expected = [1 / 2e7 + 1 / 3e7, 1 / 4e7 + 1 / 5e7, 1 / 4e7 + 1 / 6e7]
    np.testing.assert_allclose(np.diag(compliance)[:3], expected, rtol=1e-5)
    assert structure.damping[0, 0] == pytest.approx(10.0)
    assert structure.damping[1, 1] == pytest.approx(20.0)


def test_bearing_between_two_lines_gets_a_node_in_both():
    quill = BeamLine("quill", [Segment(0.4, 0.1, ROTOR_STEEL, inner_diameter=0.07, elements=2)])
    bearings = [
        Bearing("front", 0.05, (1e8, 1e8), 1e8, torsion=1e3, body="quill"),
        Bearing("rear", 0.25, (1e8, 1e8), body="quill"),
    ]
    shaft = BeamLine(
        "shaft", [Segment(0.3, 0.05, ROTOR_STEEL, elements=1)], (0, 0, 0.06), bearings=bearings
    )
    clamp = Connector("clamp", "quill", "ground", (0.0, 0.0, 0.02), (1e9,) * 6)
    # Quill: ends, 0.02, 0.11 and 0.31 m; shaft: ends, 0.05 and 0.25 m.
    assert assemble([], [clamp], [], [quill, shaft]).size == 6 * (5 + 4)


def test_first_radial_direction_turns_the_bearing():
    line = BeamLine(
        "spindle",
        [Segment(0.4, 0.08, ROTOR_STEEL)],
        bearings=[Bearing("only", 0.0, (5e6, 1e6), 1e6, (1e5, 1e5), 1e5)],
        first_radial=(0.0, 1.0, 0.4),
    )
    stiffness = assemble([], [], [], [line]).stiffness - line.stiffness_matrix
    np.testing.assert_allclose(np.diag(stiffness)[:3], [1e6, 5e6, 1e6], rtol=1e-3)


def test_damping_in_proportion_to_stiffness():
    material = Material(young=210e9, density=7850.0)
    line = BeamLine("rod", [Segment(0.2, 0.02, material)], stiffness_damping=1e-6)
    np.testing.assert_array_equal(line.damping_matrix, 1e-6 * line.stiffness_matrix)


def test_nodes_stand_where_something_is_joined_but_never_form_slivers():
    line = BeamLine(
        "rod", [Segment(0.2, 0.02, ROTOR_STEEL, elements=2), Segment(0.1, 0.03, ROTOR_STEEL)]
    )
    joined = line.with_nodes_at([(0, 0, 0.03), (0.01, 0, 0.2 + 1e-7), (0, 0, 0.03 + 1e-9)])
    assert np.any(np.isclose(joined.nodes, 0.03, atol=1e-12))
    assert np.min(np.diff(joined.nodes)) > 1e-3
    assert joined.nodes[-1] == pytest.approx(0.3)


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: Segment(0.1, 0.01, ROTOR_STEEL, inner_diameter=0.02), "inner_diameter is 0.02"),
        (lambda: Segment(-0.1, 0.01, ROTOR_STEEL), "length is -0.1"),
        (lambda: Segment(0.1, 0.01, ROTOR_STEEL, elements=0), "elements is 0"),
        (lambda: Material(young=2e11, density=0.0), "density is 0"),
        (lambda: Material(young=2e11, density=1.0, poisson=0.6), "poisson is 0.6"),
        (lambda: Disc(0.1, -1.0, 1.0, 1.0), "mass is -1"),
        (lambda: BeamLine("rod", []), 'beam "rod" has no segments'),
        (lambda: BeamLine("rod", [Segment(1, 0.1, ROTOR_STEEL)], axis=(0, 0, 0)), "no length"),
        (
            lambda: BeamLine("rod", [Segment(1, 0.1, ROTOR_STEEL)], first_radial=(0, 0, 3)),
            "first_radial lies along",
        ),
        (
            lambda: BeamLine("rod", [Segment(1, 0.1, ROTOR_STEEL)], discs=[Disc(1.1, 1, 1, 1)]),
            "station 1.1 m is off the line",
        ),
        (
            lambda: BeamLine("rod", [Segment(1, 0.1, ROTOR_STEEL)]).motion_at((0, 0, -0.1)),
            "station -0.1 m is off the line",
        ),
    ],
)
def test_impossible_lines_are_refused(build, message):
    with pytest.raises(StructureError, match=message):
        build()
