"""A file of another kind than the command takes is recognised, and said in one sentence."""

import pytest

from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.kinds_of_files import KINDS_OF_FILES, OF_CASES_ALONE, other_kind
from chatter.description.machine.machine_file import MachineFile
from tests.command_line import chatter_command
from tests.first_use.shop import CUT, written
from tests.places import EXAMPLES

CASE = EXAMPLES / "slotting" / "case.toml"
MACHINE = EXAMPLES / "machine-gantry" / "machine.toml"
MEASUREMENT = EXAMPLES / "explain-milling" / "measurement" / "measurement.toml"
LIBRARY = '[tool."12"]\ndiameter = "12 mm"\nflute_length = "20 mm"\nlength = "80 mm"\n'
ASSEMBLY = '[tool]\nname = "12"\n[spindle]\nname = "S"\n[stick_out]\nshortest = "40 mm"\n'
MATERIALS = '["C45 of our own"]\nKtc = "2000 MPa"\nKrc = "800 MPa"\nsource = "tests"\n'


def refusal(*arguments):
    """What a command prints that does not take a file."""
    done = chatter_command(*map(str, arguments))
    assert done.exit_code == 2
    return [line for line in done.stderr.splitlines() if line.startswith("chatter:")]


@pytest.mark.parametrize("command", ["check", "lobes", "simulate", "optimum", "sheet", "pitch"])
@pytest.mark.parametrize(
    ("given", "words"),
    [
        (MEASUREMENT, ["is a measurement (kind and case and [[run]])", "chatter explain"]),
        (MACHINE, ["is a machine ([body]", "names it by [structure] machine ="]),
    ],
)
def test_what_takes_a_case_says_what_it_is_given(command, given, words):
    """A measurement was answered by a list of keys that a case has."""
    (sentence,) = refusal(command, given)
    assert "where a case is required" in sentence
    for word in words:
        assert word in sentence


@pytest.mark.parametrize(
    ("command", "required"),
    [
        (["explain"], "a measurement"),
        (["compare"], "a measurement"),
        (["coefficients"], "a measurement"),
        (["learn", CASE], "a measurement"),
        (["detect"], "a record"),
        (["modes"], "a record"),
        (["frf"], "a machine"),
        (["move"], "a machine"),
        (["assemble"], "an assembly"),
    ],
)
def test_what_takes_another_file_says_that_it_is_given_a_case(command, required):
    """It said "kind: None is none of milling, axis, ...", or listed all file formats."""
    (sentence,) = refusal(*command, CASE)
    assert f"is a case ([tool] and [material] and [cut]), where {required} is required" in sentence


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("tools.toml", LIBRARY, "is a library ([tool])"),
        ("tool.toml", ASSEMBLY, "is an assembly ([spindle] and [stick_out])"),
        ("steels.toml", MATERIALS, "is a table of materials ([C45 of our own])"),
        ("summary.json", '{"verdict": "stable"}', "is JSON, such as the summary.json of a result"),
        ("tap.csv", "frequency [Hz],real [m/N]\n1,2\n", "[[structure.frf]] of a case names"),
        ("part.nc", "G0 X0 Y0\nG1 X10 F100\n", "is an NC program; simulation.program"),
    ],
)
def test_other_files_are_recognised(tmp_path, name, text, words):
    (tmp_path / name).write_text(text, encoding="utf-8")
    (sentence,) = refusal("check", tmp_path / name)
    assert words in sentence


def test_kinds_do_not_claim_the_files_of_each_other():
    import tomlkit

    for pattern, noun in [
        ("*/case.toml", "case"),
        ("*/machine*.toml", "machine"),
        ("*/measurement/measurement.toml", "measurement"),
    ]:
        paths = sorted(EXAMPLES.glob(pattern))
        assert len(paths) > 2
        for path in paths:
            data = tomlkit.parse(path.read_text(encoding="utf-8")).unwrap()
            assert other_kind(data, noun) is None
            assert [kind.noun for kind in KINDS_OF_FILES if kind.signs(data)] == [noun]


def test_only_the_cause_is_named_where_the_feed_follows_from_the_teeth(tmp_path):
    """Without tool.teeth the feed per tooth, which comes of a feed rate, was missing as well."""
    path = tmp_path / "case.toml"
    path.write_text(CUT.replace("teeth = 4\n", ""), encoding="utf-8")
    (sentence,) = refusal("check", path)
    assert "tool.teeth: is missing" in sentence


def test_a_feed_rate_without_a_tool_says_what_it_needs(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(
        '[cut]\nmode = "slot"\nspindle_speed = "1000 rpm"\nfeed_rate = "100 mm/min"\n'
        'axial_depth = "1 mm"\n',
        encoding="utf-8",
    )
    (sentence,) = refusal("check", path)
    assert "cut.feed_per_tooth: follows from cut.feed_rate, which needs [tool]" in sentence


@pytest.mark.parametrize(
    ("words", "section"),
    [
        (["whatif", MACHINE, "--vary", "cut.spindle_speed=1000..2000 rpm:3"], "cut"),
        (["whatif", MACHINE, "--vary", "tool.teeth=2..4"], "tool"),
        (["whatif", MACHINE, "--vary", "structure.position.X=1 mm, 2 mm"], "structure"),
        (
            ["whatif", MACHINE, "--set", 'cut.axial_depth="1 mm"', "--vary", "step=1 ms, 2 ms"],
            "cut",
        ),
        (["frf", MACHINE, "--set", "tool.teeth=3"], "tool"),
        (["move", MACHINE, "--set", "material.Ktc=2 GPa"], "material"),
    ],
)
def test_keys_of_a_case_on_a_machine_say_what_to_write_and_run(words, section):
    """They were unknown keys, with a list of those of a machine."""
    (sentence,) = refusal(*words)
    assert f"this is a machine file, and [{section}] belongs to a case" in sentence
    assert '[structure] machine = "(this file)"' in sentence
    assert 'paths into the machine begin with "machine."' in sentence


def test_every_section_that_a_machine_has_not_is_known_as_one_of_a_case():
    own = set(Case.model_fields) - set(MachineFile.model_fields)
    assert set(OF_CASES_ALONE) == own


@pytest.mark.parametrize("path", ["axis.Y.position", "body.table.mass"])
def test_keys_of_a_machine_on_a_case_name_the_path_into_it(path):
    """They were unknown keys, with a list of those of a case."""
    (sentence,) = refusal(
        "check", EXAMPLES / "face-mill-chatter" / "case.toml", "--set", f"{path}=3"
    )
    assert f"is a path into a machine; into that of a case it is machine.{path}" in sentence


def test_a_case_that_is_right_is_refused_by_none(tmp_path):
    from chatter.description.kinds_of_files import refuse_other_file

    refuse_other_file(written(tmp_path), "case")
    with pytest.raises(InputError, match="is a case"):
        refuse_other_file(written(tmp_path), "machine")
