"""Spindle speed by the revolution with which forces repeat."""

import math

import numpy as np
import pytest

from chatter.explain.data_checks import spindle
from chatter.explain.measurement import Run

TEETH, SPEED = 4, 100.0 * 2.0 * math.pi  # rad/s


def record(revolutions, speed):
    """Force of four teeth with runout; 200 samples a revolution."""
    time = np.arange(200 * revolutions) * 2.0 * math.pi / SPEED / 200.0
    angle = speed * time
    force = 100.0 + 40.0 * np.cos(TEETH * angle) + 15.0 * np.cos(angle)
    return Run("run", {}, {"time": time, "Fx": force})


@pytest.mark.parametrize("revolutions", [50, 2000])
def test_a_speed_beside_the_declared_one_is_told(revolutions):
    true = 1.013 * SPEED
    found = spindle.speed_by_forces(record(revolutions, true), SPEED, TEETH)
    assert found == pytest.approx(true, rel=5e-4)


def test_a_long_record_is_asked_about_no_more_speeds_than_its_end_tells(monkeypatch):
    """Twenty times the revolutions were asked about twenty times the speeds: minutes."""
    asked = []
    repeating = spindle._repeating
    monkeypatch.setattr(
        spindle, "_repeating", lambda *given: asked.append(given[2]) or repeating(*given)
    )
    counts = []
    for revolutions in (400, 2000):
        asked.clear()
        spindle.speed_by_forces(record(revolutions, SPEED), SPEED, TEETH)
        counts.append(len(asked))
    assert counts[1] == pytest.approx(counts[0], rel=0.02)
