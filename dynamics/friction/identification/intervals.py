"""Uncertainty of fitted parameters whose residuals are not white.

What a friction model leaves over is ripple and unmodelled dynamics as much as noise, and it is
low-passed besides: neighbouring samples repeat each other. The covariance of ordinary least
squares would promise several times too much. Here it allows for the correlation that the
residuals show (Newey and West 1987, Econometrica 55:703).
"""

import math
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

_CONFIDENCE = 0.95
#: logarithm of a factor beyond which an interval has no ends
_BOUNDLESS = 14.0


@dataclass(frozen=True)
class Estimate:
    """One fitted parameter."""

    value: float  # SI unit of the parameter
    standard_error: float  # same unit
    lower: float  # ends of the 95 % confidence interval
    upper: float  # ends of the 95 % confidence interval

    @property
    def relative_error(self) -> float:
        """Half the width of the interval over the value; infinite at 0."""
        half = 0.5 * (self.upper - self.lower)
        return half / abs(self.value) if self.value != 0.0 else np.inf


def correlation_length(residual: NDArray[np.float64]) -> int:
    """Return the number of samples over which residuals (n,) stay correlated: first zero of it."""
    n = len(residual)
    size = 1 << (2 * n - 1).bit_length()
    centred = residual - residual.mean()
    spectrum = np.fft.rfft(centred, size)
    correlation = np.fft.irfft(np.abs(spectrum) ** 2, size)[: max(n // 4, 1)]
    negative = np.flatnonzero(correlation <= 0.0)
    return int(negative[0]) if negative.size else len(correlation)


def covariance(
    jacobian: NDArray[np.float64], residual: NDArray[np.float64]
) -> tuple[NDArray[np.float64], float]:
    """Covariance of least-squares parameters with correlated residuals.

    By the jacobian (n, p) of the residuals, of full rank, and the residuals (n,) at the optimum:
    (p, p), and the degrees of freedom, independent stretches of residual less parameters, at least
    1.
    """
    n, p = jacobian.shape
    length = correlation_length(residual)
    lags = min(max(2 * length, int(4.0 * (n / 100.0) ** (2.0 / 9.0))), n // 3)
    if length <= 1:  # white, and for few samples the estimate of correlation is worse than none
        lags = 0
    size = np.linalg.norm(jacobian, axis=0)
    scaled = jacobian / size
    inverse = np.linalg.pinv(scaled.T @ scaled, hermitian=True)
    scores = scaled * residual[:, None]
    middle = scores.T @ scores
    for lag in range(1, lags + 1):
        product = scores[lag:].T @ scores[:-lag]
        middle += (1.0 - lag / (lags + 1.0)) * (product + product.T)
    result = inverse @ middle @ inverse * (n / max(n - p, 1))
    freedom = max(n / max(length, 1) - p, 1.0)
    return result / np.outer(size, size), freedom


def half_width(freedom: float) -> float:
    """95 % half width of Student's distribution, in standard errors."""
    return float(scipy.stats.t.ppf(0.5 + 0.5 * _CONFIDENCE, freedom))


def estimate(value: float, variance: float, freedom: float) -> Estimate:
    """Return a parameter with its symmetric interval."""
    error = float(np.sqrt(max(variance, 0.0)))
    half = half_width(freedom) * error
    return Estimate(float(value), error, float(value) - half, float(value) + half)


def positive_estimate(value: float, log_variance: float, freedom: float) -> Estimate:
    """Return a positive parameter with the interval of its logarithm."""
    error = float(np.sqrt(max(log_variance, 0.0)))
    reach = half_width(freedom) * error
    factor = math.exp(reach) if reach < _BOUNDLESS else math.inf
    return Estimate(float(value), float(value) * error, value / factor, value * factor)
