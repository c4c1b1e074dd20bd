"""Two masses on springs and dampers, stepped exactly, and their analytic receptance."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import expm

STEP = 5e-4  # s
MASS = np.diag([2.0, 1.0])  # kg
STIFFNESS = np.array([[9.0e4, -3.0e4], [-3.0e4, 5.0e4]])  # N/m, modes near 25 and 40 Hz
DAMPING = np.array([[30.0, -5.0], [-5.0, 15.0]])  # N s/m

_RATE = np.block(
    [
        [np.zeros((2, 2)), np.eye(2)],
        [-np.linalg.solve(MASS, STIFFNESS), -np.linalg.solve(MASS, DAMPING)],
    ]
)
_ENTRY = np.array([0.0, 0.0, 0.5, 0.0])  # force on the first mass


def receptance(s):
    """Motions of both masses per force on the first, m/N, shape (len(s), 2)."""
    dynamic = s[:, None, None] ** 2 * MASS + s[:, None, None] * DAMPING + STIFFNESS
    return np.linalg.inv(dynamic)[:, :, 0]


def transition(step=STEP):
    """Exact transition, state per held force and per change of force over a step."""
    block = np.zeros((6, 6))
    block[:4, :4], block[:4, 4] = _RATE * step, _ENTRY * step
    block[4, 5] = 1.0
    over = expm(block)
    return over[:4, :4], over[:4, 4], over[:4, 5]


def response(force, joined_by_lines, step=STEP):
    """State (x1, x2, v1, v2) at each sample of a force, held or joined by lines, from rest."""
    move, held, change = transition(step)
    states = np.zeros((len(force), 4))
    state = np.zeros(4)
    growth = np.diff(force) if joined_by_lines else np.zeros(len(force) - 1)
    for k in range(len(force) - 1):
        state = move @ state + held * force[k] + change * growth[k]
        states[k + 1] = state
    return states


@pytest.fixture(scope="session")
def two_masses():
    return SimpleNamespace(
        step=STEP,
        inverse_mass=0.5,  # 1/kg, of the first mass
        receptance=receptance,
        response=response,
        transition=transition,
    )
