"""The headline of a recording says how much of it was judged."""

import math

import pytest

from chatter.detection.spectral.segments import Segment
from chatter.monitoring.overall_verdict import durations_of, in_words, verdict_of


def segments(*parts):
    found, begin = [], 0.5
    for verdict, duration in parts:
        end = begin + duration
        found.append(Segment(begin, end, verdict, math.nan, "none", 0.5, 0.1, 50.0, ""))
        begin = end
    return found


@pytest.mark.parametrize(
    ("parts", "verdict"),
    [
        ([("stable", 1.3), ("not judged", 2.7)], "not judged"),
        ([("not judged", 1.0), ("stable", 1.5), ("not judged", 1.0)], "not judged"),
        ([("stable", 2.7), ("not judged", 1.3)], "stable"),
        # what is idle is no part of the cut
        ([("idle", 20.0), ("stable", 1.0), ("not judged", 2.0)], "not judged"),
        ([("idle", 20.0), ("stable", 1.0)], "stable"),
        ([("idle", 20.0)], "idle"),
        ([("stable", 20.0), ("chatter", 0.5), ("not judged", 9.0)], "chatter"),
    ],
)
def test_a_record_is_stable_only_where_more_of_the_cut_is_so_than_is_not_judged(parts, verdict):
    assert verdict_of(segments(*parts)) == verdict


def test_the_words_and_durations_say_how_much_was_judged():
    found = segments(("not judged", 1.0), ("stable", 1.25), ("not judged", 1.75))
    assert in_words(found) == "not judged for 2.75 of 4.00 s, 1.25 s stable"
    assert durations_of(found) == pytest.approx(
        {"chatter": 0.0, "stable": 1.25, "not judged": 2.75, "idle": 0.0}
    )
    assert in_words(segments(("stable", 3.0))) == "stable"
