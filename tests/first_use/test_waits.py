"""Nothing is silent for long."""

import chatter
from tests.cases import tool_of_922_hertz


def test_multi_frequency_reports_as_it_goes():
    """A check by many frequencies ran 100 s without a word at 600 rpm."""
    reports = []
    case = tool_of_922_hertz(lobes={"method": "multi-frequency"})
    chatter.check(case, progress=lambda done, total: reports.append((done, total)))
    assert len({done for done, _ in reports}) > 3
    assert all(done <= total for done, total in reports)
