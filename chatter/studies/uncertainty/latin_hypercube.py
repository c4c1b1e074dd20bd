"""Latin hypercubes (McKay, Beckman and Conover 1979), in blocks.

Each block is a Latin hypercube of its own, so that any number of whole blocks covers the
distributions evenly, and more samples go on where fewer ended. Correlation is put in by order
alone, so that every value keeps its own hypercube (Iman and Conover 1982, Commun. Stat. B 11:311).
"""

from collections.abc import Sequence

import numpy as np

from chatter.description.arrays import Array
from chatter.studies.uncertainty.uncertain_parameters import UncertainParameter

BLOCK = 50


def samples(
    parameters: Sequence[UncertainParameter],
    count: int,
    seed: int,
    correlation: Array | None = None,
) -> Array:
    """Draw values (count, p) of p parameters, SI.

    The same seed gives the same samples, whatever the count. The correlation (p, p) is that of the
    normal distributions, which are independent by default.
    """
    from scipy.stats import qmc

    blocks = []
    for block in range(-(-count // BLOCK)):
        generator = np.random.default_rng([seed, block])
        cube = qmc.LatinHypercube(len(parameters), seed=generator).random(BLOCK)
        blocks.append(cube if correlation is None else _in_order(cube, correlation))
    probability = np.concatenate(blocks)[:count]
    return np.column_stack(
        [one.at(column) for one, column in zip(parameters, probability.T, strict=True)]
    )


def _in_order(cube: Array, correlation: Array) -> Array:
    """Hypercube with its columns reordered as normal scores of a correlation."""
    from scipy.special import ndtri

    scores = ndtri(cube)
    # what chance correlates in so few samples is taken out first
    chance = np.linalg.cholesky(np.corrcoef(scores, rowvar=False))
    scores = scores @ np.linalg.inv(chance).T @ np.linalg.cholesky(correlation).T
    ranks = np.argsort(np.argsort(scores, axis=0), axis=0)
    return np.take_along_axis(np.sort(cube, axis=0), ranks, axis=0)
