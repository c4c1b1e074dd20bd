"""Limits of stability found in the time domain against semi-discretization."""

import csv
import math

import numpy as np
import pytest

import chatter
from tests.cases import tool_of_922_hertz
from tests.command_line import chatter_command

RPM = math.pi / 30.0
X = ((1, 0, 0),)
X_AND_Y = ((1, 0, 0), (0, 1, 0))


def cut_of(directions, mode, immersion, speeds, deepest, **changes):
    """Cut of the tool of 922 Hz, with what the limits are searched over."""
    values = {"diameter": 16e-3, "helix": "0 deg", "depths": 12, "count": 10} | changes
    lowest, highest = (f"{speed} rpm" for speed in speeds)
    return tool_of_922_hertz(
        directions,
        tool={"diameter": values["diameter"], "helix": values["helix"]},
        cut={"mode": mode, "spindle_speed": lowest, "radial_depth": immersion * values["diameter"]},
        lobes={
            "speeds": {"from": lowest, "to": highest, "count": values["count"]},
            "depths": {"to": deepest, "count": values["depths"]},
        },
    )


TEN_SPEEDS = {
    "one mode, up-milling": (X, "up", 0.05, (14500, 20500), "8 mm"),
    "one mode, half-immersion down-milling": (X, "down", 0.5, (14500, 20500), "4 mm"),
    "two modes, up-milling": (X_AND_Y, "up", 0.05, (14500, 20500), "6 mm"),
    "two modes, tenth immersion": (X_AND_Y, "up", 0.1, (14500, 19500), "5 mm"),
}


#: one mode and two, up- and down-milling are left
NIGHTLY = {"one mode, up-milling", "two modes, tenth immersion"}


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.nightly] if name in NIGHTLY else [])
        for name in TEN_SPEEDS
    ],
)
def test_limits_at_ten_speeds_within_two_percent(name):
    case = cut_of(*TEN_SPEEDS[name])
    found = chatter.lobes(case, method="time-domain").limits
    wanted = chatter.lobes(case).limits
    assert np.isfinite(wanted.critical_depth).all()
    assert found.critical_depth == pytest.approx(wanted.critical_depth, rel=0.02)
    assert found.chatter_frequency == pytest.approx(wanted.chatter_frequency, rel=0.01)
    assert found.bifurcation == wanted.bifurcation
    assert {"hopf", "flip"} >= set(found.bifurcation)


# validation 2.3: first limit, mm, and its kind
PUBLISHED = [
    (X, "up", 0.05, "5 mm", {10000: (1.657701, "hopf"), 20000: (3.774048, "flip")}),
    (X, "down", 0.5, "5 mm", {10000: (2.104690, "flip"), 20000: (0.719643, "hopf")}),
    (X, "slot", 1.0, "3 mm", {10000: (0.322379, "hopf"), 20000: (1.417506, "flip")}),
    (X_AND_Y, "up", 0.05, "5 mm", {10000: (1.486950, "hopf"), 20000: (3.250386, "flip")}),
]


@pytest.mark.parametrize(("directions", "mode", "immersion", "deepest", "limits"), PUBLISHED)
def test_published_limits(directions, mode, immersion, deepest, limits):
    case = cut_of(directions, mode, immersion, (10000, 20000), deepest, count=2)
    found = chatter.lobes(case, method="time-domain").limits
    depths, kinds = zip(*limits.values(), strict=True)
    assert found.spindle_speed == pytest.approx(np.array(list(limits)) * RPM)
    assert found.critical_depth * 1e3 == pytest.approx(depths, rel=0.02)
    assert found.bifurcation == kinds


# validation 3.1: closed island of period doubling below the Hopf limit, mm
ISLANDS = {18800: [1.14676, 1.98935, 4.62804], 19000: [1.60997, 2.50485, 5.17385]}


def test_islands_of_period_doubling_with_helix(tmp_path):
    case = cut_of(
        X, "up", 0.05, (18800, 19000), "6 mm",
        diameter=8e-3, helix="45 deg", depths=24, count=2,
    )  # fmt: skip
    case.save(tmp_path / "island.toml")
    result = chatter_command(
        "lobes", tmp_path / "island.toml", "--method", "time-domain", "--out", tmp_path
    )
    assert result.exit_code == 0, result.output
    with (tmp_path / "lobes.csv").open() as file:
        rows = list(csv.DictReader(file))
    for row, (rpm, crossings) in zip(rows, ISLANDS.items(), strict=True):
        assert float(row["spindle_speed [rpm]"]) == pytest.approx(rpm)
        assert float(row["critical_depth [mm]"]) == pytest.approx(crossings[0], rel=0.02)
        # half the tooth-passing frequency, of which the motion holds odd multiples
        half = rpm / 60.0
        assert float(row["chatter_frequency [Hz]"]) / half == pytest.approx(3.0, rel=1e-3)
        assert row["bifurcation"] == "flip"
    found = chatter.lobes(case, method="time-domain").limits
    for crossings, wanted in zip(found.crossings, ISLANDS.values(), strict=True):
        assert crossings * 1e3 == pytest.approx(wanted, rel=0.02)


BEYOND = [
    # directions, mode, immersion, rpm, kind
    (X, "up", 0.05, 8000, "hopf"),
    (X, "up", 0.05, 10000, "hopf"),
    (X, "up", 0.05, 20000, "flip"),
    (X, "down", 0.5, 17333, "flip"),
    (X, "down", 0.5, 20000, "hopf"),
    (X_AND_Y, "up", 0.05, 15000, "hopf"),
    (X_AND_Y, "up", 0.05, 20000, "flip"),
    (X_AND_Y, "up", 0.1, 8000, "flip"),
]


@pytest.mark.parametrize(("directions", "mode", "immersion", "rpm", "kind"), BEYOND)
def test_full_chatter_beyond_the_limit(directions, mode, immersion, rpm, kind):
    """The signals of a whole run, with loss of contact, tell frequency and kind."""
    case = cut_of(directions, mode, immersion, (rpm, rpm + 1), "9 mm", count=2)
    limit = chatter.check(case).critical_depth
    case = case.patch({"cut.axial_depth": 1.05 * limit, "simulation.revolutions": 120})
    wanted = chatter.check(case)
    assert wanted.bifurcation == kind
    detection = chatter.simulate(case).detection
    assert detection.verdict == "chatter"
    assert detection.bifurcation == kind
    assert detection.chatter_frequency == pytest.approx(wanted.chatter_frequency, rel=0.01)
