"""Small machines for the tests: two masses on a screw, a rigid motor, a machine file."""

import numpy as np
import pytest

from dynamics.control.cascade import (
    DriveController,
    Feedforward,
    LoopTiming,
    PositionController,
    VelocityController,
)
from dynamics.control.measurement import MeasuringSystem
from dynamics.machine.description import Drive, Friction, Machine
from dynamics.structure.linear_structure import LinearStructure

TRANSMISSION = 10e-3 / (2.0 * np.pi)  # m/rad
MOTOR, TABLE, BED = 6e-3, 300.0, 1500.0  # kg m^2, kg, kg
NUT, NUT_LOSS = 1.2e8, 3e4  # N/m, N s/m
FEET, FEET_LOSS = 1.5e8, 5e4

FILE = """
title = "a small machine"
tool_point = "tool"
workpiece = "table"
damping_ratio = 0.03
step = "100 us"

[body.bed]
mass = "1500 kg"
inertia = ["400 kg*m^2", "500 kg*m^2", "600 kg*m^2"]
centre = ["0 mm", "0 mm", "0 mm"]

[body.table]
mass = "300 kg"
size = ["600 mm", "800 mm", "150 mm"]
centre = ["0 mm", "0 mm", "0 mm"]

[connector.feet]
between = ["bed", "ground"]
at = ["0 mm", "0 mm", "0 mm"]
stiffness = { x = 1e9, y = 1.5e8, z = 1e9, rx = 1e9, ry = 1e9, rz = 1e9 }
damping = { y = 5e4 }

[connector.guide]
between = ["table", "bed"]
at = ["0 mm", "0 mm", "0 mm"]
stiffness = { x = 1e9, z = 1e9, rx = 1e9, ry = 1e9, rz = 1e9 }

[point.tool]
on = "bed"
at = ["0 mm", "0 mm", "0 mm"]

[point.table]
on = "table"
at = ["0 mm", "0 mm", "0 mm"]

[axis.Y]
direction = [0, 1, 0]
moving = "table"
carrying = "bed"
at = ["0 mm", "0 mm", "0 mm"]

[axis.Y.drive]
kind = "ball screw"
lead = "10 mm"
motor_inertia = "0.004 kg*m^2"
screw_inertia = "0.002 kg*m^2"
nut_stiffness = "120 N/um"
axial_damping = "30 kN*s/m"

[axis.Y.brake]
stiffness = "1e5 N*m/rad"
damping = "10 N*m*s/rad"

[axis.Y.control]
position = { gain = "30 1/s", sample_time = "1 ms" }
velocity = { proportional_gain = "2 N*m*s/rad", integral_time = "30 ms", sample_time = "200 us" }
current = { sample_time = "100 us" }
feedforward = { velocity = 1.0, inertia = "0.0067 kg*m^2" }

[friction.guide]
law = "lugre"
on = { axis = "Y" }
bristle_stiffness = "5 N/um"
bristle_damping = "2 kN*s/m"
viscous = "800 N*s/m"
coulomb = "100 N"
static = "130 N"
stribeck_velocity = "5 mm/s"

[frf.rest]
excite = "table:y"
by = "chirp"
level = "2 N"
band = ["20 Hz", "120 Hz"]
lines = 200

[frf.linear]
excite = "table:y"
by = "linearised"
band = ["20 Hz", "120 Hz"]
lines = 100
friction = false

[move.fast]
kind = "jerk limited"
axes = ["Y"]
travel = ["20 mm"]
velocity = "0.2 m/s"
acceleration = "3 m/s^2"
jerk = "100 m/s^3"
afterwards = "0.4 s"

[move.slow]
kind = "constant speed"
axes = ["Y"]
travel = ["1 mm"]
velocity = "20 mm/s"
"""


def controller(
    *,
    position_gain=30.0,
    gain=2.0,
    integral_time=0.03,
    times=(1e-3, 2e-4, 1e-4),
    on="scale",
    feedforward=None,
    torque_limit=np.inf,
    computing=0,
    transmission=TRANSMISSION,
):
    return DriveController(
        PositionController(position_gain, LoopTiming(times[0])),
        VelocityController(
            gain, LoopTiming(times[1], computing=computing), integral_time, torque_limit
        ),
        MeasuringSystem(transmission, on),
        LoopTiming(times[2]),
        feedforward=feedforward or Feedforward(),
    )


def screw_axis(control=None, frictions=()):
    """Motor, table and bed: freedoms are the motor's angle, and both displacements.

    frictions : (name, law, row) each
    """
    i = TRANSMISSION
    nut, feet = np.array([i, -1.0, 1.0]), np.array([0.0, 0.0, 1.0])
    points = {}
    for name, row in (("table", [0, 1.0, 0]), ("tool", [0, 0, 1.0])):
        points[name] = np.zeros((6, 3))
        points[name][1] = row
    structure = LinearStructure(
        np.diag([MOTOR, TABLE, BED]),
        NUT_LOSS * np.outer(nut, nut) + FEET_LOSS * np.outer(feet, feet),
        NUT * np.outer(nut, nut) + FEET * np.outer(feet, feet),
        points,
    )
    drives = ()
    if control is not None:
        motor, scale = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, -1.0])
        drives = (Drive("Y", "Y", motor, scale, control),)
    return Machine(structure, drives, tuple(Friction(*one) for one in frictions), (), ("Y",), None)


def rigid_motor(control, inertia=0.01):
    """Nothing but a motor's inertia under control."""
    one = np.ones(1)
    structure = LinearStructure(inertia * np.eye(1), np.zeros((1, 1)), np.zeros((1, 1)), {})
    return Machine(structure, (Drive("Y", "Y", one, one, control),), (), (), ("Y",), None)


@pytest.fixture(name="controller")
def controller_fixture():
    return controller


@pytest.fixture(name="screw_axis")
def screw_axis_fixture():
    return screw_axis


@pytest.fixture(name="rigid_motor")
def rigid_motor_fixture():
    return rigid_motor


@pytest.fixture
def machine_text():
    return FILE


@pytest.fixture
def machine_file(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text(FILE)
    return path
