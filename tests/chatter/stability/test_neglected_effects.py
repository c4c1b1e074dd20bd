"""What linear limits leave out is carried by the verdict itself, in check, lobes and simulate."""

import json
import math

import numpy as np
import pytest

import chatter
from chatter.stability.neglected_effects import NeglectedEffect, deciding
from chatter.stability.pockets import DEPTH_MARGIN, depth_margin, find_pockets
from tests.command_line import chatter_command

CASE = """
[tool]
kind = "end mill"
teeth = 2
diameter = "16 mm"
helix = "30 deg"
[material]
Ktc = "700 MPa"
Krc = "200 MPa"
Kte = "20 N/mm"
Kre = "15 N/mm"
[cut]
mode = "down"
spindle_speed = "4100 rpm"
feed_per_tooth = "0.1 mm"
axial_depth = "3 mm"
radial_depth = "5 mm"
[structure]
mode = [
    { frequency = "900 Hz", damping = 0.03, stiffness = "10 N/um", direction = [1, 0, 0] },
    { frequency = "1000 Hz", damping = 0.03, stiffness = "10 N/um", direction = [0, 1, 0] },
]
[lobes]
speeds = { from = "3000 rpm", to = "6000 rpm", count = 40 }
"""


@pytest.fixture
def case_file(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(CASE, encoding="utf-8")
    return path


def effect(lowest, highest, share=0.2):
    return NeglectedEffect("made up", share, lowest, highest, "because", "note")


SEARCHED = 10.0
LOWER, UNKNOWN, EITHER = effect(0.8, 1.0), effect(0.0, math.inf), effect(0.9, 1.3)


@pytest.mark.parametrize(
    ("effects", "depth", "crossings", "stable", "decides"),
    [
        ((LOWER,), 0.79, (1.0,), True, 0),
        ((LOWER,), 0.81, (1.0,), True, 1),
        # together they leave 0.72 of the limit
        ((LOWER, EITHER), 0.73, (1.0,), True, 2),
        ((LOWER, EITHER), 0.71, (1.0,), True, 0),
        # what can but lower a limit never makes chatter stable
        ((LOWER,), 1.01, (1.0,), False, 0),
        ((LOWER, EITHER), 1.29, (1.0,), False, 1),
        ((LOWER, EITHER), 1.31, (1.0,), False, 0),
        ((UNKNOWN,), 0.01, (1.0,), True, 1),
        ((UNKNOWN,), 0.01, (), True, 1),
        ((LOWER,), 0.01, (), True, 0),
        ((UNKNOWN,), 5.0, (1.0,), False, 1),
        # an island: stable between 2 and 3, whose upper end may be at 2.4
        ((LOWER,), 2.3, (1.0, 2.0, 3.0), True, 0),
        ((LOWER,), 2.5, (1.0, 2.0, 3.0), True, 1),
        ((), 0.5, (1.0,), True, 0),
        # no limit as far as 10: the true one may lie from 8 on
        ((LOWER,), 7.9, (), True, 0),
        ((LOWER,), 8.1, (), True, 1),
        ((LOWER, EITHER), 7.3, (), True, 2),
        ((), 9.9, (), True, 0),
    ],
)
def test_a_verdict_stands_where_no_bound_reaches_the_cut(
    effects, depth, crossings, stable, decides
):
    found = deciding(effects, depth, np.array(crossings), SEARCHED, stable=stable)
    assert len(found) == decides


def test_check_says_that_a_cut_just_below_the_limit_is_not_certain(case_file):
    found = chatter.check(case_file)
    (edge,) = found.neglected
    # down-milled to a chip of zero: half of each edge force over the feed counts, the chip itself
    # over the arc; the closed form of a slot is that of tests/validation
    assert edge.name == "edge forces"
    assert edge.lowest == pytest.approx(1.0 - edge.share)
    limit = found.critical_depth
    at = {share: chatter.check(chatter.load(case_file).patch({"cut.axial_depth": share * limit}))
          for share in (0.8 * edge.lowest, 0.97, 1.02, 1.05 * edge.highest)}  # fmt: skip
    assert [one.verdict for one in at.values()] == [
        "stable", "not certain", "not certain", "chatter",
    ]  # fmt: skip
    unsure = at[0.97]
    assert unsure.stable
    first, reason = unsure.sentences()
    assert first.startswith("stable by the linear analysis, not certain: ")
    assert f"{edge.share:.0%}" in reason
    assert f"{1e3 * limit:.4g} to {1e3 * limit * edge.lowest:.3g} mm" in reason
    assert unsure.summary()["verdict"] == "not certain"
    assert unsure.summary()["neglected_effects"][0]["limit_at_least"] == edge.lowest
    (sure,) = at[0.8 * edge.lowest].sentences()
    assert sure.startswith("stable: ")


def test_without_a_limit_edge_forces_leave_a_share_of_the_depths_searched(case_file):
    """A stated depth of 12 mm was "stable" while the pockets beside it were 2 mm deep."""
    stiff = {f"structure.mode[{name}].stiffness": "80 N/um" for name in ("0", "1")}
    thin = {"cut.feed_per_tooth": "0.022 mm", "lobes.depths": {"to": "25 mm"}, **stiff}
    case = chatter.load(case_file).patch(thin)
    found = chatter.check(case)
    (edge,) = found.neglected
    # mm; limits rise as the stiffness, of which the case itself has an eighth
    known = 8.0 * chatter.lobes(chatter.load(case_file)).zero_order.lowest_depth * 1e3
    assert known > 25.0
    bound = (1.0 - edge.share) * known  # mm, of which the true limit is certain
    assert 0.3 < edge.share < 0.95
    above, below = (
        chatter.check(case.patch({"cut.axial_depth": f"{depth} mm"}))
        for depth in (1.05 * bound, 0.95 * bound)
    )
    assert [above.verdict, below.verdict] == ["not certain", "stable"]
    assert above.lowest_depth == pytest.approx(bound * 1e-3)
    assert f"to {bound:.3g} mm of a limit that lies above {known:.4g} mm" in above.sentences()[1]
    sheet = chatter.sheet(above.case)
    stated, *pockets = sheet.cases[0].cuts
    assert stated.verdict == "not certain"
    assert "no limit was found up to 25 mm" in stated.because
    assert pockets
    assert all(pocket.axial_depth <= bound * (1.0 + 1e-9) for pocket in pockets)
    assert sheet.cases[0].diagram.lowest_depth == pytest.approx(bound * 1e-3)
    row = sheet.summary()["cases"][0]["cuts"][0]
    assert row["not_certain_because"] == stated.because


@pytest.mark.parametrize(("depth", "code"), [("1 mm", 0), ("3.2 mm", 4), ("4 mm", 3)])
def test_exit_code_for_scripts(case_file, depth, code):
    result = chatter_command(
        "check", str(case_file), "--exit-code", "--set", f"cut.axial_depth={depth}"
    )
    assert result.exit_code == code


def test_pockets_keep_what_edge_forces_may_take(case_file):
    small = chatter.load(case_file).patch({"cut.feed_per_tooth": 4e-5})
    usual, more = chatter.lobes(case_file), chatter.lobes(small)
    for diagram in (usual, more):
        (edge,) = diagram.neglected
        assert diagram.depth_margin == pytest.approx(max(DEPTH_MARGIN, edge.share))
        assert diagram.lowest_depth == pytest.approx(
            (1.0 - edge.share) * diagram.lowest.critical_depth
        )
        for pocket in diagram.pockets:
            assert pocket.axial_depth <= (1.0 - edge.share) * pocket.critical_depth
    assert more.depth_margin > usual.depth_margin
    assert depth_margin([effect(0.9, 1.0)]) == DEPTH_MARGIN
    speeds = np.linspace(100.0, 200.0, 101)
    limits = 1e-3 + 1e-3 * np.exp(-(((speeds - 150.0) / 10.0) ** 2))
    (half,) = find_pockets(speeds, limits, 10e-3, 1e-6, depth_margin=0.5)
    (usually,) = find_pockets(speeds, limits, 10e-3, 1e-6)
    assert half.axial_depth == pytest.approx(0.5 / (1.0 - DEPTH_MARGIN) * usually.axial_depth)


def test_lobes_says_it_of_the_operating_point(case_file, tmp_path):
    out = tmp_path / "out"
    arguments = ("--set", "cut.axial_depth=3.2 mm", "--out", str(out))
    result = chatter_command("lobes", str(case_file), *arguments)
    assert "3.2 mm: stable by the linear analysis, not certain" in result.stdout
    share = json.loads((out / "summary.json").read_text())["neglected_effects"][0]["share"]
    assert f"less {share:.0%}: edge forces" in result.stdout
    assert "edge forces may turn this verdict (see the note)" in result.stdout
    assert f"may lower the limit by {share:.0%}, or raise it by as much" in result.stderr
    for depth, words in (("3.2 mm", "stable by the linear"), ("3.4 mm", "chatter by the linear")):
        at = ("--set", f"cut.axial_depth={depth}", "--out", str(out))
        said = chatter_command("lobes", str(case_file), *at)
        assert words in said.stdout
        assert "may lower" not in said.stdout
        assert "may raise" not in said.stdout
    assert json.loads((out / "summary.json").read_text())["operating_point"]["certain"] is False


def test_simulate_names_the_other_verdict_and_the_number_that_decides(case_file, tmp_path):
    limit = chatter.check(case_file).critical_depth
    depth = ("--set", f"cut.axial_depth={0.97 * 1e3 * limit:.4f} mm")
    out = ("--out", str(tmp_path / "out"), "--signals", "none")
    result = chatter_command("simulate", str(case_file), *depth, *out)
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["verdict"] == "chatter"
    linear = summary["linear_analysis"]
    assert linear["verdict"] == "stable"
    assert not linear["agrees"]
    assert linear["spectral_radius"] < 1.0
    share = linear["neglected_effects"][0]["share"]
    assert f"may lower the limit by {share:.0%}" in result.stdout
    deep = chatter_command("simulate", str(case_file), "--set", "cut.axial_depth=1 mm", *out)
    assert "the linear analysis agrees" in deep.stdout


def test_no_depth_beyond_the_search_is_stated(case_file):
    """An end mill with 6 mm of flutes was said to be stable below 7.39 mm."""
    stiff = {f"structure.mode[{name}].stiffness": "1000 N/um" for name in ("0", "1")}
    case = chatter.load(case_file).patch({"tool.flute_length": "6 mm", **stiff})
    found = chatter.check(case)
    assert found.neglected
    assert found.verdict == "stable"
    assert found.lowest_depth == math.inf
    assert chatter.lobes(case).summary()["lowest_limit"]["stable_below_mm"] is None
    assert not any("at least" in row[0] for row in found.rows())
