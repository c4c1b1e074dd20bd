"""Nothing is silent for long."""

import numpy as np
import pytest

import chatter
from chatter.stability.lowest_limit import lowest_limit
from chatter.stability.model import milling_model
from chatter.stability.registry import METHODS
from tests.cases import tool_of_922_hertz
from tests.places import EXAMPLES


def test_multi_frequency_reports_as_it_goes():
    """A check by many frequencies ran 100 s without a word at 600 rpm."""
    reports = []
    case = tool_of_922_hertz(lobes={"method": "multi-frequency"})
    chatter.check(case, progress=lambda done, total: reports.append((done, total)))
    assert len({done for done, _ in reports}) > 3
    assert all(done <= total for done, total in reports)


class Parts:
    """Reports of a run by the part of the work that they are of."""

    def __init__(self):
        self.names, self.reports = ["limits"], {"limits": []}

    def begin(self, name):
        self.names.append(name)
        self.reports[name] = []

    def __call__(self, done, total):
        self.reports[self.names[-1]].append((done, total))


def inclined_ball(**lobes):
    return tool_of_922_hertz(
        ((1, 0, 0), (0, 1, 0)),
        material={"Ktc": "2000 MPa"},
        tool={"kind": "ball", "teeth": 2, "diameter": "10 mm"},
        cut={
            "mode": "down", "spindle_speed": "8000 rpm", "feed_per_tooth": "0.1 mm",
            "axial_depth": "0.5 mm", "stepover": "0.4 mm", "lead": "15 deg", "radial_depth": None,
        },
        lobes=lobes,
    )  # fmt: skip


def test_what_follows_the_limits_of_an_inclined_tool_is_named_and_counted():
    """Two minutes went by after "all 34 done": the lowest limit was searched without a word."""
    parts = Parts()
    speeds = {"from": "6000 rpm", "to": "9000 rpm", "count": 4}
    depths = {"to": "2 mm", "count": 12}
    chatter.lobes(inclined_ball(speeds=speeds, depths=depths), progress=parts)
    assert parts.names[1:] == [
        "what linear methods leave out", "limit at the speed of the cut",
        "lowest limit between the speeds",
    ]  # fmt: skip
    for name in (parts.names[0], *parts.names[2:]):
        reports = parts.reports[name]
        assert len(reports) > 3, name
        assert all(0 <= done <= total for done, total in reports)
        assert reports[-1][0] == reports[-1][1]


def test_the_lowest_limit_is_looked_for_no_deeper_than_it_may_lie():
    """Every round went through all depths, most of them far above the lowest limit."""
    model, depths = milling_model(tool_of_922_hertz()), np.linspace(0.2e-3, 20e-3, 100)
    speeds, asked = np.linspace(500.0, 900.0, 9), []

    class Asked:
        name, is_linear = "collocation", True

        def limits(self, *arguments):
            asked.append(arguments[2])
            return METHODS["collocation"].limits(*arguments)

    curve = METHODS["collocation"].limits(model, speeds, depths, None, lambda done, total: None)
    found = lowest_limit(Asked(), model, curve, depths)
    assert found.critical_depth <= curve.critical_depth.min()
    assert len(asked) == 2
    for given in asked:
        assert found.critical_depth < given[-1] < 0.5 * depths[-1]
    whole = METHODS["collocation"].limits(
        model, np.array([found.spindle_speed]), depths, None, lambda done, total: None
    )
    assert whole.critical_depth[0] == pytest.approx(found.critical_depth, rel=1e-9)


@pytest.mark.parametrize("call", [chatter.check, chatter.lobes])
def test_what_is_done_on_a_machine_first_is_named(call):
    """Ten seconds of assembling a machine were called "critical depth at this speed"."""
    parts = Parts()
    call(EXAMPLES / "friction-amplitude" / "case.toml", progress=parts)
    assert parts.names[1] == "machine: structure, frictions and loops"
    assert len(parts.names) > 3
