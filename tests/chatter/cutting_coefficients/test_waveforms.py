"""Coefficients from whole waveforms, against a sum over discs and teeth of its own."""

import json
import math

import numpy as np
import pytest
import scipy

import chatter
from tests.command_line import chatter_command

TEETH, RADIUS, DEPTH, HELIX = 3, 6e-3, 2e-3, math.radians(30.0)
ARC = (0.0, math.acos(1.0 - 3e-3 / RADIUS))  # up-milling, 3 mm wide
TRUE = {"Ktc": 1100e6, "Krc": 350e6, "Kac": 180e6, "Kte": 18e3, "Kre": 25e3, "Kae": 5e3}
#: of the spindle, nominally 3000 rpm; runout in m and rad
TURN, RUNOUT, DIRECTION = 2.0 * math.pi * 50.2, 8e-6, 0.7
FEEDS = (4e-5, 1e-4)
STARTS = (1.3, 4.1)
OFFSETS = ((40.0, -25.0, 15.0), (-30.0, 10.0, 20.0))
CASE = """
[tool]
kind = "end mill"
teeth = 3
diameter = "12 mm"
helix = "30 deg"
[cut]
mode = "up"
radial_depth = "3 mm"
spindle_speed = "3000 rpm"
feed_per_tooth = "0.05 mm"
axial_depth = "2 mm"
"""


def forces(time, feed, start, radial_power=1.0):
    """Forces on the tool (n, 3): Altintas 2012, eq. 2.31, feed along x, angle clockwise from +y."""
    found = np.zeros((time.size, 3))
    discs = 60
    radii = [RUNOUT * math.cos(DIRECTION - 2.0 * math.pi * j / TEETH) for j in range(TEETH)]
    for tooth in range(TEETH):
        for disc in range(discs):
            lag = math.tan(HELIX) * DEPTH / RADIUS * (disc + 0.5) / discs
            # the tooth that follows in the sense of rotation comes later, as it does in the file
            angle = (TURN * time + start + 2.0 * math.pi * tooth / TEETH - lag) % (2.0 * math.pi)
            # a tooth cuts what the one ahead of it, or one further ahead, has left
            chip = np.min(
                [
                    m * feed * np.sin(angle) + radii[tooth] - radii[(tooth + m) % TEETH]
                    for m in range(1, TEETH + 1)
                ],
                axis=0,
            )
            cuts = (angle > ARC[0]) & (angle < ARC[1]) & (chip > 0.0)
            chip = np.where(cuts, chip, 0.0)
            power = 1e-4 * (np.maximum(chip, 1e-12) / 1e-4) ** radial_power
            width = DEPTH / discs * cuts
            ft = (TRUE["Ktc"] * chip + TRUE["Kte"]) * width
            fr = (TRUE["Krc"] * power + TRUE["Kre"] * (radial_power == 1.0)) * width
            fa = (TRUE["Kac"] * chip + TRUE["Kae"]) * width
            found += np.c_[
                -ft * np.cos(angle) - fr * np.sin(angle),
                ft * np.sin(angle) - fr * np.cos(angle),
                fa,
            ]
    return found


def behind_resonance(values, step, frequency, damping):
    """Output of an oscillator of static gain 1, from rest, exact for an input held by lines."""
    omega = 2.0 * math.pi * frequency
    system = scipy.signal.lti([omega**2], [1.0, 2.0 * damping * omega, omega**2])
    return scipy.signal.lsim(system, values, step * np.arange(values.size))[1]


def records(
    folder, channels="", senses=(1.0, 1.0, 1.0), offsets=OFFSETS, noise=5.0, resonance=None, **law
):
    (folder / "case.toml").write_text(CASE, encoding="utf-8")
    random = np.random.default_rng(11)
    runs = []
    time = np.arange(0.0, 0.4, 2e-4)
    for feed, start, offset in zip(FEEDS, STARTS, offsets, strict=True):
        values = forces(time, feed, start, **law)
        if resonance:
            # lines between coarse samples would weaken what drives the oscillator
            fine = np.arange(0.0, 0.4, 5e-5)
            along_x = forces(fine, feed, start, **law)[:, 0]
            values[:, 0] = behind_resonance(along_x, fine[1], *resonance)[::4]
        values = values * np.array(senses) + np.array(offset)
        values += np.outer(time / time[-1] - 0.5, [20.0, -10.0, 5.0])
        values += noise * random.standard_normal(values.shape)
        file = f"feed_{1e3 * feed:g}.csv"
        np.savetxt(
            folder / file, np.c_[time, values], delimiter=",", comments="",
            header="time [s],Fx [N],Fy [N],Fz [N]",
        )  # fmt: skip
        runs.append(f'[[run]]\nfile = "{file}"\nfeed_per_tooth = "{1e3 * feed} mm"\n')
    (folder / "measurement.toml").write_text(
        'kind = "milling"\ncase = "case.toml"\n' + channels + "".join(runs), encoding="utf-8"
    )
    return folder


def fitted(folder):
    summary = chatter.coefficients(folder).with_waveforms().summary()
    return {**summary["waveforms"], "linear_law_holds": summary["linear_law_holds"]}


def numbers(part):
    factors = {"MPa": 1e6, "N/mm": 1e3, "um": 1e-6}
    return {
        one["name"]: (
            one["value"] * factors[one["unit"]],
            one["standard_deviation"] * factors[one["unit"]],
        )
        for one in part
    }


def test_coefficients_and_runout_come_back_under_offset_and_drift(tmp_path):
    found = fitted(records(tmp_path))
    assert found["law"] == "linear"
    assert found["linear_law_holds"]
    for name, (value, deviation) in numbers(found["coefficients"]).items():
        assert value == pytest.approx(TRUE[name], rel=0.04), name
        assert abs(value - TRUE[name]) < 3.0 * deviation, name
        assert deviation < 0.05 * TRUE[name], name
    along, across = (value for value, _ in numbers(found["runout"]).values())
    assert math.hypot(along, across) == pytest.approx(RUNOUT, rel=0.03)
    for cut, offset in zip(found["offsets"].values(), OFFSETS, strict=True):
        assert list(cut.values()) == pytest.approx(offset, abs=2.0)
    for cut in found["cuts"]:
        assert cut["spindle_speed_rpm"] == pytest.approx(3012.0, abs=0.1)
        one = cut["channels"]["Fx"]
        assert one["peak_to_peak_predicted_N"] == pytest.approx(one["peak_to_peak_N"], rel=0.05)


def test_runout_turns_with_the_start_angle(tmp_path):
    found = fitted(records(tmp_path))
    along, across = (value for value, _ in numbers(found["runout"]).values())
    starts = [math.radians(one["value"]) for one in found["start_angles"]]
    # which tooth is the first is not known: both may be turned together by a pitch
    pitch = 2.0 * math.pi / TEETH
    turned = round((starts[0] - STARTS[0]) / pitch) * pitch
    assert starts[0] - turned == pytest.approx(STARTS[0], abs=0.01)
    assert math.remainder(starts[1] - turned - STARTS[1], 2.0 * math.pi) == pytest.approx(
        0.0, abs=0.01
    )
    angle = math.atan2(across, along)
    assert math.remainder(angle + turned - DIRECTION, 2.0 * math.pi) == pytest.approx(0.0, abs=0.05)


def test_channels_as_the_record_declares_them(tmp_path):
    channels = "".join(
        f'[channels.F{axis}]\nquantity = "force"\non = "workpiece"\n{sign}direction = {direction}\n'
        for axis, direction, sign in (
            ("x", [1, 0, 0], 'sign = "unknown"\n'), ("y", [0, 1, 0], ""), ("z", [0, 0, 1], "")
        )
    )  # fmt: skip
    # forces on the work are opposite; that along x was taken with its sign turned again
    found = fitted(records(tmp_path, channels=channels, senses=(1.0, -1.0, -1.0)))
    assert found["signs"] == {"Fx": -1.0}
    values = numbers(found["coefficients"])
    assert values["Ktc"][0] == pytest.approx(TRUE["Ktc"], rel=0.04)
    assert values["Krc"][0] == pytest.approx(TRUE["Krc"], rel=0.04)


def test_a_radial_force_that_levels_off_is_not_forced_onto_a_line(tmp_path):
    found = fitted(records(tmp_path, offsets=((0.0,) * 3,) * 2, radial_power=0.4))
    assert not found["linear_law_holds"]


def test_a_resonance_of_the_dynamometer_is_told_from_the_law(tmp_path):
    found = fitted(records(tmp_path, resonance=(900.0, 0.05)))
    assert set(found["resonances"]) == {"Fx"}
    assert found["resonances"]["Fx"]["frequency_Hz"] == pytest.approx(900.0, rel=0.02)
    values = numbers(found["coefficients"])
    for name in ("Ktc", "Krc", "Kac"):
        assert values[name][0] == pytest.approx(TRUE[name], rel=0.04), name


def test_intervals_hold_the_truth_behind_three_resonances_and_a_low_pass(tmp_path):
    folder = records(tmp_path)
    random = np.random.default_rng(4)
    fine = np.arange(0.0, 0.4, 5e-5)
    resonances = ((760.0, 0.04), (915.0, 0.03), (1180.0, 0.05))
    low_pass = scipy.signal.butter(2, 2.0 * math.pi * 1800.0, analog=True)
    for feed, start, offset in zip(FEEDS, STARTS, OFFSETS, strict=True):
        seen = [
            scipy.signal.lsim(low_pass, behind_resonance(one, fine[1], *resonance), fine)[1]
            for one, resonance in zip(forces(fine, feed, start).T, resonances, strict=True)
        ]
        time, values = fine[::4], np.column_stack(seen)[::4] + np.array(offset)
        values += np.outer(time / time[-1] - 0.5, [20.0, -10.0, 5.0])
        values += 5.0 * random.standard_normal(values.shape)
        np.savetxt(
            folder / f"feed_{1e3 * feed:g}.csv", np.c_[time, values], delimiter=",", comments="",
            header="time [s],Fx [N],Fy [N],Fz [N]",
        )  # fmt: skip
    summary = chatter.coefficients(folder).with_waveforms().summary()
    assert summary["from"] == "waveforms"
    assert summary["linear_law_holds"] is True
    assert summary["waveforms"]["low_pass_Hz"] == pytest.approx(1800.0, rel=0.2)
    for axis, (frequency, _) in zip("xyz", resonances, strict=True):
        found = summary["waveforms"]["resonances"][f"F{axis}"]["frequency_Hz"]
        assert found == pytest.approx(frequency, rel=0.02)
    for name, (value, deviation) in numbers(summary["coefficients"]).items():
        assert abs(value - TRUE[name]) < 3.0 * deviation, name
        assert deviation < 0.1 * TRUE[name], name


def test_the_command_writes_law_and_picture(tmp_path):
    folder = records(tmp_path)
    out = tmp_path / "out"
    shown = chatter_command("coefficients", folder, "--waveforms", "--out", out)
    assert "whole waveforms of 2 cuts" in shown.stdout
    assert (out / "waveforms.png").stat().st_size > 0
    assert 'law = "linear"' in (out / "material-waveforms.toml").read_text()
    assert json.loads((out / "coefficients.json").read_text())["waveforms"]["law"] == "linear"


def test_a_law_that_pulls_the_tooth_into_the_work_is_not_written(tmp_path, monkeypatch):
    found = chatter.coefficients(records(tmp_path)).with_waveforms()
    assert found.waveforms.has_material
    assert not found.waveforms.notes
    monkeypatch.setitem(TRUE, "Krc", -0.3 * TRUE["Ktc"])
    (tmp_path / "pulled").mkdir()
    pulled = chatter.coefficients(records(tmp_path / "pulled")).with_waveforms()
    assert not pulled.waveforms.has_material
    assert "below zero" in " ".join(pulled.waveforms.notes)
    written = [path.name for path in pulled.save(tmp_path / "out")]
    assert "material-waveforms.toml" not in written
