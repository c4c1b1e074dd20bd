"""Rank correlation over runs, with what chance gives."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.stats
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: permutations, and runs below which ranks tell nothing
_PERMUTATIONS, _FEWEST = 4000, 5


class RankCorrelation(NamedTuple):
    """Spearman's (1904) coefficient of two series and how likely chance gives as much."""

    coefficient: float
    probability: float


def rank_correlation(first: Array, second: Array, seed: int = 0) -> RankCorrelation:
    """Rank correlation by permutations; (0, 1) where one of the series does not vary."""
    if first.size < _FEWEST or np.ptp(first) == 0.0 or np.ptp(second) == 0.0:
        return RankCorrelation(0.0, 1.0)
    x, y = (scipy.stats.rankdata(values) for values in (first, second))
    x, y = ((r - r.mean()) / np.linalg.norm(r - r.mean()) for r in (x, y))
    found = float(x @ y)
    rng = np.random.default_rng(seed)
    shuffled = rng.permuted(np.tile(y, (_PERMUTATIONS, 1)), axis=1) @ x
    as_much = int(np.sum(np.abs(shuffled) >= abs(found) - 1e-12))
    return RankCorrelation(found, (1 + as_much) / (1 + _PERMUTATIONS))
