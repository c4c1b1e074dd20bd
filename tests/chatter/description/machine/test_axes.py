"""Drives, control and frictions of machine files."""

import copy
import math

import numpy as np
import pytest

from chatter import InputError
from chatter.compile.machine_parts import assembled_machine
from chatter.description.machine.machine_file import MachineFile
from dynamics.reduction.modal_truncation import undamped_modes

TRAVEL = 0.01 / (2.0 * math.pi)
RACK = {
    "kind": "rack and pinion",
    "pinion_radius": "40 mm",
    "gear_ratio": 10,
    "mesh_stiffness": "200 N/um",
    "motors": [
        {"inertia": "0.003 kg*m^2", "towards_pinion": [0, 0, 1], "preload": "2 N*m"},
        {"inertia": "0.003 kg*m^2", "towards_pinion": [0, 0, 1], "preload": "-2 N*m"},
    ],
}


def test_controller_says_what_the_file_says(line_text):
    machine = assembled_machine(MachineFile.from_text(line_text))
    controller = machine.drives[0].controller
    assert controller.position.gain == 50.0
    assert controller.position.velocity_limit == pytest.approx(0.5)
    assert [one.sample_time for one in controller.timings] == [2e-3, 125e-6, 62.5e-6]
    assert controller.velocity.integral_time == 0.01
    assert controller.velocity.torque_limit == 80.0
    assert controller.current.natural_frequency == 800.0
    assert controller.filters[0].denominator_frequency == 1500.0
    assert controller.feedforward.inertia == 0.007
    assert controller.measuring.transmission == pytest.approx(TRAVEL)
    assert controller.measuring.position == "scale"
    assert controller.measuring.encoder_resolution == pytest.approx(math.radians(0.001))


def test_reference_model_dead_times_and_regulated_motor(line_text):
    file = MachineFile.from_text(line_text).patch({
        "axis.Y.control.velocity.reference_model": {"natural_frequency": "90 Hz", "damping": 0.8},
        "axis.Y.control.position.measuring": 1,
        "axis.Y.control.current": {
            "kind": "motor", "sample_time": "62.5 us", "resistance": "0.5 ohm",
            "inductance": "5 mH", "torque_constant": "1.5 N*m/A", "proportional_gain": "20 V/A",
            "computing": 2,
        },
        "axis.Y.control.filters": [
            {"kind": "notch", "frequency": "400 Hz", "numerator_damping": 0.1,
             "denominator_damping": 0.7},
            {"numerator_frequency": "500 Hz", "numerator_damping": 0.1,
             "denominator_frequency": "700 Hz", "denominator_damping": 1},
        ],
    })  # fmt: skip
    controller = assembled_machine(file).drives[0].controller
    assert controller.velocity.reference_model.natural_frequency == 90.0
    assert controller.position.timing.measuring == 1
    assert controller.current.inductance == 5e-3
    assert controller.current_timing.output_delay == 2
    assert controller.filters[0].continuous_response(400.0) == pytest.approx(0.1 / 0.7)
    assert controller.filters[1].numerator_frequency == 500.0


def test_friction_rows(line_text):
    file = MachineFile.from_text(line_text).patch({
        "friction.guide_z": {
            "law": "coulomb-stribeck", "coulomb": "1 N", "static": "1 N",
            "stribeck_velocity": "1 mm/s", "on": {"connector": "guide", "direction": "z"},
        },
        "friction.tilting": {
            "law": "coulomb-stribeck", "coulomb": "1 N*m", "static": "1 N*m",
            "stribeck_velocity": "1 rpm", "on": {"connector": "guide", "direction": "rx"},
        },
        "friction.slide": {
            "law": "coulomb-stribeck", "coulomb": 1, "static": 1, "stribeck_velocity": 1,
            "on": {"mode": 4},
        },
    })  # fmt: skip
    machine = assembled_machine(file, {"Y": "brake"})
    rows = {one.name: one.row for one in machine.frictions}
    structure = machine.structure
    table = structure.port("table", (0, 1, 0), "tool")
    assert rows["guide"] == pytest.approx(table)
    # of the motor against the bed: its own angle, and the bed's about the screw
    assert abs(rows["screw"][-1]) == 1.0
    assert rows["guide_z"] @ _up("table", structure) == pytest.approx(1.0)
    assert abs(rows["tilting"][np.abs(rows["tilting"]) > 0.0]) == pytest.approx([1.0, 1.0])
    # along the fourth mode, mass-normalised, and along no other
    shapes = undamped_modes(structure).shapes
    assert rows["slide"] @ shapes == pytest.approx(np.eye(len(shapes))[3], abs=1e-9)


def _up(point, structure):
    """Coordinates when only the body of a point rises by 1 m."""
    row = structure.port(point, (0, 0, 1))
    return np.where(np.arange(structure.size) == np.argmax(row), 1.0, 0.0)


def test_each_place_of_a_connector_has_its_friction(head_on_beam):
    head_on_beam["friction"] = {
        "rail": {
            "law": "lugre", "bristle_stiffness": "50 N/um", "bristle_damping": "1 kN*s/m",
            "viscous": "10 N*s/m", "coulomb": "40 N", "static": "50 N",
            "stribeck_velocity": "2 mm/s", "on": {"connector": "carriage", "direction": "x"},
        },
        "seal": {
            "law": "coulomb-stribeck", "coulomb": "1 N*m", "static": "1 N*m",
            "stribeck_velocity": "1 rpm",
            "on": {"connector": "crossbeam.left", "direction": "rx"},
        },
    }  # fmt: skip
    machine = assembled_machine(MachineFile.from_dict(head_on_beam))
    assert [one.name for one in machine.frictions] == ["rail[0]", "rail[1]", "seal"]


@pytest.mark.parametrize(("motors", "count"), [("together", 1), ("each", 2)])
def test_two_motors_on_a_rack(line, changed, motors, count):
    data = changed(line, ["axis", "Y", "drive"], copy.deepcopy(RACK))
    data = changed(data, ["axis", "Y", "control", "motors"], motors)
    if motors == "each":
        # two controllers would take the preload back
        with pytest.raises(InputError, match=r'axis\.Y.*motors\[0\]\.preload.*2 N m.*"together"'):
            MachineFile.from_dict(data)
        for motor in data["axis"]["Y"]["drive"]["motors"]:
            del motor["preload"]
    machine = assembled_machine(MachineFile.from_dict(data))
    assert len(machine.drives) == count
    assert len(machine.preloads) == (2 if motors == "together" else 0)
    assert [one.name for one in machine.frictions] == ["guide", "screw[0]", "screw[1]"]
    assert machine.drives[0].controller.measuring.transmission == pytest.approx(4e-3)


def test_linear_motor_takes_newtons(line, changed):
    data = changed(line, ["axis", "Y", "drive"], {"kind": "linear motor"})
    data = changed(data, ["axis", "Y", "brake"], {"stiffness": "100 N/um"})
    del data["friction"]["screw"]
    control = data["axis"]["Y"]["control"]
    control["velocity"].update(proportional_gain="12 kN*s/m", torque_limit="3 kN")
    control["feedforward"]["inertia"] = "300 kg"
    control["measuring"] = {"position": "scale", "encoder_resolution": "0.1 um"}
    machine = assembled_machine(MachineFile.from_dict(data))
    assert machine.drives[0].controller.velocity.proportional_gain == 12e3
    control["velocity"]["proportional_gain"] = "12 N*m*s/rad"
    data["axis"]["Y"]["brake"]["stiffness"] = "1e5 N*m/rad"
    with pytest.raises(InputError) as caught:
        MachineFile.from_dict(data)
    text = str(caught.value)
    assert "axis.Y.control.velocity.proportional_gain" in text
    assert "a damping coefficient is required" in text
    assert "axis.Y.brake.stiffness" in text


def test_spindle_as_a_rotor(line):
    line["axis"]["S"] = {
        "direction": [0, 0, 1], "carrying": "bed", "at": [0, 0, 0],
        "drive": {"kind": "spindle", "inertia": "0.05 kg*m^2"},
        "control": {
            "position": {"gain": 0, "sample_time": "2 ms", "velocity_limit": "6000 rpm"},
            "velocity": {"proportional_gain": "5 N*m*s/rad", "sample_time": "125 us"},
            "current": {"sample_time": "62.5 us"},
        },
    }  # fmt: skip
    machine = assembled_machine(MachineFile.from_dict(line))
    assert machine.axes == ("Y", "S")
    limit = machine.drives[1].controller.position.velocity_limit
    assert limit == pytest.approx(200.0 * math.pi)
    line["axis"]["S"]["control"]["position"]["velocity_limit"] = "3 m/s"
    with pytest.raises(InputError, match=r"axis\.S\.control\.position\.velocity_limit.*velocity"):
        MachineFile.from_dict(line)


def test_screw_on_a_beam(line, changed):
    data = changed(line, ["beam", "screw"], {
        "origin": ["0 mm", "-400 mm", "0 mm"], "axis": [0, 1, 0],
        "segments": [{"length": "1 m", "outer": "40 mm"}],
        "bearings": [
            {"name": "fixed", "station": 0, "on": "bed", "radial": "200 N/um",
             "axial": "400 N/um", "tilt": "1e4 N*m/rad"},
            {"name": "free", "station": "1 m", "on": "bed", "radial": "100 N/um"},
        ],
    })  # fmt: skip
    data = changed(data, ["axis", "Y", "drive"], {
        "kind": "screw on beam", "beam": "screw", "lead": "10 mm", "radial": "100 N/um",
        "axial": "250 N/um", "tilt": "1e4 N*m/rad", "nut_at": "500 mm",
        "motor_inertia": "0.004 kg*m^2", "coupling_stiffness": "1e5 N*m/rad",
    })  # fmt: skip
    file = MachineFile.from_dict(data)
    near, far = (
        assembled_machine(file, {"Y": "brake"}, {"Y": position}).structure
        for position in ("-0.3 m", "0.3 m")
    )
    port = near.port("table", (0, 1, 0), "tool")
    soft, stiff = (one.receptance(0.0, port)[0, 0, 0].real for one in (far, near))
    # compliance grows by the length of shaft between the two places: 0.6 m/(E A)
    area = math.pi / 4 * 0.04**2
    turning = 0.6 / (206e9 / 2.6 * math.pi / 32 * 0.04**4) * TRAVEL**2
    assert soft - stiff == pytest.approx(0.6 / (206e9 * area) + turning, rel=1e-3)
    with pytest.raises(InputError, match="station"):
        assembled_machine(file, positions={"Y": "600 mm"})
