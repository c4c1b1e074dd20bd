"""What is stable at any speed is a bound, not the least of some samples."""

import pytest

import chatter
from tests.cases import tool_of_922_hertz


def test_it_does_not_depend_on_the_count_of_speeds():
    """It was 2.145 mm of 200 speeds, 2.108 of another count."""
    found = []
    for count in (37, 60):
        speeds = {"from": "9000 rpm", "to": "12000 rpm", "count": count}
        diagram = chatter.lobes(tool_of_922_hertz(lobes={"speeds": speeds}), "collocation")
        assert diagram.lowest.critical_depth <= diagram.limits.critical_depth.min()
        found.append(diagram.lowest.critical_depth)
    assert found[0] == pytest.approx(found[1], rel=2e-4)
