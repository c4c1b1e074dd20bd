"""`chatter whatif` on the command line."""

import json

import pytest

from tests.command_line import chatter_command


def run(*words):
    return chatter_command("whatif", *words)


def test_a_study_on_the_command_line(case_file, tmp_path):
    out = tmp_path / "out"
    words = [case_file, "--vary", "material.Ktc=400 MPa,800 MPa", "--result", "critical-depth"]
    result = run(*words, "--method", "zero-order", "--out", out)
    assert result.exit_code == 0, result.output
    assert "as material.Ktc goes from 400 MPa to 800 MPa" in result.stdout
    names = {"whatif.csv", "whatif.png", "summary.json", "result-cache"}
    assert {path.name for path in out.iterdir()} == names
    again = run(*words, "--method", "zero-order", "--out", out, "--json")
    assert "2 of 2 points were finished before" in again.stderr
    assert json.loads(again.stdout) == json.loads((out / "summary.json").read_text())


def test_a_machine_alone(machine_file, tmp_path):
    result = run(machine_file, "--vary", "machine.body.head.mass=+-20%", "--out", tmp_path / "out")
    assert result.exit_code == 0, result.output
    assert "highest peak of the FRF" in result.stdout


def test_studies_are_listed():
    listed = run("--studies")
    assert listed.exit_code == 0
    for name in ("process-damping", "guide-friction", "contact", "axis-position", "pitch"):
        assert name in listed.stdout


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([], "--study NAME"),
        (["--study", "process-dampign"], "process-damping"),
        (["--study", "pitch", "--vary", "a=1"], "both given"),
        (["CASE"], "nothing varies"),
        (["CASE", "--study", "guide-friction"], "is made for the example"),
        (["CASE", "--vary", "cut.axial_depth=1 mm,2 Hz"], "a length is required"),
        (["nowhere.toml", "--vary", "a=1"], "there is no such file"),
    ],
)
def test_wrong_input_ends_with_2_and_a_sentence(case_file, tmp_path, words, told):
    given = [case_file if word == "CASE" else word for word in words]
    result = run(*given, "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert told in result.stderr
    assert "Traceback" not in result.output
    assert not (tmp_path / "out").exists()
