"""Meshed part whose points are tied to its nodes, before it is reduced."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dynamics.structure.imported import tied_structure
from dynamics.structure.linear_structure import LinearStructure, Matrix
from dynamics.structure.surface_constraint import InterpolatedPoint, Nodes, RigidSurface

Position = tuple[float, float, float]
#: name and position, m, of a point, and which nodes it is tied to, (m,)
TiedPoint = tuple[str, Position, NDArray[np.bool_]]


class TiedPart(NamedTuple):
    """A meshed part and the points that are tied to it."""

    coordinates: NDArray[np.float64]  # (m, 3), m
    structure: LinearStructure  # free, with points
    positions: dict[str, Position]  # of the points, m


def tied_part(
    coordinates: NDArray[np.float64],
    mass: Matrix,
    stiffness: Matrix,
    rigid: Sequence[TiedPoint],
    interpolated: Sequence[TiedPoint],
) -> TiedPart:
    """Tie points to a meshed part.

    Parameters
    ----------
    coordinates : (m, 3) array of float
        Of the nodes, m.
    mass, stiffness : (3 m, 3 m) array or sparse array
        kg, N/m.
    rigid, interpolated : sequence of (str, (3,) floats, (m,) array of bool)
        Points that make their nodes rigid, and points that follow the mean of theirs.

    Raises
    ------
    StructureError
        If the nodes of a point do not tell its motion.
    """
    nodes = Nodes.in_order(np.arange(1, len(coordinates) + 1), coordinates, mass.shape[0])
    structure = tied_structure(
        LinearStructure(mass, 0.0 * mass, stiffness, {}),
        nodes,
        [RigidSurface(name, at, nodes.names[chosen].tolist()) for name, at, chosen in rigid],
        [
            InterpolatedPoint(name, at, nodes.names[chosen].tolist())
            for name, at, chosen in interpolated
        ],
    )
    return TiedPart(coordinates, structure, {name: at for name, at, _ in (*rigid, *interpolated)})
