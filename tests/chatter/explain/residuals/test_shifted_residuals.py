"""Residuals shifted against their variables: sums by bin as a plain loop makes them."""

import numpy as np

from chatter.explain.residuals.dependence import Sample, dependence


def sums(bins, values, count):
    return np.array([values[bins == one].sum() for one in range(count)])


def gained(folds, count):
    """Sum of squares that every run loses by the steps of the others, run by run."""
    found = 0.0
    for own in range(len(folds)):
        others = [fold for index, fold in enumerate(folds) if index != own]
        top = sum(sums(b, r * w, count) for r, w, b in others)
        steps = top / sum(sums(b, w**2, count) for r, w, b in others)
        r, w, b = folds[own]
        inside = b >= 0
        left = r[inside] - steps[b[inside]] * w[inside]
        found += np.sum(r[inside] ** 2) - np.sum(left**2)
    return found


def test_the_threshold_is_that_of_residuals_rolled_one_by_one():
    random = np.random.default_rng(3)
    count, folds = 5, []
    for size in (301, 260, 333):
        bins = random.integers(-1, count, size)
        residual = random.standard_normal(size) + 0.6 * bins
        folds.append((residual, random.uniform(0.5, 2.0, size), bins))
    found = dependence([Sample(*fold) for fold in folds], count, seed=11)

    total = sum(r @ r for r, w, b in folds)
    constant = sum(r @ w for r, w, b in folds) / sum(w @ w for r, w, b in folds)
    folds = [(r - constant * w, w, b) for r, w, b in folds]
    random = np.random.default_rng(11)
    shifted = np.array(
        [
            gained([(np.roll(r, random.integers(r.size)), w, b) for r, w, b in folds], count)
            / total
            for _ in range(150)
        ]
    )
    np.testing.assert_allclose(found.share, gained(folds, count) / total, rtol=1e-9)
    expected = max(shifted.max(), shifted.mean() + 3.0 * shifted.std())
    np.testing.assert_allclose(found.threshold, expected, rtol=1e-9)
