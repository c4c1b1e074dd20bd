"""The stability diagram as particles see it: margins, probability of stability, limits."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.description.errors import InputError, RunError
from chatter.explain.fitting import WORKERS
from chatter.explain.stability_margin import first_limits, margins_over

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ParticleDiagram:
    """Margins of n particles over speeds and depths.

    Parameters
    ----------
    speeds : (s,) array of float
        rad/s.
    depths : (d,) array of float
        Ascending, m.
    margins : (n, s, d) array of float
        Share of its depth by which a cut is away from the limit; above 0: stable.
    scatter : (n,) array of float
        Of limits from test to test, as a share.
    """

    speeds: Array
    depths: Array
    margins: Array
    scatter: Array

    @property
    def probability_of_particles(self) -> Array:
        """Probability (n, s, d) of a stable cut by each particle."""
        return scipy.special.ndtr(self.margins / self.scatter[:, None, None])

    @property
    def probability(self) -> Array:
        """Probability (s, d) that a cut is stable."""
        return self.probability_of_particles.mean(axis=0)

    @property
    def limits(self) -> Array:
        """Least critical depth (n, s) of every particle, m; inf where none is on the grid."""
        return first_limits(self.margins, self.depths)


def diagram_of(
    cases: Sequence[Case], scatter: Array, speeds: Array, depths: Array
) -> ParticleDiagram:
    """Margins of cases, a particle each, over speeds (s,), rad/s, and depths (d,), m."""

    def margins(case: Case) -> Array:
        try:
            return margins_over(case, speeds, depths)
        except (InputError, RunError):
            # what cannot be cut is no cut to make
            return np.full((speeds.size, depths.size), -1.0)

    with ThreadPoolExecutor(WORKERS) as pool:
        return ParticleDiagram(speeds, depths, np.stack(list(pool.map(margins, cases))), scatter)
