"""Confidence interval of a probability from a count."""

from __future__ import annotations

import math

#: 97.5 % quantile of the normal distribution
_NORMAL_975 = 1.959963984540054


def wilson_interval(successes: int, count: int) -> tuple[float, float]:
    """95 % confidence interval of a probability (Wilson 1927).

    Parameters
    ----------
    successes, count : int
        Of independent trials; samples of a Latin hypercube spread less.

    Returns
    -------
    (float, float)
        Lowest and highest; 0 and 1 of no trials.
    """
    if count == 0:
        return 0.0, 1.0
    share, z2 = successes / count, _NORMAL_975**2 / count
    middle = (share + 0.5 * z2) / (1.0 + z2)
    half = _NORMAL_975 * math.sqrt(share * (1.0 - share) / count + 0.25 * z2 / count)
    half /= 1.0 + z2
    return max(0.0, middle - half), min(1.0, middle + half)
