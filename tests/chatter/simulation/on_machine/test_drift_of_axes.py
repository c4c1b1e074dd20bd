"""Axes that creep under friction are no chatter; what resting friction does to linear limits."""

import pytest

import chatter
from tests.places import EXAMPLES


@pytest.fixture(scope="module")
def case():
    return chatter.load(EXAMPLES / "face-mill-chatter" / "case.toml")


@pytest.mark.parametrize(
    ("depth", "verdict"),
    [("1 mm", "stable"), ("1.5 mm", "stable"), ("2 mm", "stable"), ("5 mm", "chatter")],
)
def test_verdicts_of_a_machine_with_friction(case, depth, verdict):
    found = chatter.simulate(case.patch({"cut.axial_depth": depth})).detection
    assert found.verdict == verdict
    if verdict == "chatter":
        assert found.chatter_frequency == pytest.approx(53.0, abs=2.0)


def test_note_on_resting_friction(case):
    (note,) = [one for one in chatter.check(case).notes if "taken as stuck" in one]
    for said in ("translation_y", "1.46 mm with them stuck", "2.12 mm without them"):
        assert said in note
    assert "structure.friction_amplitude" in note
    for other in ({"structure.friction": False}, {"structure.friction_amplitude": "3 um"}):
        notes = chatter.check(case.patch(other)).notes
        assert not any("taken as stuck" in one for one in notes)
