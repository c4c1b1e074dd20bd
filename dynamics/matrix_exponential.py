"""Exact steps of linear systems: the matrix exponential of the system with its inputs."""

from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray


class ExactStep(NamedTuple):
    """What a step of x' = A x + B u makes of the state and of an input linear in time."""

    transition: NDArray[np.float64]  # exp(A h), (n, n)
    constant: NDArray[np.float64]  # state per input that is 1 over the step, (n, k)
    ramp: NDArray[np.float64]  # state per input that grows from 0 to 1 over the step, (n, k)


def exact_step(matrix: NDArray[np.float64], entry: NDArray[np.float64], step: float) -> ExactStep:
    """Discretise x' = A x + B u exactly.

    Parameters
    ----------
    matrix : (n, n) array of float
        A.
    entry : (n, k) array of float
        B.
    step : float
        h.

    Notes
    -----
    exp of [A, B, 0; 0, 0, I; 0, 0, 0] (Van Loan 1978, IEEE Trans. Autom. Control 23:395).
    """
    states, inputs = entry.shape
    block = np.zeros((states + 2 * inputs,) * 2)
    block[:states, :states] = matrix * step
    block[:states, states : states + inputs] = entry * step
    block[states : states + inputs, states + inputs :] = np.eye(inputs)
    over = scipy.linalg.expm(block)[:states]
    return ExactStep(*np.split(over, [states, states + inputs], axis=1))
