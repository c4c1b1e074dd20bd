"""Values that no machine has are asked about; those of every example are not."""

import pytest

import chatter
from chatter.description.case import loads
from chatter.description.questioned import question_of_spectral_radius, questions
from tests.chatter.simulation.test_worn_flank import CASE


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        ("structure.mode[0].stiffness", "15 N/mm", "is 0.015 N/um meant?"),
        ("structure.mode[0].damping", 0.6, "is 0.6 meant?"),
        ("material.Ktc", "1.9 MPa", "is 1.9 MPa meant?"),
        # 16 mm at 140000 rad/s
        ("cut.spindle_speed", "140000 rad/s", "is 6.72e+04 m/min meant?"),
    ],
)
def test_a_value_in_the_wrong_unit_is_asked_about(path, value, words):
    case = loads(CASE).patch({path: value})
    assert any(words in one for one in questions(case))
    assert any(words in one for one in chatter.check(case).notes)


def test_what_is_usual_is_not_asked_about():
    assert questions(loads(CASE)) == []


@pytest.mark.parametrize("name", sorted(chatter.examples()))
def test_no_example_is_asked_about(name):
    for path in chatter.examples()[name].folder.glob("case*.toml"):
        assert questions(chatter.load(path)) == [], path


def test_growth_is_told_in_words():
    assert question_of_spectral_radius(2.0) == []
    (asked,) = question_of_spectral_radius(7e11)
    assert "7e+11 times from tooth to tooth" in asked
