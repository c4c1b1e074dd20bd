"""Paths and files that lead nowhere are told in one sentence, with exit code 2."""

import pytest

from chatter.studies.whatif.preset_studies import preset_study
from tests.command_line import chatter_command

CASE = "friction-amplitude/case.toml"
MACHINE = "friction-amplitude/machine.toml"


@pytest.fixture(scope="module")
def folder():
    return preset_study("friction-amplitude").file().parents[1]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (
            ["whatif", CASE, "--vary", "machine.axis.Q.position=1 mm, 2 mm"],
            ["machine.toml: axis.Q.position", "there is no axis.Q", "Y"],
        ),
        (
            ["whatif", MACHINE, "--vary", "body.tabel.mass=1 kg, 2 kg"],
            ["machine.toml: body.tabel.mass", "there is no body.tabel", '"table"'],
        ),
        (["frf", CASE], ["case.toml: is a case ([tool] and [material]", "a machine is required"]),
        (["check", MACHINE], ["machine.toml: is a machine ([body]", "a case is required"]),
        (
            ["simulate", CASE, "--set", "structure.condition.Q=brake"],
            ["case.toml: structure.condition", '"Q"', "there are Y"],
        ),
        (
            ["simulate", CASE, "--set", "structure.position.Q=3 mm"],
            ["case.toml: structure.position", '"Q"', "there are Y"],
        ),
        (
            ["simulate", CASE, "--set", "structure.friction=5"],
            ["case.toml: structure.friction: 5 is given", "true or false"],
        ),
    ],
)
def test_one_sentence(folder, tmp_path, words, told):
    command, file, *options = words
    out = tmp_path / "out"
    result = chatter_command(command, folder / file, *options, "--out", out)
    assert result.exit_code == 2, result.output
    assert "Traceback" not in result.stderr
    # beside it may stand what takes long: the first use, and the start where the computer is busy
    (line,) = [line for line in result.stderr.splitlines() if line.startswith("chatter: ")]
    for word in told:
        assert word in line
    assert not out.exists()
