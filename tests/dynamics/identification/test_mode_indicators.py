"""Mode indicator function and modal assurance criterion."""

from __future__ import annotations

import numpy as np
import pytest

from dynamics.frf.container import Frf
from dynamics.identification.mode_indicators import modal_assurance, mode_indicator_function
from dynamics.modal.modes import Mode, receptance_matrix

LINES = np.arange(50.0, 2001.0, 2.0)
THREE = (Mode(310.0, 0.02, 0.8), Mode(905.0, 0.035, 0.35), Mode(1490.0, 0.012, 0.2))


def drive_point() -> Frf:
    values = receptance_matrix(THREE, LINES)[:, 0, 0] * (2j * np.pi * LINES) ** 2
    rng = np.random.default_rng(0)
    noise = rng.standard_normal(LINES.size) + 1j * rng.standard_normal(LINES.size)
    return Frf(LINES, values + 1e-3 * np.max(np.abs(values)) * noise, "accelerance")


def test_mode_indicator_falls_at_modes_alone():
    frequency, indicator = mode_indicator_function([drive_point()])
    for mode in THREE:
        assert np.interp(mode.frequency, frequency, indicator) < 0.1
    assert np.interp(600.0, frequency, indicator) > 0.9


def test_modal_assurance_of_known_shapes():
    shapes = [[1.0, 1.0], [2j, 2j], [1.0, -1.0], [1.0, 0.0]]
    expected = [[1, 1, 0, 0.5], [1, 1, 0, 0.5], [0, 0, 1, 0.5], [0.5, 0.5, 0.5, 1]]
    assert modal_assurance(shapes) == pytest.approx(np.array(expected, dtype=float))
    apart = modal_assurance([[1.0, np.nan], [np.nan, 1.0]])
    assert apart == pytest.approx(np.eye(2))
