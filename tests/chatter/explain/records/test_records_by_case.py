"""Settled records are predicted as the case that was found settles, not the declared one."""

import numpy as np
import pytest

from chatter.description.case import loads
from chatter.explain.checking import checked
from chatter.explain.kinds.kind_list import KINDS
from chatter.explain.records.description import RecordDescription
from chatter.explain.records.steady_cut import steady_cut
from tests.chatter.explain.records.test_anti_alias_filter import behind_a_filter
from tests.chatter.explain.records.test_records import CASE, as_in_the_case, measurement

#: change, over the signal, that is settled
SETTLED = 3e-3


@pytest.fixture(scope="module")
def usable(tmp_path_factory):
    """Records whose cuts settle soon by the case that is declared."""
    case = loads(CASE)
    record = RecordDescription("cut", "unknown", 0.005)
    folder = tmp_path_factory.mktemp("records")
    made = measurement(case, behind_a_filter(4), folder, as_in_the_case, record)
    return checked(made).measurement


def damped(ratio):
    """Case of another damping ratio than the 0.03 that is declared."""
    return loads(CASE).patch({f"structure.mode[{index}].damping": ratio for index in range(2)})


def unsettled(measured, case):
    """Share by which the force of each run differs from that of a hundred revolutions."""
    shares = []
    for run in measured.runs:
        own = run.of(case)
        far = steady_cut(own, 100).force[:200]
        near = steady_cut(own, run.record.revolutions).force[:200]
        shares.append(np.linalg.norm(far - near) / np.linalg.norm(far))
    return np.array(shares)


def test_a_case_of_less_damping_than_declared_is_simulated_for_longer(usable):
    found = damped(0.003)
    assert np.max(unsettled(usable, found)) > 3.0 * SETTLED
    longer = KINDS["milling"].with_records_by(usable, found)
    assert np.max(unsettled(longer, found)) < SETTLED
    # another case that settles sooner shortens nothing, and what is as it was is the same
    assert KINDS["milling"].with_records_by(longer, usable.case) is longer


def test_the_last_fits_have_more_revolutions_than_the_case_found_needs(usable):
    """A fit by cuts that have not settled may have found a damping by which they have."""
    found = damped(0.01)
    longer = KINDS["milling"].with_records_by(usable, found)
    last = KINDS["milling"].refined(usable, found)
    for one, other in zip(last.runs, longer.runs, strict=True):
        assert one.record.revolutions > other.record.revolutions
