"""Bifurcation diagrams: branches of the Poincaré section, files and wrong ranges."""

import csv
import json
import math

import numpy as np
import pytest

import chatter
from chatter import Case, InputError
from chatter.io.result_tables import csv_text
from chatter.studies.linear_limits import Simulated, linear_limits, spectral_radius_or_nan
from tests.cases import tool_of_922_hertz
from tests.command_line import chatter_command

RPM = math.pi / 30.0


def cut_of(rpm, depth, mode="up", radial_depth="0.8 mm"):
    cut = {"spindle_speed": f"{rpm} rpm", "axial_depth": depth}
    return tool_of_922_hertz(
        cut={**cut, "mode": mode, "radial_depth": radial_depth}, simulation={"revolutions": 160}
    )


def branches(values, tolerance):
    """Number of groups of points that lie further apart than the tolerance."""
    return 1 + int(np.sum(np.diff(np.sort(values)) > tolerance))


def test_flip_opens_two_branches():
    # validation 2.3: period doubling at 3.774048 mm
    depths = np.array([3.5e-3, 3.65e-3, 3.9e-3, 4.1e-3])
    diagram = chatter.bifurcation(cut_of(20000, "3 mm"), "cut.axial_depth", depths)
    assert [point.value for point in diagram.points] == pytest.approx(depths)
    assert [point.verdict for point in diagram.points] == ["stable"] * 2 + ["chatter"] * 2
    for point in diagram.points[:2]:
        assert np.ptp(point.poincare_section[:, 0]) < 1e-3 * 1e-4
        assert math.isnan(point.chatter_frequency)
        assert point.bifurcation == "none"
    for point in diagram.points[2:]:
        x = point.poincare_section[:, 0]
        apart = np.ptp(x)
        assert apart > 1e-6
        assert branches(x, 0.02 * apart) == 2
        # it comes back with every second tooth
        assert np.abs(x[2:] - x[:-2]).max() < 0.01 * apart
        assert np.abs(np.diff(x)).min() > 0.9 * apart
        assert point.bifurcation == "flip"
        assert point.chatter_frequency == pytest.approx(1000.0, rel=1e-3)
    # two branches part like the square root of the way beyond the limit, so the second is wider
    widths = [np.ptp(point.poincare_section[:, 0]) for point in diagram.points[2:]]
    assert widths[0] < widths[1]


def test_hopf_opens_a_band():
    # validation 2.3: Hopf at 1.657701 mm
    depths = [1.2e-3, 1.9e-3]
    diagram = chatter.bifurcation(cut_of(10000, "1 mm"), "cut.axial_depth", depths)
    stable, chattering = diagram.points
    assert stable.verdict == "stable"
    assert np.ptp(stable.poincare_section[:, 0]) < 1e-7
    assert (chattering.verdict, chattering.bifurcation) == ("chatter", "hopf")
    x = chattering.poincare_section[:, 0]
    # the points fill the band: no gap as wide as a fifth of it, and none comes back
    assert np.diff(np.sort(x)).max() < 0.2 * np.ptp(x)
    assert branches(x, 1e-3 * np.ptp(x)) > 20
    assert chattering.chatter_frequency == pytest.approx(931.3, rel=0.01)


def test_speed_may_vary_as_text():
    # validation 2.3: limits of 2.2 mm or more at 10000 rpm, of 0.72 mm at 20000 rpm
    case = cut_of(10000, "1 mm", "down", "8 mm")
    diagram = chatter.bifurcation(case, "cut.spindle_speed", ["10000 rpm", "20000 rpm"])
    assert [point.value for point in diagram.points] == pytest.approx([10000 * RPM, 20000 * RPM])
    assert [point.verdict for point in diagram.points] == ["stable", "chatter"]


def test_tool_that_leaves_the_model_is_chatter_without_points():
    case = cut_of(10000, "1 mm", "down", "8 mm")
    diagram = chatter.bifurcation(case, "cut.axial_depth", [1e-3, 30e-3])
    assert diagram.points[1].verdict == "chatter"
    assert diagram.points[1].poincare_section.shape == (0, 3)
    assert diagram.summary()["points"][1]["chatter_frequency_Hz"] is None


def test_order_of_the_cuts_changes_nothing():
    case = cut_of(20000, "3 mm").patch({"simulation.revolutions": 20})
    there = chatter.bifurcation(case, "cut.axial_depth", [1e-3, 4e-3])
    back = chatter.bifurcation(case, "cut.axial_depth", [4e-3, 1e-3])
    for one, other in zip(there.points, reversed(back.points), strict=True):
        assert np.array_equal(one.poincare_section, other.poincare_section)


@pytest.mark.parametrize(
    ("path", "values", "words"),
    [
        ("cut.axial_depth", [], "no values"),
        ("cut.axial_dept", [1e-3], "axial_depth"),
        ("cut.axial_depth", ["2 kg"], "2 kg"),
        ("cut.axial_depth", [-1e-3], "axial_depth"),
        ("cut.axial_depth", [math.nan], "finite"),
    ],
)
def test_wrong_values(path, values, words):
    with pytest.raises(InputError, match=words):
        chatter.bifurcation(cut_of(20000, "3 mm"), path, values)


def cuts_at(case, path, values, verdicts):
    """Cuts with verdicts as if simulated, and their spectral radii by the linear analysis."""
    radii = [spectral_radius_or_nan(case.patch({path: value})) for value in values]
    return [Simulated(*cut) for cut in zip(values, verdicts, radii, strict=True)]


@pytest.mark.parametrize(("rpm", "limit"), [(20000, 3.774048e-3), (10000, 1.657701e-3)])
def test_limit_of_the_linear_analysis_over_depth(rpm, limit):
    # validation 2.3: flip and Hopf
    depths = [limit - 0.4e-3, limit - 0.1e-3, limit + 0.3e-3]
    case = cut_of(rpm, "1 mm")
    found = linear_limits(
        case,
        "cut.axial_depth",
        cuts_at(case, "cut.axial_depth", depths, ["stable", "stable", "chatter"]),
    )
    assert found.limits == pytest.approx([limit], rel=2e-4)
    assert found.unstable == (pytest.approx((found.limits[0], depths[-1])),)
    assert found.disagreements == ()
    assert found.reason == ""


def test_limit_of_the_linear_analysis_over_speed():
    """At the depth of the limit of 10000 rpm (validation 2.3) stability changes at that speed."""
    case = cut_of(10000, "1.657701 mm")
    speeds = [RPM * rpm for rpm in (9800, 10060)]
    cuts = cuts_at(case, "cut.spindle_speed", speeds, ["not judged"] * 2)
    (limit,) = linear_limits(case, "cut.spindle_speed", cuts).limits
    assert limit / RPM == pytest.approx(10000.0, rel=1e-4)


def test_where_simulation_and_linear_analysis_say_the_opposite():
    case, path = cut_of(10000, "1 mm"), "cut.axial_depth"
    depths = [1.2e-3, 1.4e-3, 1.5e-3, 1.8e-3, 1.9e-3]
    verdicts = ["stable", "chatter", "chatter", "stable", "chatter"]
    below, above = linear_limits(case, path, cuts_at(case, path, depths, verdicts)).disagreements
    assert (below.first, below.last, below.cuts) == (1.4e-3, 1.5e-3, 2)
    assert below.simulated == "chatter"
    assert "says stable" in below.reason
    assert "large vibration goes on where small vibration dies out" in below.reason
    assert (above.first, above.last, above.simulated) == (1.8e-3, 1.8e-3, "stable")
    assert "says chatter" in above.reason
    assert "simulation.revolutions" in above.reason
    assert "large vibration" not in above.reason


def test_edge_forces_are_the_reason_where_they_may_be():
    """A slot begins and ends at a chip of zero, where motion and radial force are along y."""
    slot = {"mode": "slot", "radial_depth": "16 mm", "axial_depth": "1 mm"}
    case = tool_of_922_hertz(((0, 1, 0),), cut=slot, material={"Kre": "6 N/mm"})
    path = "cut.axial_depth"
    cuts = [Simulated(1e-4, "chatter", 0.99), Simulated(9e-3, "stable", 1.01)]
    below, above = linear_limits(case, path, cuts).disagreements
    assert "edge forces that set in at a chip of zero may lower the limit" in below.reason
    assert "edge forces that set in at a chip of zero may raise the limit by" in above.reason
    assert "simulation.revolutions" in above.reason


def test_no_linear_analysis_where_the_engagement_changes():
    path = [["0 mm", "0 mm"], ["9 mm", "0 mm"]]
    case = cut_of(20000, "3 mm").patch({"simulation.path": path, "simulation.chip": "dexel"})
    assert math.isnan(spectral_radius_or_nan(case))
    found = linear_limits(case, "cut.axial_depth", [Simulated(1e-3, "stable", math.nan)])
    assert found.limits == found.unstable == found.disagreements == ()
    assert "engagement changes along the run" in found.reason
    assert "case.toml" not in found.reason


def test_rigid_tool_is_refused():
    document = cut_of(20000, "3 mm").model_dump(by_alias=True, exclude_none=True)
    del document["structure"]
    with pytest.raises(InputError, match="structure"):
        chatter.bifurcation(Case.from_dict(document), "cut.axial_depth", [1e-3])


@pytest.fixture
def case_file(tmp_path):
    path = tmp_path / "case.toml"
    cut_of(20000, "3 mm").save(path)
    return path


def run(case_file, vary, *options):
    out = case_file.parent / "out"
    words = ["bifurcation", case_file, "--vary", vary, "--out", out, *options]
    return chatter_command(*words)


def strict(text):
    def no_constant(name):
        raise AssertionError(f"{name} in the output")

    return json.loads(text, parse_constant=no_constant)


def test_files_of_the_command(case_file, tmp_path):
    result = run(case_file, "cut.axial_depth=3.4 mm..4.2 mm", "--count", "3", "--json")
    assert result.exit_code == 0, result.output
    out = tmp_path / "out"
    assert {path.name for path in out.iterdir()} == {
        "bifurcation.csv",
        "bifurcation.png",
        "result-cache",
        "summary.json",
    }
    assert (out / "bifurcation.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    summary = strict(result.stdout)
    assert summary == strict((out / "summary.json").read_text())
    points = summary["points"]
    assert summary["path"] == "cut.axial_depth"
    assert [point["value"] for point in points] == pytest.approx([3.4e-3, 3.8e-3, 4.2e-3])
    assert [point["verdict"] for point in points][::2] == ["stable", "chatter"]
    assert points[0]["chatter_frequency_Hz"] is None
    assert points[2]["chatter_frequency_Hz"] == pytest.approx(1000.0, rel=1e-3)
    assert [point["spectral_radius"] < 1.0 for point in points] == [True, False, False]
    # validation 2.3
    linear = summary["linear_analysis"]
    assert linear["limits"] == pytest.approx([3.774048e-3], rel=2e-4)
    assert linear["not_taken_because"] is None
    with (out / "bifurcation.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["cut.axial_depth [SI]", "x [um]", "y [um]", "z [um]", "verdict"]
    last = [row for row in rows if float(row["cut.axial_depth [SI]"]) > 4.1e-3]
    x = np.array([float(row["x [um]"]) for row in last])
    assert np.ptp(x) == pytest.approx(points[2]["spread_um"], rel=1e-4)
    assert branches(x, 0.02 * np.ptp(x)) == 2
    assert {row["verdict"] for row in last} == {"chatter"}


def test_onset_is_told(case_file):
    result = run(case_file, 'cut.axial_depth="3.4 mm..4.2 mm"', "--count", "2")
    assert result.exit_code == 0, result.output
    assert "3.4 mm: stable" in result.stdout
    assert "4.2 mm: chatter at 1000.0 Hz (flip)" in result.stdout
    # validation 2.3: 3.774048 mm
    assert "linear analysis (collocation): limit at 3.774 mm" in result.stdout
    assert "says" not in result.stdout


def test_a_range_without_a_limit_is_said_to_have_none(case_file):
    told = run(case_file, "cut.axial_depth=1 mm..1.2 mm", "--count", "2").stdout
    assert "linear analysis (collocation): stable from end to end" in told


def test_the_picture_has_the_limit_of_the_linear_analysis():
    diagram = chatter.bifurcation(cut_of(20000, "3 mm"), "cut.axial_depth", [3.6e-3, 4e-3])
    for panel in diagram.plot().axes:
        (line,) = [one for one in panel.lines if one.get_linestyle() == "--"]
        assert list(line.get_xdata()) == pytest.approx([3.774048] * 2, rel=2e-4)
        (shade,) = panel.patches
        assert shade.get_extents().transformed(panel.transData.inverted()).x0 == pytest.approx(
            3.774048, rel=2e-4
        )
    (legend,) = diagram.plot().legends
    words = {text.get_text() for text in legend.get_texts()}
    shade = "chatter by the linear analysis (collocation)"
    assert words == {shade, "its limit", "stable", "chatter"}


@pytest.mark.parametrize(
    ("vary", "words"),
    [
        ("cut.axial_depth", ["--vary", "FROM..TO"]),
        ("cut.axial_depth=1 mm", ["--vary", "FROM..TO"]),
        ("=1 mm..2 mm", ["--vary", "FROM..TO"]),
        ("cut.axial_dept=1 mm..2 mm", ["--vary", "cut.axial_dept"]),
        ("nothing=1..2", ["--vary", "nothing"]),
        ("cut.axial_depth=1 kg..2 mm", ["--vary", "cut.axial_depth", "kg"]),
        ("cut.axial_depth=1 mm..", ["--vary", "cut.axial_depth"]),
        ("cut.axial_depth=1 mm..nan mm", ["--vary", "cut.axial_depth"]),
        ("cut.axial_depth=-1 mm..2 mm", ["cut.axial_depth"]),
        ("cut.mode=up..down", ["--vary", "cut.mode"]),
        ("title=1..2", ["--vary", "title"]),
        ("structure.mode[7].damping=0.01..0.02", ["structure.mode"]),
    ],
)
def test_wrong_range(case_file, tmp_path, vary, words):
    result = run(case_file, vary, "--count", "2")
    assert result.exit_code == 2, result.output
    assert "fault in chatter" not in result.output
    told = [line for line in result.stderr.splitlines() if line.startswith("chatter: ")]
    assert len(told) == 1, result.stderr
    for word in words:
        assert word in result.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("count", [1, 0, -4, 10**9])
def test_wrong_count(case_file, count):
    result = run(case_file, "cut.axial_depth=1 mm..2 mm", "--count", count)
    assert result.exit_code == 2
    assert "--count" in result.stderr


def test_one_that_was_interrupted_goes_on_where_it_was(tmp_path):
    case, depths = cut_of(20000, "1 mm"), [1e-3, 2e-3, 3e-3, 4e-3]

    def give_up(done, total):
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(chatter.RunError, match="interrupted: 2 of 4 cuts are finished"):
        chatter.bifurcation(case, "cut.axial_depth", depths, folder=tmp_path, progress=give_up)
    told = []
    found = chatter.bifurcation(
        case, "cut.axial_depth", depths, folder=tmp_path, resumed=lambda *at: told.append(at)
    )
    assert told[0][0] >= 2
    assert told[0][1] == 4
    undisturbed = chatter.bifurcation(case, "cut.axial_depth", depths)
    assert csv_text(found.tables()["bifurcation"]) == csv_text(undisturbed.tables()["bifurcation"])
    assert found.summary() == undisturbed.summary()


def test_the_command_ends_with_the_same_bytes_when_given_again(tmp_path):
    tool_of_922_hertz(simulation={"revolutions": 60}).save(tmp_path / "case.toml")
    out = tmp_path / "out"
    words = ("bifurcation", tmp_path / "case.toml", "--vary", "cut.axial_depth=1 mm..2 mm:3")
    assert chatter_command(*words, "--out", out).exit_code == 0
    names = ("summary.json", "bifurcation.csv", "bifurcation.png")
    before = [(out / name).read_bytes() for name in names]
    again = chatter_command(*words, "--out", out)
    assert "3 of 3 cuts were finished before" in again.stderr
    assert [(out / name).read_bytes() for name in names] == before


def test_cuts_that_leave_the_range_of_the_model_are_told_and_marked(tmp_path):
    cut_of(10000, "1 mm").save(tmp_path / "case.toml")
    words = ("bifurcation", tmp_path / "case.toml", "--vary", "cut.axial_depth=1 mm..60 mm:3")
    told = chatter_command(*words, "--out", tmp_path / "out")
    assert "in 2 of 3 cuts, the first at 30.5 mm, the tool left the range" in told.stdout
    points = json.loads((tmp_path / "out" / "summary.json").read_text())["points"]
    assert points[0]["spread_um"] is not None
    assert points[-1]["spread_um"] is None
    diagram = chatter.bifurcation(
        tmp_path / "case.toml", "cut.axial_depth", ["1 mm", "60 mm"], folder=tmp_path
    )
    panel = diagram.plot().axes[0]
    labels = panel.get_legend_handles_labels()[1]
    assert "chatter, the tool left the range of the model" in labels
    assert "chatter" not in labels  # no cut that chatters has a section
    (marked,) = [one for one in panel.lines if "left the range" in str(one.get_label())]
    assert list(marked.get_xdata()) == [60.0]
