"""Direction of a motion, averaged over the time of each sample, by quadrature."""

import numpy as np
import pytest

from dynamics.friction.axis_force import SMOOTH, direction_of


def test_a_reversal_between_two_samples_shows_when_it_was():
    """Velocities of 1 mm/s a sample: the sign changes within a fiftieth of one."""
    for late in (0.1, 0.3, 0.45):
        velocity = 1e-3 * (np.arange(-3.0, 4.0) - late)
        expected = np.array([-1.0, -1.0, -1.0, -2.0 * late, 1.0, 1.0, 1.0])
        assert direction_of(velocity) == pytest.approx(expected, abs=1e-3)


def test_the_direction_is_the_mean_over_the_time_of_a_sample():
    velocity = SMOOTH * np.array([-2.0, 0.5, 0.5, 1.0, 4.0])
    ends = np.array([-0.75, 0.5, 0.75, 2.5])
    for sample in (1, 2, 3):
        across = np.linspace(ends[sample - 1], ends[sample], 20001)
        expected = np.mean(np.tanh(across))
        assert direction_of(velocity)[sample] == pytest.approx(expected, abs=1e-4)
    assert direction_of(np.full(4, 3.0 * SMOOTH)) == pytest.approx(np.tanh(3.0))
