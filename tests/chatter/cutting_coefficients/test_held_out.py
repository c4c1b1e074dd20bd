"""Cuts that were not fitted, of a tool that vibrates: by a time integration of its own."""

import json
import math

import numpy as np
import pytest
import scipy

import chatter
from chatter.cutting_coefficients.feed_series import at_feed
from chatter.description.errors import InputError
from tests.command_line import chatter_command

TURN, DEPTH, RUNOUT = 100.0, 1e-3, 2e-6
TRUE = {"Ktc": 900e6, "Krc": 300e6, "Kac": 150e6, "Kte": 20e3, "Kre": 25e3, "Kae": 10e3}
STIFFNESS, FREQUENCY, DAMPING = 8e6, 640.0, 0.05
RATE = 50_000
FEEDS = (0.04, 0.07, 0.1, 0.14)
CASE = """
[tool]
teeth = 2
diameter = "20 mm"
helix = "0 deg"
[cut]
mode = "slot"
spindle_speed = "6000 rpm"
feed_per_tooth = "0.05 mm"
axial_depth = "1 mm"
"""


def vibrating(feed, start):
    """Forces on a tool (n, 3) that vibrates along y and cuts its own waves; two straight edges."""
    count, period = RATE // 2, RATE // round(2 * TURN)
    omega = 2.0 * math.pi * FREQUENCY
    # exact over a step with the force held
    system = scipy.signal.cont2discrete(
        (np.array([[0.0, 1.0], [-(omega**2), -2.0 * DAMPING * omega]]),
         np.array([[0.0], [omega**2 / STIFFNESS]]), np.eye(2), np.zeros((2, 1))), 1.0 / RATE,
    )  # fmt: skip
    (a, b), (c, d) = system[0].tolist()
    e, f = system[1].ravel().tolist()
    place, velocity = 0.0, 0.0
    motion, forces = np.zeros(count), np.zeros((count, 3))
    for n in range(count):
        turn = 2.0 * math.pi * TURN * n / RATE + start
        motion[n] = place
        before = motion[n - period] if n >= period else 0.0
        along_y = 0.0
        for tooth, runout in enumerate((RUNOUT, -RUNOUT)):
            angle = (turn + math.pi * tooth) % (2.0 * math.pi)
            chip = feed * math.sin(angle) + 2.0 * runout + (place - before) * math.cos(angle)
            if angle >= math.pi or chip <= 0.0:
                continue
            ft = DEPTH * (TRUE["Ktc"] * chip + TRUE["Kte"])
            fr = DEPTH * (TRUE["Krc"] * chip + TRUE["Kre"])
            forces[n, 0] -= ft * math.cos(angle) + fr * math.sin(angle)
            along_y += ft * math.sin(angle) - fr * math.cos(angle)
            forces[n, 2] += DEPTH * (TRUE["Kac"] * chip + TRUE["Kae"])
        forces[n, 1] = along_y
        place, velocity = (
            a * place + b * velocity + e * along_y,
            c * place + d * velocity + f * (along_y),
        )
    return forces


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Records behind a dynamometer with a resonance, the start of vibration left out."""
    path = tmp_path_factory.mktemp("vibrating")
    (path / "case.toml").write_text(CASE, encoding="utf-8")
    time = np.arange(RATE // 2) / RATE
    omega = 2.0 * math.pi * 900.0
    runs = []
    for feed, start in zip(FEEDS, (0.3, 2.0, 4.4, 5.1), strict=True):
        forces = vibrating(1e-3 * feed, start)
        sensor = scipy.signal.lti([omega**2], [1.0, 0.1 * omega, omega**2])
        seen = np.column_stack([scipy.signal.lsim(sensor, one, time)[1] for one in forces.T])
        settled = slice(RATE // 10, None, 5)
        np.savetxt(
            path / f"feed_{feed}.csv", np.c_[time[settled], seen[settled]], delimiter=",",
            comments="", header="time [s],Fx [N],Fy [N],Fz [N]",
        )  # fmt: skip
        runs.append(f'[[run]]\nfile = "feed_{feed}.csv"\nfeed_per_tooth = "{feed} mm"\n')
    (path / "measurement.toml").write_text(
        'kind = "milling"\ncase = "case.toml"\n' + "".join(runs), encoding="utf-8"
    )
    return path


def test_forces_of_a_vibrating_tool_at_other_feeds_are_predicted(folder, tmp_path):
    held = ("feed_0.07.csv", "feed_0.14.csv")
    options = [part for name in held for part in ("--hold-out", name)]
    shown = chatter_command("coefficients", folder, *options, "--out", tmp_path)
    assert "cuts that were not fitted" in shown.stdout
    summary = json.loads((tmp_path / "coefficients.json").read_text())
    assert set(summary["not_fitted"]) == set(held)
    assert {one["run"] for one in summary["mean_forces"]} == {"feed_0.04.csv", "feed_0.1.csv"}
    assert_predicted(summary["not_fitted"])


def test_each_cut_is_predicted_by_the_others(folder):
    found = chatter.coefficients(folder).with_waveforms()
    summary = found.summary()
    worst = found.waveforms.worst_peaks()
    assert set(worst) == {"between", "beyond"}
    # the edge of a tooth that misses shows in the axial force alone
    assert 0.0 < worst["between"] < 0.2
    assert set(summary["waveforms"]["holdout"]) == {f"feed_{feed}.csv" for feed in FEEDS}
    assert_predicted(summary["waveforms"]["holdout"])


def assert_predicted(cuts):
    for channels in cuts.values():
        for name, one in channels.items():
            assert one["mean_predicted_N"] == pytest.approx(one["mean_N"], rel=0.03)
            # where the smallest feed lets a tooth miss, the axial force of its edge drops at once
            most = 0.2 if name == "Fz" else 0.03
            measured = one["peak_to_peak_N"]
            assert one["peak_to_peak_predicted_N"] == pytest.approx(measured, rel=most)
            assert name == "Fz" or one["left"] < 0.1


def test_a_run_that_is_not_there_cannot_be_held_out(folder):
    with pytest.raises(InputError, match=r"none\.csv is held out, and is no run; there are feed"):
        chatter.coefficients(folder, hold_out=["none.csv"])
    with pytest.raises(InputError, match="all runs are held out"):
        chatter.coefficients(folder, hold_out=[f"feed_{feed}.csv" for feed in FEEDS])


def test_values_between_feeds_are_on_lines_and_feeds_twice_count_once():
    feeds, values = (3.0, 1.0, 2.0, 2.0), np.array([9.0, 1.0, 3.0, 5.0])
    assert at_feed(1.5, feeds, values) == pytest.approx(2.5)
    assert at_feed(2.5, feeds, values) == pytest.approx(6.5)
    assert at_feed(4.0, feeds, values) == pytest.approx(14.0)
    assert at_feed(0.0, feeds, values) == pytest.approx(-2.0)
    assert at_feed(7.0, (2.0,), [4.0]) == pytest.approx(4.0)
