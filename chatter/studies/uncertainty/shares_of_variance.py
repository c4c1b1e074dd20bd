"""Shares of uncertain values in the variance of a result, which add up to the whole.

Relative weights of the linear regression (Johnson, J. W., 2000, Multivariate Behavioral Research
35:1): the values are rotated to the uncorrelated ones nearest to them, and the squares of the
regression on those are given back. They are never negative and add up to R^2, whether the
samples are correlated by chance or by the case.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from chatter.description.arrays import Array

#: eigenvalues of the correlation below this are none: values that go together exactly
_NO_EIGENVALUE = 1e-10


def shares_of_variance(values: Array, result: Array) -> Array:
    """Shares (p,) of values (n, p) in the variance of a result (n,), to first order.

    What is missing to 1 is curvature and joint influence. Values that do not vary have none.
    """
    varying = np.ptp(values, axis=0) > 0.0
    shares = np.zeros(values.shape[1])
    if not varying.any() or np.ptp(result) == 0.0:
        return shares
    x = values[:, varying]
    x = (x - x.mean(axis=0)) / x.std(axis=0)
    y = (result - result.mean()) / result.std()
    eigenvalue, vector = np.linalg.eigh(x.T @ x / len(x))
    kept = eigenvalue > _NO_EIGENVALUE
    eigenvalue, vector = eigenvalue[kept], vector[:, kept]
    root = np.sqrt(eigenvalue)
    # correlation of the values, and of the result, with the uncorrelated ones nearest to them
    loading = (vector * root) @ vector.T
    regression = (vector / root) @ vector.T @ (x.T @ y / len(x))
    shares[varying] = loading**2 @ regression**2
    return shares


def whole_percentages(shares: Sequence[float]) -> list[int]:
    """Shares in whole per cent that add up to those of their sum: the largest remainders go up."""
    percent = 100.0 * np.asarray(shares, dtype=np.float64)
    whole = np.floor(percent + 1e-9).astype(int)
    missing = round(float(percent.sum())) - int(whole.sum())
    largest = np.argsort(whole - percent, kind="stable")[:missing]
    whole[largest] += 1
    return [int(one) for one in whole]
