"""Small machines for the tests."""

import copy

import pytest
import tomlkit

#: everything on one line along y, so that each part moves along it alone
LINE = """
title = "table on a bed"   # a comment that stays
tool_point = "tool"
workpiece = "table"

[body.bed]
mass = "2000 kg"
inertia = ["400 kg*m^2", "500 kg*m^2", "600 kg*m^2"]
centre = ["0 mm", "-500 mm", "0 mm"]

[body.table]
mass = "300 kg"
size = ["600 mm", "800 mm", "150 mm"]
centre = ["0 mm", "100 mm", "0 mm"]

[connector.feet]
between = ["bed", "ground"]
at = ["0 mm", "-500 mm", "0 mm"]
stiffness = { x = "1e3 N/um", y = "40 N/um", z = "1e3 N/um", rx = 1e13, ry = 1e13, rz = 1e13 }

[connector.guide]
between = ["table", "bed"]
at = ["0 mm", "100 mm", "0 mm"]
stiffness = { x = "1e3 N/um", z = "1e3 N/um", rx = 1e13, ry = 1e13, rz = 1e13 }

[point.tool]
on = "bed"
at = ["0 mm", "200 mm", "0 mm"]

[point.table]
on = "table"
at = ["0 mm", "200 mm", "0 mm"]

[axis.Y]
direction = [0, 1, 0]
moving = "table"
carrying = "bed"
at = ["0 mm", "100 mm", "0 mm"]

[axis.Y.drive]
kind = "ball screw"
lead = "10 mm"
motor_inertia = "0.004 kg*m^2"
screw_inertia = "0.002 kg*m^2"
nut_stiffness = "250 N/um"
bearing_stiffness = "400 N/um"

[axis.Y.brake]
stiffness = "1e5 N*m/rad"
damping = "10 N*m*s/rad"

[axis.Y.control]
position = { gain = "50 1/s", sample_time = "2 ms", velocity_limit = "30 m/min" }
current = { kind = "second order", natural_frequency = "800 Hz", sample_time = "62.5 us" }
filters = [{ kind = "low pass", frequency = "1500 Hz" }]
feedforward = { velocity = 1.0, inertia = "0.007 kg*m^2" }
measuring = { position = "scale", encoder_resolution = "0.001 deg", scale_resolution = "0.1 um" }

[axis.Y.control.velocity]
proportional_gain = "15 N*m*s/rad"
integral_time = "10 ms"
sample_time = "125 us"
torque_limit = "80 N*m"

[friction.guide]
law = "coulomb-stribeck"
on = { axis = "Y" }
coulomb = "300 N"
static = "400 N"
stribeck_velocity = "5 mm/s"

[friction.screw]
law = "tanh-hysteresis"
on = { motor = "Y" }
coulomb = "2 N*m"
viscous = "0.02 N*m*s/rad"
low_speed_viscous = "0.1 N*m*s/rad"
low_speed_decay = "0.5 s/rad"
hysteresis_slope = "40 1/rad"

[contact]
stiffness = "2.5 N/um"
damping = "3.35 kN*s/m"
directions = ["y"]
"""

#: a head on a beam between two blocks
HEAD_ON_BEAM = {
    "body": {"head": {"mass": "50 kg", "size": ["0.3 m", "0.2 m", "0.4 m"],
                      "centre": ["500 mm", "0 mm", "-100 mm"]}},
    "beam": {
        "crossbeam": {
            "origin": [0.0, 0.0, 0.0],
            "axis": [1, 0, 0],
            "segments": [{"length": "1 m", "outer": "90 mm", "elements": 8}],
            "bearings": [
                {"name": "left", "station": "0 mm", "radial": "200 N/um", "axial": "100 N/um",
                 "tilt": "1e5 N*m/rad", "torsion": "1e6 N*m/rad"},
                {"name": "right", "station": "1 m", "radial": ["200 N/um", "150 N/um"],
                 "tilt": ["1e5 N*m/rad", "2e5 N*m/rad"]},
            ],
        }
    },
    "connector": {
        "carriage": {
            "between": ["head", "crossbeam"],
            "places": [["450 mm", "0 mm", "0 mm"], ["550 mm", "0 mm", "0 mm"]],
            "stiffness": {"x": "80 N/um", "y": "300 N/um", "z": "300 N/um",
                          "rx": "1e6 N*m/rad"},
        }
    },
    "point": {"tool": {"on": "head", "at": ["500 mm", "0 mm", "-350 mm"]}},
    "axis": {"X": {"direction": [2, 0, 0], "moving": "head", "carrying": "crossbeam"}},
}  # fmt: skip


def changed(data, path, value):
    """Copy of nested dicts with one entry changed, or with None removed."""
    data = copy.deepcopy(data)
    *steps, last = path
    item = data
    for step in steps:
        item = item.setdefault(step, {}) if isinstance(item, dict) else item[step]
    if value is None:
        del item[last]
    else:
        item[last] = value
    return data


@pytest.fixture
def line_text():
    return LINE


@pytest.fixture
def line():
    """Nested dicts of a table on a bed, all on one line."""
    return tomlkit.parse(LINE).unwrap()


@pytest.fixture
def head_on_beam():
    return copy.deepcopy(HEAD_ON_BEAM)


@pytest.fixture(name="changed")
def changed_fixture():
    return changed
