"""Modes that the residual of FRFs proposes, and where none is sought."""

import numpy as np
import pytest

from chatter.description.case import loads
from chatter.explain.effects.missing_mode import MissingMode
from chatter.explain.effects.resembling_modes import resembling_modes
from chatter.explain.kinds.frf import FrfRecord
from chatter.explain.measurement import Measurement, Run

CASE = """
[tool]
teeth = 2
diameter = "12 mm"
[[structure.mode]]
frequency = "200 Hz"
damping = 0.04
mass = "60 kg"
direction = [1, 0, 0]
"""
LINES = np.arange(10.0, 500.0, 0.5)
#: frequencies between which a mode is sought, Hz
SOUGHT = (60.0, 700.0)
#: natural frequency, Hz, damping ratio, compliance, m/N, and direction, rad, of the missing mode
MISSING = (341.0, 0.03, 4e-9, 0.6)


def response(direction):
    """FRF of the missing mode alone, by its formula."""
    frequency, damping, compliance, angle = MISSING
    ratio = LINES / frequency
    along = {"x": np.cos(angle), "y": np.sin(angle)}
    share = along[direction[0]] * along[direction[-1]]
    return share * compliance / (1.0 - ratio**2 + 2j * damping * ratio)


@pytest.fixture
def measured(tmp_path):
    record = FrfRecord(np.full(LINES.size, 1e-11))
    runs = []
    for direction in ("x", "y", "xy"):
        values = response(direction)
        signals = {"frequency": LINES, "real": values.real, "imag": values.imag}
        runs.append(Run(direction, {}, signals, direction=direction, record=record))
    return Measurement("frf", "taps", tmp_path, loads(CASE, "case.toml"), tuple(runs), {})


def test_the_mode_that_is_missing_is_proposed(measured):
    nothing = {"real": np.zeros(LINES.size), "imag": np.zeros(LINES.size)}
    first = resembling_modes(measured, {run.name: nothing for run in measured.runs}, SOUGHT)[0]
    frequency, damping, compliance, angle = MISSING
    # the frequencies tried are five percent apart
    assert first["frequency"] == pytest.approx(frequency, rel=0.03)
    assert first["damping"] == pytest.approx(damping, abs=0.06)
    assert 0.2 * compliance < first["compliance"] < 5.0 * compliance
    assert first["angle"] % np.pi == pytest.approx(angle, abs=0.05)


def test_no_mode_is_sought_beyond_the_lines_that_were_measured(measured):
    frequency = MissingMode().parameters(measured)[0]
    assert (frequency.lower, frequency.upper) == (10.0, LINES[-1])
    far = {"real": np.full(LINES.size, -1e-10), "imag": np.zeros(LINES.size)}
    found = resembling_modes(measured, {run.name: far for run in measured.runs}, SOUGHT)
    assert all(one["frequency"] <= LINES[-1] for one in found)
