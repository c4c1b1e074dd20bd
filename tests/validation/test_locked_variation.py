"""Windows of the ratio of tooth passing to variation in which chatter locks to the variation.

Twice the chatter frequency is there a combination of tooth passing and variation; the limit is some
per cent lower than beside the window, which is about half a tooth wide.
"""

import math

import numpy as np
import pytest

from benchmarks.stability import two_degrees_of_freedom
from chatter.description.progress import no_progress
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.methods.collocation.multipliers import growth_rate_at
from chatter.stability.methods.collocation.varying_limits import limits_of_varying_speed
from chatter.stability.methods.collocation.varying_speed import beside, share_between
from chatter.stability.model import milling_model
from chatter.stability.spindle_rotation import PeriodFit

#: rad/s; two teeth pass 800/9 times in a triangular variation of 6 Hz
SPEED = np.array([16000.0 * math.pi / 30.0])
#: spectral radius by the matrix-free method (`check --method matrix-free`) at two depths, m
MATRIX_FREE = {2.1443943315171637e-4: 0.524763960368682, 2.1877154291235712e-4: 1.8471947960786739}
DEEPEST = 2e-3


@pytest.fixture(scope="module")
def model():
    varied = {"amplitude": 0.2, "frequency": "6 Hz", "shape": "triangle"}
    return milling_model(two_degrees_of_freedom(0.5, speed_variation=varied))


def test_a_limit_in_a_window_is_that_of_another_method(model):
    """Between whole ratios, two and four teeth apart, 0.2271 mm was found."""
    depth, growth = np.array(list(MATRIX_FREE)), np.log(list(MATRIX_FREE.values()))
    expected = np.interp(0.0, growth, depth)
    found = limits_of_varying_speed(
        lambda points, waves: element_cut(model, DEEPEST, points, waves), SPEED,
        np.linspace(0.0, DEEPEST, 101)[1:], no_progress, 1e-3,
    )  # fmt: skip
    assert found.critical_depth[0] == pytest.approx(expected, rel=3e-3)
    assert abs(found.critical_depth[0] / expected - 1.0) < found.error


def test_growth_between_two_ratios_converges_with_the_square_of_their_distance(model):
    """The error of a line is half the curvature times the distances from both ends."""
    cut, depth = element_cut(model, DEEPEST, 5, 1.0), np.array([2.1877e-4])
    exact = growth_rate_at(cut.with_fit(PeriodFit(tuning=1e-9)), SPEED, depth)[0]
    curvature = []
    # the ratios between which 88.889 lies; corners of the triangle have borders of elements
    for tried, low in ((3, 266 / 3), (4, 355 / 4), (5, 444 / 5), (6, 533 / 6)):
        pair = beside(cut, 20, tried)
        share = share_between(pair, SPEED)[0]
        assert share == pytest.approx((800 / 9 - low) / (89 - low))
        fewer, more = (growth_rate_at(one, SPEED, depth)[0] for one in pair)
        error = fewer + share * (more - fewer) - exact
        curvature.append(error / ((800 / 9 - low) * (89 - 800 / 9)))
    assert curvature == pytest.approx(np.full(4, np.mean(curvature)), rel=0.3)
