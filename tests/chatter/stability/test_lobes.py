"""Lobe diagrams and checks end to end: files, numbers, agreement of the two methods."""

import csv
import json
import math

import numpy as np
import pytest

import chatter
from tests.cases import tool_of_922_hertz

RPM = math.pi / 30.0


def two_degrees_of_freedom(**cut):
    """Cut of a tool that is alike along the feed and across it."""
    small = {"mode": "up", "spindle_speed": "20000 rpm", "axial_depth": "2.5 mm"}
    return tool_of_922_hertz(
        ((1, 0, 0), (0, 1, 0)),
        cut={**small, "radial_depth": "0.8 mm", **cut},
        lobes={
            "speeds": {"from": "15000 rpm", "to": "20000 rpm", "count": 5},
            "depths": {"to": "10 mm", "count": 60},
        },
    )


def rows_of(path):
    with path.open() as file:
        return list(csv.DictReader(file))


def test_files_of_a_diagram(tmp_path):
    diagram = chatter.lobes(two_degrees_of_freedom(), grid=True)
    written = diagram.save(tmp_path)
    assert {path.name for path in written} == {"lobes.csv", "lobes.png", "summary.json", "grid.npz"}
    rows = rows_of(tmp_path / "lobes.csv")
    assert list(rows[0]) == [
        "spindle_speed [rpm]",
        "critical_depth [mm]",
        "chatter_frequency [Hz]",
        "bifurcation",
    ]
    # validation 2.3: 1.651214 mm Hopf at 15 000 rpm, 3.250386 mm flip at 20 000 rpm
    assert float(rows[0]["critical_depth [mm]"]) == pytest.approx(1.651214, rel=2e-4)
    assert float(rows[-1]["critical_depth [mm]"]) == pytest.approx(3.250386, rel=2e-4)
    assert (rows[0]["bifurcation"], rows[-1]["bifurcation"]) == ("hopf", "flip")
    grid = np.load(tmp_path / "grid.npz")
    assert grid["spectral_radius"].shape == (60, 5)
    assert grid["spindle_speed"][0] == pytest.approx(15000.0)
    assert grid["axial_depth"][-1] == pytest.approx(10.0)
    unstable = grid["spectral_radius"][:, -1] > 1.0
    assert grid["axial_depth"][unstable].min() == pytest.approx(3.3333, abs=1e-3)
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["operating_point"]["stable"] is True
    assert summary["operating_point"]["critical_depth_mm"] == pytest.approx(3.250386, rel=2e-4)
    # validation 2.4: 6.8496 mm against 3.2504 mm at 20 000 rpm
    ratio = diagram.zero_order.critical_depth / diagram.limits.critical_depth
    assert ratio[-1] == pytest.approx(6.8496 / 3.2504, rel=1e-3)
    assert summary["zero_order"]["highest_ratio"] == pytest.approx(ratio.max())


@pytest.mark.parametrize(
    ("rpm", "depth", "radius", "stable", "kind"),
    [
        # validation 2.2, two degrees of freedom, up-milling at 5 %
        ("5000 rpm", "1 mm", 0.8404703243, True, "none"),
        ("15000 rpm", "4 mm", 1.1290631919, False, "hopf"),
        ("20000 rpm", "4 mm", 1.1638620576, False, "flip"),
    ],
)
def test_check_of_published_points(rpm, depth, radius, stable, kind):
    summary = chatter.check(two_degrees_of_freedom(spindle_speed=rpm, axial_depth=depth)).summary()
    assert summary["spectral_radius"] == pytest.approx(radius, rel=2e-5)
    assert summary["stable"] is stable
    assert summary["bifurcation"] == kind
    assert (summary["chatter_frequency_Hz"] is None) is stable
    json.dumps(summary, allow_nan=False)


def test_chatter_frequency_of_a_growing_flip():
    summary = chatter.check(two_degrees_of_freedom(axial_depth="4 mm")).summary()
    half_tooth_passing = 20000 / 60 * 2 / 2
    # an odd multiple of half the tooth-passing frequency, the one near the mode
    assert summary["chatter_frequency_Hz"] == pytest.approx(3 * half_tooth_passing, rel=1e-6)


def test_fixed_steps_give_plain_semi_discretization():
    case = two_degrees_of_freedom().patch(
        {
            "cut.mode": "slot",
            "cut.radial_depth": None,
            "cut.spindle_speed": "5000 rpm",
            "cut.axial_depth": "1 mm",
            "structure.mode": [
                {
                    "frequency": "922 Hz",
                    "damping": 0.011,
                    "mass": "0.03993 kg",
                    "direction": [1, 0, 0],
                }
            ],
            "lobes.steps": 40,
        }
    )
    # published for first-order semi-discretization with 40 steps (validation 2.1)
    assert chatter.check(case).spectral_radius == pytest.approx(1.35026, abs=6e-6)


def test_methods_agree_in_slotting_with_many_teeth():
    case = two_degrees_of_freedom(mode="slot", radial_depth=None).patch({"tool.teeth": 5})
    case = case.patch({"lobes.depths.to": "1 mm", "lobes.speeds.count": 25})
    diagram = chatter.lobes(case)
    ratio = diagram.zero_order.critical_depth / diagram.limits.critical_depth
    assert np.all(np.abs(ratio[np.isfinite(ratio)] - 1.0) < 0.03)
    assert np.isfinite(ratio).sum() > 15


def test_zero_order_method_fills_the_same_files(tmp_path):
    diagram = chatter.lobes(two_degrees_of_freedom(), method="zero-order")
    diagram.save(tmp_path)
    rows = rows_of(tmp_path / "lobes.csv")
    assert float(rows[-1]["critical_depth [mm]"]) == pytest.approx(6.849643, rel=1e-5)
    assert {row["bifurcation"] for row in rows} == {"hopf"}


def test_symmetric_structure_cannot_tell_up_from_down():
    # validation 1.7: equal modes in x and y, equal multipliers
    up, down = (
        chatter.check(two_degrees_of_freedom(mode=mode, axial_depth="1 mm")).spectral_radius
        for mode in ("up", "down")
    )
    assert up == pytest.approx(down, rel=1e-6)


def test_process_damping_raises_the_limit_at_low_speed():
    case = two_degrees_of_freedom(
        spindle_speed="1500 rpm", radial_depth="8 mm", axial_depth="0.1 mm"
    ).patch({"lobes": None})
    depths = [
        chatter.check(case.patch({"process_damping.coefficient": c})).critical_depth
        for c in (1e-6, 2e3, 1e4)
    ]
    assert depths[0] < depths[1] < depths[2]


def test_side_of_a_mode_changes_nothing():
    case = two_degrees_of_freedom(axial_depth="4 mm")
    turned = case.patch({"structure.mode[0].side": "workpiece"})
    assert chatter.check(turned).spectral_radius == chatter.check(case).spectral_radius


def test_threads_do_not_change_a_byte(monkeypatch):
    case = two_degrees_of_freedom()
    results = []
    for threads in (1, 3):
        monkeypatch.setattr("chatter.engine.parallel.worker_count", lambda n=threads: n)
        results.append(chatter.lobes(case).limits.critical_depth.tobytes())
    assert results[0] == results[1]


@pytest.mark.parametrize("depth", ["1 mm", "60 mm", "200 mm"])
def test_the_first_limit_is_found_however_deep_the_cut_is(depth):
    """The unstable depths from 2.105 to 2.311 mm lie between two of a thousand over 200 mm."""
    case = tool_of_922_hertz().patch({"cut.axial_depth": depth})
    assert chatter.check(case).critical_depth == pytest.approx(2.10469e-3, rel=1e-5)


@pytest.mark.parametrize(
    "speed",
    [
        "2400 rpm",
        pytest.param("1200 rpm", marks=pytest.mark.nightly),
        pytest.param("300 rpm", marks=pytest.mark.nightly),
    ],
)
def test_methods_agree_on_the_chatter_frequency_at_low_speed(speed):
    """Many folds of the period: the root's dip is narrower than that at a natural frequency."""
    two = {"damping": 0.03, "stiffness": "12 N/um"}
    case = chatter.Case.from_dict(
        {
            "tool": {"teeth": 4, "diameter": "16 mm", "helix": "40 deg"},
            "material": {"Ktc": "1900 MPa", "Krc": "700 MPa", "Kte": "25 N/mm", "Kre": "40 N/mm"},
            "cut": {
                "mode": "down",
                "radial_depth": "8 mm",
                "axial_depth": "0.5 mm",
                "spindle_speed": speed,
                "feed_per_tooth": "0.08 mm",
            },
            "structure": {
                "mode": [
                    {**two, "frequency": "900 Hz", "direction": [1, 0, 0]},
                    {**two, "frequency": "950 Hz", "direction": [0, 1, 0]},
                ]
            },
        }
    )
    by_elements, by_harmonics = (
        chatter.check(case, method=name).limit for name in ("collocation", "multi-frequency")
    )
    assert by_harmonics.critical_depth == pytest.approx(by_elements.critical_depth, rel=1e-3)
    assert by_harmonics.chatter_frequency == pytest.approx(by_elements.chatter_frequency, rel=1e-3)
