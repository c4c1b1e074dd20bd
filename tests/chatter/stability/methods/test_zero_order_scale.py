"""Zeroth order of an edge that is not upright: couplings at the depth that they give."""

import math

import numpy as np
import pytest

from chatter.description.case import Case
from chatter.description.progress import no_progress
from chatter.stability.methods.zeroth_order import limits as limits_module
from chatter.stability.methods.zeroth_order.distinct_delays import limits_of_delays
from chatter.stability.methods.zeroth_order.limits import zero_order_of
from chatter.stability.model import milling_model
from chatter.stability.registry import METHODS
from dynamics.modal.modes import receptance_matrix

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


def test_teeth_of_one_delay_have_the_limits_of_a_uniform_pitch(monkeypatch):
    """400 speeds of a face mill went through every line of the receptance, 1.7 s for 0.1 s."""
    model, speeds = ball(0.4e-3), np.linspace(2500, 4500, 40) * RPM
    delays, means = model.averaged_coefficients
    assert delays == pytest.approx([0.5 * math.pi])
    line_by_line, _ = limits_of_delays(*model.receptance, delays, means, speeds)

    def refused(*_):
        raise AssertionError

    monkeypatch.setattr(limits_module, "limits_of_delays", refused)
    found = limits_module.limits_of_averages(model, (delays, means), speeds)
    assert np.isfinite(found.critical_depth).all()
    assert found.critical_depth == pytest.approx(line_by_line, rel=1e-4)
    # each is where the determinant of the closed loop vanishes
    for speed, depth, frequency in zip(
        speeds, found.critical_depth, found.chatter_frequency, strict=True
    ):
        receptance = receptance_matrix(model.structure.modes, [frequency])[0][:2, :2]
        regenerated = (1.0 - np.exp(-2j * np.pi * frequency * delays[0] / speed)) * means[0]
        assert abs(np.linalg.det(np.eye(2) + depth * receptance @ regenerated)) < 5e-3
