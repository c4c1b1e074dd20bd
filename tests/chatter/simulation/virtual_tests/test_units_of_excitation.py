"""FRFs and moves by every kind of exciter are labelled by what excites and what is read."""

import json

import pytest

import chatter
from chatter.description.machine.frequency_response import FrfSection
from chatter.simulation.virtual_tests.from_file import frfs
from tests.places import EXAMPLES


@pytest.fixture(scope="module")
def gantry():
    """X by rotary motors, Y by a linear one."""
    return chatter.load_machine(EXAMPLES / "machine-gantry" / "machine.toml")


@pytest.mark.parametrize(
    ("excite", "read", "unit"),
    [
        ("motor:Y", "tcp:y", "m/N"),
        ("motor:Y", "motor:Y", "m/N"),
        ("motor:X", "tcp:x", "m/(N*m)"),
        ("motor:X", "motor:X", "rad/(N*m)"),
        ("motor:X", "motor:Y", "m/(N*m)"),
        ("tcp:rx", "tcp:x", "m/(N*m)"),
        ("tcp:x", "tcp:rz", "rad/N"),
    ],
)
def test_units_of_frfs(gantry, tmp_path, excite, read, unit):
    section = FrfSection(excite=excite, read=read, by="linearised", band=(50.0, 200.0), lines=20)
    result = frfs(gantry, {"one": section})
    assert result["one"].unit == unit
    result.save(tmp_path)
    heading = (tmp_path / "one.csv").read_text().splitlines()[0]
    assert heading == f"frequency [Hz],real [{unit}],imag [{unit}]"
    assert json.loads((tmp_path / "summary.json").read_text())["curves"][0]["unit"] == unit
    assert unit in result.plot().axes[0].get_ylabel()


def test_units_of_efforts(gantry, tmp_path):
    short = gantry.patch({"move.square.side": "11 mm", "move.square.fillet": "5 mm"})
    result = chatter.move(short, "square")
    wanted = {"X": "N*m", "Y": "N"}
    summary = result.summary()["axes"]
    assert {axis: one["effort_unit"] for axis, one in summary.items()} == wanted
    result.save(tmp_path)
    heading = (tmp_path / "move.csv").read_text().splitlines()[0]
    assert all(f"{axis} effort [{unit}]" in heading for axis, unit in wanted.items())
