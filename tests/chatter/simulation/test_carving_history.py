"""When a cell is cut away: a disc that moves along x reaches each at a known time."""

from types import SimpleNamespace

import numpy as np
import pytest

from chatter.simulation.carving_history import removal_times

SPEED, RADIUS, DURATION = 0.02, 5e-3, 2.0  # m/s, m, s


def test_a_cell_goes_when_the_disc_reaches_it():
    time = np.linspace(0.0, DURATION, 401)
    path = SimpleNamespace(position_at=lambda t: np.array([SPEED * np.asarray(t), 0.0 * t]))
    slices = SimpleNamespace(radius=np.array([RADIUS]))
    result = SimpleNamespace(time=time, setup=SimpleNamespace(path=path, slices=slices))
    material = np.zeros((40, 80), dtype=bool)
    material[39] = True  # beyond the disc
    corners = ((0.0, -8e-3), (0.04, 8e-3))
    times = removal_times(result, material, corners, 0)
    assert np.all(np.isinf(times[39]) & (times[39] > 0.0))
    assert np.all(times[0] == -np.inf)  # 7.8 mm off the path: the tool never came
    x = (np.arange(80) + 0.5) * 0.04 / 80
    y = -8e-3 + 20.5 * 16e-3 / 40
    reached = (x - np.sqrt(RADIUS**2 - y**2)) / SPEED
    assert times[20] == pytest.approx(np.maximum(reached, 0.0), abs=2.0 * DURATION / 400)
