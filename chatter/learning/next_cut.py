"""The next cut: where its verdict says most, or where it takes off most within a risk."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.learning.diagram import ParticleDiagram

Array = NDArray[np.float64]

#: aims of the next cut
INFORMATION, METAL = "information", "metal"
AIMS = (INFORMATION, METAL)
#: expected information, bit, below which a cut is not worth making
LEAST_INFORMATION = 0.02


class NextCut(NamedTuple):
    """A cut to make."""

    spindle_speed: float  # rad/s
    axial_depth: float  # m
    probability: float  # that it is stable
    information: float  # expected of its verdict, bit


def expected_information(probability: Array) -> Array:
    """Information (...), bit, that a verdict is expected to give about the particles.

    Entropy of the verdict by all particles less the mean of its entropy by each: what is not
    scatter (Lindley 1956, Ann. Math. Stat. 27:986). Probabilities of stability are (n, ...).
    """
    return _entropy(probability.mean(axis=0)) - _entropy(probability).mean(axis=0)


def _entropy(probability: Array) -> Array:
    inside = np.clip(probability, 1e-12, 1.0 - 1e-12)
    return -(inside * np.log2(inside) + (1.0 - inside) * np.log2(1.0 - inside))


def next_cut(diagram: ParticleDiagram, aim: str, risk: float) -> NextCut | None:
    """Cut of most information, or of most metal, whose probability of chatter is `risk` at most.

    None where no cut is within the risk.
    """
    information = expected_information(diagram.probability_of_particles)
    probability = diagram.probability
    worth = information if aim == INFORMATION else np.outer(diagram.speeds, diagram.depths)
    allowed = probability >= 1.0 - risk
    if not allowed.any():
        return None
    i, j = np.unravel_index(np.argmax(np.where(allowed, worth, -1.0)), worth.shape)
    return NextCut(
        float(diagram.speeds[i]),
        float(diagram.depths[j]),
        float(probability[i, j]),
        float(information[i, j]),
    )
