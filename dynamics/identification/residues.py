"""Residues and residual terms of known poles by linear least squares (LSFD)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Records:
    """FRFs of one quantity on common lines, with the noise of each."""

    frequency: NDArray[np.float64]  # (n,), Hz, all above zero
    values: NDArray[np.complex128]  # (n, k), one column an FRF
    noise: NDArray[np.float64]  # (n, k), standard deviation of the noise of `values`
    derivative: int  # 0 for receptance, 1 for mobility, 2 for accelerance
    #: of an exponential window on the time records, rad/s: the measured function is that of the
    #: structure at s = added_decay + i omega
    added_decay: float = 0.0
    #: sum of squares over the noise that lines which were condensed no longer show
    remainder: float = 0.0

    @property
    def laplace(self) -> NDArray[np.complex128]:
        """Laplace variable at which each line was measured, rad/s."""
        return self.added_decay + 2j * np.pi * self.frequency

    @property
    def count(self) -> int:
        """Number of FRFs."""
        return self.values.shape[1]

    def lines(self, keep: NDArray[np.bool_]) -> Records:
        """Return the same FRFs on some of the lines."""
        return replace(
            self, frequency=self.frequency[keep], values=self.values[keep], noise=self.noise[keep]
        )


#: powers of s, in receptance, of the residual terms: mass line of the modes below the band,
#: quadrature left by complex modes or by a lag of the measuring chain, compliance of those above
MASS, QUADRATURE, COMPLIANCE = -2, -1, 0

#: residual terms used unless the data do not support them
ALL_TERMS: tuple[int, ...] = (MASS, QUADRATURE, COMPLIANCE)

#: next terms of the series of 1/(w^2 + s^2) for modes below and above, used where the data
#: support them
CURVATURE_TERMS: tuple[int, ...] = (-4, 2)


@dataclass(frozen=True)
class Shapes:
    """Response of every mode to a unit residue, and its derivatives."""

    unit: NDArray[np.complex128]  # (n, m), s^d / (s^2 + 2 zeta w s + w^2)
    by_frequency: NDArray[np.complex128]  # (n, m), derivative with respect to ln(w)
    by_damping: NDArray[np.complex128]  # (n, m), derivative with respect to ln(zeta)


def mode_shapes_in_frequency(
    s: NDArray[np.complex128],
    natural_frequency: NDArray[np.float64],
    damping: NDArray[np.float64],
    derivative: int,
) -> Shapes:
    """Single-degree-of-freedom responses of all modes.

    At s (n,), rad/s, of natural frequencies, rad/s, and damping ratios (m,); derivative 0 for
    receptance, 1 for mobility, 2 for accelerance.
    """
    viscous = 2.0 * s[:, None] * (damping * natural_frequency)
    inverse = 1.0 / (s[:, None] ** 2 + viscous + natural_frequency**2)
    unit = s[:, None] ** derivative * inverse
    slope = unit * inverse
    return Shapes(unit, -slope * (2.0 * natural_frequency**2 + viscous), -slope * viscous)


def residual_columns(
    s: NDArray[np.complex128], terms: tuple[int, ...], derivative: int
) -> NDArray[np.complex128]:
    """Columns of the residual terms, (n, len(terms)): powers of s."""
    if not terms:
        return np.zeros((s.size, 0), dtype=np.complex128)
    return np.stack([s ** (derivative + power) for power in terms], axis=1)


def design_matrix(
    records: Records, shapes: Shapes, natural_frequency: NDArray[np.float64], terms: tuple[int, ...]
) -> NDArray[np.complex128]:
    """Columns of all unknowns: modes, their parts in quadrature, residual terms, (n, unknowns)."""
    s = records.laplace[:, None]
    rest = residual_columns(records.laplace, terms, records.derivative)
    return np.concatenate([shapes.unit, shapes.unit * (s / natural_frequency), rest], axis=1)


def as_real(columns: NDArray[np.complex128], noise: NDArray[np.float64]) -> NDArray[np.float64]:
    """Weighted real equations: real parts above imaginary parts, each over the noise."""
    over = noise[:, None] if columns.ndim == 2 else noise
    found = np.empty((2 * columns.shape[0], *columns.shape[1:]))
    np.divide(columns.real, over, out=found[: noise.size])
    np.divide(columns.imag, over, out=found[noise.size :])
    return found
