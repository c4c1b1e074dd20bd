"""Growth rates between depths that all speeds share, and limits found by them."""

import numpy as np
import pytest

import chatter
from chatter.stability.shared_depths import SharedDepths

DEPTHS = np.linspace(0.2e-3, 4e-3, 20)


def smooth(speed, depth):
    return np.log(0.5 + 0.3 * np.sin(speed + 300.0 * depth) + 200.0 * depth)


def bent(speed, depth):
    return np.maximum(400.0 * depth - 0.7, 50.0 * depth - 0.1 * speed)


def shared(growth):
    """Growth rate on shared depths, and the points that it had to ask for one by one."""
    alone = []
    speeds = np.arange(5)

    def at_points(speed, depth):
        alone.extend(depth)
        return growth(speed, depth)

    grid = growth(speeds[:, None], DEPTHS)
    return SharedDepths(grid, DEPTHS, growth, at_points), alone


def points(count):
    random = np.random.default_rng(1)
    return random.integers(0, 5, count), random.uniform(DEPTHS[0], DEPTHS[-1], count)


def test_between_them_a_smooth_one_is_met():
    found, alone = shared(smooth)
    speed, depth = points(200)
    assert np.allclose(found(speed, depth), smooth(speed, depth), atol=2e-6)
    assert not alone


def test_at_a_bend_each_point_is_evaluated():
    found, alone = shared(bent)
    speed, depth = points(200)
    assert np.allclose(found(speed, depth), bent(speed, depth), atol=2e-4)
    assert 0 < len(alone) < 60


def test_off_them_each_point_is_evaluated():
    found, alone = shared(smooth)
    depth = np.array([0.1e-3, 5e-3])
    assert np.allclose(found(np.array([1, 2]), depth), smooth(np.array([1, 2]), depth))
    assert alone == depth.tolist()
    low, high = found.beside(np.array([0.1e-3, 1.01e-3]))
    assert np.isnan(low[0])
    assert low[1] == pytest.approx(1e-3)
    assert high[1] == pytest.approx(1.025e-3)


def test_limits_of_an_inclined_tool_are_those_of_its_converged_multipliers():
    case = chatter.Case.from_dict(
        {
            "tool": {"kind": "ball", "teeth": 2, "diameter": "6 mm", "helix": "30 deg"},
            "material": {"law": "linear", "Ktc": "2200 MPa", "Krc": "900 MPa", "Kac": "200 MPa"},
            "cut": {
                "mode": "down", "spindle_speed": "18000 rpm", "feed_per_tooth": "0.05 mm",
                "axial_depth": "0.2 mm", "stepover": "0.4 mm", "lead": "10 deg", "tilt": "-15 deg",
            },
            "structure": {
                "mode": [
                    {"frequency": "2300 Hz", "damping": 0.015, "stiffness": "3.5 N/um",
                     "direction": "x"},
                    {"frequency": "2350 Hz", "damping": 0.015, "stiffness": "3.3 N/um",
                     "direction": "y"},
                ]
            },
            "lobes": {
                "speeds": {"from": "16000 rpm", "to": "24000 rpm", "count": 11},
                "depths": {"to": "3 mm", "count": 12},
            },
        },
        "inclined ball",
    )  # fmt: skip
    many = chatter.lobes(case).limits
    few = chatter.lobes(case.patch({"lobes.speeds.count": 6})).limits
    assert np.isfinite(few.critical_depth).sum() >= 4
    assert np.allclose(many.critical_depth[::2], few.critical_depth, rtol=1e-3)
    assert np.allclose(
        many.chatter_frequency[::2], few.chatter_frequency, rtol=1e-4, equal_nan=True
    )
    assert many.bifurcation[::2] == few.bifurcation
