"""What holds for every drive: nothing strained by rigid motion, work, one free motion."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from dynamics.beam.shaft import BeamLine, Bearing, Segment
from dynamics.drive.ball_screw import BallScrew
from dynamics.drive.belt import Belt
from dynamics.drive.linear_motor import LinearMotor
from dynamics.drive.parts import DrivenAxis
from dynamics.drive.rack_and_pinion import RackAndPinion, RackMotor
from dynamics.drive.rotary import DirectRotary
from dynamics.drive.screw_on_beam import ScrewOnBeam
from dynamics.drive.screw_shaft import STEEL, ScrewShaft
from dynamics.structure.assembly import assembly
from dynamics.structure.bodies import Body, Connector, rigid_motion
from dynamics.structure.linear_structure import StructureError
from dynamics.structure.rotor import Rotor

TURN = Rotation.from_euler("xyz", [0.4, -0.7, 1.1]).as_matrix()
AHEAD, UP = TURN[0], TURN[2]
AT = np.array([0.3, -0.2, 0.5])
NUT_AT, LENGTH = 0.35, 0.9
MASS, INERTIA = 80.0, (3.0, 4.0, 5.0)
CENTRE, GUIDE = AT + np.array([0.05, 0.1, 0.2]), AT + 0.1 * UP

BELT = Belt(0.02, 0.035, 4e6, 60.0, driver_inertia=1e-4, driven_inertia=9e-4)
# Its driven pulley belongs to the part that it sits on.
BARE_BELT = Belt(0.02, 0.035, 4e6, 60.0, driver_inertia=1e-4)
SHAFT = ScrewShaft(0.032, LENGTH, NUT_AT, "fixed-fixed")
RACK = {"pinion_radius": 0.04, "gear_ratio": 12.0, "mesh_stiffness": 2e8, "mesh_damping": 900.0}
FOUR = [
    RackMotor(2e-3, up * UP, np.array([along, side, -0.1]) @ TURN, preload)
    for along, side, up, preload in [
        (0.3, 0.5, 1.0, 3.0),
        (-0.3, 0.5, 1.0, -3.0),
        (0.3, -0.5, -1.0, 2.0),
        (-0.3, -0.5, -1.0, -2.0),
    ]
]
COMPLIANT = {
    "gearbox_stiffness": 3e5,
    "gearbox_damping": 20.0,
    "coupling_stiffness": 5e4,
    "pinion_inertia": 4e-3,
}
NUT = {"radial": (2e8, 3e8), "axial": 4e8, "tilt": (1e5, 2e5), "nut_at": NUT_AT}
DRIVES = {
    "screw": BallScrew(0.01, 3e-3, 2e-3, 4e8, axial_damping=2e3),
    "left-hand screw": BallScrew(-0.01, 3e-3, 2e-3, 4e8),
    "screw on shaft": BallScrew(0.01, 3e-3, 2e-3, 4e8, 6e8, 5e8, SHAFT, 8e3, torsional_damping=2.0),
    "screw with belt": BallScrew(0.02, 3e-3, 2e-3, 4e8, 6e8, 5e8, SHAFT, 8e3, BELT),
    "screw with belt, rigid": BallScrew(0.02, 3e-3, 2e-3, 4e8, belt=BELT),
    "screw on beam": ScrewOnBeam("shaft", 0.01, **NUT, motor_inertia=3e-3, coupling_stiffness=8e3),
    "left-hand beam with belt": ScrewOnBeam(
        "shaft", -0.01, **NUT, motor_inertia=3e-3, belt=BARE_BELT
    ),
    "motor on the beam": ScrewOnBeam("shaft", 0.01, **NUT),
    "rack": RackAndPinion(motors=[RackMotor(2e-3, UP)], **RACK),
    "rack, four motors": RackAndPinion(motors=FOUR, **RACK, **COMPLIANT),
    "rack moving": RackAndPinion(
        motors=[RackMotor(2e-3, UP)],
        **RACK,
        **COMPLIANT,
        gearbox_inertia=1e-4,
        motors_on="carrying",
    ),
    "linear motor": LinearMotor(),
    "pair of linear motors": LinearMotor([(0.1, 0.4, 0.0), (-0.1, -0.4, 0.0)], (0.6, 0.4)),
    "rotary": DirectRotary(0.02, 3e5, 10.0),
    "rotary with belt": DirectRotary(0.02, np.inf, 0.0, BARE_BELT),
    "torque motor": DirectRotary(),
}
every_drive = pytest.mark.parametrize("drive", DRIVES.values(), ids=DRIVES.keys())


def machine(drive, *, base="base", allowed=7, guided=1e8, holding=0.0):
    """Table on a guide of a base that nothing holds, with the drive between them."""
    turns = isinstance(drive, DirectRotary)
    axis = DrivenAxis("X", AHEAD, "table", base, AT + 0.1 * AHEAD, 0.1)
    parts = drive.parts(axis)
    stiffness = np.full(6, guided)
    stiffness[3 if turns else 0] = holding
    bodies = [Body("table", MASS, INERTIA, CENTRE)]
    bodies += [Body("base", 300.0, (40.0, 30.0, 50.0), AT - [0.1, 0.3, 0.2])] * (base == "base")
    guide = Connector("guide", "table", base, GUIDE, stiffness, axes=TURN)
    beams = []
    if isinstance(drive, ScrewOnBeam):
        bearings = [
            Bearing("fixed", 0.0, (3e8, 3e8), 6e8, (1e5, 1e5), body=base),
            Bearing("loose", LENGTH, (3e8, 3e8), body=base),
        ]
        segments = [Segment(LENGTH, 0.032, STEEL)]
        beams = [BeamLine("shaft", segments, AT - NUT_AT * AHEAD, AHEAD, bearings=bearings)]
    whole = assembly(
        bodies, [guide, *parts.connectors], [], beams, allowed, parts.rotors, parts.couplings
    )
    travel = axis.turning("table"), axis.turning(base, -1.0)
    return whole, parts, whole.row("travel", travel if turns else axis.travel())


def moved_rigidly(whole):
    """(n, 6): all parts along and about the machine's x, y, z, the rotors turning along."""
    motions = np.zeros((whole.structure.size, 6))
    for name, part in whole.parts.items():
        if isinstance(part, Rotor):
            motions[whole.columns[name], 3:] = part.axis
        else:
            at = part.centre if isinstance(part, Body) else part.origin
            motions[whole.columns[name]] = part.rigid_motions @ rigid_motion(at)
    return motions


@every_drive
def test_rigid_motion_of_the_whole_machine_strains_nothing(drive):
    whole, parts, travel = machine(drive)
    motions = moved_rigidly(whole)
    for matrix in (whole.structure.stiffness, whole.structure.damping):
        forces = matrix @ motions
        assert np.max(np.abs(forces)) <= 1e-12 * max(np.max(np.abs(matrix)), 1.0)
    for motor in parts.motors:
        np.testing.assert_allclose(whole.row("", motor.angle) @ motions, 0.0, atol=1e-12)
    np.testing.assert_allclose(travel @ motions, 0.0, atol=1e-12)


@every_drive
def test_one_motion_is_free_and_turns_the_motors_by_the_transmission(drive):
    whole, parts, travel = machine(drive, base="ground", allowed=1)
    with pytest.raises(StructureError, match="rigid-body motions"):
        machine(drive, base="ground", allowed=0)
    free = np.linalg.svd(whole.structure.stiffness)[2][-1]
    assert abs(travel @ free) > 1e-9
    for motor in parts.motors:
        assert motor.transmission > 0.0
        angle = whole.row("", motor.angle) @ free
        assert travel @ free == pytest.approx(motor.transmission * angle, rel=1e-5)


@every_drive
def test_torque_over_transmission_is_force_at_the_table(drive):
    holding, torque = 3e6, 5.0
    whole, parts, travel = machine(drive, base="ground", allowed=0, holding=holding, guided=1e12)
    push = sum(torque * whole.row("", motor.angle) for motor in parts.motors)
    moved = travel @ np.linalg.solve(whole.structure.stiffness, push)
    force = torque * sum(1.0 / motor.transmission for motor in parts.motors)
    assert moved == pytest.approx(force / holding, rel=1e-4)


@every_drive
def test_kinetic_energy_of_the_free_motion_is_that_of_the_inertia_at_the_motor(drive):
    whole, parts, travel = machine(drive, base="ground", allowed=1)
    free = np.linalg.svd(whole.structure.stiffness)[2][-1]
    free /= travel @ free
    energy = free @ whole.structure.mass @ free
    if isinstance(drive, DirectRotary):
        lever = np.cross(AHEAD, CENTRE - GUIDE)
        at_motor = drive.inertia_at_motor(AHEAD @ np.diag(INERTIA) @ AHEAD + MASS * lever @ lever)
    elif isinstance(drive, ScrewOnBeam):
        screw = STEEL.density * LENGTH * np.pi * 0.032**4 / 32.0
        at_motor = drive.inertia_at_motor(MASS, screw)
    else:
        at_motor = drive.inertia_at_motor(MASS)
    expected = len(parts.motors) * at_motor / drive.transmission**2
    assert energy == pytest.approx(expected, rel=1e-4)


@every_drive
def test_forces_of_a_strained_machine_balance(drive):
    whole, _, _ = machine(drive)
    state = np.random.default_rng(3).normal(size=whole.structure.size)
    forces = whole.structure.stiffness @ state
    resultant = moved_rigidly(whole).T @ forces
    assert np.max(np.abs(resultant)) <= 1e-11 * np.max(np.abs(forces))
