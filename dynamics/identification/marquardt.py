"""Levenberg-Marquardt iteration on normal equations."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray


class Linearised(Protocol):
    """A sum of squares with its gradient and Gauss-Newton matrix at one point."""

    @property
    def chi_square(self) -> float:
        """Sum of squared residuals."""

    @property
    def gradient(self) -> NDArray[np.float64]:
        """Half the gradient of the sum of squares."""

    @property
    def normal(self) -> NDArray[np.float64]:
        """Jacobian transposed times Jacobian."""


Point = TypeVar("Point", bound=Linearised)

MAX_ITERATIONS = 60

#: relative fall of the sum of squares in one step at which the iteration ends
PRECISE = 1e-8

#: the same where the sum of squares is only compared with another one
ROUGH = 2e-3


def levenberg_marquardt(
    evaluate: Callable[[NDArray[np.float64]], Point],
    start: NDArray[np.float64],
    limit: Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]],
    least_gain: float = PRECISE,
) -> tuple[NDArray[np.float64], Point]:
    """Minimise a sum of squares (Marquardt 1963, with his diagonal scaling).

    The residuals number 1e5 and the unknowns some 30: only the small normal equations are kept,
    summed over the FRFs, instead of a Jacobian of all residuals.

    Parameters
    ----------
    evaluate : callable
        Point in parameter space -> value, gradient and Gauss-Newton matrix.
    start : (p,) array of float
    limit : callable
        (point, step) -> step cut to what is sensible.
    least_gain : float
        Relative fall of the sum of squares in one step at which the iteration ends.

    Returns
    -------
    parameters : (p,) array of float
    value : Linearised
        Never larger than at the start.
    """
    parameters = start
    value = evaluate(parameters)
    if start.size == 0:
        return parameters, value
    marquardt = 1e-3
    for _ in range(MAX_ITERATIONS):
        diagonal = np.diag(value.normal)
        diagonal = np.maximum(diagonal, 1e-14 * np.max(diagonal) + 1e-300)
        scale = 1.0 / np.sqrt(diagonal)
        matrix = value.normal * scale[:, None] * scale + marquardt * np.eye(start.size)
        step = -scale * np.linalg.solve(matrix, scale * value.gradient)
        step = limit(parameters, step)
        trial = evaluate(parameters + step)
        if trial.chi_square <= value.chi_square:
            gain = value.chi_square - trial.chi_square
            parameters, value = parameters + step, trial
            marquardt = max(marquardt / 6.0, 1e-12)
            if gain <= least_gain * value.chi_square:
                break
        else:
            marquardt *= 4.0
            if marquardt > 1e8:
                break
    return parameters, value
