"""Latin hypercubes (McKay, Beckman and Conover 1979), in blocks.

Each block is a Latin hypercube of its own, so that any number of whole blocks covers the
distributions evenly, and more samples go on where fewer ended.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from chatter.monte_carlo.parameters import UncertainParameter

BLOCK = 50


def samples(parameters: Sequence[UncertainParameter], count: int, seed: int) -> NDArray[np.float64]:
    """Draw values of all parameters.

    Parameters
    ----------
    parameters : sequence of p UncertainParameter
    count : int
    seed : int
        The same seed gives the same samples, whatever the count.

    Returns
    -------
    (count, p) array of float
        SI.
    """
    from scipy.stats import qmc

    blocks = []
    for block in range(-(-count // BLOCK)):
        generator = np.random.default_rng([seed, block])
        blocks.append(qmc.LatinHypercube(len(parameters), seed=generator).random(BLOCK))
    probability = np.concatenate(blocks)[:count]
    return np.column_stack(
        [one.at(column) for one, column in zip(parameters, probability.T, strict=True)]
    )
