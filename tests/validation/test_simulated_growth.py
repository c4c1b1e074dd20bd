"""Multipliers measured in simulated cuts, on cuts drawn at random, against collocation.

Teeth that are all alike meet the waves of forced vibration in phase, so that it does not change the
chip: what the linear theory says of small vibration holds however large forced vibration is.
"""

import math

import numpy as np
import pytest

import chatter
from chatter.description.case import Case
from chatter.description.progress import no_progress
from chatter.simulation.perturbation.multiplier import simulated_multiplier
from chatter.simulation.structure_in_time import modes_of
from chatter.stability.methods.time_domain.critical_depths import time_limit_curve
from chatter.stability.model import milling_model
from chatter.stability.registry import COLLOCATION

SHARES = (0.8, 0.95, 1.05, 1.3, 2.0)


def random_cut(seed, kind):
    """A cut with one or two modes; light ones double their period near two thirds."""
    rng = np.random.default_rng(seed)
    teeth, frequency, diameter = int(rng.integers(2, 6)), rng.uniform(300, 1400), 12e-3
    waves = {"slot": 10 ** rng.uniform(-0.3, 1.0), "side": 10 ** rng.uniform(-0.3, 0.7),
             "light": rng.uniform(1.4, 1.6)}[kind]  # fmt: skip
    immersion = {"slot": 1.0, "side": rng.uniform(0.2, 0.7), "light": rng.uniform(0.04, 0.15)}[kind]
    helix = 0.0 if kind == "light" else math.radians(rng.uniform(0.0, 40.0))
    stiffness = 10 ** rng.uniform(6.5, 7.5)
    modes = [
        {
            "frequency": frequency * scale, "damping": rng.uniform(0.01, 0.05),
            "stiffness": stiffness * rng.uniform(1.0, 3.0), "direction": axis,
        }
        for scale, axis in ((1.0, [1, 0, 0]), (rng.uniform(0.8, 1.6), [0, 1, 0]))
    ]  # fmt: skip
    return Case.from_dict(
        {
            "tool": {"teeth": teeth, "diameter": diameter, "helix": helix},
            "material": {"Ktc": 800e6, "Krc": rng.uniform(200e6, 500e6), "Kac": 100e6},
            "cut": {
                "mode": "slot" if kind == "slot" else str(rng.choice(["up", "down"])),
                "spindle_speed": 2.0 * math.pi * frequency / (waves * teeth),
                "feed_per_tooth": 1e-4, "axial_depth": 1e-3, "radial_depth": immersion * diameter,
            },
            "structure": {"mode": modes[: int(rng.integers(1, 3))]},
        }
    )  # fmt: skip


def limit_of(case):
    depths = np.linspace(0.0, 60e-3, 121)[1:]
    speed = np.array([case.cut.spindle_speed])
    return COLLOCATION.limits(milling_model(case), speed, depths, None, no_progress)


def multiplier_of(case):
    return COLLOCATION.multiplier(milling_model(case), None).value


def measured(case):
    return simulated_multiplier(case, modes_of(case)[0])


@pytest.mark.parametrize("kind", ["slot", "side", "light"])
@pytest.mark.parametrize("seed", range(5))
def test_stable_or_not_as_collocation_says(seed, kind):
    """Full chatter, at up to twice the limit, is never taken for stable."""
    case = random_cut(seed, kind)
    found = limit_of(case)
    limit = found.critical_depth[0]
    assert math.isfinite(limit)
    for share in SHARES:
        here = case.patch({"cut.axial_depth": share * limit})
        wanted, growth = abs(multiplier_of(here)), measured(here)
        assert (growth.radius < 1.0) == (wanted < 1.0)
        if share < 1.0 and growth.radius > 0.0:
            assert growth.radius == pytest.approx(wanted, abs=0.01)
        if share == 1.05:
            assert growth.bifurcation == found.bifurcation[0]
            assert growth.frequency == pytest.approx(found.chatter_frequency[0], rel=0.02)


def doubling(depth, runout=None):
    """Two straight teeth of which every second one cuts more: the period doubles."""
    mode = {"frequency": 922.0, "damping": 0.011, "stiffness": 1.34e6, "direction": [1, 0, 0]}
    return Case.from_dict(
        {
            "tool": {"teeth": 2, "diameter": "16 mm"} | ({"runout": runout} if runout else {}),
            "material": {"Ktc": "600 MPa", "Krc": "200 MPa"},
            "cut": {
                "mode": "up", "spindle_speed": "19500 rpm", "feed_per_tooth": "0.1 mm",
                "axial_depth": depth, "radial_depth": "1.6 mm",
            },
            "structure": {"mode": [mode]},
        }
    )  # fmt: skip


@pytest.mark.parametrize("share", [1.1, 1.5])
def test_full_chatter_of_a_doubled_period_is_a_flip(share):
    case = doubling("1 mm")
    found = limit_of(case)
    assert found.bifurcation[0] == "flip"
    growth = measured(case.patch({"cut.axial_depth": share * found.critical_depth[0]}))
    passing = case.cut.spindle_speed * 2 / (2.0 * math.pi)
    assert growth.radius > 1.0
    assert growth.bifurcation == "flip"
    assert growth.frequency / passing % 1.0 == pytest.approx(0.5, abs=1e-3)


def test_a_doubled_period_that_repeats_with_the_turn_is_chatter():
    """With two teeth that are not quite alike the period is a turn, and doubled chatter one too."""
    case = doubling("1 mm")
    limit = limit_of(case).critical_depth[0]
    for share, stable in ((0.8, True), (0.95, True), (1.1, False), (1.5, False), (2.0, False)):
        off = doubling(share * limit, {"offset": "10 nm"})
        assert (measured(off).radius < 1.0) == stable


def test_flutes_of_different_helix_differ_in_a_cut_of_one_slice_too():
    """Their edges are straight there, but each lags by its own angle."""
    case = Case.from_dict(
        {
            "tool": {
                "teeth": 4, "diameter": "12 mm", "helix": ["33 deg", "37 deg", "33 deg", "37 deg"],
            },
            "material": {"Ktc": "800 MPa", "Krc": "300 MPa"},
            "cut": {
                "mode": "slot", "spindle_speed": "21400 rpm", "feed_per_tooth": "0.1 mm",
                "axial_depth": "0.2 mm",
            },
            "structure": {
                "mode": [
                    {"frequency": 1210, "damping": 0.026, "stiffness": 2e6, "direction": [1, 0, 0]},
                    {"frequency": 1050, "damping": 0.028, "stiffness": 3e6, "direction": [0, 1, 0]},
                ]
            },
            "simulation": {"slices": 1},
        }
    )  # fmt: skip
    assert measured(case).period == pytest.approx(0.5 * 60.0 / 21400)
    assert measured(case).radius == pytest.approx(abs(multiplier_of(case)), abs=2e-3)
    assert chatter.simulate(case).detection.period_unit == "revolution"


def test_limits_tell_the_kind():
    case = doubling("1 mm")
    expected = limit_of(case)
    depths = np.linspace(0.0, 1.5 * expected.critical_depth[0], 9)[1:]
    speeds = np.array([case.cut.spindle_speed])
    found = time_limit_curve(case, modes_of(case)[0], speeds, depths)
    assert found.critical_depth[0] == pytest.approx(expected.critical_depth[0], rel=2e-3)
    assert found.bifurcation == ("flip",)


def test_what_has_died_out_does_not_grow_in_resonance_with_the_teeth():
    """5 teeth passing times 350 Hz is 1750 Hz: vibration is gone within 20 periods, and shapes that
    were hardly there had multipliers of 2.0 and 1.3, so that the limit was 0.097 mm, not 1.85."""
    case = Case.from_dict(
        {
            "tool": {"teeth": 3, "diameter": 10e-3, "helix": math.radians(40.0)},
            "material": {"Ktc": 2003e6, "Krc": 809.2e6, "Kte": 46.36e3, "Kre": 18.73e3},
            "cut": {
                "mode": "down", "spindle_speed": 7000.0 * math.pi / 30.0,
                "feed_per_tooth": 0.03889e-3, "axial_depth": 0.3e-3, "radial_depth": 4e-3,
            },
            "structure": {
                "mode": [
                    {"frequency": 1700.0, "damping": 0.025, "stiffness": 14e6, "direction": "x"},
                    {"frequency": 1760.0, "damping": 0.025, "stiffness": 13e6, "direction": "y"},
                ]
            },
        }
    )  # fmt: skip
    assert float(limit_of(case).critical_depth[0]) > 1.8e-3
    assert chatter.check(case).spectral_radius < 0.6
    modes, _ = modes_of(case)
    for depth in (0.05e-3, 0.0969e-3, 0.12e-3, 0.2e-3, 0.3e-3, 0.36e-3, 0.5e-3):
        found = simulated_multiplier(case.patch({"cut.axial_depth": depth}), modes)
        assert found.radius < 0.9, depth
