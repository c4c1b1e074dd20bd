"""Receptance of a machine without damping at and beside its natural frequency."""

import numpy as np
import pytest

from dynamics.machine.description import Machine
from dynamics.machine.harmonic import structure_receptance
from dynamics.structure.linear_structure import LinearStructure

MASS, STIFFNESS = 1.0, 4.0  # natural at 2 rad/s, a number without rounding


def receptance(omega):
    one = np.eye(1)
    structure = LinearStructure(MASS * one, 0.0 * one, STIFFNESS * one, points={})
    machine = Machine(structure, (), (), (), (), None)
    found = structure_receptance(machine, np.array([omega / (2.0 * np.pi)]), one)
    return found[0, 0, 0]


@pytest.mark.parametrize("omega", [0.5, 1.999, 2.001, 7.0])
def test_beside_it_is_that_of_mass_and_spring(omega):
    # 1 / (k - m w^2): in phase below, in opposition above
    assert receptance(omega) == pytest.approx(1.0 / (STIFFNESS - MASS * omega**2), rel=1e-9)


def test_at_it_is_a_number_beyond_all_others():
    at = receptance(2.0)
    assert np.isfinite(at)
    assert abs(at) > 1e12 / STIFFNESS
