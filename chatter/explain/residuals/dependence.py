"""How much of a residual depends on a variable, judged on holdout runs.

The residual is fitted by g(v) w, g a step function over bins of the variable v and w a weight (one,
or the predicted signal where a coefficient may depend on v). The steps are read from all runs but
one and explain that one, so that a share of zero or less is what noise gives. Chance is examined
by shifting every run's residual in time against its variables: that keeps its spectrum and its
size and breaks nothing but the dependence.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

#: shifts against which a share is held, and standard deviations of theirs that it must exceed
_SHIFTS, _BEYOND = 150, 3.0
#: shifts of a run that are held in memory together
_AT_ONCE = 30
#: shares below this are not told, whatever their significance
LEAST_SHARE = 0.01
#: weight of a bin over the largest below which nothing is known there: no cut, no share of it
_LEAST_WEIGHT = 1e-5
#: runs below which every run is cut into this many folds
_FEW_RUNS, _FOLDS = 3, 4


class Sample(NamedTuple):
    """One run of a channel for a dependence."""

    normalised: Array  # (n,), residual over the noise
    weight: Array  # (n,), weight over the noise
    bins: Indices  # (n,), bin of every sample; -1 for none


class Dependence(NamedTuple):
    """Share of a residual that depends on a variable."""

    share: float  # of the sum of squares over the noise, by holdout runs; below 0 for noise
    threshold: float  # share that shifted residuals do not exceed
    coefficients: Array  # (bins,), g of every bin from all runs, nan where there are no samples
    errors: Array  # (bins,), its standard error

    @property
    def significant(self) -> bool:
        """Whether it is more than noise gives."""
        return self.share > max(self.threshold, LEAST_SHARE)


def edges_of(values: Array, count: int = 24) -> Array:
    """Edges of bins, half of them evenly spaced and half of them evenly filled."""
    known = values[np.isfinite(values)]
    if known.size == 0 or known.min() == known.max():
        middle = float(known[0]) if known.size else 0.0
        return np.array([middle - 0.5, middle + 0.5])
    even = np.linspace(known.min(), known.max(), count // 2 + 1)
    filled = np.quantile(known, np.linspace(0.0, 1.0, count // 2 + 1))
    edges = np.unique(np.concatenate((even, filled)))
    # edges that nearly coincide make bins that hold nothing
    keep = np.concatenate(([True], np.diff(edges) > 1e-3 * (edges[-1] - edges[0])))
    keep[-1] = True
    return edges[keep]


def bins_of(values: Array, edges: Array) -> Indices:
    """Bin of every value; -1 where it is not known."""
    bins = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, edges.size - 2)
    return np.where(np.isfinite(values), bins, -1)


def dependence(samples: Sequence[Sample], bins: int, seed: int = 0) -> Dependence:
    """Share of a residual that a step function of a variable explains in holdout runs.

    Samples are one a run; the seed is of the shifts.
    """
    folds = [fold for sample in samples for fold in _folds(sample, len(samples))]
    weights = [_sums(fold.bins, fold.weight**2, bins) for fold in folds]
    folds = _without_constant(folds)
    total = sum(float(s.normalised @ s.normalised) for s in samples)
    own = [_sums(fold.bins, fold.normalised * fold.weight, bins) for fold in folds]
    share = _share(own, weights) / max(total, 1e-300)
    threshold = np.inf
    if share > LEAST_SHARE:
        rng = np.random.default_rng(seed)
        products = _shifted_products(folds, bins, rng)
        shifted = np.array([_share(one, weights) for one in products]) / max(total, 1e-300)
        # what a shift loses by chance is no measure of how far it may gain
        spread = float(np.std(shifted))
        threshold = max(float(shifted.max()), float(shifted.mean()) + _BEYOND * spread)
    all_weights = np.sum(weights, axis=0)
    products = sum(_sums(s.bins, s.normalised * s.weight, bins) for s in samples)
    known = all_weights > _LEAST_WEIGHT * all_weights.max()
    with np.errstate(divide="ignore", invalid="ignore"):
        coefficients = np.where(known, products / all_weights, np.nan)
        errors = np.where(known, 1.0 / np.sqrt(all_weights), np.nan)
    return Dependence(share, threshold, coefficients, errors)


def _folds(sample: Sample, runs: int) -> list[Sample]:
    if runs >= _FEW_RUNS:
        return [sample]
    cuts = np.array_split(np.arange(sample.normalised.size), _FOLDS)
    return [Sample(*(column[cut] for column in sample)) for cut in cuts]


def _without_constant(folds: Sequence[Sample]) -> list[Sample]:
    """Folds less the one multiple of the weight that suits all: a constant depends on nothing."""
    weights = sum(float(s.weight @ s.weight) for s in folds)
    constant = sum(float(s.normalised @ s.weight) for s in folds) / max(weights, 1e-300)
    return [s._replace(normalised=s.normalised - constant * s.weight) for s in folds]


def _shifted_products(folds: Sequence[Sample], bins: int, rng: np.random.Generator) -> Array:
    """Products (shifts, folds, bins) of residuals, shifted at random, and weights, summed."""
    shifts = np.array([[rng.integers(s.normalised.size) for s in folds] for _ in range(_SHIFTS)])
    found = np.empty((_SHIFTS, len(folds), bins))
    for index, (sample, later) in enumerate(zip(folds, shifts.T, strict=True)):
        size, known = sample.bins.size, np.flatnonzero(sample.bins >= 0)
        of_bins = np.zeros((size, bins))
        of_bins[known, sample.bins[known]] = sample.weight[known]
        twice = np.tile(sample.normalised, 2)
        # row k of the windows is the residual later by size - k samples
        windows = np.lib.stride_tricks.sliding_window_view(twice, size)
        for begin in range(0, _SHIFTS, _AT_ONCE):
            some = slice(begin, begin + _AT_ONCE)
            found[some, index] = windows[size - later[some]] @ of_bins
    return found


def _sums(bins: Indices, values: Array, count: int) -> Array:
    known = bins >= 0
    if known.all():
        return np.bincount(bins, weights=values, minlength=count)
    return np.bincount(bins[known], weights=values[known], minlength=count)


def _share(products: Sequence[Array] | Array, weights: Sequence[Array]) -> float:
    """Sum of squares that every fold loses by the steps of the others.

    Products of residual and weight, and squares of the weights, are summed by bin, fold by fold.
    """
    all_products, all_weights = np.sum(products, axis=0), np.sum(weights, axis=0)
    lost = 0.0
    for own, weight in zip(products, weights, strict=True):
        others = all_weights - weight
        known = others > 1e-12 * np.maximum(all_weights, 1e-300)
        steps = np.where(known, (all_products - own) / np.where(known, others, 1.0), 0.0)
        lost += float(np.sum(2.0 * steps * own - steps**2 * weight))
    return lost
