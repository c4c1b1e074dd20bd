"""What the outcome of a measurement is expected to say about models and their values, in bit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def information_of_verdicts(weights: Array, stable: Array) -> float:
    """Information of one verdict by the probability (n,) of a stable one, by weighted models.

    Entropy of the verdict less that which each model leaves (Lindley 1956, Ann. Math. Stat.
    27:986).
    """
    return float(_entropy(weights @ stable) - weights @ _entropy(stable))


def _entropy(probability: Array) -> Array:
    inside = np.clip(probability, 1e-12, 1.0 - 1e-12)
    return -(inside * np.log2(inside) + (1.0 - inside) * np.log2(1.0 - inside))


def information_of_signals(weights: Array, signals: Sequence[Array], noise: float) -> float:
    """Information of a signal that weighted models predict, in white noise.

    Lower bound by the Bhattacharyya distances between all pairs (Kolchinsky and Tracey 2017,
    Entropy 19:361, equation 10). Neighbours in a signal are not independent of each other: a
    signal counts as one reading of its rms.
    """
    stacked = np.stack(signals)
    apart = np.mean((stacked[:, None] - stacked[None]) ** 2, axis=2) / noise**2
    return float(-weights @ np.log2(np.exp(-apart / 8.0) @ weights))
