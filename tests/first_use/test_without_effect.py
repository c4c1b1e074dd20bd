"""A value that nothing uses is said to be without effect, in every command."""

import ast

import numpy as np
import pytest

import chatter
from chatter.description.without_effect import keys_without_effect
from tests.command_line import chatter_command
from tests.first_use.shop import cut, written
from tests.places import ROOT

FRICTION = {"law": "smooth-coulomb", "coulomb": "1 N", "smoothing_velocity": "1 mm/s"}

#: what is set, and the key that is then without effect
UNUSED = [
    ({"tool.clearance_angle": "7 deg"}, "tool.clearance_angle"),
    ({"tool.edge_radius": "10 um"}, "tool.edge_radius"),
    (
        {"tool.clearance_angle": "7 deg", "process_damping.coefficient": "20 N/mm"},
        "tool.clearance_angle",
    ),
    ({"tool.shank_diameter": "12 mm"}, "tool.shank_diameter"),
    ({"cut.cut_time": "10 min"}, "cut.cut_time"),
    ({"wear.cutting": "1 1/h"}, "wear.cutting"),
    ({"wear.edge_radial": "1 N/mm/min"}, "wear.edge_radial"),
    ({"wear.flank_pressure": "200 MPa"}, "wear.flank_pressure"),
    ({"wear.flank_friction": 0.2}, "wear.flank_friction"),
    ({"wear.saturation_time": "5 min", "cut.cut_time": "10 min"}, "wear.saturation_time"),
    ({"friction.guide": FRICTION}, "[friction.guide]"),
]

#: what makes such keys count
USED = [
    {
        "tool.clearance_angle": "7 deg",
        "tool.edge_radius": "10 um",
        "process_damping.indentation_force": "20000 N/mm^3",
    },
    {"tool.shank_diameter": "12 mm", "tool.stick_out": "60 mm"},
    {"wear.cutting": "1 1/h", "wear.saturation_time": "5 min", "cut.cut_time": "10 min"},
    {"wear.flank_pressure": "200 MPa", "tool.flank_wear": "0.2 mm"},
    {"friction.guide": FRICTION, "structure.mode[0].friction": "guide"},
    {"tool_life": {"cutting_speed": "60 m/min", "life": "20 min", "exponent": 0.2},
     "cut.cut_time": "10 min"},
]  # fmt: skip


@pytest.mark.parametrize(("values", "key"), UNUSED, ids=[key for _, key in UNUSED])
def test_what_nothing_uses_is_named_and_changes_nothing(values, key):
    case = cut().patch(values)
    (sentence,) = (one for one in keys_without_effect(case) if one.startswith(key))
    assert " has no effect " in sentence
    assert sentence in case.notes
    without = {
        path: value for path, value in values.items() if not path.startswith(key.strip("[]"))
    }
    plain = cut().patch(without) if without else cut()
    # to the last bit
    assert np.array_equal(
        chatter.lobes(case).limits.critical_depth, chatter.lobes(plain).limits.critical_depth
    )


@pytest.mark.parametrize("values", USED, ids=[next(iter(values)) for values in USED])
def test_what_counts_is_not_named(values):
    assert keys_without_effect(cut().patch(values)) == ()


def test_nothing_is_said_of_the_plain_cut_and_of_examples():
    assert keys_without_effect(cut()) == ()
    for example in chatter.examples().values():
        for path in example.folder.glob("case*.toml"):
            assert keys_without_effect(chatter.load(path)) == (), path


@pytest.mark.parametrize("command", ["check", "lobes", "simulate", "sheet"])
def test_commands_say_it(command, tmp_path):
    words = [command, written(tmp_path), "--set", "tool.clearance_angle=7 deg"]
    words += ["--set", "simulation.revolutions=8"] if command == "simulate" else []
    words += [] if command == "check" else ["--out", tmp_path / "out"]
    result = chatter_command(*words)
    assert result.exit_code == 0, result.output
    assert (
        "tool.clearance_angle has no effect without process_damping.indentation_force"
        in result.stderr
    )


def test_every_command_of_a_case_reads_it_where_notes_are_printed():
    """`patched_case` prints the notes of a case: no command that takes one goes around it."""
    for path in sorted((ROOT / "chatter" / "cli").glob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
        names |= {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
        if "CaseFile" in names and path.name != "options.py":
            assert names & {"patched_case", "patched"}, path.name
