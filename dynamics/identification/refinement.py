"""Maximum-likelihood refinement of the poles: variable projection over all FRFs."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from dynamics.identification.residues import (
    Records,
    as_real,
    design_matrix,
    mode_shapes_in_frequency,
)
from dynamics.identification.tall import factorise, gram, product, triangle_of
from dynamics.least_squares import PRECISE, least_squares

#: damping ratios outside these bounds are not followed
DAMPING_BOUNDS = (1e-6, 0.9)
#: smallest divisor
TINY = 1e-300
#: share of a column that lies across others, below which it is not found as a difference
_LEAST_ACROSS = 1e-6


@dataclass(frozen=True)
class ModalModel:
    """Poles common to all FRFs with the residues of each FRF."""

    natural_frequency: NDArray[np.float64]  # (m,), rad/s
    damping: NDArray[np.float64]  # (m,), 1
    #: (2m + terms, k), per FRF: m real parts, m parts in quadrature (multiplying s / w), residual
    #: terms
    coefficients: NDArray[np.float64]
    terms: tuple[int, ...]
    chi_square: float  # sum of |e|^2 / sigma^2 over complex lines
    #: (2m,), half the gradient by [ln w, ln zeta], residues eliminated
    gradient: NDArray[np.float64]
    normal: NDArray[np.float64]  # (2m, 2m), Gauss-Newton matrix of the same

    @property
    def count(self) -> int:
        """Number of modes."""
        return self.natural_frequency.size

    @property
    def poles_in_hertz(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Undamped natural frequencies, Hz, and damping ratios."""
        return self.natural_frequency / (2.0 * np.pi), self.damping

    def synthesis(self, records: Records) -> NDArray[np.complex128]:
        """Fitted values on the lines of `records`, (n, k)."""
        shapes = mode_shapes_in_frequency(
            records.laplace, self.natural_frequency, self.damping, records.derivative
        )
        columns = design_matrix(records, shapes, self.natural_frequency, self.terms)
        return product(columns, self.coefficients)

    def mode_contribution(self, records: Records, mode: int) -> NDArray[np.complex128]:
        """What one mode adds to each FRF, (n, k)."""
        shapes = mode_shapes_in_frequency(
            records.laplace,
            self.natural_frequency[mode : mode + 1],
            self.damping[mode : mode + 1],
            records.derivative,
        )
        turn = records.laplace[:, None] / self.natural_frequency[mode]
        real, quadrature = self.coefficients[mode], self.coefficients[self.count + mode]
        return shapes.unit * (real + turn * quadrature)


def fit_residues(
    records: Records,
    natural_frequency: NDArray[np.float64],
    damping: NDArray[np.float64],
    terms: tuple[int, ...],
) -> ModalModel:
    """Least-squares residues and residual terms for known poles (LSFD).

    Natural frequencies, rad/s, and damping ratios (m,).
    """
    shapes = mode_shapes_in_frequency(
        records.laplace, natural_frequency, damping, records.derivative
    )
    columns = design_matrix(records, shapes, natural_frequency, terms)
    modes = natural_frequency.size
    size = 2 * modes
    coefficients = np.zeros((columns.shape[1], records.count))
    normal = np.zeros((size, size))
    gradient = np.zeros(size)
    chi_square = records.remainder
    turn = records.laplace[:, None] / natural_frequency
    for k in range(records.count):
        noise = records.noise[:, k]
        fitted = _solved(columns, records.values[:, k], noise)
        coefficients[:, k] = solution = fitted.unknowns
        chi_square += float(fitted.residual @ fitted.residual)
        amplitude = solution[:modes] + turn * solution[modes : 2 * modes]
        slope = [shapes.by_frequency * amplitude, shapes.by_damping * amplitude]
        jacobian = -as_real(np.concatenate(slope, axis=1), noise)
        normal += fitted.products_across(jacobian)
        # the residual is across all columns already
        gradient += gram(jacobian, fitted.residual[:, None])[:, 0]
    return ModalModel(natural_frequency, damping, coefficients, terms, chi_square, gradient, normal)


class _Solution(NamedTuple):
    """Linear fit of one FRF."""

    unknowns: NDArray[np.float64]  # (k,)
    residual: NDArray[np.float64]  # (n,)
    #: products (j, j) of tall columns (n, j), less what of them lies along the unknowns' columns
    products_across: Callable[[NDArray[np.float64]], NDArray[np.float64]]


def _solved(
    columns: NDArray[np.complex128], values: NDArray[np.complex128], noise: NDArray[np.float64]
) -> _Solution:
    """Weighted linear solution of one FRF.

    By corrected semi-normal equations (Bjoerck 1987), as exact as QR factors where the columns are
    not nearly dependent and a third of their work; by QR factors where they are.
    """
    matrix, target = as_real(columns, noise), as_real(values, noise)
    scale = np.sqrt(np.einsum("nk,nk->k", matrix, matrix))
    scale[scale == 0.0] = 1.0
    matrix /= scale
    lower = triangle_of(gram(matrix, matrix))
    if lower is None:
        unknowns, residual, basis = solve_linear(columns, values, noise)
        return _Solution(unknowns, residual, lambda tall: _products_across(tall, basis))
    unknowns, residual = np.zeros(scale.size), target
    for _ in range(2):  # the second time takes off what the first one lost
        step = scipy.linalg.cho_solve((lower, True), gram(matrix, residual[:, None]))
        unknowns += step[:, 0]
        residual = residual - product(matrix, step)[:, 0]

    def products_across(tall: NDArray[np.float64]) -> NDArray[np.float64]:
        along = scipy.linalg.solve_triangular(lower, gram(matrix, tall), lower=True)
        whole = gram(tall, tall)
        found = whole - along.T @ along
        if np.all(np.diag(found) > _LEAST_ACROSS * np.diag(whole)):
            return found
        return _products_across(tall, factorise(matrix)[0])

    return _Solution(unknowns / scale, residual, products_across)


def _products_across(tall: NDArray[np.float64], basis: NDArray[np.float64]) -> NDArray[np.float64]:
    """Products of tall columns, less what of them lies along an orthonormal basis."""
    across = tall - product(basis, gram(basis, tall))
    return gram(across, across)


def rises_without_a_mode(records: Records, model: ModalModel) -> NDArray[np.float64]:
    """Rise of the chi-square without each mode of a model, (m,), the poles of the others kept."""
    shapes = mode_shapes_in_frequency(
        records.laplace, model.natural_frequency, model.damping, records.derivative
    )
    columns = design_matrix(records, shapes, model.natural_frequency, model.terms)
    found = np.zeros(model.count)
    for k in range(records.count):
        matrix = as_real(columns, records.noise[:, k])
        scale = np.maximum(np.linalg.norm(matrix, axis=0), TINY)
        inverse = np.linalg.pinv(factorise(matrix / scale)[1], rcond=1e-13)
        amplitude = (model.coefficients[:, k] * scale)[: 2 * model.count].reshape(2, -1).T
        rows = inverse[: 2 * model.count].reshape(2, model.count, -1).transpose(1, 0, 2)
        covariance = rows @ rows.transpose(0, 2, 1)
        solution = np.linalg.pinv(covariance, hermitian=True) @ amplitude[:, :, None]
        found += np.einsum("mi,mi->m", amplitude, solution[:, :, 0])
    return found


def falls_with_a_pole(
    records: Records,
    model: ModalModel,
    natural_frequency: NDArray[np.float64],
    damping: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Fall of the chi-square that each of some poles (p,) alone brings, those of a model kept.

    Only what the columns of the newcomer have across those of the model is fitted.
    """
    own = mode_shapes_in_frequency(
        records.laplace, model.natural_frequency, model.damping, records.derivative
    )
    columns = design_matrix(records, own, model.natural_frequency, model.terms)
    new = mode_shapes_in_frequency(
        records.laplace, natural_frequency, damping, records.derivative
    ).unit
    new = np.stack([new, new * (records.laplace[:, None] / natural_frequency)], axis=2)
    found = np.zeros(natural_frequency.size)
    for k in range(records.count):
        noise = records.noise[:, k]
        _, residual, basis = solve_linear(columns, records.values[:, k], noise)
        tall = as_real(new.reshape(noise.size, -1), noise)
        tall /= np.maximum(np.linalg.norm(tall, axis=0), TINY)
        across = (tall - product(basis, gram(basis, tall))).reshape(residual.size, -1, 2)
        normal = np.einsum("npi,npj->pij", across, across)
        along = np.einsum("npi,n->pi", across, residual)
        solution = np.linalg.pinv(normal, rcond=1e-12, hermitian=True) @ along[:, :, None]
        found += np.einsum("pi,pi->p", along, solution[:, :, 0])
    return found


def refine(records: Records, start: ModalModel, least_gain: float = PRECISE) -> ModalModel:
    """Move the poles to the weighted nonlinear least-squares optimum.

    The residues are linear and are eliminated at every step (variable projection, Golub and
    Pereyra 1973, with the Jacobian of Kaufman 1975); what is left is a small problem in
    [ln w, ln zeta].

    It ends at a relative fall of the chi-square in one step below `least_gain`, and is never worse
    than `start` with residues refitted.
    """
    return refine_poles(records, start.natural_frequency, start.damping, start.terms, least_gain)


def refine_poles(
    records: Records,
    natural_frequency: NDArray[np.float64],
    damping: NDArray[np.float64],
    terms: tuple[int, ...],
    least_gain: float = PRECISE,
) -> ModalModel:
    """`refine` from frequencies, rad/s, and damping ratios (m,)."""
    modes = natural_frequency.size

    def evaluate(parameters: NDArray[np.float64]) -> ModalModel:
        return fit_residues(records, *bounded_poles(records, parameters, modes), terms)

    poles = np.concatenate([np.log(natural_frequency), np.log(damping)])
    return least_squares(evaluate, poles, pole_reach(damping), least_gain)


def pole_range(records: Records) -> tuple[float, float]:
    """Frequencies that a pole may have: two octaves beyond either end of the lines, Hz."""
    return float(records.frequency[0]) / 4.0, float(records.frequency[-1]) * 4.0


def bounded_poles(
    records: Records, parameters: NDArray[np.float64], modes: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Poles from [ln w, ln zeta, ...], kept within two octaves of the band and damped.

    Frequencies, rad/s, and damping ratios (m,).
    """
    lowest, highest = 2.0 * np.pi * np.array(pole_range(records))
    natural_frequency = np.exp(np.clip(parameters[:modes], np.log(lowest), np.log(highest)))
    damping = np.exp(np.clip(parameters[modes : 2 * modes], *np.log(DAMPING_BOUNDS)))
    return natural_frequency, damping


def pole_reach(damping: NDArray[np.float64]) -> NDArray[np.float64]:
    """First steps of [ln w, ln zeta], (2m,): within a half-power band, to half the damping."""
    return np.concatenate([np.maximum(damping, 1e-5), np.full(damping.size, 0.7)])


def solve_linear(
    columns: NDArray[np.complex128], values: NDArray[np.complex128], noise: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Weighted linear solution of one FRF: unknowns, residual, orthonormal basis."""
    matrix = as_real(columns, noise)
    target = as_real(values, noise)
    if matrix.shape[1] == 0:
        return np.zeros(0), target, matrix
    scale = np.linalg.norm(matrix, axis=0)
    scale[scale == 0.0] = 1.0
    basis, triangle = factorise(matrix / scale)
    projected = gram(basis, target[:, None])
    solution = np.linalg.lstsq(triangle, projected[:, 0], rcond=1e-13)[0] / scale
    return solution, target - product(basis, projected)[:, 0], basis
