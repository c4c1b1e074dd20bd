"""`chatter materials`, and the coefficients that every command prints."""

import json

import pytest

from cutting.material.table import MATERIALS
from tests.cases import TOOL_OF_922_HERTZ
from tests.command_line import chatter_command


def test_the_list_and_a_search():
    listed = chatter_command("materials")
    assert listed.exit_code == 0
    assert all(name in listed.stdout for name in MATERIALS)
    found = chatter_command("materials", "inconel", "718")
    assert "source: ISCAR" in found.stdout
    assert "assumption" in found.stdout
    none = chatter_command("materials", "unobtainium")
    assert none.exit_code == 2
    assert "no row has unobtainium" in none.stderr


@pytest.mark.parametrize(
    ("grade", "told"),
    [
        ("1.2767", 'it is a tool steel; the nearest rows are "low-alloy and cast steel (VDI 6)"'),
        ("POM", "it is no metal, of which there is no row: `chatter coefficients` finds"),
    ],
)
def test_a_grade_without_a_row_is_said_to_have_none_with_the_nearest(grade, told, tmp_path):
    result = chatter_command("materials", grade)
    assert result.exit_code == 2
    assert f"no row has {grade}; by its name {told}" in result.stderr
    case = tmp_path / "case.toml"
    case.write_text(TOOL_OF_922_HERTZ, encoding="utf-8")
    result = chatter_command("check", case, "--set", f"material={{name='{grade}'}}")
    assert f'"{grade}" is not in the table of materials; by its name {told}' in result.stderr


def test_json_of_a_search():
    found = json.loads(chatter_command("materials", "brass", "--json").stdout)
    (row,) = found.values()
    assert (row["Ktc"], row["exponent"]) == (7e8, 0.73)


def test_an_own_table_is_searched(tmp_path):
    path = tmp_path / "own.toml"
    path.write_text('["ours"]\nKtc = "1800 MPa"\nsource = "tests"\n', encoding="utf-8")
    assert "Ktc 1800 MPa" in chatter_command("materials", "--table", path).stdout


@pytest.mark.parametrize("command", ["check", "simulate"])
def test_commands_print_the_coefficients(command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    case = tmp_path / "case.toml"
    case.write_text(TOOL_OF_922_HERTZ, encoding="utf-8")
    assert "coefficients: linear law, Ktc " in chatter_command(command, case).stderr
