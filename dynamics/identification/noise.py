"""Noise of a measured FRF, line by line, from the function alone."""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from scipy.ndimage import median_filter

#: lines on either side of the one whose noise is estimated
HALF_WINDOW = 5

#: lines on either side over which the estimates are averaged by their median
HALF_SMOOTHING = 20

#: smallest noise taken for real, relative to the largest value (rounding in a printed file)
RELATIVE_FLOOR = 1e-7


def noise_level(frequency: NDArray[np.float64], values: NDArray[np.complex128]) -> NDArray:
    """Standard deviation of the noise on each line of one FRF.

    Around every line a rational function of low order, a quadratic over a first-order
    polynomial in frequency, is fitted to the few lines beside it (the local rational method of
    McKelvey and Guerin 2012, in the linearised form); a resonance narrower than the window is
    followed by it, so that what is left over is noise. A running median removes the scatter of
    an estimate with few degrees of freedom.

    Parameters
    ----------
    frequency : (n,) array of float
        Hz, ascending.
    values : (n,) array of complex
        Any quantity.

    Returns
    -------
    (n,) array of float
        Standard deviation of the complex noise (root mean square of its magnitude), in the unit
        of `values`, never zero.
    """
    peak = float(np.max(np.abs(values)))
    floor = peak * RELATIVE_FLOOR if peak > 0.0 else 1.0
    half = min(HALF_WINDOW, (values.size - 1) // 2)
    freedom = 2 * half + 1 - 4
    if freedom < 1:
        return np.full(values.size, max(floor, 0.01 * peak))
    variance = _local_rational_variance(frequency, values, half)
    # the median of a chi-square variable lies below its mean (Wilson-Hilferty)
    median_to_mean = (1.0 - 2.0 / (9.0 * 2.0 * freedom)) ** 3
    reach = min(HALF_SMOOTHING, variance.size // 2)
    smooth = median_filter(variance, size=2 * reach + 1, mode="nearest") / median_to_mean
    smooth = np.concatenate([np.full(half, smooth[0]), smooth, np.full(half, smooth[-1])])
    return np.maximum(np.sqrt(smooth), floor)


def _local_rational_variance(
    frequency: NDArray[np.float64], values: NDArray[np.complex128], half: int
) -> NDArray[np.float64]:
    """Mean square residual of the local rational fits, for lines half .. n - 1 - half."""
    width = 2 * half + 1
    f = sliding_window_view(frequency, width)
    h = sliding_window_view(values, width)
    x = (f - f[:, half : half + 1]) / (0.5 * (f[:, -1:] - f[:, :1]))
    scale = np.max(np.abs(h), axis=1, keepdims=True)
    h = h / np.where(scale > 0.0, scale, 1.0)
    columns = np.stack([np.ones_like(h), x.astype(complex), (x**2).astype(complex), -h * x], axis=2)
    basis, triangle = np.linalg.qr(columns)
    projected = np.einsum("wki,wk->wi", basis.conj(), h)
    residual = h - np.einsum("wki,wi->wk", basis, projected)
    # equation error -> output error: divide by the denominator that was fitted
    pivot = triangle[:, 3, 3]
    safe = np.abs(pivot) > 1e-10
    slope = np.where(safe, projected[:, 3] / np.where(safe, pivot, 1.0), 0.0)
    denominator = np.abs(1.0 + slope[:, None] * x)
    residual = residual / np.maximum(denominator, 0.05)
    mean_square = np.sum(np.abs(residual) ** 2, axis=1) / (width - 4)
    return mean_square * scale[:, 0] ** 2
