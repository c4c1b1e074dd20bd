"""Static stiffness and natural frequencies of drives against closed forms."""

import numpy as np
import pytest

from dynamics.beam.shaft import BeamLine, Bearing, Segment
from dynamics.drive.ball_screw import BallScrew
from dynamics.drive.belt import Belt
from dynamics.drive.gear_train import Spring, in_series
from dynamics.drive.parts import DrivenAxis
from dynamics.drive.rack_and_pinion import RackAndPinion, RackMotor
from dynamics.drive.rotary import SpindleRotor
from dynamics.drive.screw_on_beam import ScrewOnBeam
from dynamics.drive.screw_shaft import STEEL, ScrewShaft
from dynamics.structure.assembly import assembly
from dynamics.structure.bodies import Body, Connector
from dynamics.structure.spring_coupling import screw_nut_matrix

DIAMETER, LENGTH, NUT_AT, LEAD = 0.032, 0.9, 0.35, 0.01
AREA, POLAR = np.pi * DIAMETER**2 / 4.0, np.pi * DIAMETER**4 / 32.0
BEARING, FAR, NUT, COUPLING = 6e8, 5e8, 4e8, 8e3
H_P = LEAD / (2.0 * np.pi)
MASS = 200.0
POSITIONS = (-0.3, 0.0, 0.2, 0.45)


def table(drive, position=0.0, beams=(), allowed=1):
    """Table on ground that only the drive holds along x, and cannot do anything else."""
    axis = DrivenAxis("X", (1.0, 0.0, 0.0), "table", "ground", (position, 0.0, 0.0), position)
    parts = drive.parts(axis)
    body = Body("table", MASS, (3.0, 4.0, 5.0), (position, 0.0, 0.0))
    guide = Connector("guide", "table", "ground", (position, 0.0, 0.0), (0.0, *[1e13] * 5))
    connectors = [guide, *parts.connectors]
    whole = assembly([body], connectors, [], beams, allowed, parts.rotors, parts.couplings)
    return whole, parts, whole.row("travel", axis.travel())


def locked_stiffness(whole, parts, travel):
    """Stiffness of the table, N/m, with every motor's angle held at zero."""
    held = np.array([whole.row("", motor.angle) for motor in parts.motors])
    stiffness = whole.structure.stiffness
    scale = 1e6
    matrix = np.block(
        [[stiffness, scale * held.T], [scale * held, np.zeros((len(held), len(held)))]]
    )
    push = np.concatenate([travel, np.zeros(len(held))])
    return 1.0 / (push @ np.linalg.solve(matrix, push))


def screw_on(support, **further):
    shaft = ScrewShaft(DIAMETER, LENGTH, NUT_AT, support)
    return BallScrew(LEAD, 3e-3, 2e-3, NUT, BEARING, shaft=shaft, **further)


@pytest.mark.parametrize("position", POSITIONS)
@pytest.mark.parametrize("support", ["fixed-free", "fixed-supported"])
def test_screw_held_at_one_end_is_a_row_of_springs(support, position):
    length = NUT_AT + position
    twist = length / (STEEL.shear_modulus * POLAR) + 1.0 / COUPLING
    compliance = 1.0 / BEARING + length / (STEEL.young * AREA) + 1.0 / NUT + H_P**2 * twist
    found = locked_stiffness(*table(screw_on(support, coupling_stiffness=COUPLING), position))
    assert found == pytest.approx(1.0 / compliance, rel=1e-7)


@pytest.mark.parametrize("position", POSITIONS)
def test_screw_held_at_both_ends_has_its_halves_side_by_side(position):
    first, second = NUT_AT + position, LENGTH - NUT_AT - position
    sides = 1.0 / (1.0 / BEARING + first / (STEEL.young * AREA))
    sides += 1.0 / (1.0 / FAR + second / (STEEL.young * AREA))
    twist = first / (STEEL.shear_modulus * POLAR)
    drive = screw_on("fixed-fixed", far_bearing_stiffness=FAR)
    found = locked_stiffness(*table(drive, position))
    assert found == pytest.approx(1.0 / (1.0 / sides + 1.0 / NUT + H_P**2 * twist), rel=1e-7)


def test_screw_between_rigid_bearings_is_softest_in_the_middle():
    shaft = ScrewShaft(DIAMETER, LENGTH, 0.0, "fixed-fixed")
    middle = shaft.axial_stiffness("", 0.5 * LENGTH, (np.inf, np.inf))
    assert middle == pytest.approx(4.0 * STEEL.young * AREA / LENGTH)
    assert shaft.axial_stiffness("", 0.4 * LENGTH, (np.inf, np.inf)) > middle


def test_bearing_ahead_of_the_nut_mirrors_the_screw():
    behind = ScrewShaft(DIAMETER, LENGTH, NUT_AT)
    ahead = ScrewShaft(DIAMETER, LENGTH, -NUT_AT)
    same = [
        shaft.axial_stiffness("", position, (BEARING, np.inf))
        for shaft, position in ((behind, 0.2), (ahead, -0.2))
    ]
    assert same[0] == pytest.approx(same[1], rel=1e-12)
    assert ahead.supports("", -0.2, (BEARING, np.inf))[0].station == pytest.approx(NUT_AT + 0.2)


@pytest.mark.parametrize("position", POSITIONS)
def test_screw_as_beam_is_as_stiff_as_the_row_of_springs(position):
    bearings = [
        Bearing("fixed", 0.0, (3e8, 3e8), BEARING, (1e5, 1e5)),
        Bearing("loose", LENGTH, (3e8, 3e8)),
    ]
    segments = [Segment(LENGTH, DIAMETER, STEEL)]
    beam = BeamLine("shaft", segments, (-NUT_AT, 0.0, 0.0), (1.0, 0.0, 0.0), bearings=bearings)
    drive = ScrewOnBeam(
        "shaft", LEAD, (2e8, 3e8), NUT, (1e5, 1e5), NUT_AT, 3e-3, coupling_stiffness=COUPLING
    )
    found = locked_stiffness(*table(drive, position, [beam]))
    rotor = screw_on("fixed-supported", coupling_stiffness=COUPLING)
    assert found == pytest.approx(locked_stiffness(*table(rotor, position)), rel=1e-6)


@pytest.mark.parametrize("lead", [LEAD, -LEAD])
def test_nut_on_a_beam_has_the_screw_nut_matrix(lead):
    radial, tilt = (2e8, 3e8), (1e5, 2e5)
    drive = ScrewOnBeam("screw", lead, radial, NUT, tilt, 0.3, 0.0, first_radial=(1.0, 0.0, 0.0))
    axis = DrivenAxis("Z", (0.0, 0.0, 1.0), "table", "ground", (0.1, 0.2, 0.3))
    parts = drive.parts(axis)
    bodies = [Body(name, 1.0, (1.0, 1.0, 1.0), axis.at) for name in ("table", "screw")]
    whole = assembly(bodies, parts.connectors, [], (), 12, parts.rotors, parts.couplings)
    matrix = screw_nut_matrix(radial, NUT, tilt, lead)
    expected = np.block([[matrix, -matrix], [-matrix, matrix]])
    np.testing.assert_allclose(whole.structure.stiffness, expected, rtol=1e-12, atol=1e-6)


def test_right_hand_nut_runs_along_a_right_hand_helix():
    """A nut turned on a held right-hand screw moves the way its turn points."""
    axis = DrivenAxis("Z", (0.0, 0.0, 1.0), "table", "ground", (0.0, 0.0, 0.0))
    row = np.zeros(6)
    for term in BallScrew(LEAD, 3e-3, 2e-3, NUT).parts(axis).couplings[0].terms:
        if term.part == "table":
            row += term.direction
    turned = np.array([0.0, 0.0, H_P, 0.0, 0.0, 1.0])
    assert row @ turned == pytest.approx(0.0, abs=1e-15)


def test_motor_and_table_swing_against_each_other():
    inertia = 5e-3
    whole, _, _ = table(BallScrew(LEAD, 3e-3, 2e-3, NUT))
    expected = np.sqrt(NUT * (1.0 / MASS + H_P**2 / inertia)) / (2.0 * np.pi)
    frequencies = whole.structure.natural_frequencies()
    assert np.min(np.abs(frequencies / expected - 1.0)) < 1e-7


def test_motor_screw_and_table_with_a_belt_are_a_chain_of_three():
    belt = Belt(0.02, 0.035, 4e6, driver_inertia=1e-4, driven_inertia=9e-4)
    whole, _, _ = table(BallScrew(LEAD, 3e-3, 2e-3, NUT, belt=belt))
    motor = 3.1e-3 / (H_P * 0.02 / 0.035) ** 2
    screw = 2.9e-3 / H_P**2
    strands = 4e6 * (0.035 / H_P) ** 2
    half = 0.5 * (strands * (1.0 / motor + 1.0 / screw) + NUT * (1.0 / screw + 1.0 / MASS))
    product = strands * NUT * (motor + screw + MASS) / (motor * screw * MASS)
    squares = half + np.array([-1.0, 1.0]) * np.sqrt(half**2 - product)
    frequencies = whole.structure.natural_frequencies()
    for expected in np.sqrt(squares) / (2.0 * np.pi):
        assert np.min(np.abs(frequencies / expected - 1.0)) < 1e-6


def test_belt_drives_by_the_ratio_of_its_radii():
    belt = Belt(0.03, 0.06, 4e6, damping=50.0)
    assert belt.ratio == pytest.approx(0.5)
    assert BallScrew(LEAD, 3e-3, 2e-3, NUT, belt=belt).transmission == pytest.approx(0.5 * H_P)


MESH, GEARBOX, INPUT, RADIUS, RATIO = 2e8, 3e5, 5e4, 0.04, 12.0
ROW = 1.0 / (1.0 / MESH + RADIUS**2 / GEARBOX + RADIUS**2 / (RATIO**2 * INPUT))


def rack(count, preloads=None, **inertias):
    motors = [
        RackMotor(2e-3, (0.0, 0.0, 1.0), (0.1 * place, 0.0, 0.0), preload)
        for place, preload in enumerate(preloads or [0.0] * count)
    ]
    return RackAndPinion(RADIUS, RATIO, motors, MESH, GEARBOX, INPUT, **inertias)


@pytest.mark.parametrize(
    ("inertias", "rotors"),
    [
        ({}, 1),
        ({"pinion_inertia": 4e-3}, 2),
        ({"pinion_inertia": 4e-3, "gearbox_inertia": 1e-4}, 3),
    ],
)
@pytest.mark.parametrize("count", [1, 4])
def test_pinions_on_a_rack_stand_side_by_side(count, inertias, rotors):
    whole, parts, travel = table(rack(count, **inertias))
    assert len(parts.rotors) == count * rotors
    assert locked_stiffness(whole, parts, travel) == pytest.approx(count * ROW, rel=1e-6)


def test_preload_loads_the_meshes_and_leaves_the_table_at_rest():
    preloads = [3.0, -1.0, 2.0, -4.0]
    drive = rack(4, preloads, pinion_inertia=4e-3)
    whole, parts, travel = table(drive)
    assert [motor.preload for motor in parts.motors] == preloads
    torques = sum(motor.preload * whole.row("", motor.angle) for motor in parts.motors)
    stiffness = whole.structure.stiffness + 1e5 * np.outer(travel, travel)
    state = np.linalg.solve(stiffness, torques)
    meshes = [one for one in parts.couplings if "mesh" in one.name]
    forces = [mesh.stiffness * whole.row("", mesh.terms) @ state for mesh in meshes]
    np.testing.assert_allclose(forces, np.array(preloads) * RATIO / RADIUS, rtol=1e-6)
    assert abs(travel @ state) < 1e-6 * max(forces) / (4 * ROW)


def test_springs_in_a_row_dissipate_as_they_do_in_slow_motion():
    springs = [Spring("a", 3e6, 200.0), Spring("b", 8e6, 900.0), Spring("c", np.inf)]
    omega = 1e-3
    flexible = [one.stiffness + 1j * omega * one.damping for one in springs[:2]]
    exact = 1.0 / sum(1.0 / one for one in flexible)
    row = in_series(springs)
    assert row.stiffness == pytest.approx(exact.real, rel=1e-9)
    assert row.damping == pytest.approx(exact.imag / omega, rel=1e-6)
    assert row.name == "b"


def test_spindle_rotor_turns_alone():
    axis = DrivenAxis("S", (0.0, 0.0, 1.0), "head", "head", (0.0, 0.0, 0.0))
    parts = SpindleRotor(0.02).parts(axis)
    head = Body("head", 50.0, (2.0, 2.0, 2.0), (0.0, 0.0, 0.0))
    feet = Connector("feet", "head", "ground", (0.0, 0.0, 0.0), [1e8] * 6)
    whole = assembly([head], [feet], [], (), 1, parts.rotors, parts.couplings)
    torque = whole.row("", parts.motors[0].angle)
    acceleration = np.linalg.solve(whole.structure.mass, torque)
    assert acceleration[whole.columns["S: motor"]][0] == pytest.approx(1.0 / 0.02)
    assert acceleration[whole.columns["head"]][5] == pytest.approx(-1.0 / 2.0)
