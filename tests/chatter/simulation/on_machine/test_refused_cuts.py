"""What a case cannot ask of a machine is refused with words."""

import json

import pytest

import chatter
from chatter.description.errors import InputError
from chatter.simulation.setup import set_up
from dynamics.machine.groups import ControlledDrives
from tests.chatter.simulation.on_machine.coupled_machines import cut_case, spindle, written
from tests.chatter.simulation.on_machine.test_feed import slide


def refused(folder, machine, structure=None, **given):
    path = written(folder, machine)
    with pytest.raises(InputError) as error:
        set_up(cut_case({"machine": str(path), **(structure or {})}, **given))
    return str(error.value)


@pytest.mark.parametrize(
    ("structure", "words"),
    [
        ({"feed": [0, 0, 1]}, ["structure.feed", "perpendicular to the tool axis"]),
        ({"spindle": "Q"}, ["structure.spindle", '"Q"', "S", "X"]),
        # an axis that travels turned the tool
        ({"spindle": "X"}, ["structure.spindle", '"X"', "does not turn", "S would"]),
        ({"tool_axis": [0, 1, 0]}, ["structure.tool_axis", "spindle S"]),
        ({"condition": {"Q": "brake"}}, ["structure.condition", '"Q"', "X"]),
        ({"condition": {"X": "brake"}}, ["brake"]),
    ],
)
def test_what_the_machine_cannot_do(tmp_path, structure, words):
    told = refused(tmp_path, slide(True), structure)
    for word in words:
        assert word in told, told


def test_no_tool_point(tmp_path):
    machine = slide(True)
    del machine["tool_point"]
    assert "tool_point is missing" in refused(tmp_path, machine)


def test_two_spindles(tmp_path):
    machine = slide(True)
    machine["axis"]["T"] = spindle("bed")
    told = refused(tmp_path, machine)
    assert "structure.spindle is missing" in told
    assert "S, T" in told


def test_an_unstable_loop(tmp_path):
    machine = slide(True)
    machine["axis"]["X"]["control"]["velocity"]["proportional_gain"] = 5e6
    told = refused(tmp_path, machine)
    assert "machine.toml: axis.X: its control loop is unstable" in told
    assert "no integral part" in told  # it said "integral time inf s"
    assert "unstable" in told


def test_a_varied_speed(tmp_path):
    cut = {"speed_variation": {"amplitude": 0.1, "frequency": "2 Hz"}}
    told = refused(tmp_path, slide(True), cut=cut)
    assert "cut.speed_variation" in told


def test_a_path_of_its_own(tmp_path):
    told = refused(tmp_path, slide(True), path=[[0.0, 0.0], [0.1, 0.0], [0.1, 0.1]])
    assert "simulation.path" in told


@pytest.mark.parametrize("key", ["feed", "tool_axis", "spindle", "condition", "position"])
def test_keys_of_a_machine_without_one(key):
    value = {"feed": [1, 0, 0], "tool_axis": [0, 0, 1], "spindle": "S"}.get(key, {"X": "brake"})
    value = {"X": 0.1} if key == "position" else value
    mode = [{"frequency": 300.0, "damping": 0.02, "mass": 3.0, "direction": [1, 0, 0]}]
    with pytest.raises(InputError) as error:
        cut_case({"mode": mode, key: value})
    assert f"structure.{key}" in str(error.value)
    assert "structure.machine is not given" in str(error.value)


def test_a_machine_file_that_is_not_there():
    with pytest.raises(InputError) as error:
        set_up(cut_case({"machine": "nowhere.toml"}))
    assert "nowhere.toml" in str(error.value)


def test_the_schema_knows_the_keys():
    told = json.dumps(chatter.schema())
    for key in ("machine", "feed", "tool_axis", "spindle", "condition", "friction", "settling"):
        assert f'"{key}"' in told


def test_no_time_to_come_to_the_feed(tmp_path):
    told = refused(tmp_path, slide(True), {"settling": 0.01})
    assert "structure.settling: 0.01 s is given" in told
    assert "X" in told
    assert "0.05 s or more is required" in told
    # where there is little, axes come to the feed in what there is
    path = written(tmp_path, slide(True))
    case = cut_case({"machine": str(path), "settling": 0.1})
    setup = set_up(case)
    explicit = setup.structure.tables.explicit
    points = next(one.points for one in explicit if isinstance(one, ControlledDrives))
    cycle = points.steps * setup.step
    # feed of 0.1 mm by four teeth and 50 turns a second
    speed = abs(points.velocity[:, 0])
    assert speed[int(0.1 / cycle) + 1] == pytest.approx(0.02)
    assert speed[int(0.05 / cycle)] == pytest.approx(0.01, rel=0.05)
