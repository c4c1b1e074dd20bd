"""Axes that creep under friction are no chatter; what resting friction does to linear limits."""

import pytest

import chatter
from tests.places import EXAMPLES


@pytest.fixture(scope="module")
def case():
    return chatter.load(EXAMPLES / "face-mill-chatter" / "case.toml")


@pytest.mark.parametrize(
    ("depth", "verdict"),
    [("0.5 mm", "stable"), ("0.8 mm", "stable"), ("1 mm", "stable"), ("5 mm", "chatter")],
)
def test_verdicts_of_a_machine_with_friction(case, depth, verdict):
    found = chatter.simulate(case.patch({"cut.axial_depth": depth})).detection
    assert found.verdict == verdict
    if verdict == "chatter":
        assert found.chatter_frequency == pytest.approx(53.0, abs=2.0)


def test_note_on_resting_friction(case):
    (note,) = [one for one in chatter.check(case).notes if "frictions of axes at rest" in one]
    for said in ("translation_y", "5 um", "0.734 mm with them stuck", "0.996 mm without them"):
        assert said in note
    stuck = chatter.check(case.patch({"structure.friction_amplitude": "0 um"}))
    (note,) = [one for one in stuck.notes if "frictions of axes at rest" in one]
    assert "taken as stuck" in note
    notes = chatter.check(case.patch({"structure.friction": False})).notes
    assert not any("frictions of axes at rest" in one for one in notes)


@pytest.mark.parametrize("depth", ["1.3 mm"])
def test_lobes_and_time_say_the_same_of_friction(case, depth):
    """It raises the limit: stable with it where it chatters without."""
    with_it = case.patch({"cut.axial_depth": depth, "simulation.duration": "6 s"})
    without = with_it.patch({"structure.friction": False})
    assert chatter.check(with_it).stable
    assert not chatter.check(without).stable
    assert chatter.simulate(with_it).detection.verdict == "stable"
    assert chatter.simulate(without).detection.verdict == "chatter"
