"""Edge forces that set in at a chip of zero: closed form, and what they do to limits in time."""

import math

import numpy as np
import pytest

import chatter
from chatter.description.case import Case
from chatter.description.progress import no_progress
from chatter.stability.edge_force_onset import edge_force_onset, lowest_limit_with_onset
from chatter.stability.forced_vibration import neglected_in_steady_cut
from chatter.stability.methods.time_domain.critical_depths import growths
from chatter.stability.model import milling_model
from chatter.stability.registry import METHODS
from tests.first_use.shop import cut
from tests.first_use.test_words import FINISHING

RPM = math.pi / 30.0
KTC, KRC, KTE, KRE, FEED = 700e6, 200e6, 20e3, 15e3, 1e-4


def slot(**tool):
    """Slot along the feed axis alone, so that both stiffnesses are single numbers."""
    return Case.from_dict(
        {
            "tool": {"teeth": 2, "diameter": 16e-3, "helix": 0.0, **tool},
            "material": {"Ktc": KTC, "Krc": KRC, "Kte": KTE, "Kre": KRE},
            "cut": {
                "mode": "slot", "spindle_speed": 4100 * RPM, "feed_per_tooth": FEED,
                "axial_depth": 1e-3,
            },
            "structure": {
                "mode": [
                    {"frequency": 900, "damping": 0.03, "stiffness": 1e7, "direction": [0, 1, 0]},
                ]
            },
        }
    )  # fmt: skip


def test_of_a_slot_is_the_closed_form():
    # normal to the feed, y: chip by cos(phi); force on y by Kt sin(phi) - Kr cos(phi).
    # chip: integral over 0..pi of (Kt s - Kr c) c = -Kr pi/2; edge: at 0 and pi, where sin is
    # zero, Kr cos(phi) cos(phi) / feed each, half of it
    case = slot()
    expected = (2 * 0.5 * KRE / FEED) / (KRC * math.pi / 2)
    assert edge_force_onset(milling_model(case), 1e-3) == pytest.approx(expected, rel=2e-3)


def test_is_none_without_edge_forces_and_falls_with_the_feed():
    case = slot()
    without = case.patch({"material.Kte": 0.0, "material.Kre": 0.0})
    assert edge_force_onset(milling_model(without), 1e-3) == 0.0
    fed = case.patch({"cut.feed_per_tooth": 3 * FEED})
    one, three = (edge_force_onset(milling_model(each), 1e-3) for each in (case, fed))
    assert three == pytest.approx(one / 3, rel=1e-6)


def finishing_ball(depth):
    """A ball whose edge forces are stiffer than the thin chip of its depth of cut, m."""
    return slot(kind="ball", diameter=10e-3).patch(
        {"material.Kre": 5e3, "cut.axial_depth": depth, "cut.feed_per_tooth": 0.06e-3}
    )


def test_bound_of_a_limit_is_where_edge_and_chip_reach_it_together():
    """Their stiffness at the bound is 1 - s^2 of the chip at the limit, with the share s there."""
    model, limit = milling_model(finishing_ball(0.3e-3)), 3e-3
    bound = lowest_limit_with_onset(model, limit)
    assert 0.2 * limit < bound < 0.9 * limit

    def chip(depth):
        """Of the ball along y, relative: integral over the edge of sin(kappa)^2 d(length)."""
        kappa = math.acos(1.0 - depth / 5e-3)
        return 0.5 * (kappa - 0.5 * math.sin(2.0 * kappa))

    share = [edge_force_onset(model, depth) for depth in (bound, limit)]
    reached = chip(bound) * (1.0 + share[0]) / chip(limit)
    assert reached == pytest.approx(1.0 - share[1] ** 2, rel=0.02)


def test_bound_of_a_cylinder_is_its_share_off_the_limit():
    case = slot().patch({"cut.feed_per_tooth": 3 * FEED})
    model = milling_model(case)
    share = edge_force_onset(model, 1e-3)
    assert lowest_limit_with_onset(model, 2e-3) == pytest.approx(2e-3 * (1.0 - share), rel=2e-3)


def test_bound_of_a_finishing_ball_is_that_of_its_limit_not_of_its_shallow_cut():
    """Edge forces 1.15 times as stiff as the thin chip at 0.3 mm: the limit lies at 4.8 mm."""
    case = cut(**FINISHING)
    found = chatter.check(case, method="collocation")
    assert found.verdict == "stable"
    (edge,) = found.neglected
    assert found.lowest_depth == pytest.approx(found.critical_depth * (1.0 - edge.share))
    speed, depths = np.full(2, case.cut.spindle_speed), np.array([found.lowest_depth, 4e-3])
    radius = METHODS["time-domain"].radius(milling_model(case), speed, depths, None, no_progress)
    # the limit in time lies between both
    assert radius[0] < 0.95
    assert radius[1] > 1.0


def test_without_a_limit_the_share_says_the_depth_that_it_is_for():
    """`simulate` gave 1.15, of the thin cut, where `check` gave 0.80, of its limit."""
    case = cut(**FINISHING)
    model, method = milling_model(case), METHODS["collocation"]
    (of_cut,) = neglected_in_steady_cut(model, method)
    assert of_cut.share == pytest.approx(edge_force_onset(model, case.cut.axial_depth))
    # what it leaves of a limit that was not looked for is not known
    assert of_cut.lowest == 0.0
    assert of_cut.because.endswith(
        f"{of_cut.share:.3g} times as stiff as the chip at 0.3 mm, the depth of the cut "
        "(at the limit by `chatter check`)"
    )
    limit = chatter.check(case, method="collocation").limit.critical_depth
    (at_limit,) = neglected_in_steady_cut(model, method, limit)
    assert "0.3 mm" not in at_limit.because
    assert at_limit.because.endswith(f"may lower the limit by {at_limit.share:.0%}")


@pytest.mark.parametrize("edge", [True, False])
def test_time_domain_grows_below_the_linear_limit_as_the_note_says(edge):
    case = slot(helix=math.radians(30)).patch(
        {
            "cut.mode": "down",
            "cut.radial_depth": 5e-3,
            "cut.axial_depth": 3e-3,
            "structure.mode": [
                {"frequency": 900, "damping": 0.03, "stiffness": 1e7, "direction": [1, 0, 0]},
                {"frequency": 1000, "damping": 0.03, "stiffness": 1e7, "direction": [0, 1, 0]},
            ],
        }
    )
    if not edge:
        case = case.patch({"material.Kte": 0.0, "material.Kre": 0.0})
    limit = chatter.check(case).critical_depth
    deep = case.patch({"cut.axial_depth": 0.95 * limit})
    model = milling_model(deep)
    speed = np.array([deep.cut.spindle_speed])
    (grown,) = growths(deep, model.structure.modes, speed, np.array([0.95 * limit]))
    told = [note for note in chatter.check(deep).notes if "edge forces set in" in note]
    assert (grown.radius > 1.0) == edge
    assert len(told) == edge


def test_edge_forces_may_raise_a_limit_of_period_doubling():
    """The time domain is stable 5 % above it; beyond 1 plus their share it grows again."""
    rpm = 19412.0
    case = slot(teeth=3, diameter=12e-3, helix=math.radians(30)).patch(
        {
            "material": {"Ktc": 900e6, "Krc": 300e6, "Kte": 12e3, "Kre": 9e3},
            "cut": {
                "mode": "up", "spindle_speed": rpm * RPM, "feed_per_tooth": 0.1e-3,
                "axial_depth": 1e-3, "radial_depth": 6e-3,
            },
            "structure.mode": [
                {"frequency": 920, "damping": 0.02, "stiffness": 5e6, "direction": [0, 1, 0]},
            ],
        }
    )  # fmt: skip
    found = chatter.check(case)
    (edge,) = found.neglected
    assert found.limit.bifurcation == ("flip",)
    limit = found.critical_depth
    above, beyond = 1.05 * limit, 1.05 * edge.highest * limit
    model, speeds = milling_model(case.patch({"cut.axial_depth": above})), np.full(2, rpm * RPM)
    grown = growths(model.case, model.structure.modes, speeds, np.array([above, beyond]))
    assert grown[0].radius < 0.99
    assert grown[1].radius > 1.01
    of_above, of_beyond = (
        chatter.check(case.patch({"cut.axial_depth": depth})) for depth in (above, beyond)
    )
    assert not of_above.stable
    assert (of_above.verdict, of_beyond.verdict) == ("not certain", "chatter")
    reason = of_above.sentences()[1]
    assert f"may raise the limit by {edge.share:.0%}, from {1e3 * limit:.4g} to " in reason
