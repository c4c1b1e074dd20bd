"""A first case from five answers."""

import pytest
from typer.testing import CliRunner

import chatter
from chatter.cli import program
from chatter.description.case import loads
from chatter.description.errors import InputError
from chatter.first_steps import self_check
from chatter.first_steps.first_case import QUESTIONS, first_case
from chatter.first_steps.self_check import closed_form_limit
from tests.command_line import chatter_command

EXAMPLES = {name: question.example for name, question in QUESTIONS.items()}


def test_the_examples_of_the_questions_make_a_case():
    case = loads(first_case(EXAMPLES))
    assert (case.tool.teeth, case.tool.diameter) == (4, pytest.approx(12e-3))
    assert case.title == "End mill 12 mm, 4 teeth, Al7075-T6"
    assert case.cut.axial_depth == pytest.approx(1e-3)
    assert case.cut.radial_depth == pytest.approx(6e-3)
    assert [mode.direction for mode in case.structure.mode] == [(1, 0, 0), (0, 1, 0)]
    assert chatter.check(case).stable in (True, False)


def test_two_coefficients_a_slot_and_per_cent():
    answers = {
        **EXAMPLES,
        "material": "700 MPa, 210 MPa",
        "engagement": "slot",
        "dynamics": "900 Hz, 3 %, 15 N/um",
    }
    case = loads(first_case(answers))
    assert case.material.values["Krc"] == pytest.approx(210e6)
    assert case.cut.radial_depth is None or case.cut.radial_depth == case.tool.diameter
    assert case.structure.mode[0].damping == pytest.approx(0.03)


@pytest.mark.parametrize(
    "answer",
    ["12.5 mm, 3", "12.5 mm, 3 flutes", "3 teeth, Ø12.5 mm", "D12,5 mm; z=3", "dia. 12.5 mm, Z 3",
     "D = 12.5 mm, 3 inserts"],
)  # fmt: skip
def test_a_tool_is_told_as_a_shop_does(answer):
    """ "3 flutes" was refused as no number of teeth."""
    tool = loads(first_case({**EXAMPLES, "tool": answer})).tool
    assert (tool.teeth, tool.diameter) == (3, pytest.approx(12.5e-3))


@pytest.mark.parametrize(
    ("answer", "mode", "depth"),
    [
        ("up 2.5 mm", "up", 2.5e-3),
        ("climb milling, 2.5 mm", "down", 2.5e-3),
        ("Conventional; 2,5 mm", "up", 2.5e-3),
        ("down-milling 2,5 mm", "down", 2.5e-3),
        ("slotting", "slot", 12e-3),
    ],
)
def test_an_engagement_is_told_as_a_shop_does(answer, mode, depth):
    cut = loads(first_case({**EXAMPLES, "engagement": answer})).cut
    assert cut.mode == mode
    assert (cut.radial_depth or 12e-3) == pytest.approx(depth)


def test_between_semicolons_a_comma_is_that_of_a_number():
    cut = loads(first_case({**EXAMPLES, "cut": "4200 rpm; 0,08 mm; 1,5 mm"})).cut
    assert (cut.feed_per_tooth, cut.axial_depth) == (pytest.approx(8e-5), pytest.approx(1.5e-3))


@pytest.mark.parametrize(
    ("name", "answer", "said"),
    [
        ("tool", "12 mm", "a number of teeth"),
        ("tool", "12 mm, four", "no number of teeth"),
        ("cut", "8000 rpm", "a speed, a feed and a depth"),
        ("cut", "8000, 0.05 mm, 1 mm", "rpm"),
        ("engagement", "sideways", 'slot, or "up" or "down"'),
        ("engagement", "slot, 3 mm", 'slot, or "up" or "down"'),
        ("engagement", "", 'slot, or "up" or "down"'),
        ("engagement", "down", 'slot, or "up" or "down"'),
        ("material", "unobtainium", "not in the table"),
        ("dynamics", "900 Hz, 0.03", "three quantities"),
        ("dynamics", "900 Hz, little, 15 N/um", "no damping ratio"),
    ],
)
def test_wrong_answers_are_told(name, answer, said, tmp_path):
    with pytest.raises(InputError) as caught:
        first_case({**EXAMPLES, name: answer}, tmp_path)
    assert said in str(caught.value)


def test_the_questions_are_asked_again_until_answered(tmp_path):
    file = tmp_path / "first.toml"
    words = "16 mm\n16 mm, 2\n\n\n\n\n"
    shown = CliRunner().invoke(program, ["new", str(file)], input=words)
    assert shown.exit_code == 0, shown.output
    assert chatter.load(file).tool.teeth == 2
    again = chatter_command("new", file)
    assert again.exit_code != 0
    assert "is there already" in again.stderr


def test_nobody_to_ask(tmp_path):
    shown = CliRunner().invoke(program, ["new", str(tmp_path / "x.toml")], input="")
    assert shown.exit_code != 0
    assert "--tool" in shown.stderr


def test_closed_form_at_the_lowest_point_of_a_lobe():
    """Over all speeds the closed form is least where Re G is: 2 pi/(N Ktc |alpha| |Re G|)."""
    speeds = [rpm * 0.10471975512 for rpm in range(9000, 20001, 50)]
    # alpha = ((cos 2 pi - 2 pi/3) - (cos pi - pi/3))/2 with Krc/Ktc of a third: 0.4764
    alpha = 0.5 * (2.0 - 3.14159265 / 3.0)
    stiffness = 0.03993 * (2.0 * 3.14159265 * 922.0) ** 2
    largest = 1.0 / (4.0 * stiffness * 0.011 * (1.0 - 0.011))
    lowest = 2.0 * 3.14159265 / (2 * 600e6 * alpha * largest)
    assert min(map(closed_form_limit, speeds)) == pytest.approx(lowest, rel=2e-3)


def test_doctor_asks_what_was_compiled_for_it(monkeypatch, tmp_path):
    monkeypatch.setattr(self_check, "_ASKED", tmp_path / "asked")
    self_check.compiled_self_check()
    shown = chatter_command("doctor")
    assert shown.exit_code == 0, shown.output
    assert shown.stdout.count("right") == 3
    assert "not compiled" not in shown.stdout


def test_doctor_compiles_no_more_than_the_zeroth_order(monkeypatch, tmp_path):
    """Where another case had compiled a part of them, it compiled for two minutes."""
    monkeypatch.setattr(self_check, "_ASKED", tmp_path / "asked")
    shown = chatter_command("doctor")
    assert shown.exit_code == 0, shown.output
    assert (shown.stdout.count("right"), shown.stdout.count("not compiled yet")) == (1, 2)
    assert "chatter compile" in shown.stdout


def test_the_version_is_printed():
    from chatter import __version__

    result = chatter_command("--version")
    assert (result.exit_code, result.stdout.strip()) == (0, f"chatter {__version__}")
