"""Imported finite element part, reduced to its points, as a part of an assembly.

A Craig-Bampton super-element keeps the motion of every point of it, so that springs may act
there. Along a rail, a line of points, they may act anywhere: the rail moves as a straight line
between neighbouring points.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.reduction.craig_bampton import super_element
from dynamics.structure.bodies import GROUND, finite, refuse_ground, rigid_motion
from dynamics.structure.linear_structure import LinearStructure, StructureError

#: distance, m, at which a position is a point
SAME_POSITION = 1e-5
#: of forces in a rigid motion, over what they are sums of
NO_FORCE = 1e-6


@dataclass(frozen=True, eq=False)
class ImportedPart:
    """Part of which only points, and rails between them, can be joined.

    Raises
    ------
    StructureError
        If the rail names no point or fewer than two, or the structure is held by itself.
    """

    name: str
    #: super-element of `reduced_part`: points' six directions in order, modal coordinates
    structure: LinearStructure
    positions: Mapping[str, ArrayLike]  # each (3,), of all its points, in order, m
    rail: Sequence[str] = ()  # points of a line along which other parts may be joined anywhere

    def __post_init__(self) -> None:
        where = f'imported part "{self.name}"'
        refuse_ground(where, self.name)
        positions = {
            name: finite(where, f'position of point "{name}"', position, (3,))
            for name, position in self.positions.items()
        }
        object.__setattr__(self, "positions", positions)
        for name in self.rail:
            if name not in positions:
                known = ", ".join(f'"{one}"' for one in positions)
                raise StructureError(
                    f'{where}: rail: there is no point "{name}"; there are {known}'
                )
        if len(self.rail) == 1 or len(set(self.rail)) < len(self.rail):
            raise StructureError(f"{where}: rail must name two points or more, each once")
        stiffness, rigid = self.stiffness_matrix, self.rigid_motions
        if np.any(np.abs(stiffness @ rigid) > NO_FORCE * np.max(np.abs(stiffness) @ np.abs(rigid))):
            raise StructureError(
                f"{where} is held by itself, being fixed in its stiffness matrix; export it free "
                f'and hold it by connectors to "{GROUND}"'
            )

    @property
    def mass_matrix(self) -> NDArray[np.float64]:
        """(n, n), kg and kin."""
        return self.structure.mass

    @property
    def damping_matrix(self) -> NDArray[np.float64]:
        """(n, n), N s/m and kin."""
        return self.structure.damping

    @property
    def stiffness_matrix(self) -> NDArray[np.float64]:
        """(n, n), N/m and kin."""
        return self.structure.stiffness

    @cached_property
    def rigid_motions(self) -> NDArray[np.float64]:
        """(n, 6): along and about x, y, z of the first point; modal coordinates rest."""
        positions = list(self.positions.values())
        motions = np.zeros((self.structure.size, 6))
        motions[: 6 * len(positions)] = np.vstack(
            [rigid_motion(one - positions[0]) for one in positions]
        )
        return motions

    def motion_at(self, position: ArrayLike) -> NDArray[np.float64]:
        """Displacements and rotations (6, n) at a position: a point, or beside the rail.

        Beside the rail the position follows the nearest position on the rail rigidly.

        Raises
        ------
        StructureError
            If the position is not a point and there is no rail, or it lies off its ends.
        """
        at = np.asarray(position, dtype=np.float64)
        for name, point in self.positions.items():
            if np.linalg.norm(at - point) <= SAME_POSITION:
                return self.structure.points[name]
        if not self.rail:
            points = "; ".join(f'"{name}" at {_shown(one)}' for name, one in self.positions.items())
            raise StructureError(
                f'imported part "{self.name}" has no point at {_shown(at)} m; there are {points}'
            )
        return self._on_rail(at)

    def shifted(self, shift: ArrayLike) -> ImportedPart:
        """Same part elsewhere, shifted by (3,) in m."""
        moved = {name: position + np.asarray(shift) for name, position in self.positions.items()}
        return replace(self, positions=moved)

    def _on_rail(self, at: NDArray[np.float64]) -> NDArray[np.float64]:
        ends = [self.positions[name] for name in self.rail]
        best, chosen = np.inf, None
        for number, (start, end) in enumerate(itertools.pairwise(ends)):
            along = end - start
            share = float((at - start) @ along / (along @ along))
            share_within = min(max(share, 0.0), 1.0)
            distance = float(np.linalg.norm(at - start - share_within * along))
            if distance < best:
                off = abs(share - share_within) * np.linalg.norm(along)
                beyond = (share < 0.0 and number == 0) or (share > 1.0 and number == len(ends) - 2)
                best, chosen = distance, (number, share_within, beyond and off > SAME_POSITION)
        number, share, beyond = chosen
        if beyond:
            raise StructureError(
                f'imported part "{self.name}": {_shown(at)} m lies off the end of the rail, which '
                f"goes from {_shown(ends[0])} to {_shown(ends[-1])} m"
            )
        first, second = (self.structure.points[name] for name in self.rail[number : number + 2])
        nearest = (1.0 - share) * ends[number] + share * ends[number + 1]
        return rigid_motion(at - nearest) @ ((1.0 - share) * first + share * second)


def reduced_part(
    name: str,
    structure: LinearStructure,
    positions: Mapping[str, ArrayLike],
    rail: Sequence[str] = (),
    highest: float = np.inf,
) -> ImportedPart:
    """Reduce a structure to its points and fixed-interface modes up to a frequency.

    The structure is free, with points that have all six directions, at positions (3,), m; the
    frequency is in Hz. StructureError as for `super_element` and `ImportedPart`.
    """
    for point in positions:
        lacking = ~np.any(structure.points[point] != 0.0, axis=1)
        if np.any(lacking):
            raise StructureError(
                f'imported part "{name}": point "{point}" lacks displacements or rotations; '
                "tie it to nodes that are not on one line"
            )
    return ImportedPart(name, super_element(structure, list(positions), highest), positions, rail)


def _shown(position: NDArray[np.float64]) -> str:
    return "(" + ", ".join(f"{part:g}" for part in position) + ")"
