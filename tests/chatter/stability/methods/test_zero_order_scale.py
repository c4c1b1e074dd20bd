"""Zeroth order of an edge that is not upright: couplings at the depth that they give."""

import math

import numpy as np
import pytest

from chatter.description.case import Case
from chatter.description.progress import no_progress
from chatter.stability.methods.zeroth_order.limits import zero_order_of
from chatter.stability.model import milling_model
from chatter.stability.registry import METHODS

RPM = math.pi / 30.0


def ball(depth):
    """Four teeth, a third of the diameter wide; the case itself cuts at some depth."""
    mode = {"frequency": "900 Hz", "damping": 0.03, "stiffness": "8 N/um"}
    return milling_model(
        Case.from_dict(
            {
                "tool": {"kind": "ball", "teeth": 4, "diameter": "12 mm", "helix": "30 deg"},
                "material": {"Ktc": "1800 MPa", "Krc": "700 MPa", "Kac": "200 MPa"},
                "cut": {
                    "mode": "slot",
                    "spindle_speed": "3000 rpm",
                    "feed_per_tooth": "0.08 mm",
                    "axial_depth": depth,
                },
                "structure": {
                    "mode": [{**mode, "direction": [1, 0, 0]}, {**mode, "direction": [0, 1, 0]}]
                },
            }
        )
    )


def test_lowest_limit_of_a_ball_does_not_depend_on_the_depth_of_the_case():
    speeds = np.linspace(2500, 4500, 120) * RPM
    lowest = [zero_order_of(ball(depth), speeds).critical_depth.min() for depth in (3e-4, 3e-3)]
    assert lowest[0] == pytest.approx(lowest[1], rel=0.06)


def test_lowest_limit_of_a_ball_against_collocation():
    """Four teeth in a slot cut so evenly that the mean says nearly all."""
    model = ball(3e-4)
    speeds = np.linspace(2500, 4500, 60) * RPM
    zero = zero_order_of(model, speeds).critical_depth
    depths = np.linspace(0.0, 2.0 * zero.min(), 31)[1:]
    full = METHODS["collocation"].limits(model, speeds, depths, None, no_progress).critical_depth
    assert zero.min() == pytest.approx(full.min(), rel=0.08)
