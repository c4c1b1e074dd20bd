"""What differs from period to period: size, growth, noise."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

#: multipliers fitted at most; weakest direction kept and weakest part that counts, of the strongest
_MOST_MULTIPLIERS = 8
_WEAKEST = 1e-3
_TAKES_PART = 0.2


class Deviations(NamedTuple):
    """Differences from each period to the next, cleared of noise."""

    rows: NDArray[np.float64]  # (periods - 1, points * k), in units of the scale of the record
    sizes: NDArray[np.float64]  # (periods - 1,), rms over points and channels summed
    noise: float  # rms of the noise of one sample, same units
    noise_size: float  # size that noise alone could still show
    rank: int  # directions that stand out of the noise


def deviations_of(values: NDArray[np.float64]) -> Deviations:
    """Differences from period to period, with what does not stand out of the noise removed.

    White noise is measured in the upper quarter of the frequencies, where a cut has next to no
    motion that does not repeat, and singular values that noise alone would reach are dropped
    (bound of the largest singular value of a random matrix: Davidson and Szarek, 2001).

    Values are (periods, points, k).
    """
    differences = np.diff(values, axis=0)
    count, points, channels = differences.shape
    noise = noise_of(differences)
    matrix = differences.reshape(count, -1)
    left, singular = directions_of(matrix)
    # neighbouring differences share a sample: their noise is correlated, up to twice one sample's
    bound = 2.0 * 1.05 * noise * (np.sqrt(count) + np.sqrt(points * channels))
    rank = int(np.count_nonzero(singular > max(bound, 1e-7 * singular[0], 1e-12)))
    rows = left[:, :rank] @ (left[:, :rank].T @ matrix)
    sizes = np.linalg.norm(rows, axis=1) / np.sqrt(points)
    return Deviations(rows, sizes, noise, float(bound / np.sqrt(count * points)), rank)


def noise_of(differences: NDArray[np.float64]) -> float:
    """Rms of white noise of one sample, from differences of two periods, (count, points, k)."""
    points = differences.shape[1]
    spectrum = np.abs(np.fft.rfft(differences, axis=1)) ** 2 / points
    upper = spectrum[:, spectrum.shape[1] * 3 // 4 :]
    # the median of an exponentially distributed power is ln 2 of its mean
    power = np.median(upper, axis=(0, 1)) / np.log(2.0)
    return float(np.sqrt(power.max() / 2.0))


def directions_of(matrix: NDArray[np.float64]) -> tuple[NDArray, NDArray]:
    """Left singular vectors and singular values of a matrix, the strongest first.

    From the smaller of the products with its transpose, which is far quicker and is good for values
    down to 1e-8 of the largest.
    """
    if len(matrix) <= matrix.shape[1]:
        squares, left = np.linalg.eigh(matrix @ matrix.T)
        return left[:, ::-1], np.sqrt(np.maximum(squares[::-1], 0.0))
    squares, right = np.linalg.eigh(matrix.T @ matrix)
    singular = np.sqrt(np.maximum(squares[::-1], 0.0))
    return matrix @ right[:, ::-1] / np.maximum(singular, 1e-8 * singular[0] + 1e-300), singular


def growth_rate_of(sizes: NDArray[np.float64]) -> tuple[float, float]:
    """Slope of the logarithm of the sizes a period, and its standard error."""
    index = np.arange(len(sizes), dtype=float)
    index -= index.mean()
    log = np.log(np.maximum(sizes, 1e-300))
    slope = float(index @ log / (index @ index))
    rest = log - log.mean() - slope * index
    error = float(np.sqrt(rest @ rest / max(len(sizes) - 2, 1) / (index @ index)))
    return slope, error


def slowest_growth_rate(rows: NDArray[np.float64]) -> tuple[float, float]:
    """Logarithm of the magnitude of the multiplier that decays least, a period, and the misfit.

    A linear map from each row to the next is fitted to the strongest directions of the rows
    (dynamic mode decomposition, Schmid, 2010), and of its eigenvalues those count that take part in
    the last rows. It sees a motion that grows below a transient that still outweighs it. Where the
    motion is not linear, it says nothing.

    Rows are (n, m); -inf if there is nothing in them. The misfit is the share of the rms of the
    rows that the map does not predict.
    """
    left, singular = directions_of(rows)
    rank = int(np.count_nonzero(singular > _WEAKEST * singular[0])) if singular[0] > 0.0 else 0
    rank = min(rank, _MOST_MULTIPLIERS, len(rows) // 3)
    if rank == 0:
        return -np.inf, 0.0
    state = left[:, :rank] * singular[:rank]
    step, *_ = np.linalg.lstsq(state[:-1], state[1:], rcond=None)
    lost = np.sum((state[1:] - state[:-1] @ step) ** 2) + np.sum(singular[rank:] ** 2)
    misfit = float(np.sqrt(lost / np.sum(singular**2)))
    values, vectors = np.linalg.eig(step.T)
    parts = np.linalg.lstsq(vectors, state.T.astype(complex), rcond=None)[0]
    last = np.sqrt(np.mean(np.abs(parts[:, -max(len(rows) // 4, 1) :]) ** 2, axis=1))
    taking_part = last > _TAKES_PART * last.max()
    return float(np.log(np.max(np.abs(values[taking_part])) + 1e-300)), misfit
