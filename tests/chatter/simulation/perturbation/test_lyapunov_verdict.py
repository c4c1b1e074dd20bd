"""Small pushes on the forced motion: their growth follows the multipliers of the cut."""

import math
from dataclasses import replace

import numpy as np
import pytest

import chatter
from chatter.io.shipped_examples import example
from chatter.simulation.perturbation.followed_run import FollowedRun, force_share
from chatter.simulation.perturbation.lyapunov_record import LyapunovRecord
from chatter.simulation.perturbation.lyapunov_verdict import lyapunov_verdict
from chatter.simulation.perturbation.multiplier import simulated_multiplier
from chatter.simulation.structure_in_time import modes_of

#: a variation so weak that the cut is that of a constant speed
WEAK = {"cut.speed_variation": {"amplitude": 1e-6, "frequency": "250 Hz"}}


@pytest.fixture(scope="module")
def case():
    given = chatter.load(example("two-degrees-of-freedom").folder / "case.toml")
    return given.patch({"cut.spindle_speed": "15000 rpm", "simulation.revolutions": 60})


def judged(case, **changes):
    changed = case.patch(changes)
    return lyapunov_verdict(changed, modes_of(changed)[0])


def test_difference_dies_out_with_the_spectral_radius(case):
    radius = chatter.check(case.patch({"cut.axial_depth": "1 mm"})).spectral_radius
    found = judged(case, **{"cut.axial_depth": "1 mm", **WEAK})
    assert found.stable
    # two teeth a turn
    assert found.rate == pytest.approx(2.0 * math.log(radius), rel=0.02)


@pytest.mark.parametrize("depth", ["2 mm", "3 mm", "5 mm", "8 mm"])
def test_chatter_grows_whatever_follows(case, depth):
    """Full chatter settles in a cycle that forgets a perturbation."""
    assert judged(case, **{"cut.axial_depth": depth, **WEAK}).verdict == "chatter"


def test_chatter_grows_with_the_spectral_radius(case):
    beyond = case.patch({"cut.axial_depth": "2 mm"})
    found = judged(beyond, **WEAK)
    check = chatter.check(beyond)
    assert found.rate == pytest.approx(2.0 * math.log(check.spectral_radius), rel=0.1)
    assert found.frequency == pytest.approx(check.chatter_frequency, rel=0.01)


def test_verdict_under_a_varying_speed(case):
    swing = {"cut.speed_variation": {"amplitude": 0.01, "frequency": "5 Hz"}}
    for depth, verdict in (("1 mm", "stable"), ("2.5 mm", "chatter")):
        varied = case.patch({"cut.axial_depth": depth, **swing})
        found = chatter.simulate(varied).detection
        assert found.verdict == verdict
        assert (found.growth_rate < 0.0) == (verdict == "stable")


def test_a_period_that_cannot_be_watched_is_not_judged(case):
    # 250 turns a second, and a period of 2000 seconds
    slow = {"cut.speed_variation": {"amplitude": 0.01, "frequency": "0.0005 Hz"}}
    found = chatter.simulate(case.patch({"cut.axial_depth": "1 mm", **slow}))
    assert found.detection is None
    assert found.summary()["verdict"] == "not judged"
    assert "5e+05 turns" in found.why_no_verdict


def test_the_cut_takes_hold_without_a_jerk():
    share = force_share(np.linspace(-0.1, 1.1, 1201))
    assert share[0] == 0.0
    assert share[-1] == 1.0
    assert share[600] == pytest.approx(0.5)
    assert np.abs(np.diff(share)).max() < 1.9e-3
    assert np.abs(np.diff(share, 2)).max() < 6e-6


def test_a_difference_is_scaled_as_a_whole(case):
    """What is brought closer goes on as what was pushed less."""
    modes = modes_of(case)[0]
    runs = [FollowedRun(case, modes, 0) for _ in range(3)]
    for run, perturbation in zip(runs, (0.0, 1e-9, 1e-11), strict=True):
        run.displace(perturbation)
        run.revolve()
    runs[1].come_closer(runs[0], 1e-2)
    leader, closer, less = (run.revolve() for run in runs)
    assert np.abs(closer - less).max() < 1e-4 * np.abs(less - leader).max()


def exponents(size, period=1.0, **others):
    """Exponents of a made-up growth of a perturbation, with 40 turns of taking hold."""
    size = np.asarray(size, dtype=float)
    given = {
        "distance": size,
        "from_rest": np.zeros(size.size),
        "still": np.zeros(size.size, dtype=bool),
    } | others
    return LyapunovRecord(
        hold=40, period=period, cycle=0.3, size=size, scale=np.zeros(size.size), motion=[],
        rest=[], step=1e-5, swing=np.zeros(size.size), left=False, **given,
    )  # fmt: skip


def test_growth_within_a_period_is_none_over_a_whole_one():
    turns = np.arange(200.0)
    swinging = 4.0 * np.sin(2.0 * math.pi * turns / 25.0)
    found = exponents(swinging - 0.02 * turns, period=25.0)
    assert found.rise(0, 3.0) is None
    rate, error = found.settled_rate()
    assert rate == pytest.approx(-0.02, abs=1e-9)
    assert error == pytest.approx(0.0, abs=1e-9)
    growing = exponents(swinging + 0.05 * turns, period=25.0)
    begin, end = growing.rise(0, 3.0)
    assert growing.rate(begin, end) == pytest.approx(0.05, rel=1e-9)


def test_growth_that_stops_is_growth():
    turns = np.arange(100.0)
    size = np.where(turns < 50, -0.5 * turns, np.minimum(0.8 * (turns - 50), 10.0) - 25.0)
    begin, end = exponents(size).rise(40, 3.0)
    assert 48 <= begin < end <= 60
    assert exponents(size).rate(begin, end) == pytest.approx(0.8, rel=0.15)


def test_what_wavers_has_an_error():
    turns = np.arange(140.0)
    found = exponents(0.5 * np.sin(turns / 7.0) - 0.005 * turns)
    rate, error = found.settled_rate()
    assert error > 0.005
    assert abs(rate + 0.005) < 2.0 * error


def test_motion_that_takes_two_periods_of_the_variation_does_not_repeat_with_it():
    turns = np.arange(120)
    found = exponents(-0.1 * turns, period=6.0)
    with_it = replace(found, swing=1.0 + 0.2 * np.cos(2.0 * math.pi * turns / 6.0))
    doubled = replace(found, swing=1.0 + 0.2 * np.cos(2.0 * math.pi * turns / 12.0))
    assert with_it.repeats(0.05)
    assert not doubled.repeats(0.05)
    # turns of one phase do not meet
    assert replace(doubled, period=6.3).repeats(0.05)


def test_growth_of_a_mode_across_the_feed():
    """A mode along y alone, with runout: the multiplier of a turn is that of two teeth."""
    mode = {"frequency": 900.0, "damping": 0.02, "stiffness": 4e6, "direction": [0, 1, 0]}
    case = chatter.Case.from_dict(
        {
            "tool": {"teeth": 2, "diameter": "16 mm", "runout": {"offset": "10 nm"}},
            "material": {"Ktc": "800 MPa", "Krc": "300 MPa"},
            "cut": {
                "mode": "down",
                "spindle_speed": "17763 rpm",
                "feed_per_tooth": "0.1 mm",
                "axial_depth": "3.7 mm",
                "radial_depth": "1.28 mm",
            },
            "structure": {"mode": [mode]},
        }
    )
    radius = chatter.check(case).spectral_radius
    assert simulated_multiplier(case, modes_of(case)[0]).radius == pytest.approx(radius, rel=2e-3)


#: teeth that differ, so that the cut repeats from turn to turn alone; depths of which the last is
#: twice the limit or more
REPEATING = {
    "variable helix": (
        {"teeth": 3, "diameter": "8 mm", "helix": ["27.6 deg", "23.6 deg", "27.6 deg"]},
        {"mode": "slot", "spindle_speed": 431.554},
        [(1135.25, 0.0108, 7.453e6), (1438.78, 0.01265, 8.16e6)],
        ("0.5 mm", "1.268 mm"),
    ),
    "runout": (
        {
            "teeth": 5,
            "diameter": "8 mm",
            "helix": "23.5 deg",
            "runout": {"offset": "4.97 um", "angle": "251 deg"},
        },
        {"mode": "down", "radial_depth": "6 mm", "spindle_speed": 60.133},
        [(331.18, 0.01456, 4.606e6), (395.02, 0.01447, 7.027e6)],
        ("0.55 mm", "0.899 mm"),
    ),
}


@pytest.mark.parametrize("name", list(REPEATING))
def test_full_chatter_that_nearly_repeats_is_chatter_at_a_constant_speed(name):
    """The record alone may take it for a transient that dies out slowly."""
    tool, cut, modes, depths = REPEATING[name]
    structure = [
        {"frequency": f, "damping": d, "stiffness": k, "direction": axis}
        for (f, d, k), axis in zip(modes, ([1, 0, 0], [0, 1, 0]), strict=True)
    ]
    case = chatter.Case.from_dict(
        {
            "tool": tool,
            "material": {"Ktc": "800 MPa", "Krc": "340 MPa", "Kac": "100 MPa"},
            "cut": cut | {"feed_per_tooth": "0.1 mm", "axial_depth": "1 mm"},
            "structure": {"mode": structure},
        }
    )
    for depth, verdict in zip(depths, ("stable", "chatter"), strict=True):
        here = case.patch({"cut.axial_depth": depth})
        assert chatter.check(here).stable == (verdict == "stable")
        assert chatter.simulate(here).detection.verdict == verdict
        radius = simulated_multiplier(here, modes_of(here)[0]).radius
        assert (radius < 1.0) == (verdict == "stable")


def test_the_cycle_of_full_chatter_is_not_taken_for_a_cut_about_to_be_stable():
    """Its own multiplier is 1 but for the error of the measurement, here to the stable side."""
    modes = [
        {"frequency": f, "damping": d, "stiffness": k, "direction": [0, 1, 0]}
        for f, d, k in ((1377.647, 0.0439617, 3.017075e6), (1553.227, 0.0440356, 2.314619e6))
    ]
    case = chatter.Case.from_dict(
        {
            "tool": {
                "teeth": 3,
                "diameter": "16 mm",
                "helix": ["39.9 deg", "35.9 deg", "39.9 deg"],
            },
            "material": {"Ktc": "800 MPa", "Krc": "432 MPa", "Kac": "100 MPa"},
            "cut": {
                "mode": "slot",
                "spindle_speed": 825.20338,
                "feed_per_tooth": "0.1 mm",
                "axial_depth": "1.77 mm",
            },
            "structure": {"mode": modes},
        }
    )
    assert chatter.check(case).spectral_radius > 2.5
    assert simulated_multiplier(case, modes_of(case)[0]).radius > 1.0
