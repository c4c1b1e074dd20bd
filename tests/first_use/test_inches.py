"""A case that a shop writes in inches is answered in inches; what machines read stays metric.

The numbers expected are what the case states, and conversions by definition: 25.4 mm to the inch,
4.4482216 N to the pound force, 550 ft lbf/s to the horsepower.
"""

import json
import math
import re
from types import SimpleNamespace

import matplotlib.pyplot as plt
import numpy as np
import pytest
import tomlkit

import chatter
from chatter.cli.learn import _print_next_cut
from chatter.description.case import loads
from chatter.description.errors import InputError
from chatter.description.unit_system import INCH, METRIC, unit_at, units_of
from chatter.explain.lobes_before_after import _change
from chatter.plots.simulation import plot_simulation
from chatter.plots.stability_diagram import plot_limits
from chatter.plots.whatif import plot_whatif
from chatter.report.summary_rows import summary_rows
from chatter.studies.bifurcation import bifurcation
from chatter.studies.optimisation.operating_point import OperatingPoint, case_at, rounded
from chatter.studies.whatif.whatif_study import whatif
from tests.command_line import chatter_command

#: half an inch, four flutes, 350 sfm, 2 thou a tooth, 50 thou deep, an eighth wide
HALF_INCH = """\
title = "1/2 in end mill in 4140"
[tool]
teeth = 4
diameter = "1/2 in"
helix = "30 deg"
[material]
Ktc = "300 ksi"
Krc = "100 ksi"
[cut]
mode = "down"
cutting_speed = "350 sfm"
feed_per_tooth = "0.002 ipt"
axial_depth = ".050 in"
radial_depth = "1/8 in"
[structure]
mode = [
    { frequency = "820 Hz", damping = 0.03, stiffness = "90000 lbf/in", direction = "x" },
    { frequency = "875 Hz", damping = 0.03, stiffness = "80000 lbf/in", direction = "y" },
]
[lobes]
method = "zero-order"
speeds = { from = "2000 rpm", to = "6000 rpm", count = 12 }
depths = { to = "0.3 in", count = 40 }
[simulation]
revolutions = 20
"""
#: of the case: 350 ft/min on half an inch
RPM = 350.0 * 12.0 / (math.pi * 0.5)
FEED_RATE = RPM * 4 * 0.002
LARGEST_SINE = math.sin(math.radians(120.0))  # the tooth enters at 120 deg, an eighth wide


@pytest.fixture(scope="module")
def case():
    return loads(HALF_INCH)


@pytest.fixture(scope="module")
def diagram(case):
    return chatter.lobes(case)


@pytest.fixture(scope="module")
def run(case):
    return chatter.simulate(case)


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "shop.toml"
    path.write_text(HALF_INCH, encoding="utf-8")
    return path


def texts_of(figure):
    """All that is written in a figure."""
    return "\n".join(text.get_text() for text in figure.findobj(plt.Text))


# by NIST SP 811, appendix B
@pytest.mark.parametrize(
    ("quantity", "in_si"),
    [
        ("length", 2.54e-2),
        ("feed_per_tooth", 2.54e-2),
        ("cutting_speed", 5.08e-3),
        ("feed_rate", 2.54e-2 / 60.0),
        ("removal_rate", 2.731177e-7),
        ("force", 4.448222),
        ("pressure", 6.894757e6),
        ("line_force", 1.751268e2),
        ("stiffness", 1.751268e2),
        ("displacement", 2.54e-5),
        ("roughness", 2.54e-8),
        ("power", 7.456999e2),
        ("torque", 1.355818),
    ],
)
def test_units_of_a_shop_in_inches(quantity, in_si):
    assert 1.0 / getattr(INCH, quantity).factor == pytest.approx(in_si, rel=1e-6)


def test_a_unit_that_is_read_instead_of_a_metric_one():
    assert INCH.instead_of("mm").text(25.4) == "1 in"
    assert INCH.instead_of("kW").text(0.7456999) == "1 hp"
    assert INCH.instead_of("um", "roughness").text(0.0254) == "1 uin"
    assert INCH.instead_of("Hz") == ("Hz", 1.0)
    assert METRIC.instead_of("µm") == ("µm", 1.0)


def test_values_set_in_si_leave_a_case_in_inches(case):
    assert units_of(case) is INCH
    assert units_of(case.patch({"cut.axial_depth": 0.001})) is INCH
    assert unit_at(case, "cut.axial_depth").text(0.00127) == "0.05 in"


def test_check_is_in_inches(case):
    found = chatter.check(case)
    rows = dict(found.rows())
    assert found.sentences()[0].startswith(f"stable: 0.05 in at {RPM:.6g} rpm")
    assert rows["critical depth"] == f"{found.summary()['critical_depth_mm'] / 25.4:.4g} in"
    assert rows["cutting speed"] == "350 sfm"
    assert rows["feed rate"] == f"{FEED_RATE:.4g} ipm"
    assert rows["width of cut"] == "0.125 in"
    assert rows["thickest chip"] == f"{0.002 * LARGEST_SINE:.3g} in"
    assert " mm" not in " ".join(rows.values())
    shown = texts_of(found.plot())
    assert "axial depth [in]" in shown
    assert "this cut, 0.05 in, stable" in shown


def test_a_deeper_cut_than_the_flutes_is_refused_in_inches(case):
    with pytest.raises(InputError, match=r"0\.7 in is more than tool\.flute_length, 0\.625 in"):
        case.patch({"tool.flute_length": "5/8 in", "cut.axial_depth": "0.7 in"})


def test_lobes_are_in_inches(file, diagram, tmp_path):
    printed = chatter_command("lobes", file, "--out", tmp_path / "out").stdout
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    lowest = summary["lowest_limit"]["critical_depth_mm"]
    assert "depth [in]" in printed
    assert "removal [in^3/min]" in printed
    assert f"lowest limit {lowest / 25.4:.4g} in" in printed
    assert f"operating point {RPM:.0f} rpm, 0.05 in: stable" in printed
    assert " mm" not in printed
    # columns and keys are read by machines
    first = (tmp_path / "out" / "lobes.csv").read_text(encoding="utf-8").splitlines()[0]
    assert "critical_depth [mm]" in first
    assert summary["operating_point"]["axial_depth_mm"] == pytest.approx(1.27)
    assert any(f"lowest limit {lowest / 25.4:.4g} in" in one for one in diagram.sentences())


def test_a_pocket_removes_cubic_inches(diagram):
    """Depth times width times feed rate."""
    pocket = diagram.pockets[0]
    depth, speed = pocket.axial_depth / 0.0254, pocket.spindle_speed * 30.0 / math.pi
    removed = depth * 0.125 * speed * 4 * 0.002
    told = next(one for one in diagram.sentences() if one.startswith("pocket"))
    assert f"pocket: {depth:.4g} in at {speed:.0f} rpm, {removed:.3g} in^3/min" == told


def test_the_picture_of_lobes_is_in_inches(diagram):
    figure = plot_limits(diagram)
    axes = figure.axes[0]
    assert axes.get_ylabel() == "axial depth [in]"
    (point,) = (line for line in axes.lines if line.get_label().startswith("operating point"))
    assert point.get_ydata()[0] == pytest.approx(0.05)
    (limit,) = (line for line in axes.lines if line.get_label().startswith("limit,"))
    drawn = limit.get_ydata()
    assert np.nanmin(drawn) == pytest.approx(diagram.lowest.critical_depth / 0.0254, rel=1e-3)
    assert " mm" not in texts_of(figure)


def test_a_simulated_cut_is_in_pounds_and_thou(file, tmp_path):
    printed = chatter_command("simulate", file, "--out", tmp_path / "out").stdout
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert "peak [lbf]" in printed
    assert f"{summary['peak_force_N']['Fx'] / 4.4482216:.4g}" in printed
    assert f"power {summary['power']['mean_W'] / 745.69987:.4g} hp mean" in printed
    assert f"torque {summary['power']['mean_torque_Nm'] / 1.3558179:.3g} lbf ft mean" in printed
    assert "cutting speed 350 sfm" in printed
    assert f"feed rate {FEED_RATE:.4g} ipm" in printed
    assert f"Ra {summary['roughness']['wall']['Ra_um'] / 0.0254:.3g} uin" in printed
    assert f"displacement {summary['peak_displacement_um'] / 25.4:.3g} mil peak" in printed
    assert " mm" not in printed
    assert " um" not in printed


def test_the_picture_of_a_simulated_cut_is_in_inches(run):
    figure = plot_simulation(run)
    shown = texts_of(figure)
    for label in ("force [lbf]", "displacement [mil]", "amplitude [mil]", "feed [in]", "µin"):
        assert label in shown
    assert "axial depth 0.05 in, feed 0.002 in a tooth" in shown
    assert "mm" not in shown
    assert "[N]" not in shown
    assert "µm" not in shown
    last = next(one for one in figure.axes if one.get_title(loc="left") == "last revolutions")
    drawn = max(np.abs(line.get_ydata()).max() for line in last.lines)
    turned = run.spindle_angle / (2.0 * math.pi)
    shown_rows = run.force[turned >= turned[-1] - 3.0]
    assert drawn == pytest.approx(np.abs(shown_rows).max() / 4.4482216, rel=1e-3)


def test_a_notebook_shows_inches(run):
    rows = dict(summary_rows(run.summary(), run.units))
    assert rows["axial depth [in]"] == "0.05"
    assert rows["cutting speed [sfm]"] == "350"


def test_a_what_if_study_is_in_inches(case):
    study = whatif(case, ["cut.radial_depth=1/8 in, 1/4 in"], "lobes", method="zero-order")
    before, after = (value / 25.4 for value in study.values())
    told = study.sentences()[0]
    assert f"{before:.4g} in -> {after:.4g} in" in told
    assert study.summary()["points"][0]["critical_depth_mm"] == pytest.approx(25.4 * before)
    figure = plot_whatif(study)
    assert figure.axes[0].get_ylabel() == "critical depth [in]"
    assert figure.axes[-1].lines[0].get_ydata() == pytest.approx([before, after])
    assert " mm" not in texts_of(figure)


def test_roughness_of_a_study_is_in_microinches(case):
    study = whatif(case, ["cut.feed_per_tooth=0.002 in"], "surface", quantity="Ra_um")
    assert f"{study.values()[0] / 0.0254:.4g} uin" in study.sentences()[0]


def test_a_bifurcation_diagram_is_over_inches(case):
    found = bifurcation(case, "cut.axial_depth", ["0.02 in", "0.05 in"])
    axes = found.plot().axes
    assert axes[-1].get_xlabel() == "axial depth [in]"
    assert axes[0].get_ylabel() == "x at the Poincaré section [mil]"
    drawn = [line.get_xdata()[0] for line in axes[0].lines if len(line.get_xdata())]
    assert drawn[0] == pytest.approx(0.02)


def test_uncertain_limits_are_in_inches(case):
    uncertain = case.patch({"material.Ktc": "300 +- 15 ksi"})
    found = chatter.uncertainty(uncertain, 10, speeds=3, method="zero-order")
    figure = found.plot()
    assert figure.axes[0].get_ylabel() == "axial depth [in]"
    assert figure.axes[1].get_xlabel() == f"limit at {RPM:.0f} rpm [in]"
    assert any(line.get_xdata()[0] == pytest.approx(0.05) for line in figure.axes[1].lines)


def test_the_next_cut_to_learn_from_is_in_inches(capsys):
    chosen = {
        "axial_depth_mm": 2.54,
        "spindle_speed_rpm": 4000.0,
        "probability_of_stability": 0.8,
        "expected_information_bit": 0.5,
    }
    summary = {"next_cut": chosen, "nothing_left_to_learn": False}
    _print_next_cut(summary, INCH.instead_of("mm"))
    assert "next cut: 0.1 in at 4000 rpm" in capsys.readouterr().out


@pytest.fixture(scope="module")
def optimum(case):
    searched = {
        "optimum.speeds": {"from": "2600 rpm", "to": "2700 rpm"},
        "optimum.depths": {"from": "0.01 in", "to": "0.03 in"},
    }
    return chatter.optimum(case.patch(searched))


def test_the_best_cut_is_in_inches(optimum):
    best, told = optimum.best, optimum.sentences()
    point = best.point
    assert f"{point.axial_depth / 0.0254:.4g} in deep, 0.125 in wide, 0.002 in a tooth" in told[0]
    assert told[0].endswith("in^3/min")
    assert f"{best.power / 745.69987:.3g} hp" in told[1]
    assert f"surface error {best.surface_error / 2.54e-5:.3g} mil" in told[1]
    assert "N m" not in told[1]


def test_candidates_in_python_are_in_inches(optimum):
    """They were in mm a tooth beside sentences in inches."""
    point, shown = optimum.best.point, repr(optimum.best)
    assert f"{point.axial_depth / 0.0254:.4g} in deep, 0.125 in wide, 0.002 in a tooth" in shown
    assert shown.endswith("in³/min>") or shown.endswith("in^3/min>")
    assert "mm" not in shown
    assert "cm" not in shown


def test_the_feed_of_a_program_is_in_inches(case, tmp_path):
    """20 ipm with four flutes at 2674 rpm is a chip of 1.87 thou."""
    (tmp_path / "part.nc").write_text("G20\nG1 X0.5 F20\n", encoding="utf-8")
    program = {"file": str(tmp_path / "part.nc"), "acceleration": 20.0, "jerk": 5000.0}
    run = chatter.simulate(
        case.patch({"simulation.revolutions": None, "simulation.program": program})
    )
    (note,) = [one for one in run.notes if "a tooth" in one and "part.nc" in one]
    assert re.search(r"up to 0\.0018\d* in a tooth;", note)


def test_what_no_cut_keeps_is_told_in_horsepower(case):
    searched = {
        "optimum.speeds": {"from": "2600 rpm", "to": "2700 rpm"},
        "optimum.depths": {"from": "0.02 in", "to": "0.03 in"},
        "optimum.max_power": "0.027 hp",
    }
    why = chatter.optimum(case.patch(searched)).why_nothing
    assert re.search(r"max_power is held nowhere \(smallest .*: 0\.0\d+ hp\)", why)


def test_the_picture_of_the_best_cut_is_in_inches(optimum):
    figure = optimum.plot()
    assert figure.axes[0].get_ylabel() == "axial depth [in]"
    shown = texts_of(figure)
    assert "removal rate [in³/min]" in shown
    assert "0.125 in wide, 0.002 in a tooth" in shown
    assert "mm" not in shown
    star = next(line for line in figure.axes[0].lines if line.get_marker() == "*")
    assert star.get_ydata()[0] == pytest.approx(optimum.best.point.axial_depth / 0.0254)


def test_pitch_angles_are_reported_with_limits_in_inches(case):
    found = chatter.pitch(
        case.patch({
            "tool.teeth": 2,
            "pitch_design.speeds": {"from": "2600 rpm", "to": "2700 rpm"},
        })
    )  # fmt: skip
    lowest = found.best.lowest_limit / 0.0254
    assert f"{lowest:.4g} in" in found.sentences()[0]
    assert not any(" mm" in one for one in found.sentences())
    labels = [axes.get_ylabel() for axes in found.plot().axes]
    assert labels == ["critical depth [in]", "lowest critical depth [in]"]


def test_the_best_cut_is_written_with_the_chip_that_it_was_found_with(case):
    """A case with the rate of the feed kept it at another speed: 1.3 thou in the place of 2."""
    stated = case.patch({"cut.feed_per_tooth": None, "cut.feed_rate": "21 ipm"})
    point = OperatingPoint(1.5 * case.cut.spindle_speed, 0.03 * 0.0254, 0.00254, 5.08e-5, 0.0)
    written = loads(case_at(stated, point).to_toml())
    assert written.cut.feed_per_tooth == pytest.approx(5.08e-5)
    assert written.cut.spindle_speed == pytest.approx(1.5 * case.cut.spindle_speed)
    assert written.stated["cut"]["feed_per_tooth"] == "0.002 in"
    assert written.stated["cut"]["spindle_speed"].endswith(" rpm")


def test_a_programmer_writes_whole_tenths():
    point = OperatingPoint(300.0, 0.08035433 * 0.0254, 0.125 * 0.0254, 5.08e-5, 0.0)
    assert rounded(point, 2.54e-6).axial_depth / 0.0254 == pytest.approx(0.0803, abs=1e-9)
    assert rounded(point, 2.54e-6).radial_depth / 0.0254 == pytest.approx(0.125, abs=1e-9)


@pytest.mark.parametrize(
    ("cut", "said"),
    [
        ({"radial_depth": "0.75 in"}, "0.75 in is more than the diameter of the tool, 0.5 in"),
        ({"mode": "slot"}, '0.125 in is not the diameter, 0.5 in, that mode = "slot" cuts'),
        (
            {"mode": None, "radial_depth": None, "workpiece_width": "1 in", "tool_offset": "2 in"},
            "2 in from the middle of a workpiece 1 in wide the tool of 0.5 in does not reach it",
        ),
        ({"feed_per_tooth": None, "feed_rate": "11000 ipm"}, "cut.feed_rate: 1.1e+04 ipm at 2674"),
    ],
)
def test_widths_and_feeds_that_are_refused_are_in_inches(cut, said):
    """They were in mm where the case had inches."""
    document = tomlkit.parse(HALF_INCH)
    for key, value in cut.items():
        if value is None:
            del document["cut"][key]
        else:
            document["cut"][key] = value
    with pytest.raises(InputError) as error:
        loads(tomlkit.dumps(document))
    assert said in str(error.value)
    assert " mm" not in str(error.value)


def test_lobes_before_and_after_of_explain_are_in_inches():
    """Limits of 2.54 mm that fall to half are 0.1 in and 0.05 in."""
    before, after = (
        SimpleNamespace(spindle_speed=np.array([100.0, 200.0]), critical_depth=depth)
        for depth in (np.array([2.54e-3, 5.08e-3]), np.array([1.27e-3, 5.08e-3]))
    )
    said = _change(before, after, INCH.length)
    assert "from 0.1 to 0.05 in" in said
    assert "(from 0.1 to 0.05 in)" in said
