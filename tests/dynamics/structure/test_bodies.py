"""Rigid bodies on connectors, against closed forms and invariances."""

import numpy as np
import pytest
import scipy.linalg
from scipy.spatial.transform import Rotation

from dynamics.beam.shaft import BeamLine, Material, Segment
from dynamics.structure.assembly import assemble
from dynamics.structure.bodies import Body, Connector, Point
from dynamics.structure.linear_structure import StructureError

STEEL = Material(young=210e9, density=7850.0, poisson=0.3)


def spring(name, at, along, stiffness, first="block", second="ground", damping=0.0):
    """Connector with one translational spring along x, y or z."""
    values = np.zeros(6)
    values[along] = stiffness
    lost = np.zeros(6)
    lost[along] = damping
    return Connector(name, first, second, at, values, lost)


def mount(name, at, first="block", second="ground", axes=None):
    values = (3e6, 5e6, 2e6, 4e4, 7e4, 1e4)
    lost = (300.0, 500.0, 200.0, 4.0, 7.0, 1.0)
    return Connector(name, first, second, at, values, lost, np.eye(3) if axes is None else axes)


def machine(turn=None, shift=(0.0, 0.0, 0.0)):
    """Column on four feet, table on guides and a spindle in the column, turned as a whole."""
    turn = np.eye(3) if turn is None else turn

    def at(*place):
        return turn @ np.array(place) + shift

    bodies = [
        Body("column", 800.0, turn @ np.diag([90.0, 70.0, 40.0]) @ turn.T, at(0.0, 0.1, 0.9)),
        Body("table", 150.0, turn @ np.diag([6.0, 9.0, 14.0]) @ turn.T, at(0.3, -0.5, 0.5)),
    ]
    feet = [(-0.4, -0.3, 0.0), (0.4, -0.3, 0.0), (-0.4, 0.3, 0.0), (0.4, 0.3, 0.0)]
    connectors = [
        mount(f"foot {place}", at(*foot), "column", axes=turn.T) for place, foot in enumerate(feet)
    ]
    connectors += [
        mount("guide", at(0.1, -0.4, 0.6), "table", "column", axes=turn.T),
        mount("front bearing", at(0.2, -0.4, 1.2), "spindle", "column", axes=turn.T),
        mount("rear bearing", at(0.2, -0.4, 1.5), "column", "spindle", axes=turn.T),
    ]
    spindle = BeamLine(
        "spindle", [Segment(0.5, 0.06, STEEL)], origin=at(0.2, -0.4, 1.6), axis=turn @ [0, 0, -1.0]
    )
    points = [
        Point("tool", "spindle", at(0.2, -0.4, 1.1)),
        Point("work", "table", at(0.35, -0.6, 0.8)),
    ]
    return assemble(bodies, connectors, points, [spindle])


def test_bounce_and_pitch_of_a_block_on_two_springs():
    mass, inertia, ahead, behind, front, rear = 120.0, 15.0, 0.7, 0.4, 2e6, 3e6
    structure = assemble(
        [Body("block", mass, (1.0, inertia, 1.0), (0.0, 0.0, 0.0))],
        [
            spring("front", (ahead, 0.0, 0.0), 2, front),
            spring("rear", (-behind, 0.0, 0.0), 2, rear),
        ],
        [],
        allowed_rigid_motions=4,
    )
    bounce = (front + rear) / mass
    pitch = (front * ahead**2 + rear * behind**2) / inertia
    coupling = (rear * behind - front * ahead) ** 2 / (mass * inertia)
    half = 0.5 * (bounce + pitch)
    root = np.sqrt(0.25 * (bounce - pitch) ** 2 + coupling)
    expected = np.sqrt([half - root, half + root]) / (2.0 * np.pi)
    np.testing.assert_allclose(structure.natural_frequencies()[-2:], expected, rtol=1e-10)


def test_body_on_a_hinge_swings_about_it():
    # Parallel axes: a body whose hinge is an arm away has inertia I + m a^2 about it.
    mass, inertia, arm, tilt = 40.0, 3.0, 0.5, 8e4
    stiff = 1e13
    structure = assemble(
        [Body("block", mass, (5.0, inertia, 6.0), (0.0, 0.0, arm))],
        [Connector("hinge", "ground", "block", (0, 0, 0), (stiff,) * 3 + (1e12, tilt, 1e12))],
        [Point("top", "block", (0.1, 0.0, 2 * arm))],
    )
    expected = np.sqrt(tilt / (inertia + mass * arm**2)) / (2.0 * np.pi)
    assert structure.natural_frequencies(1)[0] == pytest.approx(expected, rel=1e-5)
    # A force along x at the top turns it by F h / k about y; the point 0.1 m off moves down.
    force = structure.port("top", (1.0, 0.0, 0.0))
    moved = np.linalg.solve(structure.stiffness, force)
    turn = 2 * arm / tilt
    expected_motion = [turn * 2 * arm, 0.0, -turn * 0.1, 0.0, turn, 0.0]
    np.testing.assert_allclose(structure.points["top"] @ moved, expected_motion, atol=1e-11)


def test_damper_gives_its_damping_ratio():
    mass, stiffness, damping = 25.0, 4e6, 600.0
    structure = assemble(
        [Body("block", mass, (1.0, 1.0, 1.0), (0.0, 0.0, 0.0))],
        [Connector("pad", "block", "ground", (0, 0, 0), (stiffness,) * 6, (damping,) * 6)],
        [Point("centre", "block", (0.0, 0.0, 0.0))],
    )
    natural = np.sqrt(stiffness / mass) / (2.0 * np.pi)
    response = structure.receptance(natural, structure.port("centre", (0, 1, 0)))[0, 0, 0]
    expected = 1.0 / (1j * 2.0 * np.pi * natural * damping)
    assert response == pytest.approx(expected, rel=1e-9)


def test_axes_of_a_connector_turn_its_springs():
    angle = np.radians(30.0)
    rows = [[np.cos(angle), np.sin(angle), 0], [-np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    structure = assemble(
        [Body("block", 1.0, (1.0, 1.0, 1.0), (0.0, 0.0, 0.0))],
        [Connector("pad", "block", "ground", (0, 0, 0), (9.0, 1.0, 1.0, 1.0, 1.0, 1.0), axes=rows)],
        [],
    )
    assert structure.stiffness[0, 0] == pytest.approx(9 * 0.75 + 0.25)
    assert structure.stiffness[0, 1] == pytest.approx((9 - 1) * np.sqrt(3) / 4)


def test_two_bodies_keep_their_centre_of_mass():
    bodies = [
        Body("one", 3.0, (0.1, 0.2, 0.3), (0.0, 0.0, 0.0)),
        Body("two", 5.0, (0.4, 0.3, 0.6), (0.5, 0.2, 0.1)),
    ]
    joint = Connector("joint", "one", "two", (0.3, 0.0, 0.2), (1e6, 2e6, 3e6, 1e3, 2e3, 3e3))
    structure = assemble(bodies, [joint], [], allowed_rigid_motions=6)
    about_origin = np.vstack([np.eye(6), np.eye(6)])
    for place, body in enumerate(bodies):
        for axis in range(3):
            turn = np.cross(np.eye(3)[axis], body.centre)
            about_origin[6 * place : 6 * place + 3, 3 + axis] = turn
    np.testing.assert_allclose(structure.stiffness @ about_origin, 0.0, atol=1e-8)
    moved = about_origin.T @ structure.mass @ about_origin
    np.testing.assert_allclose(moved[:3, :3], 8.0 * np.eye(3), atol=1e-12)
    # Moment of inertia of the pair about z: own ones and 5 (0.5^2 + 0.2^2).
    assert moved[5, 5] == pytest.approx(0.3 + 0.6 + 5.0 * 0.29)


def test_whole_machine_turned_and_shifted_has_the_same_frequencies_and_receptance():
    turn = Rotation.from_euler("xyz", [0.4, -1.1, 2.3]).as_matrix()
    upright, turned = machine(), machine(turn, (3.0, -2.0, 1.0))
    np.testing.assert_allclose(
        turned.natural_frequencies(20), upright.natural_frequencies(20), rtol=1e-7
    )
    for structure in (upright, turned):
        for matrix in (structure.mass, structure.damping, structure.stiffness):
            np.testing.assert_allclose(matrix, matrix.T, atol=1e-9 * np.max(np.abs(matrix)))
        assert scipy.linalg.eigvalsh(structure.mass)[0] > 0.0
    direction = np.array([0.6, 0.0, 0.8])
    first = upright.receptance([40.0], upright.port("tool", direction, "work"))
    second = turned.receptance([40.0], turned.port("tool", turn @ direction, "work"))
    np.testing.assert_allclose(second, first, rtol=1e-7)


def test_inertia_tensor_and_principal_moments_agree():
    given = Body("block", 2.0, np.diag([1.0, 2.0, 2.5]), (0, 0, 0)).mass_matrix
    np.testing.assert_array_equal(given, Body("b", 2.0, (1.0, 2.0, 2.5), (0, 0, 0)).mass_matrix)


BLOCK = Body("block", 1.0, (1.0, 1.0, 1.0), (0.2, 0.0, 0.0))


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: Body("bed", 0.0, (1, 1, 1), (0, 0, 0)), 'body "bed": mass is 0'),
        (lambda: Body("bed", 1.0, (1, 0, 1), (0, 0, 0)), "principal moment"),
        (lambda: Body("bed", 1.0, [[1, 2, 0], [2, 1, 0], [0, 0, 1]], (0, 0, 0)), "principal"),
        (lambda: Body("bed", 1.0, [[1, 0.2, 0], [0, 1, 0], [0, 0, 1]], (0, 0, 0)), "symmetric"),
        (lambda: Body("bed", 1.0, (1, 1, 1), (0, np.nan, 0)), "centre must be 3 finite"),
        (lambda: Body("ground", 1.0, (1, 1, 1), (0, 0, 0)), "does not move"),
        (lambda: spring("pad", (0, 0, 0), 1, -2.0), 'connector "pad": stiffness y is -2'),
        (lambda: spring("pad", (0, 0, 0), 1, 2.0, damping=-1.0), "damping y is -1"),
        (lambda: mount("pad", (0, 0, 0), axes=2 * np.eye(3)), "perpendicular unit"),
        (lambda: spring("pad", (0, 0, 0), 1, 2.0, "block", "block"), "with itself"),
        (lambda: assemble([BLOCK, BLOCK], [], []), 'body or beam "block" is there twice'),
        (lambda: assemble([BLOCK], [mount("a", (0, 0, 0))] * 2, []), 'connector "a" is there'),
        (lambda: assemble([BLOCK], [mount("a", (0, 0, 0), "bed")], []), 'no body or beam "bed"'),
        (
            lambda: assemble([BLOCK], [mount("a", (0, 0, 0))], [Point("tip", "tool", (0, 0, 0))]),
            'point "tip": there is no body or beam "tool"',
        ),
        (
            lambda: assemble(
                [BLOCK], [mount("a", (0, 0, 0))], [Point("p", "block", (0, 0, 0))] * 2
            ),
            'point "p" is there twice',
        ),
        (lambda: assemble([], [], []), "at least one body"),
        (lambda: assemble([BLOCK], [], []), 'motions that no connector holds: 6.*"block" x; '),
    ],
)
def test_impossible_structures_are_refused_by_name(build, message):
    with pytest.raises(StructureError, match=message):
        build()


def test_free_motion_is_named():
    table = Body("table", 10.0, (1.0, 1.0, 1.0), (0.0, 0.0, 0.5))
    bed = Body("bed", 90.0, (9.0, 9.0, 9.0), (0.0, 0.0, 0.0))
    feet = mount("feet", (0.0, 0.0, -0.2), "bed")
    slide = Connector("slide", "table", "bed", (0.0, 0.0, 0.4), (0, 1e8, 1e8, 1e6, 1e6, 1e6))
    with pytest.raises(StructureError, match=r'holds: 1, allowed: 0; free are "table" x$'):
        assemble([table, bed], [feet, slide], [])
    assert assemble([table, bed], [feet, slide], [], allowed_rigid_motions=1).size == 12
    hinge = Connector("hinge", "table", "bed", (0.0, 0.0, 0.0), (1e8, 1e8, 1e8, 1e6, 0, 1e6))
    with pytest.raises(StructureError, match=r'free are "table" x with "table" rotation about y$'):
        assemble([table, bed], [feet, hinge], [])
