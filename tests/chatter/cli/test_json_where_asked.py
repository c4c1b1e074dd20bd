"""Every command prints words, and JSON alone on stdout where it is asked for."""

import json

import pytest
import typer.main

from chatter.cli import COMMANDS, program
from tests.cases import TOOL_OF_922_HERTZ
from tests.command_line import chatter_command
from tests.places import ROOT

#: the result is a JSON schema, or a case file
WITHOUT_JSON = {"new", "schema"}
GROUP = typer.main.get_command(program)

CASE = f"""{TOOL_OF_922_HERTZ}
[lobes]
speeds = {{ from = "9000 rpm", to = "11000 rpm", count = 4 }}
depths = {{ to = "4 mm", count = 6 }}
[simulation]
revolutions = 12
[optimum]
max_power = "5 kW"
speeds = {{ from = "9000 rpm", to = "10000 rpm" }}
depths = {{ from = "0.2 mm", to = "1 mm", count = 3 }}
[pitch_design]
speeds = {{ from = "9500 rpm", to = "10000 rpm" }}
depths = {{ from = "0.2 mm", to = "1 mm", count = 3 }}
"""
RUNS = {
    "check": ["case.toml"],
    "lobes": ["case.toml"],
    "simulate": ["case.toml"],
    "bifurcation": ["case.toml", "--vary", "cut.axial_depth=0.5 mm..1 mm:2"],
    "whatif": ["case.toml", "--vary", "cut.axial_depth=0.5 mm, 1 mm", "--result", "critical depth"],
    "uncertainty": [
        "case.toml", "--set", "material.Ktc=600 +- 30 MPa", "--samples", "4", "--speeds", "2",
    ],
    "optimum": ["case.toml"],
    "pitch": ["case.toml"],
    "modes": [ROOT / "tests/data/frf-beam/point_1.csv"],
    "compare": [ROOT / "tests/data/measurements/set-121"],
    "materials": ["titanium"],
    "examples": [],
}  # fmt: skip


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def is_json(text):
    try:
        json.loads(text)
    except ValueError:
        return False
    return True


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_the_option(command):
    names = [name for one in GROUP.commands[command].params for name in one.opts]
    assert ("--json" in names) != (command in WITHOUT_JSON)


@pytest.mark.parametrize("command", RUNS)
def test_words_by_default_and_json_alone_where_asked(command, folder):
    words = chatter_command(command, *RUNS[command])
    assert words.exit_code == 0, words.output
    assert words.stdout.strip()
    assert not is_json(words.stdout)
    asked = chatter_command(command, *RUNS[command], "--json")
    assert asked.exit_code == 0, asked.output
    assert is_json(asked.stdout), asked.stdout


def test_the_list_of_examples_is_json_without_a_name():
    assert chatter_command("examples", "slotting", "--json").exit_code == 2
