"""Real modes at the tool point: undamped frequency, damping ratio, mass and direction."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dynamics.identification.refinement import ModalModel, bounded_poles, pole_reach, solve_linear
from dynamics.identification.residues import (
    Records,
    as_real,
    mode_shapes_in_frequency,
    residual_columns,
)
from dynamics.identification.tall import gram, product
from dynamics.least_squares import PRECISE, least_squares


@dataclass(frozen=True)
class ToolPointRecords:
    """FRFs with what is known of their degrees of freedom at the tool point."""

    records: Records
    #: directions measured at the tool point, each one component of the mode vectors
    axes: tuple[str, ...]
    #: per FRF: response and reference axis (index into `axes`), or None for an FRF that does not
    #: both start and end at the tool point: its residues are free real numbers
    pairs: tuple[tuple[int, int] | None, ...]


@dataclass(frozen=True)
class RealModel:
    """Real modes with positive mass: the residue matrix at the tool point is u u^T."""

    natural_frequency: NDArray[np.float64]  # (m,), rad/s
    damping: NDArray[np.float64]  # (m,), 1
    vectors: NDArray[np.float64]  # (m, axes), at the tool point for unit modal mass, 1/sqrt(kg)
    delay: float | None  # lag of the response channels behind the force channel, s
    terms: tuple[int, ...]  # powers of s of the residual terms, in receptance
    #: per FRF the linear unknowns (unknowns,): real residues where the FRF is not of the tool
    #: point, then the residual terms
    free: tuple[NDArray[np.float64], ...]
    chi_square: float
    gradient: NDArray[np.float64]  # (p,)
    #: (p, p), Gauss-Newton matrix of [ln w, ln zeta, vectors, delay in `DELAY_UNIT` if there is
    #: one]
    normal: NDArray[np.float64]

    @property
    def count(self) -> int:
        """Number of modes."""
        return self.natural_frequency.size

    def synthesis(self, tool: ToolPointRecords) -> NDArray[np.complex128]:
        """Fitted values with delay and residual terms, (n, k)."""
        return np.stack([self._of_one(tool, k) for k in range(len(tool.pairs))], axis=1)

    def residues(self, pairs: Sequence[tuple[int, int] | None]) -> NDArray[np.float64]:
        """Real residues of all modes in all FRFs, 1/kg, (m, k)."""
        columns = []
        for k, pair in enumerate(pairs):
            if pair is None:
                columns.append(self.free[k][: self.count])
            else:
                columns.append(self.vectors[:, pair[0]] * self.vectors[:, pair[1]])
        return np.stack(columns, axis=1)

    def _of_one(self, tool: ToolPointRecords, k: int) -> NDArray[np.complex128]:
        records = tool.records
        s = records.laplace
        shapes = mode_shapes_in_frequency(
            s, self.natural_frequency, self.damping, records.derivative
        )
        values = np.sum(shapes.unit * self.residues(tool.pairs)[:, k], axis=1)
        offset = self.free[k].size - len(self.terms)
        for i, power in enumerate(self.terms):
            values = values + self.free[k][offset + i] * s ** (records.derivative + power)
        return values * np.exp(-s * (self.delay or 0.0))


#: the delay is iterated in microseconds, to be of the size of the other unknowns
DELAY_UNIT = 1e-6


def starting_vectors(
    tool: ToolPointRecords, model: ModalModel
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mode vectors closest to the residues of a fit with complex modes.

    The symmetric matrix of the real residues (the mean where both cross terms were measured) is
    replaced by the nearest matrix of rank one, from its largest eigenvalue.

    Vectors (m, axes), 1/sqrt(kg), zero where no eigenvalue is positive, and eigenvalues (m, axes),
    1/kg, largest first: the second tells of a second mode at the same frequency, a negative one of
    a residue that no drive point has.
    """
    axes = len(tool.axes)
    total = np.zeros((model.count, axes, axes))
    count = np.zeros((axes, axes))
    for k, pair in enumerate(tool.pairs):
        if pair is None:
            continue
        for i, j in {pair, pair[::-1]}:
            total[:, i, j] += model.coefficients[: model.count, k]
            count[i, j] += 1
    matrices = total / np.maximum(count, 1)
    missing = count == 0
    for i in range(axes):
        if missing[i, i]:
            matrices[:, i, i] = _missing_diagonal(matrices, missing, i)
    for i, j in zip(*np.nonzero(missing), strict=True):
        if i != j:
            product = np.maximum(matrices[:, i, i] * matrices[:, j, j], 0.0)
            matrices[:, i, j] = np.sqrt(product)
    values, vectors = np.linalg.eigh(matrices)
    values, vectors = values[:, ::-1], vectors[:, :, ::-1]
    leading = vectors[:, :, 0] * np.sqrt(np.maximum(values[:, :1], 0.0))
    return leading, values


def _missing_diagonal(
    matrices: NDArray[np.float64], missing: NDArray[np.bool_], i: int
) -> NDArray[np.float64]:
    """Diagonal term that a rank-one matrix has, from a cross term: a_ij^2 / a_jj."""
    for j in range(missing.shape[0]):
        if j != i and not missing[i, j] and not missing[j, j]:
            divisor = matrices[:, j, j]
            safe = np.abs(divisor) > 1e-300
            return np.where(safe, matrices[:, i, j] ** 2 / np.where(safe, divisor, 1.0), 0.0)
    return np.zeros(matrices.shape[0])


def refine_real_modes(
    tool: ToolPointRecords,
    natural_frequency: NDArray[np.float64],
    damping: NDArray[np.float64],
    vectors: NDArray[np.float64],
    terms: tuple[int, ...],
    delay: float | None,
    least_gain: float = PRECISE,
) -> RealModel:
    """Weighted nonlinear least-squares fit of real modes with positive mass.

    Poles, mode vectors at the tool point and one delay are nonlinear unknowns; residual terms and
    the residues of other FRFs are linear and eliminated (variable projection).

    It begins at frequencies, rad/s, damping ratios (m,), vectors (m, axes), 1/sqrt(kg), and a
    delay, s, None for a measurement without one; terms are powers of s of the residual terms.
    """
    modes, axes = vectors.shape

    def evaluate(parameters: NDArray[np.float64]) -> RealModel:
        return _evaluate(tool, parameters, modes, axes, terms)

    start = _parameters(natural_frequency, damping, vectors, delay)
    others = np.maximum(np.abs(start[2 * modes :]), 1e-3)
    reach = np.concatenate([pole_reach(damping), others])
    return least_squares(evaluate, start, reach, least_gain)


def evaluate_real_modes(
    tool: ToolPointRecords,
    natural_frequency: NDArray[np.float64],
    damping: NDArray[np.float64],
    vectors: NDArray[np.float64],
    terms: tuple[int, ...],
    delay: float | None,
) -> RealModel:
    """Model of the given modes, linear unknowns fitted; arguments as `refine_real_modes`."""
    parameters = _parameters(natural_frequency, damping, vectors, delay)
    modes, axes = vectors.shape
    return _evaluate(tool, parameters, modes, axes, terms)


def _parameters(
    natural_frequency: NDArray[np.float64],
    damping: NDArray[np.float64],
    vectors: NDArray[np.float64],
    delay: float | None,
) -> NDArray[np.float64]:
    lag = np.zeros(0) if delay is None else np.array([delay / DELAY_UNIT])
    return np.concatenate([np.log(natural_frequency), np.log(damping), vectors.ravel(), lag])


def _evaluate(
    tool: ToolPointRecords,
    parameters: NDArray[np.float64],
    modes: int,
    axes: int,
    terms: tuple[int, ...],
) -> RealModel:
    """Linear unknowns, gradient and Gauss-Newton matrix at one point."""
    records = tool.records
    s = records.laplace
    natural_frequency, damping = bounded_poles(records, parameters, modes)
    end = 2 * modes + modes * axes
    vectors = parameters[2 * modes : end].reshape(modes, axes)
    delayed = parameters.size > end
    delay = float(parameters[end]) * DELAY_UNIT if delayed else 0.0
    shapes = mode_shapes_in_frequency(s, natural_frequency, damping, records.derivative)
    lag = np.exp(-s * delay)[:, None]
    unit, by_frequency, by_damping = (
        a * lag for a in (shapes.unit, shapes.by_frequency, shapes.by_damping)
    )
    residual = lag * residual_columns(s, terms, records.derivative)
    normal = np.zeros((parameters.size, parameters.size))
    gradient = np.zeros(parameters.size)
    chi_square = records.remainder
    free = []
    for k, pair in enumerate(tool.pairs):
        noise = records.noise[:, k]
        if pair is None:
            columns = np.concatenate([unit, residual], axis=1)
            solution, error, basis = solve_linear(columns, records.values[:, k], noise)
            amplitude = solution[:modes]
        else:
            amplitude = vectors[:, pair[0]] * vectors[:, pair[1]]
            rest = records.values[:, k] - np.sum(unit * amplitude, axis=1)
            solution, error, basis = solve_linear(residual, rest, noise)
        free.append(solution)
        chi_square += float(error @ error)
        slope = np.zeros((s.size, parameters.size), dtype=np.complex128)
        slope[:, :modes] = by_frequency * amplitude
        slope[:, modes : 2 * modes] = by_damping * amplitude
        if delayed:
            elastic = np.sum(unit * amplitude, axis=1)
            beyond = residual @ solution[solution.size - len(terms) :]
            slope[:, end] = -s * DELAY_UNIT * (elastic + beyond)
        if pair is not None:
            i, j = pair
            by_vector = slope[:, 2 * modes : end].reshape(s.size, modes, axes)
            by_vector[:, :, i] += unit * vectors[:, j]
            by_vector[:, :, j] += unit * vectors[:, i]
        jacobian = -as_real(slope, noise)
        jacobian -= product(basis, gram(basis, jacobian))
        normal += gram(jacobian, jacobian)
        gradient += gram(jacobian, error[:, None])[:, 0]
    return RealModel(
        natural_frequency,
        damping,
        vectors,
        delay if delayed else None,
        terms,
        tuple(free),
        chi_square,
        gradient,
        normal,
    )
