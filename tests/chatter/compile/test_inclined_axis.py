"""Lead and tilt in a case: effective diameter by hand, what is refused and why, what is exact."""

import math

import numpy as np
import pytest

import chatter
from chatter.compile.cutter import cutter_of
from chatter.compile.inclined_axis import (
    effective_diameter,
    effective_diameter_of_ball,
    inclined_engagement,
)
from chatter.description.case import Case
from chatter.description.errors import InputError

BALL = {
    "tool": {"kind": "ball", "teeth": 2, "diameter": "10 mm", "helix": "30 deg"},
    "material": {"Ktc": "1900 MPa", "Krc": "700 MPa", "Kac": "200 MPa"},
    "cut": {
        "mode": "down", "spindle_speed": "6000 rpm", "feed_per_tooth": "0.1 mm",
        "axial_depth": "0.5 mm", "stepover": "0.4 mm",
    },
    "structure": {
        "mode": [
            {"frequency": "900 Hz", "damping": 0.03, "stiffness": "10 N/um", "direction": [1, 0, 0]}
        ]
    },
}  # fmt: skip


def of_ball(**changed):
    """Case of a ball with other values of [cut]."""
    cut = {key: value for key, value in {**BALL["cut"], **changed}.items() if value is not None}
    return Case.from_dict({**BALL, "cut": cut})


def test_effective_diameter_of_a_ball():
    # upright: 2 sqrt(a_p (D - a_p)); inclined by 90 deg less the arc: the full diameter, no more
    assert effective_diameter_of_ball(10e-3, 0.5e-3, 0.0) == pytest.approx(
        2 * math.sqrt(0.5e-3 * 9.5e-3)
    )
    assert effective_diameter_of_ball(10e-3, 0.5e-3, math.radians(15)) == pytest.approx(
        6.5397e-3, rel=1e-4
    )
    assert effective_diameter_of_ball(10e-3, 0.5e-3, math.radians(80)) == pytest.approx(10e-3)


@pytest.mark.parametrize(("lead", "tilt"), [(15, 0), (0, 15), (0, -15), (40, 0), (80, 0)])
def test_effective_diameter_of_what_is_in_the_cut(lead, tilt):
    case = of_ball(lead=f"{lead} deg", tilt=f"{tilt} deg")
    found = effective_diameter(inclined_engagement(case, cutter_of(case)))
    by_hand = effective_diameter_of_ball(10e-3, 0.5e-3, math.radians(max(lead, abs(tilt))))
    assert found == pytest.approx(by_hand, rel=1e-4)


def test_check_shows_it():
    rows = dict(chatter.check(of_ball(lead="15 deg"), method="zero-order").rows())
    # 30 D_eff Omega = pi 6.54 mm 6000/min
    assert rows["effective diameter"] == "6.54 mm, 123.3 m/min there"
    assert rows["width of cut"] == "0.4 mm"


def test_no_inclination_is_an_upright_tool_bit_for_bit():
    upright, given = of_ball(), of_ball(lead="0 deg", tilt="0 deg")
    one, other = chatter.simulate(upright), chatter.simulate(given)
    assert np.array_equal(one.rows, other.rows)


def test_next_to_none_is_nearly_upright():
    # by the other way: slices, arcs and axes of the inclined tool
    one, other = chatter.simulate(of_ball()), chatter.simulate(of_ball(lead="1e-6 deg"))
    largest = np.abs(one.mean_force).max()
    assert other.mean_force == pytest.approx(one.mean_force, abs=2e-3 * largest)
    assert other.mean_power == pytest.approx(one.mean_power, rel=1e-3)
    limits = [
        chatter.check(case, method="collocation").critical_depth
        for case in (of_ball(), of_ball(lead="1e-6 deg"))
    ]
    assert limits[1] == pytest.approx(limits[0], rel=1e-3)


@pytest.mark.parametrize(
    ("tool", "cut", "rest", "words"),
    [
        (
            {"kind": "taper", "taper_angle": "20 deg", "corner_radius": "5 mm"},
            {"lead": "71 deg"},
            {},
            "incline it by less",
        ),
        ({"kind": "end mill"}, {"stepover": "4 mm", "lead": "-2 deg"}, {}, "not -2 deg"),
        (
            {"serration": {"depth": "0.1 mm", "wavelength": "2 mm"}, "kind": "end mill"},
            {"stepover": "4 mm"},
            {},
            r"tool\.serration",
        ),
        (
            {},
            {"mode": "face", "stepover": None, "workpiece_width": "6 mm"},
            {},
            'state a workpiece wider than the tool by mode = "slot"',
        ),
        ({}, {}, {"contact": {"stiffness": "1 N/um"}}, r"\[contact\] is not computed"),
        ({}, {}, {"simulation": {"chip": "dexel"}}, 'simulation.chip = "delay"'),
    ],
)
def test_what_is_not_computed_is_refused_with_the_reason(tool, cut, rest, words):
    cut = {"lead": "5 deg", **cut}
    kept = {key: value for key, value in {**BALL["cut"], **cut}.items() if value is not None}
    case = Case.from_dict({**BALL, "tool": {**BALL["tool"], **tool}, "cut": kept, **rest})
    for call in (chatter.check, chatter.simulate):
        with pytest.raises(InputError, match=rf"cut\.lead: with an inclined tool axis .*{words}"):
            call(case)


def test_work_that_reaches_above_the_flutes_is_refused():
    """At s along the axis from the centre of the ball its shank is R (1 - sin a) + s cos a high."""
    radius, depth, lean = 5.0, 0.3, math.radians(80.0)
    top = radius + (depth - radius * (1.0 - math.sin(lean))) / math.cos(lean)
    case = of_ball(lead="80 deg", axial_depth=f"{depth} mm")
    short = case.patch({"tool.flute_length": f"{0.99 * top} mm"})
    words = (
        rf"cut\.lead: .* reaches {top:.3g} mm up the tool, .* tool\.flute_length, {0.99 * top:.6g}"
    )
    with pytest.raises(InputError, match=words):
        chatter.check(short)
    chatter.check(case.patch({"tool.flute_length": f"{1.01 * top} mm"}))
    # all in the ball, whose edges reach as far as it does
    chatter.check(of_ball(lead="15 deg", axial_depth="0.3 mm").patch({"tool.flute_length": "1 mm"}))


def test_studies_that_take_an_upright_tool_say_so():
    case = of_ball(tilt="10 deg")
    for call in (chatter.optimum, chatter.pitch):
        with pytest.raises(InputError, match=r"cut\.tilt: 10 deg is not computed here"):
            call(case)
