"""Tests that cannot all be right are named by their rows."""

import pytest

import chatter
from chatter.learning.contradictions import contradictions, one_sided
from chatter.learning.cuts import read_cuts

CASE = """
[tool]
kind = "end mill"
teeth = 2
diameter = "16 mm"
[material]
Ktc = "800 MPa"
Krc = "240 MPa"
[cut]
mode = "down"
spindle_speed = "9000 rpm"
feed_per_tooth = "0.1 mm"
axial_depth = "1 mm"
radial_depth = "8 mm"
[[structure.mode]]
frequency = "900 Hz"
damping = 0.02
stiffness = "6 N/um"
direction = [0, 1, 0]
"""


def measured(tmp_path, *rows, heading="spindle_speed [rpm],axial_depth [mm],stable"):
    (tmp_path / "case.toml").write_text(CASE)
    (tmp_path / "cuts.csv").write_text("\n".join([heading, *rows]) + "\n")
    return read_cuts(tmp_path / "cuts.csv", chatter.load(tmp_path / "case.toml"))


def test_one_cut_judged_both_ways(tmp_path):
    (told,) = contradictions(
        measured(tmp_path, "3000,1,1", "4000,1,1", "3005,1.005,0", "3000,1,stable", "3000,0.5,1")
    )
    assert told.startswith(
        "tests 1, 4 (stable) and 3 (chatter) are one cut, 1 mm and 3000 rpm: one verdict is wrong"
    )


def test_a_stable_cut_deeper_than_one_that_chatters(tmp_path):
    (told,) = contradictions(measured(tmp_path, "3000,1,0", "3000,2,1", "3000,0.5,0", "3500,9,1"))
    assert told == (
        "test 2 is stable at 2 mm and 3000 rpm, deeper than test 3, which chatters at 0.5 mm: is "
        "one verdict wrong?"
    )


@pytest.mark.parametrize(
    ("heading", "rows"),
    [
        ("", ("3000,1,1", "3000,1.2,0", "3050,1,0", "4000,0.3,0")),
        ("", ("3000,1,1", "3000,1,marginal", "3000,1,1")),
        (",feed_per_tooth [mm]", ("3000,1,1,0.05", "3000,1,0,0.2", "3000,1,,0.05")),
        (",cut_time [min]", ("3000,1,1,40", "3000,1,0,0")),
        (",radial_depth [mm]", ("3000,3,1,1", "3000,1,0,8")),
    ],
)
def test_cuts_that_differ_or_were_not_judged_contradict_nothing(tmp_path, heading, rows):
    plain = "spindle_speed [rpm],axial_depth [mm],stable"
    assert contradictions(measured(tmp_path, *rows, heading=plain + heading)) == []


def test_many_contradictions_are_counted(tmp_path):
    rows = [f"{1000 + 100 * k},1,{verdict}" for k in range(6) for verdict in (0, 1)]
    told = contradictions(measured(tmp_path, *rows))
    assert len(told) == 4
    assert told[-1] == "3 more cuts are judged both ways"


def test_a_verdict_that_the_learnt_case_does_not_believe_is_named(tmp_path):
    # half the tooth passing frequency far from the mode: some millimetres at the most are stable
    rows = ["9000,0.2,1", "9000,40,1", "9400,0.3,1", "8700,12,0", "9300,14,0", "9600,10,0"]
    found = chatter.learn(tmp_path / "case.toml", measured(tmp_path, *rows), particles=64)
    (told,) = [note for note in found.notes if note.startswith("test 2, stable at 40 mm")]
    assert "check its verdict and its units" in told
    assert list(found.notes) == found.summary()["notes"]


@pytest.mark.parametrize(
    ("verdicts", "said"),
    [
        ("1111", "all 4 tests are stable: they say that limits are not lower, not how much higher"),
        ("0000", "all 4 tests chatter: they say that limits are not higher, not how much lower"),
        ("1101", None),
        ("11", None),
    ],
)
def test_verdicts_all_alike_bound_limits_from_one_side(tmp_path, verdicts, said):
    rows = [f"{3000 + 500 * k},{1 + k},{verdict}" for k, verdict in enumerate(verdicts)]
    told = one_sided(measured(tmp_path, *rows))
    assert [note[: len(said or "")] for note in told] == ([said] if said else [])
