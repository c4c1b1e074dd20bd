"""How far `optimum` takes a depth back where the time domain does not hold it is said."""

from dataclasses import replace

import pytest

import chatter
from chatter.studies.optimisation.candidate import EASING, EASINGS, TIME_DOMAIN
from tests.first_use.shop import cut


@pytest.fixture(scope="module")
def found():
    return chatter.optimum(
        cut(**{
            "optimum.speeds": {"from": "1000 rpm", "to": "1200 rpm"},
            "optimum.depths": {"from": "0.1 mm", "to": "0.4 mm"},
        })
    )  # fmt: skip


def test_a_depth_that_was_taken_back_says_by_how_much_at_the_most(found):
    """Only "limited by time domain" was said of a cut that was made less deep."""
    best = found.best
    assert not any("taken back" in line for line in found.sentences())
    eased = replace(best, active=(*best.active, TIME_DOMAIN))
    told = replace(found, candidates=(eased,)).sentences()[-1]
    assert f"by {EASING:.0%} a step, {EASING * EASINGS:.0%} at the most" in told


def test_where_none_holds_it_is_said_how_far_down_was_tried(found):
    """ "Nor a little less deep" was said of 18 %."""
    failed = replace(found.best, verification=_chattering())
    why = replace(found, candidates=(failed,)).why_nothing
    assert "nor up to 18% less deep, as far as is tried" in why
    assert "`chatter check --method time-domain` computes the limit that holds" in why


def _chattering():
    from chatter.studies.optimisation.candidate import Verification

    return Verification(
        verdict="chatter", verified=False,
        **{name: 1.0 for name in Verification.__dataclass_fields__
           if name not in ("verdict", "verified")},
    )  # fmt: skip
