"""Edge forces that set in at a chip of zero: closed form, and what they do to limits in time."""

import math

import numpy as np
import pytest

import chatter
from chatter.description.case import Case
from chatter.stability.edge_force_onset import edge_force_onset
from chatter.stability.methods.time_domain.critical_depths import growths
from chatter.stability.model import milling_model

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
