"""Rails of imported parts, between their points, against the theory of beams."""

import numpy as np
import pytest

from dynamics.reduction.imported_part import bent_beam
from dynamics.structure.bodies import rigid_motion

AXIS = np.array([2.0, -1.0, 2.0]) / 3.0
ACROSS = np.array([1.0, 2.0, 0.0]) / np.sqrt(5.0)
LENGTH = 0.4


@pytest.mark.parametrize("share", [0.0, 0.2, 0.7, 1.0])
def test_rigid_motion_stays_rigid(share):
    first, second = np.eye(6), rigid_motion(LENGTH * AXIS)
    found = bent_beam(first, second, LENGTH * AXIS, share)
    np.testing.assert_allclose(found, rigid_motion(share * LENGTH * AXIS), atol=1e-14)


@pytest.mark.parametrize("share", [0.25, 0.6])
def test_cantilever_bends_as_in_the_textbook(share):
    """Force F at the end: w = F x^2 (3 l - x) / 6 E I across, slope F x (2 l - x) / 2 E I."""
    force_over_stiffness = 3e-3

    def motion(x):
        deflection = force_over_stiffness * x**2 * (3.0 * LENGTH - x) / 6.0
        slope = force_over_stiffness * x * (2.0 * LENGTH - x) / 2.0
        # theta x axis = slope across, so theta = slope axis x across
        return np.concatenate([deflection * ACROSS, slope * np.cross(AXIS, ACROSS)])[:, None]

    found = bent_beam(motion(0.0), motion(LENGTH), LENGTH * AXIS, share)
    np.testing.assert_allclose(found, motion(share * LENGTH), atol=1e-12)


def test_stretch_and_twist_are_linear():
    first, second = np.zeros((6, 2)), np.zeros((6, 2))
    second[:3, 0], second[3:, 1] = 5e-6 * AXIS, 2e-5 * AXIS
    found = bent_beam(first, second, LENGTH * AXIS, 0.3)
    np.testing.assert_allclose(found[:3, 0], 1.5e-6 * AXIS, atol=1e-20)
    np.testing.assert_allclose(found[3:, 1], 0.6e-5 * AXIS, atol=1e-20)
    np.testing.assert_allclose(found[3:, 0], 0.0, atol=1e-20)
    np.testing.assert_allclose(found[:3, 1], 0.0, atol=1e-20)
