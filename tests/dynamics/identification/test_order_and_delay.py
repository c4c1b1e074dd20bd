"""Delay between channels and number of modes where a structure is more than a few real modes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dynamics.frf.container import Frf, Point
from dynamics.identification import tool_point
from dynamics.identification.discrepancy import effective_samples, with_discrepancy
from dynamics.identification.fit import identify_modes
from dynamics.identification.residues import Records
from dynamics.modal.modes import Mode, receptance_matrix

LINES = np.arange(100.0, 3500.0, 2.0)
OMEGA = 2.0 * np.pi * LINES
#: peak receptances 0.66, 0.25 and 0.24 um/N
TOOL = (Mode(1070.0, 0.032, 0.52), Mode(1960.0, 0.035, 0.38), Mode(2640.0, 0.03, 0.25))


def blow_on_a_tool(delay: float, seed: int = 1) -> Frf:
    """Accelerance of three modes among small resonances that are not viscous, little noise."""
    rng = np.random.default_rng(seed)
    receptance = receptance_matrix(TOOL, LINES)[:, 0, 0]
    for _ in range(9):  # each 1 to 4 percent of the peak, up to 40 degrees off a real mode
        natural = 2.0 * np.pi * rng.uniform(250.0, 3300.0)
        damping = rng.uniform(0.01, 0.04)
        peak = rng.uniform(0.01, 0.04) * 0.66e-6 * np.exp(1j * np.radians(rng.uniform(-40, 40)))
        receptance = receptance + peak * 2.0 * damping * natural**2 / (
            natural**2 - OMEGA**2 + 2j * damping * natural * OMEGA
        )
    values = -(OMEGA**2) * receptance * np.exp(-1j * OMEGA * delay)
    noise = rng.standard_normal(LINES.size) + 1j * rng.standard_normal(LINES.size)
    return Frf(LINES, values + 2e-4 * np.max(np.abs(values)) * noise, "accelerance")


class FitThatMisses:
    """A fit with a delay, whose error is the same over all lines, under a noise."""

    terms = ()

    def __init__(self, delay, error, noise):
        self.delay = delay
        self.chi_square = 2.0 * 400 * (error / noise) ** 2
        self._error = np.full((400, 1), error * (1 + 1j) / np.sqrt(2.0))

    def synthesis(self, _tool):
        return self._error


def test_a_delay_is_supported_by_fits_under_the_same_noise(monkeypatch):
    """Without the delay the error is three times as large; the first fit had a far lower noise."""
    error, quiet = 1e-3, np.full((400, 1), 1e-5)
    records = Records(OMEGA[:400], np.zeros((400, 1), complex), quiet, 0)
    judged = replace(records, noise=np.full((400, 1), error))

    def again(tool, _real, _terms, delay, _least_gain):
        missed = error if delay else 3.0 * error
        return FitThatMisses(delay, missed, float(tool.records.noise[0, 0]))

    monkeypatch.setattr(tool_point, "_again", again)
    monkeypatch.setattr(tool_point, "effective_samples", lambda _error: 200.0)
    monkeypatch.setattr(
        tool_point, "_with_discrepancy", lambda tool, _real: replace(tool, records=judged)
    )
    tool = tool_point.ToolPointRecords(records, ("x",), ((0, 0),))
    assert tool_point._supported_delay(tool, FitThatMisses(9e-6, error, 1e-5)) == 9e-6


@pytest.mark.parametrize("delay", [28e-6, -12e-6, 60e-6])
def test_one_blow_gives_the_modes_of_the_tool_and_no_more(delay):
    fit = identify_modes([blow_on_a_tool(delay)])
    assert len(fit.modes) == len(TOOL)
    for found, true in zip(fit.modes, TOOL, strict=True):
        assert found.frequency == pytest.approx(true.frequency, rel=0.01)
        assert 2 * found.damping * found.stiffness == pytest.approx(
            2 * true.damping * true.stiffness, rel=0.1
        )
    assert all(mode.phase_deviation < 15.0 for mode in fit.identified)
    assert fit.models[0].delay == pytest.approx(
        delay, abs=4e-6
    )  # the resonances leave a phase of 5 degrees


def test_delay_is_taken_off_where_there_is_no_drive_point():
    """Residues of a far point are real, of both signs, once 20 us are taken off."""
    delay = 20e-6
    first, second, third = (receptance_matrix((mode,), LINES)[:, 0, 0] for mode in TOOL)
    values = -(OMEGA**2) * (first - 0.7 * second + 0.5 * third) * np.exp(-1j * OMEGA * delay)
    rng = np.random.default_rng(0)
    noise = rng.standard_normal(LINES.size) + 1j * rng.standard_normal(LINES.size)
    values = values + 1e-3 * np.max(np.abs(values)) * noise
    frf = Frf(LINES, values, "accelerance", Point("2", "x"), Point("1", "x"))
    fit = identify_modes([frf])
    assert fit.models[0].delay == pytest.approx(delay, abs=0.5e-6)
    assert [m.frequency for m in fit.identified] == pytest.approx(
        [m.frequency for m in TOOL], rel=2e-3
    )
    residues = np.array([m.residues[0] for m in fit.identified])
    expected = np.array([1.0 / 0.52, -0.7 / 0.38, 0.5 / 0.25])
    assert residues.real == pytest.approx(expected, rel=0.03)
    assert np.max(np.abs(residues.imag / residues.real)) < 0.05


def test_delay_of_an_undelayed_measurement_is_not_made_up():
    receptance = receptance_matrix(TOOL, LINES)[:, 0, 0]
    fit = identify_modes([Frf(LINES, receptance)])
    assert abs(fit.models[0].delay) < 1e-9
    assert not fit.notes


def test_discrepancy_is_the_part_of_the_error_that_is_no_noise():
    rng = np.random.default_rng(3)
    size = 4000
    white = (rng.standard_normal(size) + 1j * rng.standard_normal(size)) / np.sqrt(2.0)
    records = Records(LINES[:1000], white[:1000, None], np.full((1000, 1), 1.0), 0)
    zero = np.zeros((1000, 1))
    assert with_discrepancy(records, zero).noise == pytest.approx(records.noise)
    larger = replace(records, values=5.0 * records.values)  # 25 = 1 + 24
    noise = with_discrepancy(larger, zero).noise
    assert noise**2 == pytest.approx(np.full((1000, 1), 25.0), rel=0.1)


def test_errors_that_are_alike_count_as_few():
    """First-order process with correlation 0.9: 0.1 / 1.9 of the samples."""
    rng = np.random.default_rng(4)
    size = 20000
    drive = rng.standard_normal(size) + 1j * rng.standard_normal(size)
    error = np.zeros(size, dtype=complex)
    for k in range(1, size):
        error[k] = 0.9 * error[k - 1] + drive[k]
    assert effective_samples(error[:, None]) == pytest.approx(2 * size * 0.1 / 1.9, rel=0.06)
    assert effective_samples(drive[:, None]) == pytest.approx(2 * size, rel=0.04)


#: half the peak of its neighbour, from which it is told by no fall to half the power
SHOULDER = Mode(2740.0, 0.034, 0.4)


def test_shoulder_and_small_resonances_leave_the_resonances_that_one_reads():
    """Three maxima are read; the curve of the modes written has them where the FRF has them."""
    measured = blow_on_a_tool(10e-6)
    extra = receptance_matrix((SHOULDER, Mode(1265.0, 0.035, 1.9)), LINES)[:, 0, 0]
    values = measured.values - OMEGA**2 * extra * np.exp(-10e-6j * OMEGA)
    fit = identify_modes([Frf(LINES, values, "accelerance")])
    assert len(fit.modes) == 3
    assert fit.models[0].delay == pytest.approx(10e-6, abs=3e-6)
    size = np.abs(values) / OMEGA**2
    fitted = np.abs(fit.models[0].values_of_modes(LINES)) / OMEGA**2
    for mode in fit.modes:
        near = np.abs(LINES - mode.frequency) < 0.05 * mode.frequency
        assert np.max(fitted[near]) == pytest.approx(np.max(size[near]), rel=0.05)
        where, there = LINES[near][np.argmax(fitted[near])], LINES[near][np.argmax(size[near])]
        assert where == pytest.approx(there, rel=0.01)


def test_neighbours_that_fit_to_the_noise_are_modes_however_close():
    """Without anything that the model misses a shoulder is a mode."""
    true = (*TOOL, SHOULDER)
    rng = np.random.default_rng(5)
    noise = rng.standard_normal(LINES.size) + 1j * rng.standard_normal(LINES.size)
    values = -(OMEGA**2) * receptance_matrix(true, LINES)[:, 0, 0]
    frf = Frf(LINES, values + 1e-3 * np.max(np.abs(values)) * noise, "accelerance")
    found = identify_modes([frf]).modes
    assert [m.frequency for m in found] == pytest.approx([m.frequency for m in true], rel=3e-3)
