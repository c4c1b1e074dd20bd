"""Verdict under a varying spindle speed where friction rubs on a mode, against long runs from rest.

A period of the variation is two turns, so that the motion of a stable cut repeats with every second
turn. Friction that sticks holds what little chatter there is, and the tool at any of many places;
what a deep cut does from rest is more than it holds.
"""

import math

import numpy as np
import pytest

import chatter
from chatter.description.case import Case
from chatter.description.progress import no_progress
from chatter.simulation.perturbation.lyapunov_verdict import lyapunov_verdict
from chatter.simulation.perturbation.multiplier import motion_of
from chatter.simulation.setup import delayed, set_up
from chatter.simulation.structure_in_time import modes_of
from chatter.stability.model import milling_model
from chatter.stability.registry import COLLOCATION

TURNS = 300
LAWS = {
    "coulomb": {"law": "coulomb-stribeck"},
    "coulomb-stribeck": {"law": "coulomb-stribeck", "stribeck_velocity": 1e-3},
    "lugre": {
        "law": "lugre", "stribeck_velocity": 1e-3, "bristle_stiffness": 1e8,
        "bristle_damping": 100.0,
    },
    "tanh": {"law": "tanh-hysteresis", "presliding_stiffness": 2e7},
}  # fmt: skip


def rubbing_case(law, force, depth=1e-3):
    """Four straight teeth in a slot, on a guide that rubs along the feed."""
    speed = 2.0 * math.pi * 900.0 / (4.25 * 4)
    variation = {"amplitude": 0.15, "frequency": speed / (4.0 * math.pi), "shape": "triangle"}
    friction = {"coulomb": force} | LAWS[law]
    if "stribeck_velocity" in friction:
        friction["static"] = 1.3 * force
    mode = {"frequency": 900.0, "damping": 0.02, "stiffness": 8e6, "direction": [1, 0, 0]}
    other = {"frequency": 980.0, "damping": 0.025, "stiffness": 1e7, "direction": [0, 1, 0]}
    document = {
        "tool": {"teeth": 4, "diameter": "16 mm"},
        "material": {"Ktc": "800 MPa", "Krc": "300 MPa"},
        "cut": {
            "mode": "slot", "spindle_speed": speed, "feed_per_tooth": 1e-4, "axial_depth": depth,
            "speed_variation": variation,
        },
        "structure": {"mode": [mode | ({"friction": "guide"} if force else {}), other]},
    }  # fmt: skip
    return Case.from_dict(document | ({"friction": {"guide": friction}} if force else {}))


@pytest.fixture(scope="module")
def limit():
    """Limit without friction, m."""
    case = rubbing_case("coulomb", 0.0)
    speed = np.array([case.cut.spindle_speed])
    depths = np.linspace(0.0, 4e-3, 41)[1:]
    found = COLLOCATION.limits(milling_model(case), speed, depths, None, no_progress)
    return found.critical_depth[0]


def is_forced(case):
    """Whether a run from rest comes to repeat, and is no larger than as the cut takes hold."""
    swings = []
    for ramp in (0, TURNS // 2):
        setup = set_up(delayed(case))
        bins = setup.resolution.steps_per_revolution
        motion, done = motion_of(setup, TURNS * bins, ramp * bins)
        if done < TURNS * bins:
            return False
        first, last = motion[(TURNS - 4) * bins : TURNS * bins].reshape(2, -1, 3)
        swings.append(np.ptp(last, axis=0).max())
        if np.abs(last - first).max() > 0.005 * swings[-1]:
            return False
    return swings[0] < 1.5 * swings[1]


NIGHTLY = [pytest.mark.nightly]
WEAK, STRONG = (2.0, (0.7, 1.4, 3.0)), (20.0, (1.4, 3.0))


# every law rubs weakly or strongly in every run, and both in the nightly one
@pytest.mark.parametrize(
    ("law", "force", "shares"),
    [
        *(pytest.param(law, *WEAK, marks=NIGHTLY if law == "lugre" else []) for law in LAWS),
        *(pytest.param(law, *STRONG, marks=NIGHTLY if law == "tanh" else []) for law in LAWS),
    ],
)
def test_verdict_is_that_of_the_run(limit, law, force, shares):
    for share in shares:
        case = rubbing_case(law, force, share * limit)
        found = lyapunov_verdict(case, modes_of(case)[0])
        assert found.verdict == ("stable" if is_forced(case) else "chatter")


def test_friction_makes_a_cut_stable_that_chatters_without(limit):
    free, rubbing = (rubbing_case("coulomb", force, 1.4 * limit) for force in (0.0, 20.0))
    assert lyapunov_verdict(free, modes_of(free)[0]).verdict == "chatter"
    found = chatter.simulate(rubbing).detection
    assert found.stable
    assert found.reason == "a small perturbation on the forced motion dies out at once"


def test_deep_cuts_break_loose(limit):
    """Of the same friction, small vibration is held and large is not."""
    case = rubbing_case("coulomb", 2.0, 3.0 * limit)
    assert not is_forced(case)
    assert chatter.simulate(case).detection.verdict == "chatter"
