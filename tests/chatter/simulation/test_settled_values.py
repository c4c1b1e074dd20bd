"""Peaks are those of the settled cut; what the start exceeds them by is given apart."""

import numpy as np
import pytest

import chatter
from chatter.description.case import loads
from tests.chatter.simulation.test_worn_flank import CASE
from tests.command_line import chatter_command


def resonant():
    """A cut whose start rings for a long time."""
    return loads(CASE).patch(
        {
            "structure.mode[0].stiffness": "8 N/um",
            "structure.mode[0].damping": 0.004,
            "cut.axial_depth": "0.02 mm",
            "simulation.revolutions": 60,
        }
    )


def test_peaks_are_those_of_the_last_half():
    result = chatter.simulate(resonant())
    summary = result.summary()
    moved = np.linalg.norm(result.displacement, axis=1)
    settled = result.spindle_angle >= 2.0 * np.pi * 30 - 1e-9
    assert 1e-6 * summary["peak_displacement_um"] == pytest.approx(moved[settled].max(), rel=1e-9)
    start = summary["transient"]
    assert 1e-6 * start["peak_displacement_um"] == pytest.approx(moved[~settled].max(), rel=1e-9)
    assert start["peak_displacement_um"] > 1.02 * summary["peak_displacement_um"]
    assert start["until_s"] == pytest.approx(30 * 60.0 / 1200.0, rel=1e-3)
    assert summary["power"]["peak_W"] == pytest.approx(result.power[settled].max(), rel=1e-9)


def test_the_start_is_given_apart_on_the_terminal(tmp_path):
    resonant().save(tmp_path / "case.toml")
    shown = chatter_command("simulate", tmp_path / "case.toml", "--out", tmp_path / "out").stdout
    assert "settled cut" in shown
    assert "at the start, until 1.5 s: up to" in shown


def test_cutting_speed_and_feed_rate_are_shown(tmp_path):
    summary = chatter.simulate(loads(CASE)).summary()
    # pi 16 mm 1200/min; 0.08 mm, 4 teeth, 1200/min
    assert summary["cutting_speed_m_per_min"] == pytest.approx(np.pi * 0.016 * 1200.0)
    assert summary["feed_rate_mm_per_min"] == pytest.approx(0.08 * 4 * 1200.0)
