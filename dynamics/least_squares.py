"""Nonlinear least squares from small normal equations, by the trust region of scipy.

Where residuals number 1e5 and unknowns some 30, as in modal fits by variable projection, only the
normal equations are kept, summed over the records. With N = J' J = Q W Q' and g = J' f, the square
matrix W^1/2 Q' and the vector W^-1/2 Q' g, joined by what is left of the sum of squares, have the
same normal equations, gradient and sum of squares: to `scipy.optimize.least_squares` they are the
problem itself.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, Protocol, TypeVar

import numpy as np
import scipy
from numpy.typing import NDArray


class Linearised(Protocol):
    """A sum of squares with its gradient and Gauss-Newton matrix at one point."""

    @property
    def chi_square(self) -> float:
        """Sum of squared residuals."""

    @property
    def gradient(self) -> NDArray[np.float64]:
        """Half the gradient of the sum of squares, (p,)."""

    @property
    def normal(self) -> NDArray[np.float64]:
        """Jacobian transposed times Jacobian, (p, p)."""


Point = TypeVar("Point", bound=Linearised)

#: evaluations at the most
MAX_EVALUATIONS = 60
#: relative fall of the sum of squares in one step at which the iteration ends
PRECISE = 1e-8
#: the same where the sum of squares is only compared with another one
ROUGH = 2e-3
#: smallest eigenvalue of the scaled normal equations, relative to the largest, that is kept
_SINGULAR = 1e-14


def least_squares(
    evaluate: Callable[[NDArray[np.float64]], Point],
    start: NDArray[np.float64],
    reach: NDArray[np.float64],
    least_gain: float = PRECISE,
) -> Point:
    """Minimise a sum of squares that is known by its normal equations.

    Parameters
    ----------
    evaluate : callable
        Parameters (p,) -> sum of squares, half gradient and Gauss-Newton matrix there.
    start : (p,) array of float
    reach : (p,) array of float
        Size of a first step that is sensible; the trust region begins with it.
    least_gain : float
        Relative fall of the sum of squares in one step at which the iteration ends.

    Returns
    -------
    Linearised
        At the optimum; its sum of squares is never larger than at the start.
    """
    if start.size == 0:
        return evaluate(start)
    points = _Points(evaluate, start)
    found = scipy.optimize.least_squares(
        points.residuals,
        np.zeros(start.size),  # steps from the start: the trust region begins with `reach`
        points.jacobian,
        x_scale=reach,
        ftol=least_gain,
        xtol=1e-14,
        gtol=1e-15,
        max_nfev=MAX_EVALUATIONS,
    )
    return points.at(found.x)


class _Points(Generic[Point]):
    """Evaluations as scipy asks for them: the residuals of a step, then perhaps their Jacobian."""

    def __init__(
        self, evaluate: Callable[[NDArray[np.float64]], Point], start: NDArray[np.float64]
    ) -> None:
        self.evaluate, self.start = evaluate, start
        self.kept: dict[bytes, Point] = {}

    def at(self, step: NDArray[np.float64]) -> Point:
        key = step.tobytes()
        if key not in self.kept:
            # the best point so far and the one tried; older ones are not asked for again
            for old in list(self.kept)[:-2]:
                del self.kept[old]
            self.kept[key] = self.evaluate(self.start + step)
        return self.kept[key]

    def residuals(self, step: NDArray[np.float64]) -> NDArray[np.float64]:
        point = self.at(step)
        root, basis, scale = _factor(point)
        projected = basis.T @ (scale * point.gradient)
        projected = np.divide(projected, root, out=np.zeros_like(root), where=root > 0.0)
        rest = max(point.chi_square - float(projected @ projected), 0.0)
        return np.append(projected, np.sqrt(rest))

    def jacobian(self, step: NDArray[np.float64]) -> NDArray[np.float64]:
        root, basis, scale = _factor(self.at(step))
        return np.vstack([root[:, None] * basis.T / scale, np.zeros(step.size)])


def _factor(
    point: Linearised,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Square roots of eigenvalues (p,), vectors (p, p) and scale (p,) of the normal equations.

    A direction that the residuals do not depend on has the root 0 and is not moved along.
    """
    diagonal = np.diag(point.normal)
    scale = 1.0 / np.sqrt(np.maximum(diagonal, _SINGULAR * np.max(diagonal) + 1e-300))
    values, basis = np.linalg.eigh(point.normal * scale[:, None] * scale)
    return np.sqrt(np.where(values > _SINGULAR * values[-1], values, 0.0)), basis, scale
