"""Limits of a flank that ploughs: linear methods against growth in simulated cuts.

A flat land presses on the way into the work alone, so that what the steady motion does decides.
"""

import math

import numpy as np
import pytest

from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.progress import no_progress
from chatter.stability.check import check
from chatter.stability.methods.time_domain.critical_depths import growths
from chatter.stability.model import milling_model
from chatter.stability.registry import COLLOCATION, METHODS

RPM = math.pi / 30.0


def ploughing_case(tool, cut, damping):
    """Modes of 800 and 900 Hz in a 20 mm cutter."""
    modes = [
        {"frequency": 800.0, "damping": 0.03, "mass": 0.05, "direction": [1, 0, 0]},
        {"frequency": 900.0, "damping": 0.03, "mass": 0.05, "direction": [0, 1, 0]},
    ]
    return Case.from_dict(
        {
            "tool": {"diameter": "20 mm", "clearance_angle": "6 deg"} | tool,
            "material": {"Ktc": "700 MPa", "Krc": "250 MPa"},
            "cut": {"axial_depth": "0.5 mm"} | cut,
            "structure": {"mode": modes},
            "process_damping": damping,
            "wear": {"flank_pressure": 0.0},  # edge forces that set in have limits of their own
        }
    )


def worn_case(feed):
    """Case of the independent integration: 0.485 mm at a small feed."""
    return ploughing_case(
        {"teeth": 3, "flank_wear": "50 um"},
        {"mode": "down", "spindle_speed": "1500 rpm", "feed_per_tooth": feed, "radial_depth": 8e-3},
        {"indentation_force": 4e13},
    )


CASES = {
    "flat land, small feed": worn_case("0.02 mm"),
    "flat land, large feed": worn_case("0.1 mm"),
    "long land of helical teeth": ploughing_case(
        {"teeth": 4, "flank_wear": "100 um", "helix": "30 deg"},
        {"mode": "up", "spindle_speed": "1925 rpm", "feed_per_tooth": 2e-5, "radial_depth": 8.6e-3},
        {"indentation_force": 4e13, "friction": 0.3},
    ),
    "rounded edge": ploughing_case(
        {"teeth": 3, "edge_radius": "20 um", "helix": "30 deg"},
        {
            "mode": "down",
            "spindle_speed": "1255 rpm",
            "feed_per_tooth": 2e-5,
            "radial_depth": 0.012,
        },
        {"indentation_force": 1e13},
    ),
    "land against the wave of chatter": ploughing_case(
        {"teeth": 1, "edge_radius": "20 um", "flank_wear": "100 um", "helix": "30 deg"},
        {"mode": "slot", "spindle_speed": "2876 rpm", "feed_per_tooth": 5e-5},
        {"indentation_force": 4e13},
    ),
}


def limit_of(case, method=COLLOCATION, to=4e-3):
    speed = np.array([case.cut.spindle_speed])
    depths = np.linspace(0.0, to, 81)[1:]
    return method.limits(milling_model(case), speed, depths, None, no_progress).critical_depth[0]


@pytest.mark.parametrize("name", list(CASES))
def test_limit_is_that_of_growth_in_the_time_domain(name):
    case = CASES[name]
    limit = limit_of(case)
    modes = milling_model(case).structure.modes
    speeds = np.full(2, case.cut.spindle_speed)
    below, above = growths(case, modes, speeds, limit * np.array([0.97, 1.03]))
    assert below.radius < 1.0 < above.radius


def test_limit_at_a_small_feed_is_that_of_an_independent_integration():
    assert limit_of(worn_case("0.02 mm")) == pytest.approx(0.485e-3, rel=0.01)


def test_linear_methods_agree():
    case = CASES["long land of helical teeth"]
    wanted = limit_of(case, to=4e-4)
    for name in ("matrix-free", "semi-discretization"):
        assert limit_of(case, METHODS[name], to=4e-4) == pytest.approx(wanted, rel=5e-3)


def test_check_says_which_share_of_the_dashpot_acts():
    found = check(worn_case("0.1 mm"))
    assert found.critical_depth == pytest.approx(limit_of(worn_case("0.1 mm")), rel=2e-3)
    (note,) = (note for note in found.notes if "dashpot K l^2/2" in note)
    assert note.startswith("ploughing: at 1500 rpm and 0.5 mm")
    assert "on average; beside a still tool 0.5 of it" in note


def test_a_land_that_no_flank_has_is_refused():
    with pytest.raises(InputError, match=r'tool\.flank_wear: "50 mm" is out of range'):
        check(worn_case("0.1 mm").patch({"tool.flank_wear": "50 mm"}))
