"""Numbers and messages are understood at the first reading."""

import math
import re

import numpy as np
import pytest

import chatter
from chatter.description.formatting import to_digits
from chatter.description.unit_system import METRIC
from chatter.report.parameters import parameter_row
from chatter.stability.methods.time_domain.critical_depths import _SimulatedCuts
from chatter.studies.whatif.measures import Curve, Outcome
from chatter.studies.whatif.summary import _is_another_peak
from chatter.studies.whatif.whatif_study import whatif
from tests.command_line import chatter_command
from tests.first_use.shop import cut, written
from tests.places import ROOT


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (143.0, "140"),
        (-99.6, "-100"),
        (100.4, "100"),
        (1.0, "1"),
        (0.0123, "0.012"),
        (7.0e-6, "7e-06"),
        (0.0, "0"),
        (math.inf, "inf"),
    ],
)
def test_two_digits_have_no_exponent(value, shown):
    assert to_digits(value) == shown


def test_no_percentage_or_deviation_is_printed_with_an_exponent():
    """It said "by -1e+02 % of what is predicted", "1900 +- 1.4e+02 MPa"."""
    percent = re.compile(r"\{[^{}]*:[+]?\.2g\} ?%|\+- \{[^{}]*deviation[^{}]*:\.2g\}")
    for path in sorted((ROOT / "chatter").rglob("*.py")):
        if not {"explain", "cutting_coefficients", "cli"} & set(path.parts):
            continue
        found = percent.findall(path.read_text(encoding="utf-8"))
        assert not found, path


@pytest.mark.parametrize(
    ("value", "unit", "row"),
    [
        (1.1736e-05, "m", ["11.74", "um", "5.868 to 23.47"]),
        (2.5e-3, "m", ["2.5", "mm", "1.25 to 5"]),
        (0.68159, "rad", ["39.05", "deg", "19.53 to 78.1"]),
        (25e3, "N/m", ["25", "N/mm", "12.5 to 50"]),
        (12e6, "N/m", ["12", "N/um", "6 to 24"]),
        (700e6, "Pa", ["700", "MPa", "350 to 1400"]),
        (922.0, "Hz", ["922", "Hz", "461 to 1844"]),
    ],
)
def test_parameters_of_effects_are_in_units_of_people(value, unit, row):
    one = {"value": value, "unit": unit, "ci95": [0.5 * value, 2.0 * value]}
    assert parameter_row("offset", one) == ["offset", *row]


def test_the_slope_of_a_frequency_is_read_in_percent_per_thousand_revolutions():
    # 1000 rpm are 104.72 rad/s
    one = {"value": -5.421e-5, "unit": "s/rad", "ci95": [-5.5e-5, -5.3e-5]}
    row = ["slope", "-0.5677", "% per 1000 rpm", "-0.576 to -0.555"]
    assert parameter_row("slope", one) == row


def test_what_was_chosen_is_shown_without_an_interval():
    one = {"value": 2.0, "unit": "", "ci95": None}
    assert parameter_row("power", one) == ["power", "2", "", "chosen"]


def test_tables_of_explain_have_headings():
    """An error table without headings."""
    source = (ROOT / "chatter" / "cli" / "explain.py").read_text(encoding="utf-8")
    assert '["", ""]' not in source


def test_errors_of_compare_have_the_unit_of_their_channel():
    """It said "rms error [SI]"."""
    source = (ROOT / "chatter" / "explain" / "comparison.py").read_text(encoding="utf-8")
    assert "[SI]" not in source
    assert "run,channel,unit,rms error" in source


def test_a_growth_that_no_number_describes_has_no_frequency(tmp_path):
    """A stiffness of 15 N/mm: |mu| of 6e81, "chatter at 0 Hz (quasi-periodic)"."""
    found = chatter.check(cut(**{"structure.mode[0].stiffness": "15 N/mm"}))
    assert found.sentences() == ["chatter: 0.5 mm at 1193.66 rpm"]
    assert any("is 0.015 N/um meant?" in note for note in found.notes)
    assert any("in the wrong unit" in note for note in found.notes)


def test_feeds_are_written_as_people_write_them(tmp_path):
    """380 mm/s: 22800 mm/min, not 2.28e+04, and asked about."""
    result = chatter_command("check", written(tmp_path), "--set", "cut.feed_rate=380 mm/s")
    assert "22800 mm/min" in result.stdout
    # 22800 mm/min over 4 teeth and 1193.66 rpm
    assert "cut.feed_per_tooth: is 4.78 mm meant? that is 30% of the diameter" in result.stderr


@pytest.mark.parametrize(
    ("path", "value", "asked"),
    [
        # a thousandth of what is meant: N/m for N/mm
        ("material.Kte", "25 N/m", "material.Kte: is 0.025 N/mm meant?"),
        ("material.Krc", "7000 MPa", "3.7 times the tangential one"),
        ("tool.runout.offset", "1 mm", "tool.runout.offset: is 1 mm meant?"),
    ],
)
def test_slips_of_a_unit_are_asked_about(path, value, asked):
    from chatter.description.questioned import questions

    (sentence,) = questions(cut(**{path: value}))
    assert asked in sentence
    assert questions(cut()) == []


def outcome(*peaks, highest):
    """FRF with maxima at frequencies, Hz, the one at `highest` above the others."""
    x = np.arange(5.0, 100.0, 0.5)
    y = sum(
        (3.0 if peak == highest else 1.0) * np.exp(-(((x - peak) / 2.0) ** 2)) for peak in peaks
    )
    curve = Curve("receptance", "x", x.tolist(), y.tolist(), "frequency [Hz]")
    numbers = {"highest_peak": 3.0, "peak_frequency_Hz": highest}
    return Outcome(numbers, {"highest": "x"}, (curve,))


def test_another_peak_is_no_change_of_a_frequency():
    """It said "frequency of the highest peak: 18.09 Hz -> 58.93 Hz (3.26 times)"."""
    first, other = outcome(18.0, 59.0, highest=18.0), outcome(18.0, 59.0, highest=59.0)
    assert _is_another_peak(first, other)
    # one peak that moves is the same one
    assert not _is_another_peak(outcome(18.0, highest=18.0), outcome(40.0, highest=40.0))
    assert not _is_another_peak(first, outcome(19.0, 59.0, highest=19.0))


def test_a_study_of_forces_says_where_the_cut_chatters():
    """Forces of a worn tool in a cut that chatters are those of chatter."""
    case = cut(**{"simulation.revolutions": 40})
    deep = whatif(case, ["cut.axial_depth=0.4 mm,2 mm"], result="forces")
    (said,) = (one for one in deep.sentences() if "chatters" in one)
    assert "at cut.axial_depth = 2 mm" in said
    assert "those of chatter" in said
    assert "0.4 mm" not in said


def test_the_reason_of_a_verdict_has_no_change_of_zero(tmp_path):
    """It said "with a change of +0.0% a turn"; and the forces of chatter are no settled cut."""
    out = tmp_path / "out"
    result = chatter_command(
        "simulate", written(tmp_path), "--set", "cut.axial_depth=2 mm", "--out", out
    )
    assert "force on the tool, in chatter" in result.stdout
    assert re.search(r"the motion differs from \w+ to \w+ by \d+% of its rms", result.stdout)
    assert not re.search(r"[+ ]0\.0%", result.stdout)


def test_bifurcation_says_from_where_to_where_with_units(tmp_path):
    """It said "0.0004: chatter"."""
    result = chatter_command(
        "bifurcation", written(tmp_path), "--vary", "cut.axial_depth=0.4 mm..2 mm:3",
        "--set", "simulation.revolutions=40", "--out", tmp_path / "out",
    )  # fmt: skip
    assert "0.4 mm: stable" in result.stdout
    assert "1.2 mm to 2 mm: chatter at " in result.stdout


def test_progress_of_simulated_cuts_never_says_that_all_is_done_before_it_is():
    """It said "all 30 done" while it still computed."""
    reports = []
    cuts = _SimulatedCuts(lambda done, total: reports.append((done, total)), 8)
    for count in (30, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1):
        batch = cuts.more(count)
        for done in range(1, count + 1):
            batch(done, count)
    assert all(done < total for done, total in reports)
    assert [done for done, _ in reports] == list(range(1, 42))
    last = cuts.last(2)
    last(1, 2)
    last(2, 2)
    assert reports[-1][0] == reports[-1][1] == 43


def test_a_sheet_reports_its_speeds_and_says_what_is_not_certain(monkeypatch):
    """It said "0 of 1" for minutes; "stable" where `check` says not certain."""
    reports = []
    case = cut(**{"cut.axial_depth": "0.85 mm", "lobes.method": "collocation"})
    case = case.patch({"lobes.speeds": {"from": "1100 rpm", "to": "1300 rpm", "count": 8}})
    # varied speeds are tried for minutes
    monkeypatch.setattr("chatter.operator_sheet.sheet.variation_that_helps", lambda *_: None)
    found = chatter.sheet(case, lambda done, total: reports.append((done, total)))
    assert len({done for done, _ in reports}) > 3
    # of its last part
    assert reports[-1][0] / reports[-1][1] > 0.5
    assert found.cases[0].cuts[0].verdict == chatter.check(case).verdict == "not certain"


FINISHING = {
    "tool.kind": "ball", "tool.diameter": "10 mm", "cut.stepover": "0.3 mm",
    "cut.axial_depth": "0.3 mm",
}  # fmt: skip


def test_a_finishing_ball_has_the_bound_of_its_limit_in_every_command(tmp_path):
    """Edge forces were weighed at the depth of the cut alone: "not certain", and no pocket."""
    words = [word for key, value in FINISHING.items() for word in ("--set", f"{key}={value}")]
    shown = chatter_command("lobes", written(tmp_path), *words, "--out", tmp_path / "out").stdout
    assert "pockets worth using (80% below the limit" in shown
    found = chatter.sheet(cut(**FINISHING))
    stated = found.cases[0].cuts[0]
    assert stated.verdict == chatter.check(cut(**FINISHING)).verdict == "stable"


def test_where_no_linear_limit_bounds_the_true_one_it_is_said_with_what_computes_it(tmp_path):
    """A chip of a few um: an empty table "100% below the limit"."""
    thin = {**FINISHING, "cut.feed_rate": "100 mm/min"}
    words = [word for key, value in thin.items() for word in ("--set", f"{key}={value}")]
    shown = chatter_command("lobes", written(tmp_path), *words, "--out", tmp_path / "out").stdout
    assert "pockets worth using" not in shown
    assert "no pocket is named: " in shown
    assert "`chatter check --method time-domain`" in shown
    found = chatter.sheet(cut(**thin))
    assert [one.name for one in found.cases[0].cuts] == ["as stated"]


def test_the_documents_have_a_measurement_file():
    """measurement.toml had no example."""
    page = (ROOT / "docs" / "closing-the-loop.md").read_text(encoding="utf-8")
    assert re.search(r'    kind = "milling"\n    case = "case.toml"\n', page)


def test_a_diagram_over_another_value_says_what_check_says_of_edge_forces():
    """`lobes --x` gave limits alone where `check` says that they may be a tenth lower."""
    from chatter.studies.diagram_over_axes import lobes_over

    widths = ("4 mm", "8 mm")
    shares = [
        chatter.check(cut(**{"cut.radial_depth": width})).neglected[0].share for width in widths
    ]
    (note,) = (
        one for one in lobes_over(cut(), "cut.radial_depth=4 mm..8 mm:2").notes if "edge" in one
    )
    assert (
        f"by up to {max(shares):.0%} (cut.radial_depth = {widths[int(np.argmax(shares))]})" in note
    )
    sharp = cut(**{"material.Kte": 0.0, "material.Kre": 0.0})
    assert lobes_over(sharp, "cut.radial_depth=4 mm..8 mm:2").notes == ()


def test_a_folder_above_the_measurement_is_answered_by_the_one_below():
    """The folder of an example: "measurement.toml: cannot be read: No such file or directory"."""
    folder = chatter.examples()["explain-axis"].folder
    result = chatter_command("compare", folder)
    assert result.exit_code == 2
    assert f"there is one in {folder / 'measurement'}" in " ".join(result.stderr.split())


def test_a_folder_without_a_measurement_says_what_it_lacks(tmp_path):
    result = chatter_command("explain", tmp_path)
    assert result.exit_code == 2
    assert "has no measurement.toml, which says what the files are of: kind" in result.stderr


def test_calls_of_the_loop_are_there_in_python():
    """`chatter.compare` and `chatter.explain` were missing."""
    assert callable(chatter.compare)
    assert callable(chatter.explain)
    assert {"compare", "explain"} <= set(dir(chatter))


def test_commands_write_no_json_that_is_not_asked_for(tmp_path):
    shown = chatter_command("check", written(tmp_path)).stdout
    assert "{" not in shown


def test_check_says_which_method_the_verdict_is_by_where_limits_of_two_differ():
    """It said "chatter: 1.05 mm" above a table with a critical depth of 1.1 mm."""
    found = chatter.check(cut(cut__axial_depth="1.05 mm"), method="zero-order")
    assert found.critical_depth > 1.05e-3
    assert not found.stable
    assert any("zero-order would say stable; the verdict is by collocation" in one
               for one in found.notes)  # fmt: skip
    assert ["spectral radius", f"{found.spectral_radius:.4g} by collocation (below 1: stable)"] in (
        found.rows()
    )
    alike = chatter.check(cut(cut__axial_depth="0.5 mm"), method="zero-order")
    assert not any("would say" in one for one in alike.notes)
    own = chatter.check(cut(cut__axial_depth="0.5 mm"), method="collocation")
    assert ["spectral radius", f"{own.spectral_radius:.4g} (below 1: stable)"] in own.rows()


@pytest.mark.parametrize(
    ("wall", "floor", "told"),
    [
        # "floor: -15.5 um too deep"
        (-4.0, -15.5, ("error -4 um (too little removed)", "floor: 15.5 um too high")),
        (4.0, 15.5, ("error 4 um (too much removed)", "floor: 15.5 um too deep")),
    ],
)
def test_the_sign_of_an_error_of_the_surface_is_in_its_words(wall, floor, told):
    from chatter.cli.simulate import _surface

    nothing = {"Ra_um": None}
    summary = {
        "surface_location_error_um": wall,
        "surface_location": {"floor_um": floor},
        "roughness": {"wall": nothing, "floor": nothing},
    }
    lines = _surface(summary, 90.0, METRIC)
    for line, words in zip(lines, told, strict=True):
        assert line.endswith(words)


EXPONENT = re.compile(r"\d[eE][+-]?\d\d")
HEAVY = {
    "tool.diameter": "250 mm", "tool.teeth": "16", "cut.mode": "face",
    "cut.workpiece_width": "180 mm", "cut.axial_depth": "8 mm", "cut.feed_rate": "none",
    "cut.feed_per_tooth": "0.3 mm", "cut.cutting_speed": "1200 m/min",
    "structure.mode[*].stiffness": "9000 N/um", "lobes.speeds": "1000..2000 rpm:30",
}  # fmt: skip


@pytest.mark.parametrize(
    "words",
    [
        ("check",),
        ("lobes",),
        ("simulate", "--set", "structure=none"),
        ("whatif", "--vary", "cut.axial_depth=8 mm, 9 mm", "--set", "structure=none",
         "--result", "forces"),
        ("whatif", "--vary", "structure.mode[*].stiffness=2 N/um, 9000 N/um",
         "--result", "critical depth"),
        ("optimum", "--set", "optimum.depths=1..9 mm:3"),
    ],
)  # fmt: skip
def test_large_numbers_have_no_exponent(words, tmp_path):
    """ "3.74e+3 W", "1.24e+03 cm3/min"."""
    command, *further = words
    sets = [word for key, value in HEAVY.items() for word in ("--set", f"{key}={value}")]
    result = chatter_command(command, written(tmp_path), *sets, *further, "--out", tmp_path / "out")
    assert result.exit_code == 0, result.stderr
    shown = result.stdout + result.stderr.replace(str(tmp_path), "")
    assert not EXPONENT.findall(shown), shown
