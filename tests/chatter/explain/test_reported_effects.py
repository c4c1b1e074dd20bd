"""Probabilities that are stated of effects."""

import math
from types import SimpleNamespace

import pytest

from chatter.explain.reported_effects import probability


def stage(**evidence):
    """Stage of candidates by the logarithms of their evidence over none; the first is the best."""
    tried = [
        SimpleNamespace(effect=SimpleNamespace(name=name), evidence=math.log(odds))
        for name, odds in evidence.items()
    ]
    return SimpleNamespace(evidence=0.0, tried=tried, best=tried[0])


def test_odds_of_six_to_two_and_one_are_two_thirds():
    assert probability(stage(runout=6.0, pitch=2.0), 0.999) == pytest.approx(6.0 / 9.0)


def test_members_of_a_family_count_together():
    two = stage(wear=3.0, pitch=2.0)
    two.tried.append(SimpleNamespace(effect=SimpleNamespace(name="wear"), evidence=math.log(4.0)))
    assert probability(two, 0.999) == pytest.approx(7.0 / 10.0)


def test_no_probability_is_stated_above_that_of_what_is_unknown():
    assert probability(stage(contact=1e6), 0.07) == 0.07
    assert probability(stage(contact=1e6), 0.999) == 0.999
