"""Values that no machine has are asked about; those of every example are not."""

import math

import pytest

import chatter
from chatter.description.case import loads
from chatter.description.errors import InputError
from chatter.description.plausibility import check_plausible
from chatter.description.questioned import (
    question_of_flutes,
    question_of_spectral_radius,
    questions,
    stick_out_compliance,
)
from tests.chatter.simulation.test_worn_flank import CASE
from tests.places import EXAMPLES


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        ("structure.mode[0].stiffness", "15 N/mm", "is 0.015 N/um meant?"),
        ("structure.mode[0].damping", 0.6, "is 0.6 meant?"),
        ("material.Ktc", "1.9 MPa", "is 1.9 MPa meant?"),
        ("material.Kac", "-9000 MPa", "is -9000 MPa meant? the axial coefficient"),
        # 16 mm at 140000 rad/s
        ("cut.spindle_speed", "140000 rad/s", "is 67200 m/min meant?"),
        # bare numbers are metres
        ("cut.axial_depth", 0.5, "is 500 mm meant?"),
    ],
)
def test_a_value_in_the_wrong_unit_is_asked_about(path, value, words):
    case = loads(CASE).patch({path: value})
    assert any(words in one for one in questions(case))
    assert any(words in one for one in chatter.check(case).notes)


def test_a_mode_softer_by_far_than_the_cut_is_refused_at_once():
    """A bare number of N/um is one of N/m: methods would take hours, and say so at the end."""
    case = loads(CASE)
    cut = case.material.Ktc * case.cut.axial_depth
    for share, is_refused in ((0.9e-4, True), (1.1e-4, False)):
        soft = case.patch({"structure.mode[0].stiffness": share * cut})
        if is_refused:
            with pytest.raises(InputError, match=r"mode\[0\].stiffness.*bare number is in N/m"):
                check_plausible(soft)
        else:
            check_plausible(soft)


def test_what_is_usual_is_not_asked_about():
    assert questions(loads(CASE)) == []


@pytest.mark.parametrize("name", sorted(chatter.examples()))
def test_no_example_is_asked_about(name):
    for path in chatter.examples()[name].folder.glob("case*.toml"):
        assert questions(chatter.load(path)) == [], path


def test_a_tool_is_no_stiffer_than_its_stick_out():
    # k = 3 E I / L^3 with I = pi d^4 / 64: 650 GPa, 10 mm, 50 mm
    solid = 3.0 * 650e9 * math.pi * 0.01**4 / 64.0 / 0.05**3
    assert 1.0 / stick_out_compliance(0.01, 0.05) == pytest.approx(solid, rel=1e-12)
    assert 1.0 / stick_out_compliance(0.01, 0.05, 0.02, 0.01) == pytest.approx(solid, rel=1e-12)
    # a shank of twice the diameter above flutes of 20 mm: 8/125 of the flutes stay, the rest / 16
    share = 8.0 / 125.0 + (1.0 - 8.0 / 125.0) / 16.0
    stepped = stick_out_compliance(0.01, 0.05, 0.02, 0.02)
    assert stepped == pytest.approx(share / solid, rel=1e-12)
    case = loads(CASE).patch({"tool.stick_out": "80 mm", "structure.mode[0].stiffness": "400 N/um"})
    (asked,) = questions(case)
    # 3 pi E d^4 / (64 L^3) of 16 mm over 80 mm is 12.3 N/um
    assert "are 400 N/um along" in asked
    assert "has at most 12.3 N/um" in asked
    assert questions(case.patch({"tool.stick_out": "20 mm"})) == []
    assert (
        questions(case.patch({"tool.shank_diameter": "40 mm", "tool.flute_length": "20 mm"})) == []
    )


def test_growth_is_told_in_words():
    assert question_of_spectral_radius(2.0) == []
    (asked,) = question_of_spectral_radius(7e11)
    assert "7e+11 times from tooth to tooth" in asked


def test_growth_is_that_of_a_tooth_where_the_tool_repeats_itself_after_more():
    """Of two teeth with runout it was that of a turn: 1e8 for 1e4."""
    case = chatter.load(EXAMPLES / "one-degree-of-freedom" / "case.toml").patch(
        {"cut.axial_depth": "30 mm"}
    )
    told = [
        next(note for note in chatter.check(one).notes if "would grow" in note)
        for one in (case, case.patch({"tool.runout.offset": "0.01 um"}))
    ]
    radius = chatter.check(case, "semi-discretization").summary()["spectral_radius"]
    assert f"{radius:.2g} times from tooth to tooth" in told[0]
    assert told[1] == told[0]


@pytest.mark.parametrize(
    ("lead", "tilt", "asked"),
    [
        ("15 deg", "0 deg", ""),
        ("59 deg", "0 deg", ""),
        # cos 40 deg cos 40 deg = cos 54.1 deg; cos 50 deg cos 50 deg = cos 65.6 deg
        ("40 deg", "-40 deg", ""),
        ("50 deg", "-50 deg", "cut.lead: is 50 deg meant? the tool axis lies 24.4 deg above"),
        ("80 deg", "0 deg", "cut.lead: is 80 deg meant? the tool axis lies 10 deg above"),
        ("5 deg", "-75 deg", "cut.tilt: is -75 deg meant? the tool axis lies 14.94 deg above"),
    ],
)
def test_a_tool_that_lies_down_is_asked_about(lead, tilt, asked):
    text = CASE.replace('radial_depth = "8 mm"', 'stepover = "0.3 mm"').replace("end mill", "ball")
    leaning = loads(text).patch({"cut.lead": lead, "cut.tilt": tilt})
    found = [one for one in questions(leaning) if one.startswith("cut.")]
    assert (found[0] if found else "").startswith(asked)
    assert len(found) == bool(asked)


@pytest.mark.parametrize(("depth", "asked"), [("0.4 mm", 0), ("2 mm", 0), ("4 mm", 1)])
def test_a_wave_deeper_than_long_is_asked_about(depth, asked):
    serrated = {"tool.serration": {"depth": depth, "wavelength": "2 mm"}}
    found = questions(loads(CASE).patch(serrated))
    assert len(found) == asked
    assert all(
        "serration.depth: is 4 mm meant? that is 2 times" in one and "2 mm;" in one for one in found
    )


def test_a_deep_limit_asks_for_the_length_of_the_flutes():
    case = loads(CASE)
    (asked,) = question_of_flutes(case, 3.5 * case.tool.diameter)
    assert "56 mm are 3.5 diameters of the tool" in asked
    assert question_of_flutes(case, 2.9 * case.tool.diameter) == []
    assert question_of_flutes(case, math.inf) == []
    known = case.patch({"tool.flute_length": "60 mm"})
    assert question_of_flutes(known, 56e-3) == []
