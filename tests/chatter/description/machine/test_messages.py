"""A bad machine is told by file, key and name before anything runs."""

import pytest

from chatter import InputError
from chatter.compile.machine_parts import assembled_machine
from chatter.description.machine.machine_file import MachineFile, load_machine

FRICTION = {
    "law": "coulomb-stribeck", "coulomb": "1 N", "static": "1 N", "stribeck_velocity": "1 mm/s",
}  # fmt: skip
CONTROL = ["axis", "Y", "control"]


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        (["body", "table", "mass"], "0 kg", ["body.table.mass", "greater than 0"]),
        (["body", "table", "mass"], "300 N", ["body.table.mass", "a force", "a mass is required"]),
        (["body", "table", "mas"], "300 kg", ["body.table.mas", "unknown key", '"mass"']),
        (["body", "table", "inertia"], [1, 1, 1], ["body.table", "inertia and size", "one is"]),
        (["body", "table", "size"], None, ["body.table.inertia", "missing"]),
        (["body", "bed", "inertia"], [1, -1, 1],
         ["body.bed: a principal moment of inertia is -1"]),
        (["body", "bed", "inertia"], [1, 1], ["body.bed.inertia", "three principal"]),
        (["body", "ground"], {"mass": 1, "size": [1, 1, 1], "centre": [0, 0, 0]},
         ["body.ground", "does not move"]),
        (["body", "two words"], {"mass": 1, "size": [1, 1, 1], "centre": [0, 0, 0]},
         ["body", '"two words" is not allowed', "letters"]),
        (["beam"], {"table": {"origin": [0, 0, 0], "segments": [{"length": 1, "outer": 0.1}]}},
         ['"table" is the name of two parts']),
        (["connector", "guide", "stiffness", "x"], "-3 N/um",
         ["connector.guide.stiffness.x", "at least 0"]),
        (["connector", "guide", "stiffness", "rx"], "3 N/um",
         ["connector.guide.stiffness.rx", "per length", "a rotational stiffness is required"]),
        (["connector", "guide", "between"], ["tabel", "bed"],
         ["connector.guide.between[0]", 'no part "tabel"', '"table"']),
        (["connector", "guide", "between"], ["table", "table"],
         ["connector.guide", 'joins "table" with itself']),
        (["connector", "guide", "at"], None, ["connector.guide.at", "missing"]),
        (["connector", "guide", "places"], [[0, 0, 0]], ["at and places"]),
        (["connector", "guide", "axes"], [[1, 0, 0], [1, 1, 0], [0, 0, 1]],
         ["connector.guide", "perpendicular"]),
        (["point", "tool", "on"], "spindle", ["point.tool.on", 'no part "spindle"', "bed"]),
        (["point", "tool", "at"], ["1 mm", "2 mm"], ["point.tool.at", "3 quantities are required"]),
        (["tool_point"], "tip", ["tool_point", 'no point "tip"', "tool, table"]),
        (["tool_point"], None, ["tool_point", "missing", "contact"]),
        (["axis", "Y", "moving"], "tabel", ["axis.Y.moving", 'no part "tabel"']),
        (["axis", "Y", "moving"], None, ["axis.Y.moving", "missing"]),
        (["axis", "Y", "at"], None, ["axis.Y.at", "missing"]),
        (["axis", "Y", "direction"], [0, 0, 0], ["axis.Y.direction", "no length"]),
        (["axis", "Y", "carries"], ["bed"], ["axis.Y.carries", "lacks", "moves against"]),
        (["axis", "Y", "drive", "kind"], "belt", ["axis.Y.drive.kind", "allowed are"]),
        (["axis", "Y", "drive", "lead"], "0 mm", ["axis.Y.drive", "lead", "not 0"]),
        (["axis", "Y", "drive", "lead"], "10 mm/rev", ["axis.Y.drive.lead", "per angle"]),
        (["axis", "Y", "drive", "lead"], None,
         ["axis.Y.drive.lead", "missing", 'kind = "ball screw" needs it', "a length"]),
        (["axis", "Y", "drive", "gear_ratio"], 3,
         ["axis.Y.drive.gear_ratio", 'does not belong to kind = "ball screw"']),
        (["axis", "Y", "drive"], None, ["axis.Y.brake", "no drive"]),
        (["axis", "X"], {"direction": [1, 0, 0], "moving": "bed", "carrying": "table"},
         ["axis.Y.carries", 'but not "bed" that axis X carries']),
        ([*CONTROL, "velocity", "sample_time"], "130 us",
         ["axis.Y.control", "position loop", "0.002 s", "whole multiple", "0.00013 s"]),
        ([*CONTROL, "velocity", "sample_time"], None,
         ["axis.Y.control.velocity.sample_time", "missing", "a time"]),
        ([*CONTROL, "filters"], [{"kind": "low pass", "frequency": "9 kHz"}],
         ["axis.Y.control", "9000 Hz", "Nyquist"]),
        ([*CONTROL, "filters"], [{"kind": "notch", "frequency": "9 kHz"}],
         ["axis.Y.control.filters[0].numerator_damping", "missing"]),
        ([*CONTROL, "current", "time_constant"], "1 ms",
         ["axis.Y.control.current.time_constant", "does not belong"]),
        ([*CONTROL, "velocity", "torque_limit"], "80 N",
         ["axis.Y.control.velocity.torque_limit", "a force", "a torque is required"]),
        ([*CONTROL, "position", "computing"], 1.5,
         ["axis.Y.control.position.computing", "not a whole number"]),
        (["friction", "guide", "law"], "Dahl", ["friction.guide.law", "lugre"]),
        (["friction", "guide", "on"], {"axis": "Z"}, ["friction.guide.on.axis", '"Z"', "Y"]),
        (["friction", "guide", "on"], {"axis": "Y", "motor": "Y"},
         ["friction.guide.on", "one of", "2 are given"]),
        (["friction", "guide", "on"], {"connector": "guide"},
         ["friction.guide.on.direction", "missing"]),
        (["friction", "guide", "on"], {"connector": "rail", "direction": "x"},
         ["friction.guide.on.connector", '"rail"']),
        (["friction", "guide", "coulomb"], "3 N*m",
         ["friction.guide.coulomb", "a torque", "a force is required"]),
        (["friction", "screw", "hysteresis_slope"], "40 1/m",
         ["friction.screw.hysteresis_slope", "an inverse of an angle is required"]),
        (["friction", "guide", "hysteresis_slope"], 4,
         ["friction.guide.hysteresis_slope", "does not belong to law"]),
        (["friction", "screw", "hysteresis_slope"], None,
         ["friction.screw", "give hysteresis_slope or presliding_stiffness"]),
        (["friction", "screw", "coulomb"], 0, ["friction.screw.coulomb", "must be above 0"]),
        (["contact", "directions"], ["u"], ["contact.directions[0]", "allowed are"]),
        (["damping_ratio"], 1.5, ["damping_ratio", "less than 1"]),
    ],
)  # fmt: skip
def test_told_on_reading(line, changed, path, value, words):
    with pytest.raises(InputError) as caught:
        MachineFile.from_dict(changed(line, path, value), name="m.toml")
    text = str(caught.value)
    assert all(one.startswith("m.toml: ") for one in caught.value.messages)
    for word in words:
        assert word in text, text


@pytest.mark.parametrize(
    ("patch", "arguments", "words"),
    [
        ({"connector.guide": None}, {}, ['"table" x', "no connector holds"]),
        ({"connector.feet.stiffness.y": 0}, {}, ["free are", "y"]),
        ({}, {"conditions": {"Z": "brake"}}, ['no axis "Z"', '"Y"']),
        ({}, {"conditions": {"Y": "off"}}, ['axis "Y"', "'off'", "control, brake, free"]),
        ({"axis.Y.control": None}, {"conditions": {"Y": "control"}}, ["has no controller"]),
        ({"axis.Y.brake": None}, {"conditions": {"Y": "brake"}}, ["axis.Y.brake", "missing"]),
        ({"contact": None}, {"in_cut": True}, ["[contact] is missing"]),
        ({}, {"positions": {"Z": 0.1}}, ['there is no axis "Z"', "known are Y"]),
        ({}, {"positions": {"Y": "1 kg"}}, ["position of axis Y", "a mass", "a length"]),
        (
            {"axis.Y.drive.shaft": {"diameter": "40 mm", "length": "1 m", "nut_at": "0.5 m"}},
            {"positions": {"Y": "600 mm"}},
            ["nut would be 1.1 m", "from 0 to 1 m"],
        ),
        ({"friction.guide.on": {"mode": 99}}, {}, ['friction "guide"', "mode"]),
    ],
)
def test_told_on_assembling(line_text, patch, arguments, words):
    file = MachineFile.from_text(line_text, name="m.toml").patch(patch)
    with pytest.raises(InputError) as caught:
        assembled_machine(file, **arguments)
    text = str(caught.value)
    assert text.startswith("m.toml: ")
    for word in words:
        assert word in text, text


def test_all_problems_are_told_together(line):
    line["body"]["table"]["mass"] = "-3 kg"
    line["connector"]["guide"]["stiffness"]["x"] = "3 kg"
    line["axis"]["Y"]["control"]["position"]["gain"] = "fast"
    with pytest.raises(InputError) as caught:
        MachineFile.from_dict(line)
    assert len(caught.value.messages) == 3


def test_a_rotor_takes_friction_of_its_motor(line):
    line["axis"]["S"] = {
        "direction": [0, 0, 1], "carrying": "bed", "at": [0, 0, 0],
        "drive": {"kind": "spindle", "inertia": 0.05},
    }  # fmt: skip
    line["friction"]["guide"] = {**FRICTION, "on": {"axis": "S"}}
    with pytest.raises(InputError, match=r"friction\.guide\.on\.axis.*rotor"):
        MachineFile.from_dict(line)


def test_files_that_are_none(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        load_machine(tmp_path / "m.toml")
    (tmp_path / "m.toml").write_text(" ")
    with pytest.raises(InputError, match="is empty; a machine file is TOML text"):
        load_machine(tmp_path / "m.toml")
    with pytest.raises(InputError, match="has no parts"):
        MachineFile.from_text("title = 'nothing'")
    with pytest.raises(InputError, match=r"no valid TOML.*line 2"):
        MachineFile.from_text("a = 1\nb = = 2")


def test_paths_that_lead_nowhere(line_text):
    file = MachineFile.from_text(line_text)
    with pytest.raises(InputError, match="into a machine, such as axis"):
        file.get("body..mass")
    with pytest.raises(InputError, match=r"there is no body\.tabel"):
        file.get("body.tabel.mass")
    with pytest.raises(InputError, match='unknown key; did you mean "mass"'):
        file.patch({"body.table.mas": 1})
