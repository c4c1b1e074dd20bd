"""Properties that limits of any cut have: scaling laws, time scale, units, sense of directions.

`CHATTER_PROPERTIES=2500 pytest tests/validation/test_properties.py` draws 10 000 cases in place of
200 (`make nightly`). The zeroth-order solution is a closed form over the same description, arrays
and coefficients that every method starts from, so that a wrong unit or sign there shows.
"""

import math
import os

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import chatter
from tests.cases import tool_of_922_hertz

COUNT = int(os.environ.get("CHATTER_PROPERTIES", "50"))
drawn = settings(max_examples=COUNT, deadline=None, suppress_health_check=[HealthCheck.too_slow])

MODES = st.fixed_dictionaries(
    {
        "frequency": st.floats(50.0, 3000.0),
        "damping": st.floats(0.005, 0.1),
        "stiffness": st.floats(1e6, 1e8),
        "angle": st.floats(0.0, math.pi),
    }
)
CUTS = st.fixed_dictionaries(
    {
        "teeth": st.integers(1, 8),
        "mode": st.sampled_from(["up", "down"]),
        "immersion": st.floats(0.1, 1.0),
        "Ktc": st.floats(2e8, 4e9),
        "ratio": st.floats(0.05, 1.0),
        "speed": st.floats(100.0, 2000.0),
        "modes": st.lists(MODES, min_size=1, max_size=3),
    }
)


def case_of(cut, *, stiffness=1.0, pressure=1.0, length=1.0, pace=1.0, turned=1.0):
    """Case of what was drawn; stiffness, cutting pressure, lengths and frequencies by factors."""
    diameter = 0.016 * length
    modes = [
        {
            "frequency": one["frequency"] * pace,
            "damping": one["damping"],
            "stiffness": one["stiffness"] * stiffness,
            "direction": [turned * math.cos(one["angle"]), turned * math.sin(one["angle"]), 0.0],
        }
        for one in cut["modes"]
    ]
    return tool_of_922_hertz(
        tool={"teeth": cut["teeth"], "diameter": diameter},
        material={"Ktc": cut["Ktc"] * pressure, "Krc": cut["ratio"] * cut["Ktc"] * pressure},
        cut={
            "mode": cut["mode"],
            "spindle_speed": cut["speed"] * pace,
            "feed_per_tooth": 1e-4 * length,
            "axial_depth": 1e-3 * length,
            "radial_depth": cut["immersion"] * diameter,
        },
        structure={"mode": modes},
    )


def limit(case):
    """Critical depth, m, infinite where there is none; its frequency, Hz; the depth searched, m."""
    checked = chatter.check(case, method="zero-order").summary()
    depth, frequency = checked["critical_depth_mm"], checked["chatter_frequency_Hz"]
    searched = 1e-3 * checked["limit"]["max_axial_depth_mm"]
    return (math.inf if depth is None else 1e-3 * depth), frequency, searched


def assert_same(first, second, scale=1.0):
    """Limits agree, the second being that of the first times a scale, as far as both searched."""
    searched = min(first[2] * scale, second[2]) * (1.0 - 1e-3)
    depth, other = (math.inf if one > searched else one for one in (first[0] * scale, second[0]))
    at_the_end = abs(min(depth, other) - searched) < 2e-3 * searched
    assert at_the_end or other == pytest.approx(depth, rel=1e-3)


@drawn
@given(CUTS, st.floats(0.3, 3.0), st.floats(0.3, 3.0))
def test_limit_is_a_stiffness_over_a_pressure(cut, stiffness, pressure):
    """Dimension analysis: b = k/K f(all that has no dimension)."""
    other = limit(case_of(cut, stiffness=stiffness, pressure=pressure))
    assert_same(limit(case_of(cut)), other, scale=stiffness / pressure)


@drawn
@given(CUTS, st.floats(0.3, 3.0))
def test_a_cut_twice_as_fast_on_a_structure_twice_as_fast_has_the_same_limit(cut, pace):
    first, second = limit(case_of(cut)), limit(case_of(cut, pace=pace))
    assert_same(first, second)
    if math.isfinite(first[0]) and first[1] and second[1]:
        assert second[1] == pytest.approx(first[1] * pace, rel=1e-3)


@drawn
@given(CUTS, st.floats(0.3, 3.0))
def test_limit_of_a_linear_law_depends_on_no_length(cut, length):
    """Diameter, width and feed scale together: the engagement stays."""
    assert_same(limit(case_of(cut)), limit(case_of(cut, length=length)))


@drawn
@given(CUTS)
def test_sense_of_a_direction_and_order_of_modes_do_not_matter(cut):
    back = {**cut, "modes": cut["modes"][::-1]}
    assert_same(limit(case_of(cut)), limit(case_of(back, turned=-1.0)))
