"""Force laws as the time-domain kernels see them: a table of numbers and a leaf for each law.

A law is added by its class in `force_law`, a table and a leaf here, and its entry in `EDGE_LAWS`;
which leaf runs is settled when the driver is compiled, by the type of the table.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from cutting.compiled import INLINED, by_table
from cutting.force.force_law import ExponentialLaw, ForceLaw, LinearLaw


class LinearEdge(NamedTuple):
    """F = (K_c h + K_e) b; rows are teeth, columns tangential, radial, axial."""

    cutting: NDArray[np.float64]  # N/m^2, (N, 3)
    edge: NDArray[np.float64]  # N/m, (N, 3)


class ExponentialEdge(NamedTuple):
    """F = (K h0 (h/h0)^p + K_e) b; rows are teeth, columns tangential, radial, axial."""

    cutting: NDArray[np.float64]  # N/m^2, (N, 3)
    edge: NDArray[np.float64]  # N/m, (N, 3)
    reference: float  # h0, m
    exponent: float  # p


@register_jitable(**INLINED)
def linear_edge_force(law, tooth, chip):
    """Tangential, radial and axial force per length of edge, N/m, at a chip thickness > 0, m."""
    return (
        law.cutting[tooth, 0] * chip + law.edge[tooth, 0],
        law.cutting[tooth, 1] * chip + law.edge[tooth, 1],
        law.cutting[tooth, 2] * chip + law.edge[tooth, 2],
    )


@register_jitable(**INLINED)
def exponential_edge_force(law, tooth, chip):
    """Tangential, radial and axial force per length of edge, N/m, at a chip thickness > 0, m."""
    # a power, by exponential and logarithm: a tenth of the whole time step less
    size = law.reference * math.exp(law.exponent * math.log(chip / law.reference))
    return (
        law.cutting[tooth, 0] * size + law.edge[tooth, 0],
        law.cutting[tooth, 1] * size + law.edge[tooth, 1],
        law.cutting[tooth, 2] * size + law.edge[tooth, 2],
    )


#: table -> leaf
EDGE_LAWS = {LinearEdge: linear_edge_force, ExponentialEdge: exponential_edge_force}
#: force per length of edge by the law of the table; see the leaves
edge_force = by_table(EDGE_LAWS)


def edge_law_table(laws: list[ForceLaw]) -> LinearEdge | ExponentialEdge:
    """Return the table of a force law, given for each tooth (helix may differ among them)."""
    cutting = np.array([law.cutting for law in laws], dtype=np.float64)
    edge = np.array([law.edge for law in laws], dtype=np.float64)
    first = laws[0]
    if isinstance(first, ExponentialLaw):
        return ExponentialEdge(cutting, edge, first.reference_chip_thickness, first.exponent)
    if isinstance(first, LinearLaw):
        return LinearEdge(cutting, edge)
    raise TypeError(f"no table for the force law {type(first).__name__}")
