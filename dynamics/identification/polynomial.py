"""Poly-reference least-squares complex frequency-domain estimator: poles for every model order."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from dynamics.identification.tall import gram, product

#: the highest line stands a little inside the half circle, away from z = -1
BAND_OVERSHOOT = 1.02


@dataclass(frozen=True)
class OrderPoles:
    """Poles that one model order gives."""

    order: int  # polynomial order of the matrix denominator; each reference adds `order` poles
    #: (p,), rad/s, those with positive frequency only; unstable ones included
    poles: NDArray[np.complex128]
    #: (p, references), modal participation of each pole, unit norm
    participation: NDArray[np.complex128]


def polynomial_basis(
    z: NDArray[np.complex128], start: NDArray[np.float64], order: int
) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
    """Weighted polynomials in z, orthonormal on the given points and their conjugates.

    The monomials of the z-domain are orthogonal only where the points cover the whole circle;
    orthogonalised one by one (Arnoldi; Brubeck, Nakatsukasa and Trefethen 2021) they span the
    same spaces and stay independent for any band and weight.

    Points z (n,), and the polynomial of degree zero: their weight, of unit norm. Column k of the
    basis (n, order + 1) is the weight times the polynomial of degree k, with real coefficients; z *
    basis[:, :-1] = basis @ hessenberg, (order + 1, order).
    """
    columns = np.zeros((2 * z.size, order + 1))
    columns[: z.size, 0] = start
    hessenberg = np.zeros((order + 1, order))
    for k in range(order):
        vector = real_rows(z * complex_rows(columns[:, k]))[:, None]
        for _ in range(2):  # a second pass restores orthogonality lost by cancellation
            part = gram(columns[:, : k + 1], vector)
            hessenberg[: k + 1, k] += part[:, 0]
            vector = vector - product(columns[:, : k + 1], part)
        hessenberg[k + 1, k] = np.linalg.norm(vector)
        columns[:, k + 1] = vector[:, 0] / hessenberg[k + 1, k]
    return complex_rows(columns), hessenberg


def real_rows(values: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Real parts above imaginary parts: real inner products are those of conjugate pairs."""
    return np.concatenate([values.real, values.imag])


def complex_rows(values: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Undo `real_rows`."""
    half = values.shape[0] // 2
    return values[:half] + 1j * values[half:]


def polyreference_poles(
    frequency: NDArray[np.float64],
    values: NDArray[np.complex128],
    weight: NDArray[np.float64],
    orders: Sequence[int],
) -> list[OrderPoles]:
    """Poles of the right matrix-fraction model for a range of orders.

    The reduced normal equations of the pLSCF estimator (Peeters, Van der Auweraer, Guillaume and
    Leuridan 2004, "The PolyMAX frequency-domain method", eqs. 8-17), with orthonormal numerator
    polynomials in which the elimination of the numerators is a projection. The basis functions
    are powers of z = exp(-s T) and the highest of them carries the identity matrix: the poles
    that only describe noise then come out unstable and the diagram stays clear (Cauberghe,
    Guillaume, Verboven, Vanlanduit and Parloo 2005).

    Lines (n,), Hz, values (n, responses, references), each response divided by its noise level, and
    the weight of the lines (n,). Each order of the denominator adds as many poles as there are
    references.
    """
    lines, responses, references = values.shape
    largest = max(orders)
    period = 1.0 / (2.0 * frequency[-1] * BAND_OVERSHOOT)
    z = np.exp(-2j * np.pi * frequency * period)
    start = weight / np.linalg.norm(weight)
    basis, hessenberg = polynomial_basis(z, start, largest)
    size = (largest + 1) * references
    total = np.zeros((size, size))
    numerator = real_rows(basis)
    projections = []
    for o in range(responses):
        known = real_rows((basis[:, :, None] * values[:, o, None, :]).reshape(lines, size))
        total += gram(known, known)
        projections.append(gram(numerator, known))
    found = []
    for order in orders:
        use = (order + 1) * references
        reduced = total[:use, :use].copy()
        for projection in projections:
            part = projection[: order + 1, :use]
            reduced -= part.T @ part
        found.append(_solve_order(reduced, hessenberg, order, references, period))
    return found


def _solve_order(
    reduced: NDArray[np.float64],
    hessenberg: NDArray[np.float64],
    order: int,
    references: int,
    period: float,
) -> OrderPoles:
    """Denominator of one order from the reduced normal equations, and its poles."""
    free = order * references
    coefficients = -np.linalg.lstsq(reduced[:free, :free], reduced[:free, free:], rcond=1e-14)[0]
    companion = np.kron(hessenberg[:order, :order], np.eye(references))
    companion[:, -references:] -= hessenberg[order, order - 1] * coefficients
    roots, left = scipy.linalg.eig(companion, left=True, right=False)
    participation = left[:references, :].conj().T
    keep = (roots.imag < 0.0) & (np.abs(roots) > 1e-6)
    poles = -np.log(roots[keep]) / period
    participation = participation[keep]
    norm = np.linalg.norm(participation, axis=1, keepdims=True)
    return OrderPoles(order, poles, participation / np.where(norm > 0.0, norm, 1.0))
