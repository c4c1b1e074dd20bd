"""Cutting coefficients against records that were made by formulas of their own."""

import json
import math

import numpy as np
import pytest

import chatter
from chatter.compile.cutter import force_law
from chatter.description.case import load
from chatter.description.errors import InputError
from tests.command_line import chatter_command

TEETH, RADIUS, DEPTH, SPEED = 3, 6e-3, 2e-3, 50.0
TRUE = {"Ktc": 1100e6, "Krc": 350e6, "Kac": 180e6, "Kte": 18e3, "Kre": 25e3, "Kae": 5e3}
CASE = """
[tool]
kind = "end mill"
teeth = 3
diameter = "12 mm"
helix = "30 deg"
[cut]
mode = "{mode}"
{width}
spindle_speed = "3000 rpm"
feed_per_tooth = "0.05 mm"
axial_depth = "2 mm"
"""


def waveform(time, feed, arc, power=1.0, radial_power=1.0, axial_power=1.0):
    """Forces on the tool (n, 3), each disc of the edge and each tooth summed; feed in m."""
    forces = np.zeros((time.size, 3))
    discs = 200
    lag = math.tan(math.radians(30.0)) * DEPTH / RADIUS
    for tooth in range(TEETH):
        for disc in range(discs):
            angle = np.mod(
                2.0 * math.pi * (SPEED * time + tooth / TEETH) - lag * (disc + 0.5) / discs + 0.4,
                2.0 * math.pi,
            )
            cuts = (angle > arc[0]) & (angle < arc[1])
            chip = np.where(cuts, feed * np.sin(angle), 0.0)
            h = np.maximum(chip, 1e-12) / 1e-4
            ft = (TRUE["Ktc"] * 1e-4 * h**power + TRUE["Kte"]) * cuts
            fr = (TRUE["Krc"] * 1e-4 * h**radial_power + TRUE["Kre"]) * cuts
            fa = (TRUE["Kac"] * 1e-4 * h**axial_power + TRUE["Kae"]) * cuts
            width = DEPTH / discs
            # Altintas 2012, eq. 2.31: feed along x, angle clockwise from +y
            forces[:, 0] += (-ft * np.cos(angle) - fr * np.sin(angle)) * width
            forces[:, 1] += (ft * np.sin(angle) - fr * np.cos(angle)) * width
            forces[:, 2] += fa * width
    return forces


FEEDS = (0.03, 0.06, 0.09, 0.12)  # mm a tooth


def records(folder, arc, mode, width="", channels="", senses=(1, 1, 1), feeds=FEEDS, **law):
    random = np.random.default_rng(5)
    (folder / "case.toml").write_text(CASE.format(mode=mode, width=width), encoding="utf-8")
    runs = []
    time = np.arange(0.0, 0.4, 1e-4)
    for feed in feeds:
        forces = waveform(time, 1e-3 * feed, arc, **law) * np.array(senses)
        forces += random.standard_normal(forces.shape) * 3.0
        file = f"feed_{feed}.csv"
        np.savetxt(
            folder / file, np.c_[time, forces], delimiter=",", comments="",
            header="time [s],Fx [N],Fy [N],Fz [N]",
        )  # fmt: skip
        runs.append(f'[[run]]\nfile = "{file}"\nfeed_per_tooth = "{feed} mm"\n')
    (folder / "measurement.toml").write_text(
        'kind = "milling"\ncase = "case.toml"\n' + channels + "".join(runs), encoding="utf-8"
    )
    return folder


UP = (0.0, math.acos(1.0 - 3e-3 / RADIUS))
UP_CUT = {"arc": UP, "mode": "up", "width": 'radial_depth = "3 mm"'}


def in_si(summary):
    factors = {"MPa": 1e6, "N/mm": 1e3}
    return {one["name"]: one["value"] * factors[one["unit"]] for one in summary["coefficients"]}


@pytest.mark.parametrize(
    "cut", [{"arc": (0.0, math.pi), "mode": "slot"}, UP_CUT], ids=["slot", "up"]
)
def test_coefficients_of_a_linear_law_come_back(tmp_path, cut):
    found = chatter.coefficients(records(tmp_path, **cut))
    summary = found.summary()
    assert summary["law"] == "linear"
    assert summary["linear_law_holds"]
    values = in_si(summary)
    for key, true in TRUE.items():
        assert values[key] == pytest.approx(true, rel=0.02 if key[2] == "c" else 0.04)
    assert max(summary["holdout_error"].values()) < 0.02


def test_what_is_written_is_a_section_of_a_case(tmp_path):
    found = chatter.coefficients(records(tmp_path, **UP_CUT))
    written = {path.name for path in found.save(tmp_path / "out")}
    assert written == {"coefficients.json", "material.toml", "coefficients.png"}
    text = (tmp_path / "case.toml").read_text() + (tmp_path / "out" / "material.toml").read_text()
    (tmp_path / "whole.toml").write_text(text)
    case = load(tmp_path / "whole.toml")
    assert case.get("material.Ktc") == pytest.approx(TRUE["Ktc"], rel=0.02)
    assert 0.0 < case.deviations()["material.Ktc"] < 0.05 * TRUE["Ktc"]


def test_exchanged_channels_make_no_material(tmp_path):
    """Fx and Fy of a half-immersed tool exchanged: the radial force seems to pull at the work."""
    arc = (0.5 * math.pi, math.pi)
    folder = records(tmp_path, arc, "down", width='radial_depth = "6 mm"')
    for file in folder.glob("feed_*.csv"):
        text = file.read_text(encoding="utf-8").replace("Fx [N],Fy [N]", "Fy [N],Fx [N]")
        file.write_text(text, encoding="utf-8")
    found = chatter.coefficients(folder)
    assert any("are two channels exchanged?" in note for note in found.notes)
    assert "material.toml" not in {path.name for path in found.save(tmp_path / "out")}


@pytest.mark.nightly
def test_unknown_senses_of_a_dynamometer_are_found(tmp_path):
    channels = "".join(
        f'[channels.F{axis}]\nquantity = "force"\non = "workpiece"\nsign = "unknown"\n'
        f"direction = {direction}\n"
        for axis, direction in (("x", [0, 1, 0]), ("y", [1, 0, 0]), ("z", [0, 0, 1]))
    )
    folder = records(tmp_path, **UP_CUT, channels=channels)
    for file in folder.glob("feed_*.csv"):
        table = np.loadtxt(file, delimiter=",", skiprows=1)
        # Fx of the rig is the force on the work against y, Fy the force on it along x
        table = np.c_[table[:, 0], table[:, 2], -table[:, 1], table[:, 3]]
        np.savetxt(
            file, table, delimiter=",", comments="", header="time [s],Fx [N],Fy [N],Fz [N]"
        )  # fmt: skip
    summary = chatter.coefficients(folder).summary()
    assert in_si(summary)["Ktc"] == pytest.approx(TRUE["Ktc"], rel=0.02)
    assert in_si(summary)["Krc"] == pytest.approx(TRUE["Krc"], rel=0.02)
    assert summary["signs"] == {"Fx": -1.0, "Fy": 1.0, "Fz": -1.0}


def test_a_radial_force_that_levels_off_is_not_forced_onto_a_line(tmp_path):
    summary = chatter.coefficients(records(tmp_path, **UP_CUT, radial_power=0.3)).summary()
    assert summary["linear_law_holds"] is False
    own = summary["by_direction"]
    assert own["forms"]["tangential"] == "line"
    values = {one["name"]: one["value"] for one in own["coefficients"]}
    assert values["Ktc"] == pytest.approx(1100.0, rel=0.03)
    assert any("linear law leaves more" in note for note in summary["notes"])


def test_the_section_of_a_case_has_the_exponent_of_each_direction(tmp_path, monkeypatch):
    monkeypatch.setitem(TRUE, "Kre", 0.0)
    found = chatter.coefficients(records(tmp_path, **UP_CUT, radial_power=0.3))
    assert max(found.holdout.values()) < 0.02
    assert found.summary()["exponents"][0]["of"] == ["radial"]
    found.save(tmp_path / "out")
    text = (tmp_path / "case.toml").read_text() + (tmp_path / "out" / "material.toml").read_text()
    (tmp_path / "whole.toml").write_text(text)
    law = force_law(load(tmp_path / "whole.toml"), 0.0)
    # what the rig did: a line along the cut, a power of 0.3 towards the axis
    tangential, radial, _ = law.force(2e-4) / law.force(1e-4)
    edge = TRUE["Kte"] / (TRUE["Kte"] + 1e-4 * TRUE["Ktc"])
    assert tangential == pytest.approx(2.0 - edge, rel=0.02)
    assert radial == pytest.approx(2.0**0.3, rel=0.05)


def test_two_feeds_that_contradict_a_law_without_edge_forces_are_a_line_with_them(tmp_path):
    summary = chatter.coefficients(records(tmp_path, **{**UP_CUT, "feeds": (0.05, 0.15)})).summary()
    assert summary["law"] == "linear"
    for key in ("Ktc", "Kte", "Krc", "Kre"):
        assert in_si(summary)[key] == pytest.approx(TRUE[key], rel=0.03)


def test_exponential_law_is_kept_where_it_holds(tmp_path, monkeypatch):
    for key in ("Kte", "Kre", "Kae"):
        monkeypatch.setitem(TRUE, key, 0.0)
    laws = {"power": 0.7, "radial_power": 0.7, "axial_power": 0.7}
    summary = chatter.coefficients(records(tmp_path, **UP_CUT, **laws)).summary()
    assert summary["law"].startswith("exponential")
    assert summary["exponents"][0]["value"] == pytest.approx(0.7, abs=0.02)
    assert in_si(summary)["Ktc"] == pytest.approx(TRUE["Ktc"], rel=0.03)


def test_the_command(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    folder = records(tmp_path, **UP_CUT)
    shown = chatter_command("coefficients", folder, "--out", tmp_path / "out")
    assert "linear law, waveforms of 4 cuts" in shown.stdout
    alone = chatter_command("coefficients", folder, "--mean-forces", "--json")
    given = json.loads(alone.stdout)
    assert given["law"] == "linear"
    assert given["from"] == "mean forces"
    assert given["waveforms"] is None


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (("0.06.csv", "none.csv"), "none.csv"),
        (('spindle_speed = "3000 rpm"', 'spindle_speed = "300 rpm"'), "whole revolutions"),
        # forces along y and z alone leave tangential and radial ones open
        (("Fx [N]", "x [m]"), "determine no force law"),
    ],
)
def test_what_is_wrong_is_told(tmp_path, change, told):
    folder = records(tmp_path, **UP_CUT)
    for file in folder.iterdir():
        text = file.read_text()
        file.write_text(text.replace(*change))
    with pytest.raises(InputError, match=told):
        chatter.coefficients(folder)


def test_a_row_of_the_own_table_is_used_by_name(tmp_path):
    folder = tmp_path / "feeds"
    folder.mkdir()
    records(folder, **UP_CUT)
    table = tmp_path / "ours.toml"
    table.write_text('# ours\n[older]\nKtc = "700 MPa"\nKrc = "200 MPa"\nsource = "a book"\n')
    shown = chatter_command(
        "coefficients", folder, "--table", table, "--name", "our steel", "--mean-forces",
        "--out", tmp_path / "out",
    )  # fmt: skip
    assert shown.exit_code == 0, shown
    assert table.read_text().startswith("# ours\n[older]")
    case = load(folder / "case.toml").patch(
        {"material": {"name": "our steel", "table": str(table)}}
    )
    assert case.material.values["Ktc"] == pytest.approx(TRUE["Ktc"], rel=0.02)
    with pytest.raises(InputError, match='row "our steel" already'):
        chatter.coefficients(folder).keep_in(table, "our steel")


def test_files_of_one_name_in_several_folders_are_runs_of_their_own(tmp_path):
    folder = records(tmp_path, **UP_CUT)
    text = (folder / "measurement.toml").read_text(encoding="utf-8")
    for feed in FEEDS:
        (folder / f"{feed}").mkdir()
        (folder / f"feed_{feed}.csv").rename(folder / f"{feed}" / "forces.csv")
        text = text.replace(f'"feed_{feed}.csv"', f'"{feed}/forces.csv"')
    (folder / "measurement.toml").write_text(text, encoding="utf-8")
    found = chatter.coefficients(folder)
    assert [run.name for run in found.measurement.runs] == [f"{f}/forces.csv" for f in FEEDS]
    assert in_si(found.summary())["Ktc"] == pytest.approx(TRUE["Ktc"], rel=0.02)


def test_a_run_without_the_feed_that_the_others_state_is_told(tmp_path):
    folder = records(tmp_path, **UP_CUT)
    path = folder / "measurement.toml"
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace('feed_per_tooth = "0.09 mm"\n', ""), encoding="utf-8")
    said = [note for note in chatter.coefficients(folder).notes if "states no feed" in note]
    assert len(said) == 1
    assert said[0].startswith("feed_0.09.csv:")
    assert "0.05 mm a tooth" in said[0]


def test_one_cut_is_written_as_one(tmp_path):
    folder = records(tmp_path, **UP_CUT, feeds=(0.06,))
    shown = chatter_command("coefficients", folder, "--mean-forces", "--out", tmp_path / "out")
    assert "of 1 cut\n" in shown.stdout
    assert "of 1 cut\n" in (tmp_path / "out" / "material.toml").read_text(encoding="utf-8")


#: SI of a pound (a force), an inch: NIST SP 811
POUND, INCH = 4.4482216152605, 0.0254


def in_inches(folder):
    """The same records, their case in inches and forces in pounds."""
    for file in folder.glob("feed_*.csv"):
        table = np.loadtxt(file, delimiter=",", skiprows=1)
        table[:, 1:] /= POUND
        np.savetxt(
            file, table, delimiter=",", comments="",
            header="time [s],Fx [lbf],Fy [lbf],Fz [lbf]",
        )  # fmt: skip
    case = (folder / "case.toml").read_text(encoding="utf-8")
    for metric, inches in {"12 mm": 12e-3, "0.05 mm": 5e-5, "2 mm": 2e-3, "3 mm": 3e-3}.items():
        case = case.replace(f'"{metric}"', f'"{inches / INCH:.12g} in"')
    (folder / "case.toml").write_text(case, encoding="utf-8")
    return folder


def test_a_case_in_inches_has_coefficients_in_pounds_and_inches(tmp_path):
    found = chatter.coefficients(in_inches(records(tmp_path, **UP_CUT)))
    factors = {"ksi": 1e3 * POUND / INCH**2, "lbf/in": POUND / INCH}
    for one in found.summary()["coefficients"]:
        share = 0.02 if one["name"][2] == "c" else 0.04
        assert one["value"] * factors[one["unit"]] == pytest.approx(TRUE[one["name"]], rel=share)
    text = (tmp_path / "case.toml").read_text() + found.material_toml()
    (tmp_path / "whole.toml").write_text(text)
    case = load(tmp_path / "whole.toml")
    assert case.get("material.Ktc") == pytest.approx(TRUE["Ktc"], rel=0.02)
    assert case.get("material.Kte") == pytest.approx(TRUE["Kte"], rel=0.04)
    assert found.plot().axes[0].get_ylabel() == "mean force [lbf]"
