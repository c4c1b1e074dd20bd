"""From measured FRFs to limits: the same as from the modes that made them."""

import json

import numpy as np
import pytest

import chatter
import chatter.description.case
from chatter.compile.measured_frf import is_passive
from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.stability.model import milling_model
from dynamics.frf.container import Frf
from dynamics.modal.modes import Mode, receptance_matrix

MODES = (
    Mode(820.0, 0.03, 0.45, (1.0, 0.0, 0.0)),
    Mode(1430.0, 0.02, 0.30, (1.0, 0.0, 0.0)),
    Mode(760.0, 0.035, 0.50, (0.0, 1.0, 0.0)),
)
LINES = np.arange(200.0, 2600.0, 4.0)


def write_frf(path, values, unit="m/N"):
    rows = [f"frequency [Hz],real [{unit}],imag [{unit}]"]
    rows += [f"{f:.3f},{v.real:.9e},{v.imag:.9e}" for f, v in zip(LINES, values, strict=True)]
    path.write_text("\n".join(rows) + "\n")


@pytest.fixture
def tap_test(tmp_path):
    """Receptances in x and y with a little noise, x as accelerance in g/N."""
    rng = np.random.default_rng(3)
    full = receptance_matrix(MODES, LINES)
    for axis, name in enumerate("xy"):
        values = full[:, axis, axis].copy()
        values += (
            2e-4
            * np.abs(values).max()
            * (rng.normal(size=LINES.size) + 1j * rng.normal(size=LINES.size))
        )
        if name == "x":
            write_frf(tmp_path / "x.csv", -((2 * np.pi * LINES) ** 2) * values / 9.80665, "g/N")
        else:
            write_frf(tmp_path / "y.csv", values * 1e6, "um/N")
    return tmp_path


def case_with(structure, folder="."):
    return Case.from_dict(
        {
            "tool": {"teeth": 3, "diameter": "12 mm"},
            "material": {"Ktc": "800 MPa", "Krc": "250 MPa"},
            "cut": {
                "mode": "down",
                "spindle_speed": "9000 rpm",
                "feed_per_tooth": "0.05 mm",
                "axial_depth": "1 mm",
                "radial_depth": "6 mm",
            },
            "structure": structure,
            "lobes": {
                "speeds": {"from": "6000 rpm", "to": "14000 rpm", "count": 9},
                "depths": {"to": "12 mm", "count": 60},
            },
        },
        folder=folder,
    )


def measured_case(folder):
    files = [{"file": f"{axis}.csv", "direction": axis} for axis in "xy"]
    return case_with({"frf": files}, folder)


def direct_case():
    tables = [
        {"frequency": m.frequency, "damping": m.damping, "mass": m.mass, "direction": m.direction}
        for m in MODES
    ]
    return case_with({"mode": tables})


def test_fitted_modes_are_those_that_made_the_frfs(tap_test):
    found = sorted(
        milling_model(measured_case(tap_test)).structure.modes, key=lambda m: m.frequency
    )
    for mode, truth in zip(found, sorted(MODES, key=lambda m: m.frequency), strict=True):
        assert mode.frequency == pytest.approx(truth.frequency, rel=1e-3)
        assert mode.damping == pytest.approx(truth.damping, rel=0.02)
        assert mode.mass == pytest.approx(truth.mass, rel=0.02)
        assert mode.direction == pytest.approx(truth.direction, abs=1e-9)


@pytest.mark.parametrize("method", ["semi-discretization", "zero-order"])
def test_limits_from_measured_frfs(tap_test, method):
    measured = chatter.lobes(measured_case(tap_test), method=method).limits.critical_depth
    direct = chatter.lobes(direct_case(), method=method).limits.critical_depth
    assert measured == pytest.approx(direct, rel=0.03)


def test_zero_order_needs_no_fit(tap_test, monkeypatch):
    def refuse(*_args, **_options):
        raise AssertionError("the zeroth-order solution asked for a modal fit")

    monkeypatch.setattr("chatter.compile.measured_frf.identify_modes", refuse)
    from chatter.stability.methods.zeroth_order.limits import zero_order_of

    model = milling_model(measured_case(tap_test))
    assert np.isfinite(zero_order_of(model, np.array([900.0])).critical_depth[0])


def test_tool_and_workpiece_add_up(tmp_path):
    full = receptance_matrix(MODES[:1], LINES)[:, 0, 0]
    write_frf(tmp_path / "half.csv", 0.5 * full)
    files = [{"file": "half.csv", "direction": "x", "side": side} for side in ("tool", "workpiece")]
    lines, both = milling_model(case_with({"frf": files}, tmp_path)).receptance
    expected = receptance_matrix(MODES[:1], lines)[:, 0, 0]
    assert both[:, 0, 0] == pytest.approx(expected, rel=1e-6)


def test_frf_without_direction_is_taken_for_both_and_said(tmp_path):
    write_frf(tmp_path / "tap.csv", receptance_matrix(MODES[:1], LINES)[:, 0, 0])
    model = milling_model(case_with({"frf": "tap.csv"}, tmp_path))
    assert {mode.direction for mode in model.structure.modes} == {(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)}
    assert any("no direction" in note for note in model.notes)


def test_missing_and_broken_files_are_told_together(tmp_path):
    (tmp_path / "bad.csv").write_text("frequency [Hz],real [m/N],imag [m/N]\n1,nan,2\n2,1,1\n")
    files = [{"file": "no.csv", "direction": "x"}, {"file": "bad.csv", "direction": "y"}]
    with pytest.raises(InputError) as error:
        milling_model(case_with({"frf": files}, tmp_path))
    assert len(error.value.messages) == 2
    assert "no.csv" in error.value.messages[0]
    assert "bad.csv" in error.value.messages[1]


def test_power_flows_into_a_drive_point():
    drive = receptance_matrix(MODES[:2], LINES)[:, 0, 0]
    ends = drive - 2.0 * receptance_matrix(MODES[1:2], LINES)[:, 0, 0]
    assert is_passive(Frf(LINES, drive))
    assert is_passive(Frf(LINES, -drive))
    assert not is_passive(Frf(LINES, ends))


def test_mirror_points_of_a_beam_give_the_modes_of_its_end(tmp_path):
    # free-free beam, struck at one end, measured at the other: every second sign turns
    ends = receptance_matrix(MODES[:1], LINES) - receptance_matrix(MODES[1:2], LINES)
    write_frf(tmp_path / "ends.csv", ends[:, 0, 0])
    test = chatter.modes(tmp_path / "ends.csv", direction="x")
    masses = [mode.mass for mode in test.fit.modes]
    assert masses == pytest.approx([MODES[0].mass, MODES[1].mass], rel=0.01)
    assert any("no drive point" in note for note in test.notes)


def test_files_of_a_modal_test(tap_test, tmp_path):
    test = chatter.modes([tap_test / "x.csv"], direction="x")
    test.save(tmp_path / "out")
    summary = json.loads((tmp_path / "out/summary.json").read_text())
    assert summary["fit_error"]["maximum"] < 0.05
    assert len(summary["modes"]) == 2
    snippet = (tmp_path / "out/modes.toml").read_text()
    assert chatter.description.case.loads(snippet).structure.mode[0].frequency == pytest.approx(
        820, rel=1e-3
    )


def test_shipped_beam_has_six_modes():
    from chatter.io.shipped_examples import example

    test = chatter.modes(example("flexible-workpiece").folder / "beam.uff", direction="y")
    found = [mode.frequency for mode in test.fit.modes]
    # resonances as its README gives them
    assert found == pytest.approx([52, 142, 279, 460, 687, 959], rel=0.01)
    assert test.fit.worst_error < 0.05
