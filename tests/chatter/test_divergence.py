"""Two runs that begin almost alike: their difference follows the multipliers of the cut."""

import math

import pytest

import chatter
from chatter.example_cases import example
from chatter.simulation.divergence import divergence
from chatter.simulation.setup import modes_of


@pytest.fixture(scope="module")
def case():
    given = chatter.load(example("two-degrees-of-freedom").folder / "case.toml")
    return given.patch({"cut.spindle_speed": "15000 rpm", "simulation.revolutions": 60})


def test_difference_dies_out_with_the_spectral_radius(case):
    stable = case.patch({"cut.axial_depth": "1 mm"})
    radius = chatter.check(stable).spectral_radius
    found = divergence(stable, modes_of(stable)[0])
    assert found.stable
    # two teeth a turn
    assert found.rate == pytest.approx(2.0 * math.log(radius), rel=0.05)


def test_chatter_does_not_forget_the_push(case):
    beyond = case.patch({"cut.axial_depth": "2 mm"})
    found = divergence(beyond, modes_of(beyond)[0])
    assert not found.stable
    wanted = chatter.check(beyond).chatter_frequency
    assert found.frequency == pytest.approx(wanted, rel=0.01)


def test_verdict_under_a_varying_speed(case):
    swing = {"cut.speed_variation": {"amplitude": 0.01, "frequency": "5 Hz"}}
    for depth, verdict in (("1 mm", "stable"), ("2.5 mm", "chatter")):
        varied = case.patch({"cut.axial_depth": depth, **swing})
        assert chatter.simulate(varied).judgement.verdict == verdict
