"""Life of the edge by Taylor's equation: in check, in notes, and as a limit of the optimum."""

import math

import numpy as np
import pytest

import chatter
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.stability.model import milling_model
from chatter.studies.optimisation.limits import limits_of

#: 60 m/min for 15 min; with n = 0.25 twice the speed lasts a sixteenth
CASE = {
    "tool": {"teeth": 4, "diameter": "16 mm"},
    "material": {"Ktc": "1900 MPa", "Krc": "700 MPa"},
    "cut": {
        "mode": "down", "cutting_speed": "120 m/min", "feed_per_tooth": "0.1 mm",
        "axial_depth": "0.5 mm", "radial_depth": "8 mm",
    },
    "structure": {
        "mode": [
            {"frequency": "900 Hz", "damping": 0.03, "stiffness": "12 N/um", "direction": [1, 0, 0]}
        ]
    },
    "tool_life": {"cutting_speed": "60 m/min", "life": "15 min", "exponent": 0.25},
    "optimum": {"speeds": {"from": "500 rpm", "to": "5000 rpm"}, "min_tool_life": "60 min"},
}  # fmt: skip


def test_twice_the_speed_lasts_a_sixteenth():
    case = Case.from_dict(CASE)
    assert case.tool_life.life_at(2.0) == pytest.approx(15 * 60 / 16)
    assert case.tool_life.cutting_speed_for(15 * 60 / 16) == pytest.approx(2.0)
    assert ["tool life", "0.938 min"] in chatter.check(case).rows()


def test_an_edge_that_has_cut_for_longer_is_told():
    worn = Case.from_dict({**CASE, "cut": {**CASE["cut"], "cut_time": "2 min"}})
    (told,) = [note for note in milling_model(worn).notes if "life of the edge" in note]
    assert "2 min is beyond the life of the edge at 120 m/min, 0.938 min" in told
    assert not [note for note in milling_model(Case.from_dict(CASE)).notes if "life" in note]


def test_the_optimum_keeps_to_speeds_at_which_the_edge_lasts():
    case = Case.from_dict(CASE)
    limits = limits_of(case, milling_model(case))
    # 60 min are four times 15: v = 60/4^0.25 = 42.43 m/min, 844 rpm on 16 mm
    highest = 60 / 60 / 4**0.25 * 2 / 16e-3
    assert limits.speeds[-1] == pytest.approx(highest)
    assert limits.speeds[-1] * 30 / math.pi == pytest.approx(844.0, abs=0.1)
    assert np.all(np.diff(limits.speeds) > 0)


def test_what_cannot_last_is_refused():
    late = Case.from_dict(CASE).patch({"optimum.min_tool_life": 1e6})
    with pytest.raises(InputError, match="the search begins at 500 rpm"):
        limits_of(late, milling_model(late))
    without = Case.from_dict({key: value for key, value in CASE.items() if key != "tool_life"})
    with pytest.raises(InputError, match=r"min_tool_life: needs \[tool_life\]"):
        limits_of(without, milling_model(without))
