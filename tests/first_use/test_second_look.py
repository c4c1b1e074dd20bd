"""What a second look by the documents alone has met: each may not be met again."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import chatter
from chatter.description.errors import InputError
from chatter.description.unit_system import INCH, METRIC
from tests.command_line import chatter_command
from tests.first_use.shop import cut, written
from tests.places import EXAMPLES

MACHINE = EXAMPLES / "face-mill-chatter" / "machine.toml"


def in_time(found, limit):
    """Check with the limit, m, of a method in the time domain."""
    curve = found.limit._replace(
        critical_depth=np.array([limit]), crossings=(np.array([limit]),), bifurcation=("hopf",)
    )
    return replace(found, method="time-domain", limit=curve, neglected=())


def test_verdict_of_the_time_domain_is_by_its_own_limit():
    """It said "stable: 1.2 mm" above a critical depth of 1.053 mm, and the simulation chatter."""
    found = chatter.check(cut(cut__axial_depth="0.8 mm"), method="collocation")
    assert found.stable
    assert found.critical_depth > 0.8e-3
    below, above = in_time(found, 0.7e-3), in_time(found, 0.9e-3)
    assert below.verdict == "chatter"
    assert below.bifurcation == "hopf"
    assert below.sentences()[0].startswith("chatter: 0.8 mm")
    assert above.verdict == "stable"
    assert above.bifurcation == "none"


@pytest.mark.nightly
def test_time_domain_says_chatter_where_the_linear_analysis_does_not():
    case = cut(cut__axial_depth="0.88 mm", tool__flank_wear="0.3 mm")
    found = chatter.check(case, method="time-domain")
    assert found.spectral_radius < 1.0
    assert found.critical_depth < 0.88e-3
    assert found.verdict == "chatter"
    assert any("the linear analysis (collocation, spectral radius" in one for one in found.notes)


def test_a_path_is_accepted_where_a_case_or_a_machine_is(tmp_path):
    """`chatter.whatif`, `frf` and `mode_shapes` raised AttributeErrors of a str."""
    path = written(tmp_path)
    vary = {"material.Ktc": ["1900 MPa", "3800 MPa"]}
    by_path = chatter.whatif(path, vary, "critical depth").values()
    assert by_path == chatter.whatif(chatter.load(path), vary, "critical depth").values()
    shapes = chatter.mode_shapes(MACHINE, 2)
    assert shapes.frequency.tolist() == (
        chatter.mode_shapes(chatter.load_machine(MACHINE), 2).frequency.tolist()
    )
    with pytest.raises(InputError, match="--only nothing"):
        chatter.whatif(MACHINE, {"body.table.mass": ["150 kg", "160 kg"]}, only=["nothing"])
    with pytest.raises(InputError, match=r"no \[move.nothing\]"):
        chatter.move(str(MACHINE), "nothing")


def test_what_is_neither_a_case_nor_a_path_is_named():
    """It was "'int' object has no attribute 'lobes'"."""
    with pytest.raises(InputError, match="a case or the path of its file is required; 3 is given"):
        chatter.check(3)
    wanted = "a machine or the path of its file is required; "
    with pytest.raises(InputError, match=wanted + "3 is given"):
        chatter.frf(3)
    with pytest.raises(InputError, match=wanted + "<Case 'case': Shop> is given"):
        chatter.mode_shapes(cut())
    with pytest.raises(InputError, match="a case, a machine or the path of its file is required"):
        chatter.whatif(3, {"cut.axial_depth": ["1 mm"]})


def test_bifurcation_of_python_takes_a_range():
    """Its letters were taken for values: "0" is out of range."""
    case = cut(cut__axial_depth="0.5 mm", simulation__revolutions=12)
    found = chatter.bifurcation(case, "cut.axial_depth", "0.2 mm..0.6 mm:3")
    assert [point.value for point in found.points] == pytest.approx([0.2e-3, 0.4e-3, 0.6e-3])


def test_every_wrong_value_of_a_study_is_named(tmp_path):
    """Only the first one was."""
    path = written(tmp_path)
    values = "cut.radial_depth=8 mm, -1 mm, 3 xx, 4 s"
    told = chatter_command("whatif", path, "--vary", values, "--result", "critical depth").stderr
    assert all(value in told for value in ('"-1 mm"', '"xx"', '"4 s"'))
    wide = "cut.radial_depth=8 mm, 20 mm, 30 mm"
    told = chatter_command("whatif", path, "--vary", wide, "--result", "critical depth").stderr
    assert "20 mm is more than the diameter" in told
    assert "30 mm is more than the diameter" in told
    with pytest.raises(InputError) as raised:
        chatter.bifurcation(cut(), "cut.radial_depth", ["20 mm", "8 mm", "30 mm"])
    assert len(raised.value.messages) == 2


def test_wear_lowers_what_is_certain_of_a_limit(tmp_path):
    """`whatif` said that a worn flank changes nothing, `check` that it may take a third."""
    varied = "tool.flank_wear=0 mm, 0.3 mm"
    args = ("--vary", varied, "--result", "critical depth", "--out", tmp_path / "out")
    shown = chatter_command("whatif", written(tmp_path), *args).stdout
    fresh, worn = (chatter.check(cut(tool__flank_wear=one)) for one in ("0 mm", "0.3 mm"))
    assert worn.critical_depth == pytest.approx(fresh.critical_depth)
    assert worn.lowest_depth < 0.9 * fresh.lowest_depth
    assert "has no effect" not in shown
    assert (
        f"{1e3 * fresh.lowest_depth:.4g} mm -> {1e3 * worn.lowest_depth:.4g} mm "
        f"({100.0 * (worn.lowest_depth / fresh.lowest_depth - 1.0):+.3g} %)"
    ) in shown


def test_a_depth_that_nothing_bounds_is_not_called_zero():
    from chatter.studies.whatif.measures import MEASURES, Outcome
    from chatter.studies.whatif.summary import value_text

    certain = MEASURES["critical depth"].quantities["certain_depth_mm"]
    outcome = Outcome({"certain_depth_mm": 0.0})
    told = value_text(SimpleNamespace(units=METRIC), certain, outcome, "certain_depth_mm")
    assert told == "not known"


def test_probability_says_what_edge_forces_may_take_of_it():
    """It was 82 % of a cut that `check` did not call certain and that chatters in time."""
    values = {"material.Ktc": "1900 +- 100 MPa", "cut.axial_depth": "0.84 mm"}
    found = chatter.uncertainty(cut().patch(values), 20, speeds=2, method="collocation")
    (effect,) = found.neglected
    # Kte phi in Ktc fz of the chip where it sets in: 0.111 as of the cut by hand in the documents
    assert effect.lowest == pytest.approx(1.0 - 0.1111, abs=2e-3)
    certain = np.mean(found.operating * effect.lowest > 0.84e-3)
    assert found.least_probability == certain < found.probability
    assert f"for certain with {certain:.1%} alone" in found.for_certain_in_words()
    shallow = replace(found, case=found.case.patch({"cut.axial_depth": "0.3 mm"}))
    shallow = replace(shallow, stable=np.ones(20, bool))
    assert shallow.for_certain_in_words() == ""


def test_materials_are_found_by_their_iso_group():
    """`chatter materials iso K`, as the documents have it, listed 38 of 46 rows, M all of them."""
    for words in (("iso", "K"), ("iso K",), ("k",)):
        shown = chatter_command("materials", *words).stdout
        names = [line for line in shown.splitlines() if line.startswith('"')]
        assert names
        assert all(line.endswith("[K]") for line in names), names


def test_a_range_of_the_diagram_is_stated_in_a_line():
    """FROM..TO:COUNT was refused where "a table is required"."""
    ranged = cut().patch({"lobes.speeds": "3000..9000 rpm:50", "lobes.depths": "0..4 mm:20"})
    assert ranged.lobes.speeds.from_ == pytest.approx(3000.0 * np.pi / 30.0)
    assert ranged.lobes.speeds.to == pytest.approx(9000.0 * np.pi / 30.0)
    assert (ranged.lobes.speeds.count, ranged.lobes.depths.count) == (50, 20)
    assert ranged.lobes.depths.to == pytest.approx(4e-3)
    assert 'to = "4 mm"' in ranged.to_toml()
    with pytest.raises(InputError, match="no range with units"):
        cut().patch({"lobes.speeds": "3000..9000:50"})
    with pytest.raises(InputError, match="it begins at 0"):
        cut().patch({"lobes.depths": "1 mm..4 mm:20"})


def test_a_depth_in_metres_is_asked_about():
    """1.5 was answered with "1500 mm is more than tool.flute_length", of which nothing was said."""
    with pytest.raises(InputError, match=r'22 mm; is "1.5 mm" meant\?'):
        cut(tool__flute_length="22 mm", cut__axial_depth=1.5)
    with pytest.raises(InputError, match=r"1016 mm is more than tool.flute_length, 22 mm$"):
        cut(tool__flute_length="22 mm", cut__axial_depth="40 in")
    with pytest.raises(InputError, match=r"flute_length, 22 mm$"):
        cut(tool__flute_length="22 mm", cut__axial_depth="25 mm")


def test_a_reason_below_a_picture_does_not_make_it_wider():
    """A line of 130 letters squeezed the panels to a third of the picture."""
    from chatter.plots.stability_diagram import _LINE_LENGTH, _pocket_list

    ball = cut(tool__kind="ball", cut__radial_depth=None, cut__stepover="0.25 mm",
               cut__feed_rate="100 mm/min")  # fmt: skip
    diagram = chatter.lobes(ball)
    assert len(diagram.why_no_pocket) > _LINE_LENGTH
    assert max(map(len, _pocket_list(diagram).splitlines())) <= _LINE_LENGTH


def test_colours_of_a_map_change_where_its_boundary_is():
    """Blocks of 40 x 10 values stood beside the smooth curve of |mu| = 1."""
    from chatter.plots.stability_diagram import _finer_map

    x, y = np.array([0.0, 1.0]), np.array([0.0, 2.0, 4.0])
    radius = np.ma.masked_invalid([[0.5, 0.5], [2.0, 0.5], [2.0, 8.0]])
    across, up, drawn = _finer_map(x, y, radius)
    assert drawn.shape == (up.size, across.size)
    # along x = 0 the logarithm goes evenly from that of 1/2 to that of 2: 1 half way, at y = 1
    assert np.interp(1.0, up, drawn[:, 0]) == pytest.approx(1.0, rel=1e-3)
    assert drawn[-1, -1] == pytest.approx(8.0)
    missing = np.ma.masked_invalid([[0.5, 0.5], [2.0, np.nan], [2.0, 8.0]])
    assert _finer_map(x, y, missing)[2] is missing


def test_a_sheet_says_which_coefficients_it_has(tmp_path):
    shown = chatter_command("sheet", written(tmp_path), "--out", tmp_path / "out").stderr
    assert "coefficients: linear law, Ktc 1900 MPa, Krc 700 MPa" in shown


def test_what_a_ball_leaves_beside_it_is_a_shoulder(tmp_path):
    """It was called the wall, of which the next pass leaves nothing."""
    ball = ("--set", "tool.kind=ball", "--set", "cut.radial_depth=none",
            "--set", 'cut.stepover="0.4 mm"', "--set", "structure=none")  # fmt: skip
    shown = chatter_command("simulate", written(tmp_path), *ball, "--out", tmp_path / "o").stdout
    # acos(1 - 0.5/8) = 20.36 deg
    assert "shoulder at 20.4 deg: surface location error" in shown
    assert "wall" not in shown
    assert shown.index("floor: ") < shown.index("shoulder")


def test_a_band_without_a_unit_is_answered_in_words_of_the_option():
    """It was "test of the command line: band: "10" has no unit", such as 922 Hz."""
    told = chatter_command("frf", MACHINE, "--band", "10..200").stderr
    assert '--band "10..200" has no unit; a band is written as in "10 Hz..200 Hz"' in told
    from chatter.cli.frf import _ends

    assert _ends("10..200 Hz") == ["10 Hz", "200 Hz"]
    assert _ends("5 Hz, 0.5 kHz") == ["5 Hz", "0.5 kHz"]


def test_no_length_is_written_with_an_exponent():
    """ "displacement 1.21e+03 um peak"; then "2500 um a tooth", where a shop says 2.5 mm."""
    notes = chatter.check(cut(cut__feed_per_tooth="2.5 mm", material__Kte="900 N/mm")).notes
    assert any("the chip of 2.5 mm a tooth" in one for one in notes)
    assert not any("um" in one for one in notes)


def test_a_chip_is_read_in_the_unit_of_its_size():
    """Tenths of a millimetre in mm, hundredths in um; an inch is 25.4 mm, a mil 25.4 um."""
    assert METRIC.at_the_size_of(1e-3).text(1e-3) == "1 mm"
    assert METRIC.at_the_size_of(0.12e-3).text(0.12e-3) == "0.12 mm"
    assert METRIC.at_the_size_of(80e-6).text(80e-6) == "80 um"
    assert INCH.at_the_size_of(1.27e-3).text(1.27e-3) == "0.05 in"
    assert INCH.at_the_size_of(50.8e-6).text(50.8e-6) == "2 mil"
    # beside each other they have one unit
    assert METRIC.at_the_size_of(80e-6, 0.25e-3).name == "mm"


def test_pockets_on_a_machine_keep_what_its_frictions_may_take():
    """They were those of vibration of 5 um: beyond the limit where the frictions stick."""
    case = chatter.load(EXAMPLES / "friction-amplitude" / "case.toml")
    diagram = chatter.lobes(case)
    assert diagram.resting_friction < 0.9
    for pocket in diagram.pockets:
        speed = {"cut.spindle_speed": float(pocket.spindle_speed)}
        for amplitude in ("0 um", "5 um"):
            own = case.patch({**speed, "structure.friction_amplitude": amplitude})
            limit = chatter.check(own.patch({"cut.axial_depth": "1 mm"})).critical_depth
            assert pocket.axial_depth < limit
            assert pocket.critical_depth <= limit * (1.0 + 1e-6)


def test_what_frictions_make_of_a_limit_is_said_once():
    """ "anything from 8.58 mm to 11.6 mm, ..., from 11.6 to 8.58 mm"."""
    case = chatter.load(EXAMPLES / "friction-amplitude" / "case.toml")
    second = chatter.check(case).sentences()[1]
    assert second.count("8.58") == 1


def test_the_receptance_of_a_state_of_a_machine_is_computed_once():
    from chatter.stability.model import milling_model

    structure = milling_model(chatter.load(EXAMPLES / "friction-amplitude" / "case.toml")).structure
    assert structure.receptance()[1] is structure.receptance()[1]


def test_a_study_of_wear_begins_with_a_new_tool():
    """A land of 0 was refused where the flank ploughs: "neither edge_radius nor flank_wear"."""
    from chatter.compile.cutter import process_damping_of

    ploughing = {"process_damping.indentation_force": "2e14 N/m^3", "tool.clearance_angle": "8 deg"}
    case = cut().patch(ploughing)
    with pytest.raises(InputError, match="neither edge_radius nor flank_wear is given"):
        process_damping_of(case)
    assert process_damping_of(case.patch({"tool.flank_wear": "0.1 mm"})).flank_wear == 1e-4
    new = case.patch({"tool.flank_wear": "0 mm"})
    assert process_damping_of(new) is None
    assert chatter.check(new).critical_depth == chatter.check(cut()).critical_depth
    assert any("no effect while tool.flank_wear is 0" in one for one in new.notes)


def test_the_chip_of_a_slanting_edge_is_thinner_than_the_feed():
    """A face mill had no thickest chip, and its material was judged by the feed per tooth."""
    face = {"tool.kind": "inserted", "tool.helix": "0 deg", "tool.diameter": "80 mm",
            "tool.cutting_edge_angle": "45 deg", "cut.mode": "face", "cut.radial_depth": None,
            "cut.workpiece_width": "60 mm", "cut.feed_per_tooth": "0.2 mm",
            "cut.feed_rate": None, "cut.axial_depth": "2 mm"}  # fmt: skip
    # centred: f_z sin(45 deg)
    centred = chatter.check(cut().patch(face))
    assert ["thickest chip", f"{0.2 * np.sqrt(0.5):.3g} mm"] in centred.rows()
    aside = face | {"cut.workpiece_width": "10 mm", "cut.tool_offset": "30 mm"}
    # the work lies from -35 to -25 mm beside the axis: sin(phi) = sqrt(1 - (25/42)^2)
    chip = 0.2 * np.sqrt(0.5) * np.sqrt(1.0 - (25.0 / 42.0) ** 2)
    assert ["thickest chip", f"{chip:.3g} mm"] in chatter.check(cut().patch(aside)).rows()


def test_parts_of_results_have_short_reprs():
    """The points of a bifurcation diagram filled the screen with their sections."""
    from chatter.simulation.virtual_tests.frf import FrfCurve, FrfResult
    from dynamics.frf.container import Frf

    case = cut(cut__axial_depth="0.3 mm", simulation__revolutions=12)
    point = chatter.bifurcation(case, "cut.axial_depth", ["0.3 mm"]).points[0]
    assert f"poincare_section=<array {len(point.poincare_section)} x 3>" in repr(point)
    assert "value=0.0003" in repr(point)
    result = chatter.simulate(case)
    zero_order = chatter.lobes(case).zero_order
    for part in (point, result.detection, result.finish, zero_order):
        assert len(repr(part)) < 700, type(part)
    lines = np.linspace(5.0, 500.0, 400)
    frf = Frf(lines, np.ones(400, complex))
    curve = FrfCurve("table", "at rest", frf, frf, "force", "displacement")
    assert len(repr(FrfResult("a machine", [curve] * 9))) < 200
    assert len(repr(curve)) < 400


def test_a_width_in_percent_is_a_width_everywhere(tmp_path):
    """`optimum` ended in "a fault in chatter itself", `--vary` refused what a case may state."""
    narrow = cut(cut__radial_depth="25 %")
    assert narrow.deviations() == {}
    assert narrow.patch({"cut.radial_depth": 3e-3}).cut.radial_depth == pytest.approx(3e-3)
    assert narrow.patch({"material.Ktc": "1900 +- 50 MPa"}).deviations() == {
        "material.Ktc": pytest.approx(50e6)
    }
    from chatter.studies.whatif.variation import read_variation

    # of 16 mm: 10 % are 1.6 mm, 50 % are 8 mm
    ranged = read_variation("cut.radial_depth=10..50 %:3", narrow)
    assert ranged.numbers == pytest.approx([1.6, 4.8, 8.0])
    listed = read_variation("cut.radial_depth=10 %, 50 %", narrow)
    assert listed.numbers == pytest.approx([1.6, 8.0])
    assert ranged.unit == listed.unit == "mm"
    with pytest.raises(InputError, match="plain number"):
        read_variation("cut.axial_depth=10 %, 50 %", narrow)


def test_two_speeds_in_one_command_are_refused(tmp_path):
    """The one given first was left out without a word."""
    both = ("--set", "cut.spindle_speed=8000 rpm", "--set", "cut.cutting_speed=100 m/min")
    told = chatter_command("check", written(tmp_path), *both)
    assert told.exit_code == 2
    assert "cut.spindle_speed is given as well; give one of the two" in told.stderr


def test_cuts_of_an_optimum_and_of_a_sheet_have_short_reprs():
    case = cut(optimum={"depths": "0.2..1 mm:4", "speeds": "1100..1300 rpm"})
    best = chatter.optimum(case).candidates[0]
    assert repr(best).startswith("<Candidate ")
    assert f"{6e7 * best.removal_rate:.4g} cm" in repr(best)
    (one,) = chatter.sheet([cut()]).cases
    assert len(repr(one)) < 80
    assert repr(one.cuts[0]) == "<SheetCut as stated: 0.5 mm at 1193.66 rpm, stable>"
    assert max(len(repr(part)) for part in (best, *one.cuts)) < 120


def test_a_bound_is_told_only_where_it_differs():
    """Without edge forces the limit and what is certain of it were told in two sentences alike."""
    widths = ["cut.radial_depth=4 mm,8 mm"]
    plain = cut(material__Kte=None, material__Kre=None)
    assert "certain" not in " ".join(chatter.whatif(plain, widths, "critical depth").sentences())
    told = " ".join(chatter.whatif(cut(), widths, "critical depth").sentences())
    assert "depth stable for certain" in told


@pytest.mark.parametrize(
    ("call", "further", "required"),
    [
        ("load", (), "the path of a case file"),
        ("load_machine", (), "the path of a machine file"),
        ("assemble", (), "the path of an assembly file"),
        ("coefficients", (), "the path of a measurement folder or a record"),
        ("compare", (), "the path of a measurement folder"),
        ("explain", (), "the path of a measurement folder"),
        ("detect", (), "the path of a recording"),
        ("friction", (), "the path of a record of a drive"),
        ("modes", (), "the path of an FRF file or a hammer record"),
        ("learn", ("cuts.csv",), "a case or the path of its file"),
        ("sheet", (), "a case or the path of its file"),
        ("export", (), "a machine or the path of its file"),
        ("optimum", (), "a case or the path of its file"),
    ],
)
def test_what_is_no_path_is_named(call, further, required):
    """ "expected str, bytes or os.PathLike object, not int"."""
    with pytest.raises(InputError) as found:
        getattr(chatter, call)(5, *further)
    assert str(found.value) == f"{required} is required; 5 is given"
