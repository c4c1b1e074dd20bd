"""Delay between the channels of FRFs: found where a drive point would give power, only there."""

from dataclasses import replace

import numpy as np
import pytest

from chatter.description.case import loads
from chatter.explain.measurement import Measurement, Run
from chatter.explain.records.response_delay import without_delay
from dynamics.frf.container import Frf
from dynamics.identification.fit import delay_between_channels

CASE = """
[tool]
teeth = 4
diameter = "10 mm"
[[structure.mode]]
frequency = "1070 Hz"
damping = 0.03
mass = "0.9 kg"
direction = [1, 0, 0]
"""
LINES = np.arange(400.0, 3000.0, 2.0)
#: Hz, damping ratio, kg, direction: the case lacks all but the first
MODES = (
    (1070.0, 0.03, 0.9, (1.0, 0.0)),
    (1960.0, 0.04, 0.35, (0.8, 0.6)),
    (2600.0, 0.03, 0.3, (1, 0)),
)


def receptance(response=0, force=0):
    """Receptance (n,), m/N, of the modes, by hand."""
    omega = 2.0 * np.pi * LINES
    return sum(
        shape[response] * shape[force] / mass
        / ((2.0 * np.pi * f) ** 2 - omega**2 + 2j * damping * 2.0 * np.pi * f * omega)
        for f, damping, mass, shape in MODES
    )  # fmt: skip


def measured(exact, direction, seed, delay=0.0, condition="idle"):
    """Run of an FRF behind a chain in which the response lags, s, with the scatter of a sensor."""
    noise = np.random.default_rng(seed).standard_normal((2, LINES.size))
    values = exact * np.exp(-2j * np.pi * LINES * delay)
    values = values + 0.003 * np.abs(exact).max() * (noise[0] + 1j * noise[1])
    signals = {"frequency": LINES, "real": values.real, "imag": values.imag}
    return Run(f"{direction}{seed}", {}, signals, condition=condition, direction=direction)


def measurement(*runs, case=CASE):
    described = loads(case)
    return Measurement("frf", "taps", described.folder, described, runs, {})


def values(run):
    return run.signals["real"] + 1j * run.signals["imag"]


@pytest.mark.parametrize("delay", [-28e-6, -20e-6, 15e-6, 40e-6])
@pytest.mark.parametrize("count", [1, 3])
def test_a_delay_is_taken_off(delay, count):
    runs = [measured(receptance(), "x", seed, delay) for seed in range(count)]
    found, notes = without_delay(measurement(*runs))
    for before, after in zip(runs, found.runs, strict=True):
        turned = values(after) / values(before)
        assert np.allclose(np.abs(turned), 1.0)
        lag = np.median(np.unwrap(np.angle(turned)) / (2.0 * np.pi * LINES))
        assert lag == pytest.approx(delay, abs=2e-6)
    (note,) = notes
    assert note.severity == "note"
    assert ("lags" if delay > 0 else "leads") in note.description
    assert "in x is above zero between" in note.description


def test_cross_frfs_of_the_same_sensor_are_put_right_and_others_are_not():
    cross, other = receptance(0, 1), receptance(1, 1)
    runs = (
        measured(receptance(), "x", 0, 25e-6),
        measured(cross, "xy", 1, 25e-6),
        measured(other, "y", 2),
    )  # fmt: skip
    found, _ = without_delay(measurement(*runs))
    assert found.runs[2].signals is runs[2].signals
    noise = 0.003 * np.abs(cross).max()
    assert np.abs(values(found.runs[1]) - cross).std() < 3.0 * noise


def of_both_axes(delay_of_x, delay_of_y):
    """Three FRFs along each axis, too noisy to show that power flows out."""
    along_y = sum(
        1.0 / mass / ((2.0 * np.pi * f) ** 2 - omega**2 + 2j * damping * 2.0 * np.pi * f * omega)
        for f, damping, mass in ((860.0, 0.04, 1.1), (1700.0, 0.03, 0.5))
        for omega in [2.0 * np.pi * LINES]
    )
    return [
        run
        for seed in range(3)
        for run in (
            measured(receptance(), "x", seed, delay_of_x),
            measured(along_y, "y", 10 + seed, delay_of_y),
        )
    ]


@pytest.mark.parametrize("delay", [-6e-6, 6e-6])
def test_a_delay_that_both_axes_share_is_taken_off_though_no_power_flows_out(delay):
    runs = of_both_axes(delay, delay)
    for axis in "xy":
        own = [run for run in runs if run.direction == axis]
        assert without_delay(measurement(*own))[1] == []
    found, notes = without_delay(measurement(*runs))
    for before, after in zip(runs, found.runs, strict=True):
        turned = values(after) / values(before)
        lag = np.median(np.unwrap(np.angle(turned)) / (2.0 * np.pi * LINES))
        assert lag == pytest.approx(delay, abs=1e-6)
    (note,) = notes
    assert note.severity == "note"
    assert ("lags" if delay > 0 else "leads") in note.description
    assert "several axes" in note.description


@pytest.mark.parametrize("delays", [(0.0, 0.0), (6e-6, 0.0), (3e-6, 7e-6), (5e-6, -5e-6)])
def test_delays_that_differ_by_axis_are_of_the_structure(delays):
    runs = of_both_axes(*delays)
    found, notes = without_delay(measurement(*runs))
    assert notes == []
    assert all(one.signals is run.signals for one, run in zip(found.runs, runs, strict=True))


@pytest.mark.parametrize("seed", range(4))
def test_frfs_without_a_delay_are_as_they_were(seed):
    runs = tuple(measured(receptance(), "x", 10 * seed + k) for k in range(3))
    found, notes = without_delay(measurement(*runs))
    assert notes == []
    assert all(one.signals is run.signals for one, run in zip(found.runs, runs, strict=True))


def test_an_frf_between_two_points_is_said_to_be_none_of_a_drive_point():
    # modes of opposite sign: no delay makes it one
    one, all_of_them = receptance(1, 1), receptance()
    run = measured(all_of_them - 3.0 * one, "x", 0)
    found, notes = without_delay(measurement(run))
    assert np.array_equal(values(found.runs[0]), values(run))
    assert "no delay accounts for it" in notes[0].description


def test_a_small_error_of_phase_between_resonances_of_little_damping_is_no_other_point():
    # as on a free beam with a damping of 0.0005, where the loss between resonances is next to none
    omega = 2.0 * np.pi * LINES
    exact = sum(
        1.0 / ((2.0 * np.pi * f) ** 2 - omega**2 + 2j * 5e-4 * 2.0 * np.pi * f * omega)
        for f in (700.0, 1500.0, 2400.0)
    )
    values_of = exact * np.exp(0.05j * np.sin(LINES / 90.0))
    run = replace(
        measured(exact, "x", 0),
        signals={"frequency": LINES, "real": values_of.real, "imag": values_of.imag},
    )
    found, notes = without_delay(measurement(run))
    assert notes == []
    assert np.array_equal(values(found.runs[0]), values_of)


def test_a_turned_sign_is_no_delay():
    found, notes = without_delay(measurement(measured(-receptance(), "x", 0)))
    assert notes == []
    assert np.array_equal(values(found.runs[0]), values(measured(-receptance(), "x", 0)))


def test_the_delay_of_one_frf_is_that_of_its_chain():
    exact = receptance() * np.exp(-2j * np.pi * LINES * 20e-6)
    assert delay_between_channels(Frf(LINES, exact)) == pytest.approx(20e-6, abs=1e-6)
    assert delay_between_channels(Frf(LINES, receptance())) == pytest.approx(0.0, abs=1e-6)
