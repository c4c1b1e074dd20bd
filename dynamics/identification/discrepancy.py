"""What a model misses beyond the noise, and how many independent errors that leaves.

The noise of one blow on a tool can be a thousandth of what a model of a few real modes misses:
joints that are not viscous, small resonances of everything else. Judged by the noise alone every
bump is a mode. Kennedy and O'Hagan (2001, Bayesian calibration of computer models) add the
discrepancy of the model to the noise; here it is a constant receptance of each FRF, found by its
likelihood, with errors of neighbouring lines that are alike (first-order correlation).
"""

from dataclasses import replace

import numpy as np
import scipy
from numpy.typing import NDArray

from dynamics.identification.residues import Records

#: correlation of neighbouring errors taken at most
_MOST_CORRELATION = 0.995


def with_discrepancy(records: Records, synthesis: NDArray[np.complex128]) -> Records:
    """Records whose noise includes what a model misses, `synthesis` (n, k) its values."""
    scale = np.abs(records.laplace) ** records.derivative
    noise = np.stack(
        [
            np.hypot(level, _discrepancy(np.abs(error), level, scale) * scale)
            for error, level in zip((records.values - synthesis).T, records.noise.T, strict=True)
        ],
        axis=1,
    )
    return replace(records, noise=noise)


def effective_samples(error: NDArray[np.complex128]) -> float:
    """Number of independent real errors among the lines, errors (n, k) over their deviation.

    Errors of neighbouring lines with correlation r tell no more than 2 n (1 - r) / (1 + r)
    independent ones (first-order process, Bartlett 1946).
    """
    power = float(np.sum(np.abs(error) ** 2))
    neighbours = float(np.sum(error[1:] * error[:-1].conj()).real)
    correlation = float(np.clip(neighbours / max(power, 1e-300), 0.0, _MOST_CORRELATION))
    return 2.0 * error.size * (1.0 - correlation) / (1.0 + correlation)


def _discrepancy(
    error: NDArray[np.float64], noise: NDArray[np.float64], scale: NDArray[np.float64]
) -> float:
    """Constant receptance, m/N, whose squares added to those of the noise are most likely."""
    error, noise = error / scale, noise / scale

    def improbability(logarithm: float) -> float:
        variance = noise**2 + np.exp(2.0 * logarithm)
        return float(np.sum(np.log(variance) + error**2 / variance))

    largest = float(np.max(error))
    if largest <= 0.0:
        return 0.0
    span = np.log(largest) + np.array([-12.0, 0.5])
    found = scipy.optimize.minimize_scalar(
        improbability, bounds=span, method="bounded", options={"xatol": 0.02}
    )
    none = float(np.sum(2.0 * np.log(noise) + (error / noise) ** 2))
    # the noise is an estimate: an improvement that a few percent of it would bring is none
    return float(np.exp(found.x)) if none - found.fun > 0.02 * error.size else 0.0
