"""Coefficients of a tool that wears: by rate, with an end, and at once."""

import math

import numpy as np
import pytest

from chatter.compile.cutter import force_law, process_damping_of
from chatter.description.case import loads

CASE = """
[tool]
kind = "end mill"
teeth = 4
diameter = "16 mm"
[material]
law = "linear"
Ktc = "800 MPa"
Krc = "200 MPa"
Kte = "20 N/mm"
Kre = "30 N/mm"
[cut]
mode = "down"
spindle_speed = "3000 rpm"
feed_per_tooth = "0.1 mm"
axial_depth = "1 mm"
radial_depth = "8 mm"
[process_damping]
coefficient = "4e4 N/m"
[wear]
"""


def growths(wear: str, cut_time: float) -> tuple[float, float, float]:
    """Shares by which Ktc and process damping have grown, and what Kte gained, N/mm."""
    case = loads(CASE + wear).patch({"cut.cut_time": cut_time})
    law = force_law(case, 0.0)
    damping = process_damping_of(case).coefficient
    return law.cutting[0] / 8e8 - 1.0, damping / 4e4 - 1.0, law.edge[0] * 1e-3 - 20.0


def test_cutting_and_damping_grow_at_their_rates():
    wear = "cutting = 2e-4\nprocess_damping = 1e-3\n"
    assert growths(wear, 1000.0) == pytest.approx((0.2, 1.0, 0.0), abs=1e-12)


def test_growth_ends_where_wear_saturates():
    wear = 'cutting = 2e-4\nprocess_damping = 1e-3\nsaturation_time = "500 s"\n'
    share = 1.0 - math.exp(-2.0)
    assert growths(wear, 1000.0) == pytest.approx((0.1 * share, 0.5 * share, 0.0), abs=1e-12)


def test_a_chipped_edge_grows_at_once():
    wear = (
        'cutting = 1e-4\n[wear.chipping]\ntime = "600 s"\ncutting = 0.3\nprocess_damping = 2.0\n'
        'edge_tangential = "5 N/mm"\n'
    )
    assert growths(wear, 599.0) == pytest.approx((0.0599, 0.0, 0.0), abs=1e-12)
    assert np.asarray(growths(wear, 600.0)) == pytest.approx((0.36, 2.0, 5.0), abs=1e-12)
