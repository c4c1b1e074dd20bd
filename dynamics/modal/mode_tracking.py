"""Modes followed from one position of a machine to another, and modal models between positions.

Modes are paired by the modal assurance criterion (Allemang and Brown 1982) so that the sum over
all pairs is largest; a pairing that is not clear is refused rather than guessed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from dynamics.structure.bodies import finite
from dynamics.structure.linear_structure import LinearStructure, StructureError

#: Least assurance of a pair.
LEAST_ASSURANCE = 0.6
#: How much better than the runner-up a pair must be: shapes that look alike tell nothing.
LEAST_LEAD = 0.1


@dataclass(frozen=True, eq=False)
class ModalModel:
    """Real modes with their motion at named points.

    Raises
    ------
    StructureError
        If sizes disagree or a number is negative or not finite.
    """

    frequency: NDArray[np.float64]  # (m,), undamped natural frequencies, Hz, 0 or more
    damping: NDArray[np.float64]  # (m,), ratios, 1
    #: each (6, m), mass-normalised: three displacements (1/sqrt(kg)) and three rotations (rad/(m
    #: sqrt(kg))) of each point
    shapes: Mapping[str, NDArray[np.float64]]
    #: as of `LinearStructure`
    residual: Mapping[tuple[str, str], NDArray[np.float64]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        count = np.size(self.frequency)
        for what in ("frequency", "damping"):
            values = finite("modal model", what, getattr(self, what), (count,))
            if np.any(values < 0.0):
                raise StructureError(f"modal model: {what} {values.min():g} is negative")
            object.__setattr__(self, what, values)
        shapes = {
            name: finite("modal model", f'shapes at "{name}"', rows, (6, count))
            for name, rows in self.shapes.items()
        }
        object.__setattr__(self, "shapes", shapes)

    @classmethod
    def of_reduced(cls, reduced: LinearStructure, points: Sequence[str]) -> ModalModel:
        """Modal model of a structure in modal coordinates, as `reduction.truncated` gives it.

        Damping that couples modes is left out: the diagonal counts. Raises StructureError if its
        mass is not the unit matrix or its stiffness not diagonal.
        """
        squared = np.diag(reduced.stiffness)
        off = np.max(np.abs(reduced.stiffness - np.diag(squared)), initial=0.0)
        unit = np.max(np.abs(reduced.mass - np.eye(reduced.size)), initial=0.0)
        if unit > 1e-6 or off > 1e-6 * np.max(squared, initial=0.0):
            raise StructureError("modal model: the structure is not in modal coordinates")
        omega = np.sqrt(np.maximum(squared, 0.0))
        over = np.diag(reduced.damping)
        ratios = np.divide(over, 2.0 * omega, out=np.zeros_like(omega), where=omega > 0.0)
        for name in points:
            reduced.port(name, np.zeros(3))
        return cls(
            omega / (2.0 * np.pi),
            ratios,
            {name: reduced.points[name] for name in points},
            {pair: left for pair, left in reduced.residual.items() if set(pair) <= set(points)},
        )

    def structure(self) -> LinearStructure:
        """Structure in modal coordinates."""
        omega = 2.0 * np.pi * self.frequency
        return LinearStructure(
            np.eye(omega.size),
            np.diag(2.0 * self.damping * omega),
            np.diag(omega**2),
            self.shapes,
            self.residual,
        )

    def in_order(
        self, order: NDArray[np.int64], signs: float | NDArray[np.float64] = 1.0
    ) -> ModalModel:
        """Modes (k,) picked by their places, each times a sign."""
        return ModalModel(
            self.frequency[order],
            self.damping[order],
            {name: rows[:, order] * signs for name, rows in self.shapes.items()},
            self.residual,
        )

    def stacked(self, lever: float = 0.0) -> NDArray[np.float64]:
        """(6 points, m): all motions, rotations times a lever in m."""
        scale = np.repeat([1.0, lever], 3)[:, None]
        return np.vstack([scale * self.shapes[name] for name in sorted(self.shapes)])


def assurance(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    """Modal assurance criterion (m, k) between shapes (p, m) and (p, k); 0 where one is zero.

    MAC = |a' b|^2 / (a' a)(b' b) (Allemang and Brown 1982).
    """
    sizes = np.outer(np.sum(first**2, axis=0), np.sum(second**2, axis=0))
    return np.divide((first.T @ second) ** 2, sizes, out=np.zeros_like(sizes), where=sizes > 0.0)


def paired(
    first: ModalModel, second: ModalModel, least: float = LEAST_ASSURANCE, lever: float = 0.0
) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Find each mode of one model in another.

    Parameters
    ----------
    first, second : ModalModel
        With the same points; the second may have more modes.
    least : float
        Least MAC of a pair, from 0.5 to below 1.
    lever : float
        Weighs rotations against displacements, m; 0 leaves them out.

    Returns
    -------
    order : (m,) array of int
        Place in `second` of each mode of `first`.
    agreement : (m,) array of float
        MAC of the pairs.

    Raises
    ------
    StructureError
        If points differ, modes are lacking, a pair has too low a MAC, or another mode fits as
        well.
    """
    if set(first.shapes) != set(second.shapes):
        raise StructureError("mode tracking: the models have different points")
    if not 0.5 <= least < 1.0:
        raise StructureError(f"mode tracking: least MAC is {least}; from 0.5 to below 1")
    if second.frequency.size < first.frequency.size:
        raise StructureError(
            f"mode tracking: {first.frequency.size} modes cannot be found among "
            f"{second.frequency.size}; keep more"
        )
    table = assurance(first.stacked(lever), second.stacked(lever))
    rows, order = scipy.optimize.linear_sum_assignment(table, maximize=True)
    agreement = table[rows, order]
    for row in np.flatnonzero(agreement < least):
        raise StructureError(
            f"mode tracking: the mode at {first.frequency[row]:.4g} Hz is not found again; the "
            f"nearest, at {second.frequency[order[row]]:.4g} Hz, has a MAC of "
            f"{agreement[row]:.2f}, below {least:g}; take positions closer together, more points, "
            "or keep more modes"
        )
    others = table.copy()
    others[rows, order] = 0.0
    for row in np.flatnonzero(np.max(others, axis=1) > agreement - LEAST_LEAD):
        raise StructureError(
            f"mode tracking: the mode at {first.frequency[row]:.4g} Hz looks like two modes at "
            f"{second.frequency[order[row]]:.4g} and "
            f"{second.frequency[np.argmax(others[row])]:.4g} Hz; take more points"
        )
    return order, agreement


def aligned(
    first: ModalModel, second: ModalModel, least: float = LEAST_ASSURANCE, lever: float = 0.0
) -> ModalModel:
    """Second model with the modes of the first, in its order and with its signs."""
    order, _ = paired(first, second, least, lever)
    products = np.sum(first.stacked(lever) * second.stacked(lever)[:, order], axis=0)
    return second.in_order(order, np.where(products < 0.0, -1.0, 1.0))


class ModalModelAlongAxis:
    """Modal model between the positions where it was computed or measured.

    Squares of frequencies, damping ratios, mass-normalised shapes and residual compliances are
    interpolated monotonically (PCHIP; linearly with two positions) along tracked modes.

    Parameters
    ----------
    positions : (k,) array of float
        Ascending, m (or rad); two at least.
    models : sequence of ModalModel
        One a position. The modes of the first are followed.
    least, lever
        As for `paired`.

    Raises
    ------
    StructureError
        If positions do not ascend, numbers disagree or a mode is lost between two positions.
    """

    def __init__(
        self,
        positions: ArrayLike,
        models: Sequence[ModalModel],
        least: float = LEAST_ASSURANCE,
        lever: float = 0.0,
    ) -> None:
        count = len(models)
        self.positions = finite("mode tracking", "positions", positions, (count,))
        if count < 2 or np.any(np.diff(self.positions) <= 0.0):
            raise StructureError("mode tracking: give two positions or more, ascending")
        pairs = set(models[0].residual)
        if any(set(model.residual) != pairs for model in models):
            raise StructureError("mode tracking: the models have residuals at different points")
        followed = [models[0]]
        for position, model in zip(self.positions[1:], models[1:], strict=True):
            try:
                followed.append(aligned(followed[-1], model, least, lever))
            except StructureError as error:
                raise StructureError(f"towards position {position:g}: {error}") from error
        self.models = tuple(followed)
        self._squared = self._between([model.frequency**2 for model in followed])
        self._damping = self._between([model.damping for model in followed])
        self._shapes = {
            name: self._between([model.shapes[name] for model in followed])
            for name in followed[0].shapes
        }
        self._residual = {
            pair: self._between([model.residual[pair] for model in followed]) for pair in pairs
        }

    def at(self, position: float) -> ModalModel:
        """Modal model at a position, in the order of the first.

        Raises StructureError if the position is beyond the first or last.
        """
        if not self.positions[0] <= position <= self.positions[-1]:
            raise StructureError(
                f"mode tracking: position {position:g} is outside {self.positions[0]:g} to "
                f"{self.positions[-1]:g}"
            )
        return ModalModel(
            np.sqrt(np.maximum(self._squared(position), 0.0)),
            self._damping(position),
            {name: rows(position) for name, rows in self._shapes.items()},
            {pair: left(position) for pair, left in self._residual.items()},
        )

    def _between(self, values: Sequence[NDArray[np.float64]]) -> scipy.interpolate.PPoly:
        return scipy.interpolate.PchipInterpolator(self.positions, np.array(values))
