"""Long FRFs on fewer lines, and modes weighed without a whole fit for each."""

from __future__ import annotations

import numpy as np
import pytest

from dynamics.frf.container import Frf
from dynamics.identification.condensed import condensed
from dynamics.identification.prepare import prepare
from dynamics.identification.refinement import falls_with_a_pole, fit_residues, rises_without_a_mode
from dynamics.identification.residues import ALL_TERMS
from dynamics.modal.modes import Mode, receptance_matrix

LINES = np.arange(1.0, 8001.0) * 0.25
#: half-power bandwidths of 80, 38 and (one narrow) 2 lines
MODES = (Mode(500.0, 0.02, 1.0), Mode(800.0, 0.006, 0.7), Mode(1250.0, 2e-4, 20.0))
NATURAL = 2.0 * np.pi * np.array([mode.frequency for mode in MODES])
DAMPING = np.array([mode.damping for mode in MODES])


@pytest.fixture(scope="module")
def records():
    rng = np.random.default_rng(3)
    omega = 2.0 * np.pi * LINES
    values = -(omega**2) * receptance_matrix(MODES, LINES)[:, 0, 0]
    noise = rng.standard_normal(LINES.size) + 1j * rng.standard_normal(LINES.size)
    values = values + 1e-3 * np.max(np.abs(values)) * noise
    measurement = prepare([Frf(LINES, values, "accelerance")], (50.0, 1900.0))
    return measurement.of([0], measurement.searched)


def test_fewer_lines_say_the_same_of_models_near_and_far(records):
    fewer = condensed(records)
    assert fewer.frequency.size < 0.25 * records.frequency.size
    best = [fit_residues(lines, NATURAL, DAMPING, ALL_TERMS) for lines in (records, fewer)]
    assert best[1].chi_square == pytest.approx(best[0].chi_square, rel=0.03)
    assert best[1].coefficients[:3, 0] == pytest.approx([1.0, 1 / 0.7, 1 / 20.0], rel=0.02)
    for factor in (1.0002, 1.002):
        rise = [
            fit_residues(lines, NATURAL * factor, DAMPING, ALL_TERMS).chi_square - one.chi_square
            for lines, one in zip((records, fewer), best, strict=True)
        ]
        assert rise[1] == pytest.approx(rise[0], rel=0.01)


def test_resonance_of_two_lines_stays(records):
    """Within a block of lines it is no noise, however well a polynomial would do elsewhere."""
    fewer = condensed(records)
    near = np.abs(fewer.frequency - MODES[2].frequency) < 1.0
    assert np.sum(near) == np.sum(np.abs(records.frequency - MODES[2].frequency) < 1.0)
    without = fit_residues(fewer, NATURAL[:2], DAMPING[:2], ALL_TERMS)
    whole = fit_residues(records, NATURAL[:2], DAMPING[:2], ALL_TERMS)
    falls = [
        falls_with_a_pole(lines, model, NATURAL[2:], DAMPING[2:])[0]
        for lines, model in ((fewer, without), (records, whole))
    ]
    assert falls[0] == pytest.approx(falls[1], rel=0.01)


def test_short_records_stay_as_they_are(records):
    short = records.lines(records.frequency < 400.0)
    assert condensed(short) is short


def test_a_mode_more_or_less_costs_what_a_whole_fit_says(records):
    model = fit_residues(records, NATURAL, DAMPING, ALL_TERMS)
    rises = rises_without_a_mode(records, model)
    for mode in range(3):
        keep = np.arange(3) != mode
        lesser = fit_residues(records, NATURAL[keep], DAMPING[keep], ALL_TERMS)
        rise = lesser.chi_square - model.chi_square
        assert rises[mode] == pytest.approx(rise, rel=1e-6)
        falls = falls_with_a_pole(records, lesser, NATURAL[mode : mode + 1], DAMPING[[mode]])
        assert falls[0] == pytest.approx(rise, rel=1e-6)
