"""Results of studies: closed forms, single runs, resumption, files."""

import csv
import json
import math

import numpy as np
import pytest

import chatter
from chatter.description.errors import InputError, RunError
from chatter.studies.model import load_model
from chatter.studies.whatif import measures
from chatter.studies.whatif.preset_studies import preset_studies
from chatter.studies.whatif.whatif_study import whatif

ZERO_ORDER = {"method": "zero-order"}


def test_limit_of_one_degree_of_freedom_goes_as_one_over_the_force_coefficient(case):
    """b = -1 / (2 alpha Re G): the directional factor alpha is proportional to Ktc and Krc."""
    kept = case.get("material.Krc") / case.get("material.Ktc")
    studies = []
    for factor in (1.0, 1.5, 2.0):
        scaled = case.patch({"material.Ktc": factor * 600e6, "material.Krc": factor * kept * 600e6})
        studies += whatif(scaled, {"cut.feed_per_tooth": [1e-4]}, "critical depth").values()
    assert studies[0] / np.array(studies) == pytest.approx([1.0, 1.5, 2.0], rel=1e-3)
    for name in ("semi-discretization", "zero-order"):
        alone = case.patch({"material.Krc": 0.0, "cut.mode": "up"})
        study = whatif(
            alone, {"material.Ktc": ["400 MPa", "800 MPa"]}, "critical depth", method=name
        )
        low, high = study.values()
        assert low / high == pytest.approx(2.0, rel=1e-3)


def test_a_tornado_has_the_signs_of_physics(case):
    study = whatif(
        case.patch({"cut.spindle_speed": "12000 rpm"}),
        ["material.Ktc=+-10%", "structure.mode[*].damping=+-10%", "cut.feed_per_tooth=+-10%"],
        "critical depth",
        tornado=True,
        **ZERO_ORDER,
    )
    base, *ends = study.values()
    assert len(study.points) == 7
    assert ends[0] > base > ends[1]  # harder material: less depth
    assert ends[2] < base < ends[3]  # more damping: more depth
    assert ends[4] == pytest.approx(base)  # the linear law does not know the feed
    assert ends[5] == pytest.approx(base)
    # the strongest first, and the weakest last
    assert "as given" in study.sentences()[0]
    assert "cut.feed_per_tooth" in study.sentences()[-1]
    assert study.sentences()[-1].count("(no change)") == 2


def test_corners_of_a_heat_map_are_single_runs(case):
    speeds, depths = ["9000 rpm", "10000 rpm", "11000 rpm"], ["1 mm", "3 mm"]
    study = whatif(
        case,
        {"cut.spindle_speed": speeds, "cut.axial_depth": depths},
        "critical depth",
        quantity="spectral_radius",
    )
    assert study.layout == "heat map"
    grid = np.reshape(study.values(), (3, 2))
    for i, j in ((0, 0), (0, 1), (2, 0), (2, 1)):
        single = chatter.check(
            case.patch({"cut.spindle_speed": speeds[i], "cut.axial_depth": depths[j]})
        )
        assert grid[i, j] == pytest.approx(single.spectral_radius, rel=1e-12)


def test_files_hold_what_single_commands_give(case, tmp_path):
    study = whatif(case, ["structure.mode[0].damping=0.011,0.022"], "lobes", folder=tmp_path)
    study.save(tmp_path)
    rows = list(csv.DictReader((tmp_path / "whatif.csv").read_text().splitlines()))
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert (tmp_path / "whatif.png").stat().st_size > 10_000
    assert [float(row["structure.mode[0].damping"]) for row in rows] == [0.011, 0.022]
    for row, damping, point in zip(rows, (0.011, 0.022), summary["points"], strict=True):
        single = chatter.lobes(case.patch({"structure.mode[0].damping": damping})).summary()
        expected = single["operating_point"]["critical_depth_mm"]
        assert float(row["critical_depth_mm"]) == pytest.approx(expected, rel=1e-8)
        assert point["critical_depth_mm"] == expected
        assert row["verdict"] == point["verdict"] == "stable"
    # twice the damping, in words
    first = summary["changes"][0]
    assert first.startswith("critical depth at 10000 rpm: ")
    assert first.endswith("as structure.mode[0].damping goes from 0.011 to 0.022")
    before, after = (point["critical_depth_mm"] for point in summary["points"])
    assert f"{before:.4g} mm -> {after:.4g} mm ({100 * (after / before - 1):+.3g} %)" in first


def counted(monkeypatch, name, stop_at=None):
    """Count evaluations of a measure; interrupt at one of them."""
    calls = []
    real = measures.MEASURES[name]

    def evaluate(*args):
        if stop_at is not None and len(calls) == stop_at:
            raise KeyboardInterrupt
        calls.append(args)
        return real.evaluate(*args)

    replaced = measures.Measure(real.name, real.quantities, evaluate, real.logarithmic)
    monkeypatch.setitem(measures.MEASURES, name, replaced)
    return calls


def test_a_study_that_was_stopped_computes_only_the_rest(case, tmp_path, monkeypatch):
    vary = {"cut.axial_depth": ["1 mm", "1.5 mm", "2 mm", "2.5 mm"]}
    with monkeypatch.context() as patch:
        calls = counted(patch, "critical depth", stop_at=2)
        with pytest.raises(RunError, match="2 of 4 points are finished"):
            whatif(case, vary, "critical depth", folder=tmp_path)
        assert len(calls) == 2
    told = []
    with monkeypatch.context() as patch:
        calls = counted(patch, "critical depth")
        resumed = whatif(
            case, vary, "critical depth", folder=tmp_path, resumed=lambda *a: told.append(a)
        )
        assert len(calls) == 2
        assert told == [(2, 4)]
        # all are there now
        whatif(case, vary, "critical depth", folder=tmp_path)
        assert len(calls) == 2
        # another method, another case: nothing of it holds
        whatif(case, vary, "critical depth", folder=tmp_path, method="zero-order")
        assert len(calls) == 6
        whatif(case.patch({"material.Krc": 1e8}), vary, "critical depth", folder=tmp_path)
        assert len(calls) == 10
    assert resumed.outcomes == whatif(case, vary, "critical depth").outcomes


def test_points_without_a_result_do_not_spoil_the_others(case, tmp_path):
    # flutes that run into each other within the depth of cut
    angles = [["30 deg", "30 deg"], ["0 deg", "89 deg"]]
    study = whatif(case, {"tool.helix": angles}, "critical depth", folder=tmp_path)
    assert study.values()[0] > 0.0
    assert study.values()[1] is None
    assert "no result at tool.helix" in study.sentences()[-1]
    study.save(tmp_path)
    with pytest.raises(InputError, match="run into each other"):
        whatif(case, {"tool.helix": angles[1:]}, "critical depth")


def test_forces_of_a_rigid_tool_are_proportional_to_the_depth(case):
    rigid = case.patch({"structure": None, "simulation.revolutions": 4})
    study = whatif(rigid, {"cut.axial_depth": ["1 mm", "2 mm", "4 mm"]}, "forces")
    assert np.array(study.values()) / study.values()[0] == pytest.approx([1, 2, 4], rel=1e-6)
    power = study.values("mean_power_W")
    assert np.array(power) / power[0] == pytest.approx([1, 2, 4], rel=1e-6)


def test_surface_of_a_rigid_tool_has_the_error_of_its_runout(case):
    """The outermost tooth alone cuts the wall: it lies deeper by the offset."""
    rigid = case.patch({"structure": None, "simulation.revolutions": 20})
    study = whatif(rigid, {"tool.runout.offset": ["0 um", "20 um"]}, "surface")
    change = np.diff(study.values())[0]
    assert change == pytest.approx(20.0, abs=0.5)
    assert study.outcomes[0].curves


def test_surface_of_a_ball_that_leans_is_its_floor():
    """It leaves no wall; feed marks of a circle are f^2 / (8 R) high."""
    ball = chatter.Case.from_dict(
        {
            "tool": {"kind": "ball", "teeth": 2, "diameter": "6 mm"},
            "material": {"law": "linear", "Ktc": "2000 MPa", "Krc": "800 MPa"},
            "cut": {
                "mode": "down", "spindle_speed": "18000 rpm", "feed_per_tooth": "0.1 mm",
                "axial_depth": "0.2 mm", "stepover": "0.2 mm", "lead": "10 deg",
            },
            "simulation": {"revolutions": 20},
        },
        "leaning ball",
    )  # fmt: skip
    study = whatif(ball, {"cut.feed_per_tooth": ["0.1 mm", "0.2 mm"]}, "surface")
    assert study.values("surface_location_error_um") == [None, None]
    assert study.values("floor_Rz_um") == pytest.approx(
        [1e3 * f**2 / 24.0 for f in (0.1, 0.2)], 0.06
    )
    assert study.quantity == "floor_error_um"
    assert all("none" not in sentence for sentence in study.sentences())
    assert [one.panel for one in study.outcomes[0].curves] == ["floor [µm]"]


def test_frf_of_a_machine_follows_stiffness_and_mass(machine_file):
    machine = load_model(machine_file)
    study = whatif(machine, {"connector.column.stiffness.x": ["20 N/um", "80 N/um"]})
    soft, stiff = study.outcomes
    low, high = soft.numbers["peak_frequency_Hz"], stiff.numbers["peak_frequency_Hz"]
    # light damping: peaks at sqrt(k/m), heights 1/(c w)
    assert low == pytest.approx(math.sqrt(20e6 / 100.0) / (2 * math.pi), rel=2e-3)
    assert high / low == pytest.approx(2.0, rel=3e-3)
    heights = study.values()  # um/N
    assert heights[0] == pytest.approx(1e6 / (2000.0 * math.sqrt(20e6 / 100.0)), rel=5e-3)
    assert heights[0] / heights[1] == pytest.approx(2.0, rel=5e-3)
    assert f"{heights[0]:.4g} um/N" in study.sentences()[0]


def test_lobes_of_a_case_follow_its_machine(case_on_machine, machine_file):
    case = load_model(case_on_machine).patch(
        {"cut.spindle_speed": "1500 rpm", "lobes.depths.to": "60 mm"}
    )
    values = ["0.2 kN*s/m", "0.5 kN*s/m"]
    study = whatif(case, {"machine.connector.column.damping.x": values}, "critical depth")
    low, high = study.values()
    print(low, high)
    assert high > 1.5 * low
    # the same through a machine file of its own
    other = machine_file.with_name("other.toml")
    text = machine_file.read_text().replace('x = "2 kN*s/m"', 'x = "0.5 kN*s/m"')
    other.write_text(text)
    single = chatter.check(case.patch({"structure.machine": other.name}), "zero-order")
    assert high == pytest.approx(single.critical_depth * 1e3, rel=1e-9)


@pytest.mark.parametrize("name", preset_studies())
def test_ready_studies_fit_their_examples(name):
    """Every patch of a ready study is valid on its example."""
    from chatter.studies.model import patched
    from chatter.studies.whatif.design import chosen_layout, points_of
    from chatter.studies.whatif.variation import read_variation

    study = preset_studies()[name]
    model = patched(load_model(study.file()), study.settings)
    variations = [read_variation(text, model) for text in study.vary]
    for point in points_of(variations, chosen_layout(variations, study.tornado)):
        patched(model, point.patch)
    measures.measure_of(study.result, model)


def test_a_value_that_nothing_uses_is_said_to_be_without_effect(case):
    study = whatif(case, {"tool.clearance_angle": ["5 deg", "9 deg"]}, "critical depth")
    assert "tool.clearance_angle has no effect on what is computed here (critical depth)" in (
        study.sentences()
    )
    study = whatif(case, {"material.Ktc": ["500 MPa", "900 MPa"]}, "critical depth")
    assert not any("no effect" in one for one in study.sentences())
