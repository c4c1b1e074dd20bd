"""Eigenvalues of a machine under control from its frequency response.

Where the loop damps a mode until it is no peak, or a peak of another mode lies beside it, only the
eigenvalue tells its frequency. A quotient of polynomials is fitted to the response, weighted by its
own denominator until that stays (Sanathanan and Koerner 1963, IEEE Trans. Autom. Control 8:56).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

#: powers of the denominator: modes of the band, and of what lies beyond it
ORDER = 12
_ROUNDS = 30


class Eigenvalue(NamedTuple):
    """Vibration that the loops leave."""

    frequency: float  # Hz, of the undamped vibration
    damping: float  # ratio, 1


def eigenvalues(
    frequency: NDArray[np.float64], values: NDArray[np.complex128], order: int = ORDER
) -> list[Eigenvalue]:
    """Eigenvalues within the lines of a response (n,), Hz, by rising frequency."""
    middle = float(np.sqrt(frequency[0] * frequency[-1]))
    s = 1j * frequency / middle
    size = values / np.abs(values).max()
    powers = np.vander(s, order + 1, increasing=True)
    denominator = np.ones_like(s)
    for _ in range(_ROUNDS):
        weighted = powers / denominator[:, None]
        unknown = np.hstack([weighted, -size[:, None] * weighted[:, :-1]])
        known = size * weighted[:, -1]
        stacked = np.vstack([unknown.real, unknown.imag])
        found = np.linalg.lstsq(stacked, np.hstack([known.real, known.imag]), rcond=None)[0]
        coefficients = np.append(found[order + 1 :], 1.0)
        denominator = powers @ coefficients
    roots = middle * np.roots(coefficients[::-1])
    inside = (roots.imag > 0.0) & (np.abs(roots) > frequency[0]) & (np.abs(roots) < frequency[-1])
    pairs = sorted((float(abs(one)), float(-one.real / abs(one))) for one in roots[inside])
    return [Eigenvalue(*pair) for pair in pairs]


def most_damped(found: list[Eigenvalue], low: float, high: float) -> Eigenvalue:
    """The most damped one between two frequencies, Hz."""
    return max((one for one in found if low < one.frequency < high), key=lambda one: one.damping)
