"""Lead and tilt: the effective diameter of a ball by hand, and a refusal by every method."""

import math

import pytest

import chatter
from chatter.compile.inclined_axis import effective_diameter_of_ball
from chatter.description.case import Case
from chatter.description.errors import InputError

BALL = {
    "tool": {"kind": "ball", "teeth": 2, "diameter": "10 mm"},
    "material": {"Ktc": "1900 MPa", "Krc": "700 MPa"},
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


def test_effective_diameter_of_a_ball():
    # upright: 2 sqrt(a_p (D - a_p)); inclined by 90 deg less the arc: the full diameter, no more
    assert effective_diameter_of_ball(10e-3, 0.5e-3, 0.0) == pytest.approx(
        2 * math.sqrt(0.5e-3 * 9.5e-3)
    )
    assert effective_diameter_of_ball(10e-3, 0.5e-3, math.radians(15)) == pytest.approx(
        6.5397e-3, rel=1e-4
    )
    assert effective_diameter_of_ball(10e-3, 0.5e-3, math.radians(80)) == pytest.approx(10e-3)


@pytest.mark.parametrize("call", [chatter.check, chatter.lobes, chatter.simulate])
@pytest.mark.parametrize("key", ["lead", "tilt"])
def test_every_method_refuses_it_with_the_effective_diameter(call, key):
    case = Case.from_dict({**BALL, "cut": {**BALL["cut"], key: "-15 deg"}})
    with pytest.raises(InputError, match=rf"cut\.{key}: an inclined tool axis") as refused:
        call(case)
    assert "effective diameter of 6.54 mm, at 123.3 m/min" in str(refused.value)


def test_other_tools_are_refused_and_an_upright_axis_is_not():
    upright = Case.from_dict({**BALL, "cut": {**BALL["cut"], "lead": "0 deg"}})
    assert upright.cut.lead == 0.0
    end_mill = {**BALL["tool"], "kind": "end mill"}
    cut = {**BALL["cut"], "stepover": "4 mm", "lead": "2 deg"}
    with pytest.raises(InputError, match="for an axis normal to the surface"):
        chatter.check(Case.from_dict({**BALL, "tool": end_mill, "cut": cut}))
