"""Mean and peak forces on a rigid tool against sums over thousands of slices, at every default."""

import json
import math

import numpy as np
import pytest

from benchmarks.contradictions.trochoid_cut import TrochoidCut
from chatter import Case
from chatter.simulation.simulate import simulate
from tests.validation.reference.rigid_forces import RigidCut, drawn_case

#: stated in docs/time-domain.md
MEAN, PEAK = 0.005, 0.01
#: of drawn cuts: a tenth of those of which 200 were compared, see docs/validation.md
DRAWN = [1005, 1010, 1023, 1024, 1033, 1040, 1043, 1057]


def compared(case, **simulation):
    """Mean and largest forces found and wanted, each (2, 3), N."""
    found = simulate(Case.from_dict({**case, "simulation": {"revolutions": 2, **simulation}}))
    wanted = RigidCut(case, 1500)
    numbers = found.summary()
    got = [list(numbers[name].values()) for name in ("mean_force_N", "peak_force_N")]
    return np.array(got), np.array([wanted.mean(), wanted.peak(1440)])


@pytest.mark.parametrize("seed", DRAWN)
def test_drawn_cuts(seed):
    got, wanted = compared(drawn_case(np.random.default_rng(seed)))
    assert got[0] == pytest.approx(wanted[0], rel=MEAN)
    assert got[1] == pytest.approx(wanted[1], rel=PEAK)


def ball(mode="up", share=0.4, depth=0.5e-3, helix=0.0):
    """20 mm ball end; at partial immersion only the upper part of its edge cuts."""
    return {
        "tool": {"kind": "ball", "teeth": 2, "diameter": 20e-3, "helix": helix},
        "material": {"law": "linear", "Ktc": 8e8, "Krc": 3e8, "Kte": 1e4, "Kre": 1.5e4},
        "cut": {
            "mode": mode,
            "spindle_speed": 500.0,
            "feed_per_tooth": 0.1e-3,
            "axial_depth": depth,
            "radial_depth": share * 20e-3,
        },
    }


@pytest.mark.parametrize(
    ("mode", "share", "depth", "helix_deg"),
    [("up", 0.4, 0.5e-3, 0.0), ("down", 0.3, 1e-3, 30.0), ("up", 0.1, 5e-3, 10.0)],
)
def test_ball_end_at_partial_immersion(mode, share, depth, helix_deg):
    got, wanted = compared(ball(mode, share, depth, math.radians(helix_deg)))
    assert got[0] == pytest.approx(wanted[0], rel=MEAN)
    assert got[1] == pytest.approx(wanted[1], rel=PEAK)


def test_slices_given_reach_the_corner():
    case = ball()
    errors = []
    for slices in (4, 16):
        got, wanted = compared(case, slices=slices)
        errors.append(np.abs(got / wanted - 1.0).max())
    assert errors[1] < 0.3 * errors[0]


def test_straight_edge_at_small_immersion():
    """A few degrees in the cut, with jumps that no sample meets: mean and peak keep to the law."""
    case = ball("down", 0.01)
    case["tool"]["kind"] = "end mill"
    got, wanted = compared(case)
    assert got[0] == pytest.approx(wanted[0], rel=1e-3)
    assert got[1] == pytest.approx(wanted[1], rel=1e-3)


def test_mean_does_not_depend_on_the_record(tmp_path):
    """A long run keeps few rows a revolution; its mean and peak forces are those of every step."""
    case = {**ball("down", 0.02), "simulation": {"revolutions": 2}}
    case["tool"]["kind"] = "end mill"
    short = simulate(Case.from_dict(case))
    long = simulate(Case.from_dict({**case, "simulation": {"revolutions": 300}}))
    assert long.setup.resolution.stride > 1
    for name in ("mean_force_N", "peak_force_N"):
        one, other = (list(found.summary()[name].values()) for found in (short, long))
        assert one == pytest.approx(other, rel=1e-3)
    written = json.loads((long.save(tmp_path), tmp_path / "summary.json")[1].read_text())
    assert written["mean_force_N"] == long.summary()["mean_force_N"]


def test_tip_of_a_ball_of_dexels_cuts_the_chip_of_one_tooth():
    # cuts near the axis once waited for the edge to be farther away than it ever got, so that
    # the tip met stock all around; the edge force there then acted twice as long
    sections = {
        "tool": {"kind": "ball", "teeth": 1, "diameter": 4.6e-3, "helix": 0.0},
        "material": {"Ktc": 600e6, "Krc": 200e6, "Kte": 20e3, "Kre": 20e3},
        "cut": {
            "mode": "slot", "spindle_speed": 314.0, "feed_per_tooth": 29e-6,
            "axial_depth": 0.29e-3, "radial_depth": 4.6e-3,
        },
    }  # fmt: skip
    carved = {"chip": "dexel", "revolutions": 4, "slices": 12, "resolution": 4e-6}
    case = Case.from_dict({**sections, "simulation": carved})
    expected = TrochoidCut(case).mean()[:3]
    found = simulate(case).mean_force
    assert np.abs(found - expected).max() < 0.01 * np.linalg.norm(expected)
