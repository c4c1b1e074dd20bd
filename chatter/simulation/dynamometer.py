"""Forces as a dynamometer with a resonance of its own shows them."""

from __future__ import annotations

import math

import numpy as np
import scipy.signal
from numpy.typing import NDArray

from chatter.description.case import Case
from dynamics.matrix_exponential import exact_step

_FORCES = slice(0, 3)


def as_measured(case: Case, rows: NDArray[np.float64], step: float) -> NDArray[np.float64]:
    """Rows of a record whose forces have gone through the dynamometer of a case.

    Parameters
    ----------
    case : Case
    rows : (n, c) array of float
        Forces, N, in the first three columns.
    step : float
        From row to row, s.

    Returns
    -------
    (n, c) array of float
        The same rows where the case has no [dynamometer].
    """
    sensor = case.dynamometer
    if sensor is None or len(rows) < 2:
        return rows
    measured = rows.copy()
    measured[:, _FORCES] = through_resonance(
        rows[:, _FORCES], sensor.frequency, sensor.damping, step
    )
    return measured


def through_resonance(
    force: NDArray[np.float64], frequency: float, damping: float, step: float
) -> NDArray[np.float64]:
    """Answer (n, k) of m''/w^2 + 2 D m'/w + m = f to forces (n, k) that are linear in steps.

    Parameters
    ----------
    force : (n, k) array of float
        N; the sensor is at rest before.
    frequency : float
        Natural frequency, Hz.
    damping : float
        D.
    step : float
        s.

    Notes
    -----
    Exact for a force that varies linearly from row to row.
    """
    omega = 2.0 * math.pi * frequency
    matrix = omega * np.array([[0.0, 1.0], [-1.0, -2.0 * damping]])
    transition, held, ramp = exact_step(matrix, np.array([[0.0], [omega]]), step)
    held, ramp = held[:, 0], ramp[:, 0]
    # z transfer from the force at the beginning and at the end of a step
    trace, determinant = np.trace(transition), np.linalg.det(transition)
    ahead, behind = ramp, held - ramp
    first = [0.0, ahead[0], transition[0, 1] * ahead[1] - transition[1, 1] * ahead[0]]
    last = [0.0, behind[0], transition[0, 1] * behind[1] - transition[1, 1] * behind[0]]
    numerator = np.array([first[1], first[2] + last[1], last[2]])
    return scipy.signal.lfilter(numerator, [1.0, -trace, determinant], force, axis=0)
