"""Diagrams and simulated points of a case for values of its sliders."""

from __future__ import annotations

import numpy as np
import pytest

import chatter
from chatter.app import followed_limits
from chatter.app.live_case import LiveCase
from chatter.app.sliders import case_sliders
from chatter.description.errors import InputError
from tests.places import EXAMPLES

CASE = EXAMPLES / "two-degrees-of-freedom" / "case.toml"


def no_progress(*_):
    pass


@pytest.fixture(scope="module")
def live():
    return LiveCase(chatter.load(CASE), "zero-order")


def test_sliders_hold_the_values_of_the_case(live):
    held = live.by_path
    assert held["material.Ktc"].value == pytest.approx(600.0)
    assert held["structure.mode[1].damping"].value == pytest.approx(0.011)
    assert held["tool.teeth"].whole
    assert held["lobes.depths.to"].value == pytest.approx(10.0)
    assert all(one.low <= one.value <= one.high for one in held.values())
    # the limits of the linear law do not depend on the feed
    assert "cut.feed_per_tooth" not in held


def test_diagram_is_that_of_the_command(live):
    drawn = live.diagram({}, "fine", no_progress)
    wanted = chatter.lobes(live.case, "zero-order").limits
    rpm = wanted.spindle_speed * 30.0 / np.pi
    shown = [depths[0] if depths else 10.0 for depths in drawn["crossings_mm"]]
    expected = np.interp(drawn["spindle_speed_rpm"], rpm, np.minimum(wanted.critical_depth, 0.01))
    # the two grids of speeds are not the same, and the lobes have corners
    assert np.median(np.abs(np.array(shown) / (1e3 * expected) - 1.0)) < 0.01


def test_the_curve_has_the_limit_at_the_speed_of_the_cut():
    """The point was judged by a limit that the curve between 200 speeds passed beside."""
    live = LiveCase(chatter.load(CASE).patch({"cut.spindle_speed": "9876.5 rpm"}), "collocation")
    drawn = live.diagram({}, "fine", no_progress)
    speeds = drawn["spindle_speed_rpm"]
    (at,) = np.flatnonzero(np.isclose(speeds, 9876.5))
    wanted = 1e3 * chatter.check(live.case, "collocation").critical_depth
    assert drawn["crossings_mm"][at][0] == pytest.approx(wanted, rel=1e-3)
    assert np.all(np.diff(speeds) > 0.0)
    assert len(speeds) == len(drawn["crossings_mm"]) == len(drawn["bifurcation"])


def test_limit_is_inverse_to_the_coefficients(live):
    before = live.diagram({}, "coarse", no_progress)
    values = {"material.Ktc": 1200.0, "material.Krc": 400.0, "lobes.depths.to": 5.0}
    after = live.diagram(values, "coarse", no_progress)
    lowest = [min(d[0] for d in one["crossings_mm"] if d) for one in (before, after)]
    assert lowest[1] == pytest.approx(0.5 * lowest[0])


def test_a_cut_off_the_diagram_does_not_make_each_move_a_search(monkeypatch):
    live, searched = LiveCase(chatter.load(CASE), "collocation"), []
    values = {"lobes.depths.to": 0.9 * live.by_path["cut.axial_depth"].value}
    live.diagram(values, "coarse", no_progress)
    search = followed_limits.collocation.limit_curve
    monkeypatch.setattr(followed_limits.collocation, "limit_curve",
                        lambda *given: searched.append(given) or search(*given))  # fmt: skip
    live.diagram({**values, "material.Ktc": 603.0}, "coarse", no_progress)
    assert not searched


def test_only_a_coarse_diagram_that_followed_is_checked():
    live = LiveCase(chatter.load(CASE), "collocation")
    live.diagram({}, "coarse", no_progress)
    # all was searched: nothing is left to look for
    assert live.checked_diagram(no_progress) is None
    for frequency in np.linspace(930.0, 1000.0, 8):
        moved = {"structure.mode[1].frequency": frequency}
        live.diagram(moved, "coarse", no_progress)
    found = live.checked_diagram(no_progress)
    assert found is not None
    assert found["stage"] == "coarse"
    assert live.checked_diagram(no_progress) is None


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"material.Ktc": 1e9}, "out of range"),
        ({"tool.teeth": 2.5}, "not a whole number"),
        ({"material.Ktc": "600 MPa"}, "not a number"),
        ({"material.Ktc": True}, "not a number"),
        ({"material.Ktc": float("nan")}, "not a number"),
        ({"structure.frf": 1}, "no slider"),
        ({"lobes.speeds.from": 25000, "lobes.speeds.to": 5000}, "not below"),
        ([1], "table"),
    ],
)
def test_values_out_of_bounds_are_refused(live, values, said):
    with pytest.raises(InputError, match=said):
        live.diagram(values, "coarse", no_progress)
    with pytest.raises(InputError, match=said):
        live.simulation(values, 2e4, 1.0, no_progress)


@pytest.mark.parametrize("point", [(1e9, 1.0), (2e4, 0.0), (2e4, 1e9), ("x", 1.0), (None, None)])
def test_points_off_the_diagram_are_refused(live, point):
    with pytest.raises(InputError):
        live.simulation({}, *point, no_progress)


def test_a_method_too_slow_is_told():
    with pytest.raises(InputError, match="--method"):
        LiveCase(chatter.load(CASE), "time-domain")


def cuts_of_the_examples():
    """Examples whose case is a cut of a structure."""
    cases = {path.parent.name: chatter.load(path) for path in EXAMPLES.glob("*/case.toml")}
    sections = ("tool", "material", "cut", "structure")
    return sorted(name for name, case in cases.items() if all(getattr(case, s) for s in sections))


@pytest.mark.parametrize("name", cuts_of_the_examples())
def test_every_slider_of_every_example_may_be_moved(name):
    case = chatter.load(EXAMPLES / name / "case.toml")
    for one in case_sliders(case):
        assert one.low <= one.value <= one.high
        for value in (one.low, one.value, one.high):
            # in steps of the slider, numbers are whole where they must be
            case.patch({one.path: one.text(round(value) if one.whole else value)})


def test_coarse_diagram_follows_the_boundary_that_the_fine_one_finds():
    live = LiveCase(chatter.load(CASE), "collocation")
    # one lobe, so that both have the same number of limits at every speed
    values = {"lobes.speeds.from": 15000.0, "lobes.speeds.to": 18000.0, "lobes.depths.to": 3.0}
    coarse, fine = (live.diagram(values, stage, lambda *_: None) for stage in ("coarse", "fine"))
    speeds = coarse["spindle_speed_rpm"]
    limits = [depths[0] for depths in fine["crossings_mm"] if depths]
    wanted = np.interp(
        speeds,
        [s for s, d in zip(fine["spindle_speed_rpm"], fine["crossings_mm"], strict=True) if d],
        limits,
    )
    compared = [
        depths[0] / limit
        for depths, limit in zip(coarse["crossings_mm"], wanted, strict=True)
        if depths
    ]
    assert len(compared) > 60
    assert max(abs(ratio - 1.0) for ratio in compared) < 0.01
    assert coarse["operating"]["stable"] == fine["operating"]["stable"]
    heard = [value for value in coarse["chatter_frequency_Hz"] if value is not None]
    assert all(900.0 < value < 1100.0 for value in heard)


EDGE = {"material.Kte": "27.7 N/mm", "material.Kre": "26.6 N/mm", "cut.feed_per_tooth": "0.015 mm"}


def test_what_edge_forces_leave_open_is_said_as_the_command_says_it():
    """The page named pockets and a stable cut where the command is not certain."""
    case = chatter.load(CASE).patch(EDGE)
    live, told = LiveCase(case, "collocation"), chatter.lobes(case).summary()
    assert not told["operating_point"]["certain"]
    assert not told["pockets"]
    fine = live.diagram({}, "fine", no_progress)
    assert (fine["operating"]["certain"], fine["pockets"]) == (False, [])
    assert any("edge forces" in note for note in fine["notes"])
    # it does not change its mind while a slider moves
    assert not live.diagram({"material.Ktc": 610.0}, "coarse", no_progress)["operating"]["certain"]
    plain = LiveCase(chatter.load(CASE), "collocation").diagram({}, "fine", no_progress)
    assert plain["operating"]["certain"]
    assert plain["pockets"]


def test_friction_of_a_machine_moves_its_limit():
    """At a vibration the friction of a guide damps and stiffens: without it the limit is another.

    The limit without comes from the case whose frictions are left out.
    """
    case = chatter.load(EXAMPLES / "friction-amplitude" / "case.toml")
    live = LiveCase(case, None)

    def lowest(of, **values):
        found = of.diagram(values, "coarse", no_progress)["crossings_mm"]
        return min(one[0] for one in found if one)

    path = "machine.friction.guide.coulomb"
    with_friction, little = lowest(live), lowest(live, **{path: live.by_path[path].low})
    frictionless = {"structure.friction": False, "structure.friction_amplitude": None}
    without = LiveCase(case.patch(frictionless), None)
    assert little == pytest.approx(lowest(without), rel=0.01)
    assert with_friction > 1.1 * little


def test_friction_of_a_motor_is_a_torque():
    case = chatter.load(EXAMPLES / "face-mill-chatter" / "case.toml")
    units = {one.path: one.unit for one in case_sliders(case)}
    assert units["machine.friction.rotation_x.coulomb"] == "N*m"
    assert units["machine.friction.translation_x.coulomb"] == "N"
