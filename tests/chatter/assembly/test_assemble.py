"""Tool, holder and spindle: against beam elements, by inverse coupling, and as a user calls it."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import reduce

import numpy as np
import pytest

import chatter
from chatter.assembly.assembly_file import AssemblyFile
from chatter.assembly.catalogue import library_of_catalogue
from chatter.assembly.library import Library, shipped_library
from chatter.assembly.line import holder_segments, round_segments, tool_segments
from chatter.assembly.spindle import modelled_spindle
from chatter.assembly.tool_point import Base, tool_point_receptance
from chatter.description.errors import InputError
from chatter.io.formats.format_list import read_frfs
from chatter.plots.assembly import plot_assembly
from dynamics.beam.element import Segment
from dynamics.beam.shaft import BeamLine, Bearing
from dynamics.receptance.coupling import Component, coupled
from dynamics.receptance.timoshenko import line_receptance, timoshenko_beam
from tests.command_line import chatter_command as run

#: between the two points of a measured spindle, m
DISTANCE = 0.05
ASSEMBLY = """
title = "12 mm end mill"
loss_factor = 0.0
[spindle]
name = "generic HSK-A63"
[holder]
name = "HSK-A63 shrink 12"
[tool]
name = "end mill 12"
[stick_out]
shortest = "30 mm"
longest = "44 mm"
count = 2
[frequencies]
to = "4000 Hz"
step = "4 Hz"
"""
CASE = """
[tool]
kind = "end mill"
teeth = 4
diameter = "12 mm"
[material]
law = "linear"
Ktc = "800 MPa"
Krc = "300 MPa"
[cut]
mode = "slot"
spindle_speed = "12000 rpm"
feed_per_tooth = "0.06 mm"
axial_depth = "2 mm"
[lobes]
speeds = { from = "8000 rpm", to = "16000 rpm", count = 9 }
"""


def entries():
    shipped = shipped_library()
    return (
        shipped.tool["end mill 12"],
        shipped.holder["HSK-A63 shrink 12"],
        shipped.spindle["generic HSK-A63"],
    )


def test_tool_point_is_that_of_beam_elements_on_springs():
    tool, holder, spindle = entries()
    frequency = np.array([10.0, 400.0, 1600.0])
    file = AssemblyFile.from_text(ASSEMBLY)
    base = Base(frequency, modelled_spindle(spindle, frequency, 0.0))
    found = tool_point_receptance(file, base, tool, holder, 0.04)
    outside = [*tool_segments(tool, 0.04), *holder_segments(holder, tool, 0.04)]
    segments = [
        Segment(s.length, s.outer_diameter, s.material, s.inner_diameter, elements=8)
        for s in [*outside, *round_segments(spindle.sections)]
    ]
    nose = sum(segment.length for segment in outside)
    bearings = [
        Bearing(f"b{k}", nose + b.station, (b.stiffness, b.stiffness))
        for k, b in enumerate(spindle.bearings)
    ]
    line = BeamLine("line", segments, bearings=bearings)
    tip = line.motion_at(line.position(0.0))[:1]
    stiffness = line.stiffness_matrix.copy()
    for bearing in bearings:
        for row in line.motion_at(line.position(bearing.station))[:2]:
            stiffness += bearing.radial[0] * np.outer(row, row)
    for direction in line.motion_at(line.position(0.0))[[2, 5]]:  # axial, torsion: held
        stiffness += 1e9 * np.outer(direction, direction)
    for k, w in enumerate(2.0 * np.pi * frequency):
        elements = (tip @ np.linalg.solve(stiffness - w**2 * line.mass_matrix, tip.T))[0, 0]
        # dampers of the bearings are in one of the two: they matter at resonances alone
        assert found[k].real == pytest.approx(elements, rel=5e-3)


def test_shank_in_the_bore_stiffens_the_holder():
    """E I of a ring of steel and a core of carbide add up; so do their masses."""
    tool, holder, _ = entries()
    first = holder_segments(holder, tool, 0.04)[0]
    d, bore = first.outer_diameter, 0.012
    ring = 210e9 * np.pi * (d**4 - bore**4) / 64.0
    core = 580e9 * np.pi * bore**4 / 64.0
    assert first.material.young * np.pi * d**4 / 64.0 == pytest.approx(ring + core)
    mass = 7850.0 * (d**2 - bore**2) + 14400.0 * bore**2
    assert first.material.density * d**2 == pytest.approx(mass)
    total = sum(s.length for s in holder_segments(holder, tool, 0.04))
    assert total == pytest.approx(0.09)  # DIN 69882-8: A = 90 mm


def measured_with_a_standard(tmp_path, loss):
    """Three FRFs of an empty standard holder at two points, as a tap test gives them."""
    shipped = shipped_library()
    standard, spindle = shipped.holder["HSK-A63 shrink 20"], shipped.spindle["generic HSK-A63"]
    frequency = np.arange(100.0, 3000.0, 10.0)
    stiffness = modelled_spindle(spindle, frequency, loss)
    front, rear, start = [], [], 0.0
    for segment in holder_segments(standard, None, 0.0):
        middle = min(max(DISTANCE, start), start + segment.length)
        for part, length in ((front, middle - start), (rear, start + segment.length - middle)):
            if length > 1e-9:
                part.append(replace(segment, length=length))
        start += segment.length
    rest = line_receptance(frequency, rear, stiffness, loss)
    piece = reduce(coupled, [timoshenko_beam(frequency, one, loss) for one in front])
    whole = coupled(piece, Component(rest, rest, rest, rest))
    measured = {"direct": whole.near, "cross": whole.far_near, "behind": whole.far}
    for name, blocks in measured.items():
        values = blocks[:, 0, 0]
        rows = [
            f"{f:.6f},{v.real:.12e},{v.imag:.12e}" for f, v in zip(frequency, values, strict=True)
        ]
        text = "frequency [Hz],real [m/N],imag [m/N]\n" + "\n".join(rows) + "\n"
        (tmp_path / f"{name}.csv").write_text(text)
    return frequency


def test_inverse_coupling_from_a_standard_holder_predicts_another_tool(tmp_path):
    loss = 0.02
    frequency = measured_with_a_standard(tmp_path, loss)
    measured = ASSEMBLY.replace("loss_factor = 0.0", f"loss_factor = {loss}").replace(
        'name = "generic HSK-A63"',
        'frf = "direct.csv"\ncross_frf = "cross.csv"\nbehind_frf = "behind.csv"\n'
        'cross_distance = "50 mm"\n'
        'standard_holder = "HSK-A63 shrink 20"',
    )
    (tmp_path / "assembly.toml").write_text(measured)
    found = chatter.assemble(tmp_path / "assembly.toml")
    tool, holder, spindle = entries()
    base = Base(frequency, modelled_spindle(spindle, frequency, loss))
    file = AssemblyFile.from_text(measured, folder=tmp_path)
    direct = tool_point_receptance(file, base, tool, holder, 0.044)
    error = np.abs(found.receptance[1] - direct)
    assert np.max(error) < 1e-6 * np.max(np.abs(direct))


def test_one_point_behind_the_end_less_still_finds_the_peaks(tmp_path):
    """Without behind_frf one mode is taken to rule; the highest peak stays within 5 %."""
    loss = 0.02
    frequency = measured_with_a_standard(tmp_path, loss)
    measured = ASSEMBLY.replace("loss_factor = 0.0", f"loss_factor = {loss}").replace(
        'name = "generic HSK-A63"',
        'frf = "direct.csv"\ncross_frf = "cross.csv"\ncross_distance = "50 mm"\n'
        'standard_holder = "HSK-A63 shrink 20"',
    )
    (tmp_path / "assembly.toml").write_text(measured)
    found = chatter.assemble(tmp_path / "assembly.toml")
    tool, holder, spindle = entries()
    base = Base(frequency, modelled_spindle(spindle, frequency, loss))
    file = AssemblyFile.from_text(measured, folder=tmp_path)
    direct = np.abs(tool_point_receptance(file, base, tool, holder, 0.044))
    peak = frequency[np.argmax(np.abs(found.receptance[1]))]
    assert peak == pytest.approx(frequency[np.argmax(direct)], rel=0.05)
    assert any("ruling mode" in note for note in found.notes)


@pytest.mark.parametrize("count", [3, 40])
def test_the_legend_of_the_picture_hides_no_response(count, tmp_path):
    """It lay over the peak of the tool, at the upper right."""
    (tmp_path / "assembly.toml").write_text(ASSEMBLY.replace("count = 2", f"count = {count}"))
    found = chatter.assemble(tmp_path / "assembly.toml")
    figure = plot_assembly(found)
    figure.canvas.draw()
    (axes,) = figure.axes
    box = axes.get_legend().get_window_extent()
    assert not box.overlaps(axes.get_window_extent())
    assert figure.bbox.contains(*box.min)
    assert figure.bbox.contains(*box.max)
    named = {text.get_text() for text in axes.get_legend().get_texts()}
    best = f"{1e3 * found.stick_out[found.best]:.4g} mm"
    assert {"30 mm", "44 mm", best} <= named
    # the responses keep most of the width
    assert axes.get_window_extent().width > 0.7 * figure.bbox.width


def test_command_writes_what_it_says(tmp_path):
    (tmp_path / "case.toml").write_text(CASE)
    text = ASSEMBLY.replace("loss_factor = 0.0", 'loss_factor = 0.03\ncase = "case.toml"')
    (tmp_path / "assembly.toml").write_text(text)
    out = tmp_path / "out"
    done = run(
        "assemble", str(tmp_path / "assembly.toml"), "--method", "zero-order", "--out", str(out)
    )
    assert done.exit_code == 0, done.output
    assert "best stick-out" in done.output
    names = {path.name for path in out.iterdir()}
    assert names == {
        "tool-point.csv", "modes.toml", "summary.json", "assemble.png", "lobes-stick-out.csv"
    }  # fmt: skip
    summary = json.loads((out / "summary.json").read_text())
    peaks = [row["peak_receptance_m_per_N"] for row in summary["stick_outs"]]
    (frf,) = read_frfs(out / "tool-point.csv")
    assert np.max(np.abs(frf.values)) == pytest.approx(
        peaks[
            [row["stick_out_mm"] for row in summary["stick_outs"]].index(
                summary["best_stick_out_mm"]
            )
        ],
        rel=1e-6,
    )
    rows = (out / "lobes-stick-out.csv").read_text().splitlines()
    assert rows[0] == "stick-out [mm],spindle_speed [rpm],critical_depth [mm]"
    assert [float(v) for v in rows[1].split(",")[:2]] == [30.0, 8000.0]
    assert len(rows) == 1 + 2 * 9
    best = max(summary["stick_outs"], key=lambda row: row["removal_rate_cm3_per_min"])
    assert best["stick_out_mm"] == summary["best_stick_out_mm"]
    cut = 12.0 * 0.06 * 4 * best["at_spindle_speed_rpm"] / 1e3  # cm^3/min for a depth of 1 mm
    depths = [
        float(r.split(",")[2]) for r in rows[1:] if float(r.split(",")[0]) == best["stick_out_mm"]
    ]
    assert 0.0 < best["removal_rate_cm3_per_min"] / cut <= max(depths) * 1.0001


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('name = "end mill 12"', 'name = "end mill 13"', 'tool.name = "end mill 13"'),
        ('name = "HSK-A63 shrink 12"', 'name = "HSK-A63 shrink 16"', "bore"),
        ('name = "HSK-A63 shrink 12"', 'name = "SK40 shrink 12"', "taper"),
        ('longest = "44 mm"', 'longest = "70 mm"', "47 mm at most"),
        ('longest = "44 mm"', 'longest = "20 mm"', "20 mm; it must not be below the shortest"),
        ('shortest = "30 mm"', 'shortest = "20 mm"', "26 mm"),
        ('name = "generic HSK-A63"', 'frf = "tap.csv"', "cross_frf"),
        ('[tool]\nname', '[tool]\nnmae', "nmae"),
    ],
)  # fmt: skip
def test_wrong_assemblies_are_refused(tmp_path, old, new, said):
    path = tmp_path / "assembly.toml"
    path.write_text(ASSEMBLY.replace(old, new))
    with pytest.raises(InputError) as error:
        chatter.assemble(path)
    assert said in str(error.value)


def test_catalogue_becomes_a_library(tmp_path):
    catalogue = tmp_path / "maker.csv"
    catalogue.write_text(
        "Order code;DC [mm];DCON [mm];APMX [mm];OAL [mm];ZEFP;Substrate\n"
        "A-1;12,0;12;26;83;4;VHM\nA-2;0,5 ;6;;57;2;HSS\n".replace(
            "A-2;0,5 ;6;;57", "A-2;5,5;6;13;57"
        )
    )
    done = run("assemble", "--import", str(catalogue), "--out", str(tmp_path / "lib"))
    assert done.exit_code == 0, done.output
    text = ASSEMBLY.replace("title =", 'library = "lib/library.toml"\ntitle =').replace(
        'name = "end mill 12"', 'name = "A-1"'
    )
    (tmp_path / "own.toml").write_text(text)
    (tmp_path / "shipped.toml").write_text(ASSEMBLY)
    own = chatter.assemble(tmp_path / "own.toml")
    shipped = chatter.assemble(tmp_path / "shipped.toml")
    assert own.receptance == pytest.approx(shipped.receptance)


@pytest.mark.parametrize(
    "text",
    [
        "Bezeichnung;Durchmesser [mm];Schneidenlänge [mm];Gesamtlänge [mm];Schneidenzahl\n"
        "A;12,5;26,0;83,0;4\n",
        "tool name,diameter mm,flute length mm,overall length mm,number of flutes\n"
        "A,12.5,26,83,4\n",
        "Katalog 2024;;;;\nArt.-Nr.;D1/mm;L2, mm;OAL in mm;Zähnezahl\nA;12,5;26;83;4,0\n",
        "name;diameter;flute length;length;z\nA;12,5 mm;2,6 cm;83 mm;4\n",
        'name,diameter [mm],flute length [mm],length [mm],teeth\nA,"12,5",26,83,4\n',
    ],
)
@pytest.mark.parametrize("encoding", ["utf-8-sig", "cp1252", "utf-16"])
def test_catalogues_as_shops_have_them(tmp_path, text, encoding):
    catalogue = tmp_path / "maker.csv"
    catalogue.write_bytes(text.encode(encoding))
    library, names = library_of_catalogue(catalogue)
    assert names == ["A"]
    tool = Library.from_text(library, "library").tool["A"]
    assert tool.diameter == pytest.approx(12.5e-3)
    assert tool.flute_length == pytest.approx(26e-3)
    assert tool.length == pytest.approx(83e-3)
    assert tool.teeth == 4


def test_fractions_of_an_inch_in_a_catalogue(tmp_path):
    catalogue = tmp_path / "maker.csv"
    heading = "name,diameter [in],shank diameter [in],flute length [in],length [in],teeth"
    catalogue.write_text(f'{heading}\nA,1/2,1/2",1 1/4,2-1/2,4\n', encoding="utf-8")
    tool = Library.from_text(library_of_catalogue(catalogue)[0], "library").tool["A"]
    assert tool.diameter == tool.shank_diameter == pytest.approx(12.7e-3, rel=1e-9)
    assert tool.flute_length == pytest.approx(31.75e-3, rel=1e-9)
    assert tool.length == pytest.approx(63.5e-3, rel=1e-9)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("name,diameter,flute length [mm],length [mm]\nA,12,26,83\n", "no unit"),
        ('name,diameter [mm],flute length [mm],length [mm]\nA,"1,200",26,83\n', "thousand"),
        ("name,diameter [mm],flute length [mm],length [mm],z\nA,12,26,83,4.5\n", "whole number"),
        ("name,diameter [mm],length [mm]\n", "flute length"),
        ("name,diameter [mm],flute length [mm],length [mm]\nA,12,x,83\n", "line 2"),
        ("name,diameter [mm],flute length [mm],length [mm]\n", "no row"),
        ("name,diameter [mm],flute length [mm],length [mm]\nA,12,90,83\n", "flute_length"),
        ("", "empty"),
    ],
)
def test_catalogues_that_say_too_little_are_refused(tmp_path, text, said):
    (tmp_path / "maker.csv").write_text(text)
    done = run("assemble", "--import", str(tmp_path / "maker.csv"), "--out", str(tmp_path / "lib"))
    assert done.exit_code == 2
    assert said in done.output


def test_shipped_library_has_a_dozen_of_entries_with_sources():
    shipped = shipped_library()
    assert len(shipped.tool) + len(shipped.holder) >= 12
    every = [*shipped.tool.values(), *shipped.holder.values(), *shipped.spindle.values()]
    assert all(entry.source for entry in every)


def test_words_and_picture_are_in_inches_where_the_case_is(tmp_path):
    """They were in mm; the files keep their units."""
    case = CASE.replace('"12 mm"', '"0.5 in"').replace('"0.06 mm"', '"0.0024 ipt"')
    (tmp_path / "case.toml").write_text(case.replace('"2 mm"', '"0.08 in"'), encoding="utf-8")
    path = tmp_path / "assembly.toml"
    path.write_text('case = "case.toml"\n' + ASSEMBLY, encoding="utf-8")
    result = run("assemble", path, "--out", tmp_path / "out")
    best = json.loads((tmp_path / "out" / "summary.json").read_text())["best_stick_out_mm"]
    assert f"best stick-out {best / 25.4:.4g} in by removal rate" in result.stdout
    for heading in ("stick-out [in]", "lowest limit [in]", "removal [in^3/min]"):
        assert heading in result.stdout
    assert "1.181" in result.stdout  # 30 mm
    drawn = [axes.get_ylabel() for axes in plot_assembly(chatter.assemble(path)).axes]
    assert not any("[mm]" in one for one in drawn)
    assert any("[in]" in one for one in drawn)
