"""Drives that make no sense are refused with the name of what is wrong."""

import numpy as np
import pytest

from dynamics.drive.ball_screw import BallScrew
from dynamics.drive.belt import Belt
from dynamics.drive.linear_motor import LinearMotor
from dynamics.drive.parts import DrivenAxis
from dynamics.drive.rack_and_pinion import RackAndPinion, RackMotor
from dynamics.drive.rotary import DirectRotary, SpindleRotor
from dynamics.drive.screw_on_beam import ScrewOnBeam
from dynamics.drive.screw_shaft import ScrewShaft
from dynamics.structure.linear_structure import StructureError

UP = (0.0, 0.0, 1.0)
MOTOR = RackMotor(2e-3, UP)
SCREW = {"lead": 0.01, "motor_inertia": 3e-3, "screw_inertia": 2e-3, "nut_stiffness": 4e8}
RACK = {"pinion_radius": 0.04, "gear_ratio": 12.0, "motors": [MOTOR], "mesh_stiffness": 2e8}
BEAM = {
    "beam": "shaft",
    "lead": 0.01,
    "radial": (2e8, 2e8),
    "axial": 4e8,
    "tilt": (0.0, 0.0),
    "nut_at": 0.3,
}


def axis(position=0.0):
    return DrivenAxis("X", (1.0, 0.0, 0.0), "table", "ground", (0.0, 0.0, 0.0), position)


@pytest.mark.parametrize(
    ("kind", "good", "wrong", "message"),
    [
        (BallScrew, SCREW, {"lead": 0.0}, "ball screw: lead"),
        (BallScrew, SCREW, {"lead": np.nan}, "ball screw: lead"),
        (BallScrew, SCREW, {"motor_inertia": 0.0}, "motor_inertia"),
        (BallScrew, SCREW, {"screw_inertia": -1.0}, "screw_inertia"),
        (BallScrew, SCREW, {"nut_stiffness": -1.0}, "nut_stiffness"),
        (BallScrew, SCREW, {"bearing_stiffness": np.nan}, "bearing_stiffness"),
        (BallScrew, SCREW, {"far_bearing_stiffness": 1e8}, "fixed-fixed"),
        (BallScrew, SCREW, {"axial_damping": np.inf}, "axial_damping"),
        (ScrewShaft, {"diameter": 0.03, "length": 1.0, "nut_at": 0.3}, {"length": 0.0}, "length"),
        (
            ScrewShaft,
            {"diameter": 0.03, "length": 1.0, "nut_at": 0.3},
            {"nut_at": np.nan},
            "nut_at",
        ),
        (
            ScrewShaft,
            {"diameter": 0.03, "length": 1.0, "nut_at": 0.3},
            {"support": "free"},
            '"fixed-supported"',
        ),
        (
            Belt,
            {"driver_radius": 0.02, "driven_radius": 0.03, "stiffness": 1e6},
            {"stiffness": 0},
            "belt",
        ),
        (ScrewOnBeam, BEAM, {"radial": (1e8, -1.0)}, 'beam "shaft": radial'),
        (ScrewOnBeam, BEAM, {"axial": 0.0}, "axial"),
        (ScrewOnBeam, BEAM, {"tilt": 3.0}, "tilt"),
        (RackAndPinion, RACK, {"motors": []}, "no motors"),
        (RackAndPinion, RACK, {"gear_ratio": 0.0}, "gear_ratio"),
        (RackAndPinion, RACK, {"motors_on": "rack"}, '"moving" or "carrying"'),
        (RackAndPinion, RACK, {"motors": [MOTOR, RackMotor(1.0, UP, preload=1.0)]}, "preloads"),
        (
            RackMotor,
            {"inertia": 1.0, "towards_pinion": UP},
            {"towards_pinion": (0, 0, 0)},
            "length",
        ),
        (LinearMotor, {}, {"offsets": []}, "place"),
        (LinearMotor, {}, {"shares": (0.5,)}, "in sum 1"),
        (LinearMotor, {}, {"shares": (0.5, 0.5)}, "shares"),
        (DirectRotary, {}, {"motor_inertia": -1.0}, "motor_inertia"),
        (SpindleRotor, {}, {"inertia": 0.0}, "inertia"),
    ],
)
def test_number_out_of_range_is_told_by_its_key(kind, good, wrong, message):
    if kind is not SpindleRotor:
        kind(**good)
    with pytest.raises(StructureError, match=message):
        kind(**{**good, **wrong})


@pytest.mark.parametrize("position", [-0.31, 0.71])
def test_nut_off_its_shaft_is_told_with_axis_and_place(position):
    drive = BallScrew(**SCREW, shaft=ScrewShaft(0.03, 1.0, 0.3))
    with pytest.raises(StructureError, match=r'axis "X": ball screw: at position .* reaches'):
        drive.parts(axis(position))


@pytest.mark.parametrize(
    ("drive", "message"),
    [
        (BallScrew(**{**SCREW, "nut_stiffness": np.inf}), "all rigid"),
        (BallScrew(**SCREW, torsional_damping=1.0), "screw torsion.*is rigid"),
        (ScrewOnBeam(**BEAM, motor_inertia=1e-3), '"X: motor" has inertia'),
        (ScrewOnBeam(**BEAM, coupling_stiffness=1e4), '"X: motor" has no inertia'),
        (ScrewOnBeam(**BEAM, first_radial=(2.0, 0.0, 0.0)), "first_radial"),
        (RackAndPinion(0.04, 12.0, [MOTOR]), '"X: motor" has inertia'),
        (RackAndPinion(0.04, 12.0, [RackMotor(1.0, (1.0, 0, 1.0))], 1e8), "not perpendicular"),
        (DirectRotary(0.1), '"X: motor" has inertia'),
    ],
)
def test_drive_that_cannot_be_built_is_told_with_its_axis(drive, message):
    with pytest.raises(StructureError, match=f'axis "X": .*{message}'):
        drive.parts(axis())
