"""Imported finite element part, reduced to its points, as a part of an assembly.

A Craig-Bampton super-element keeps the motion of every point of it, so that springs may act
there. Along a rail, a line of points, they may act anywhere: between neighbouring points the rail
moves as a beam that is bent by the motion of its ends alone.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

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
        If a rail names no point or fewer than two, or the structure is held by itself.
    """

    name: str
    #: super-element of `reduced_part`: points' six directions in order, modal coordinates
    structure: LinearStructure
    positions: Mapping[str, ArrayLike]  # each (3,), of all its points, in order, m
    #: points of lines along which other parts may be joined anywhere
    rails: Sequence[Sequence[str]] = ()

    def __post_init__(self) -> None:
        where = f'imported part "{self.name}"'
        refuse_ground(where, self.name)
        positions = {
            name: finite(where, f'position of point "{name}"', position, (3,))
            for name, position in self.positions.items()
        }
        object.__setattr__(self, "positions", positions)
        for rail in self.rails:
            _check_rail(where, rail, positions)
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
        """Displacements and rotations (6, n) at a position: a point, or beside a rail.

        Beside a rail the position follows the nearest position on it rigidly.

        Raises
        ------
        StructureError
            If the position is not a point and there is no rail, or it lies off its ends.
        """
        at = np.asarray(position, dtype=np.float64)
        apart = self._all_positions - at
        off = np.einsum("kd,kd->k", apart, apart)
        nearest = int(off.argmin())
        if off[nearest] <= SAME_POSITION**2:
            return self.structure.points[list(self.positions)[nearest]]
        if not self.rails:
            points = "; ".join(f'"{name}" at {_shown(one)}' for name, one in self.positions.items())
            raise StructureError(
                f'imported part "{self.name}" has no point at {_shown(at)} m; there are {points}'
            )
        return self._on_rail(at)

    def shifted(self, shift: ArrayLike) -> ImportedPart:
        """Same part elsewhere, shifted by (3,) in m."""
        if not np.any(shift):
            return self
        moved = {name: position + np.asarray(shift) for name, position in self.positions.items()}
        # rigid motions are about the first point: what was checked once holds everywhere
        elsewhere = copy(self)
        for kept in ("_spans", "_starts_and_alongs", "_all_positions"):
            elsewhere.__dict__.pop(kept, None)
        object.__setattr__(elsewhere, "positions", moved)
        return elsewhere

    @cached_property
    def _spans(self) -> list[_Span]:
        """All pairs of neighbouring points of the rails."""
        return [
            _Span(
                *pair,
                self.positions[pair[0]],
                self.positions[pair[1]] - self.positions[pair[0]],
                number == 0,
                number == len(rail) - 2,
            )
            for rail in self.rails
            for number, pair in enumerate(itertools.pairwise(rail))
        ]

    @cached_property
    def _bendings(self) -> dict[tuple[str, str], NDArray[np.float64]]:
        """Of all spans, by their points."""
        return {(one.first, one.second): _bending(one.along) for one in self._spans}

    @cached_property
    def _all_positions(self) -> NDArray[np.float64]:
        """Of the points, (k, 3), m."""
        return np.array(list(self.positions.values()))

    @cached_property
    def _starts_and_alongs(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Of all spans, (k, 3) each, m."""
        return np.array([one.start for one in self._spans]), np.array(
            [one.along for one in self._spans]
        )

    def _on_rail(self, at: NDArray[np.float64]) -> NDArray[np.float64]:
        starts, alongs = self._starts_and_alongs
        apart = at - starts
        squared = np.einsum("kd,kd->k", alongs, alongs)
        shares = np.clip(np.einsum("kd,kd->k", apart, alongs) / squared, 0.0, 1.0)
        apart -= shares[:, None] * alongs
        off = np.einsum("kd,kd->k", apart, apart)
        span = self._spans[int(np.argmin(off))]
        if span.is_beyond(at):
            ends = "; ".join(
                f"{_shown(self.positions[rail[0]])} to {_shown(self.positions[rail[-1]])}"
                for rail in self.rails
            )
            raise StructureError(
                f'imported part "{self.name}": {_shown(at)} m lies off the end of the rail, which '
                f"goes from {ends} m"
            )
        share = span.share_within(at)
        nearest = span.start + share * span.along
        bent = _at_share(self._bendings[span.first, span.second], share)
        ends = [self.structure.points[name] for name in (span.first, span.second)]
        return rigid_motion(at - nearest) @ bent @ np.vstack(ends)


class _Span(NamedTuple):
    """Two neighbouring points of a rail."""

    first: str
    second: str
    start: NDArray[np.float64]  # position of the first, m
    along: NDArray[np.float64]  # from the first to the second, m
    begins: bool  # whether the rail begins with it
    ends: bool

    def share(self, at: NDArray[np.float64]) -> float:
        return float((at - self.start) @ self.along / (self.along @ self.along))

    def share_within(self, at: NDArray[np.float64]) -> float:
        return min(max(self.share(at), 0.0), 1.0)

    def is_beyond(self, at: NDArray[np.float64]) -> bool:
        share = self.share(at)
        off = abs(share - self.share_within(at)) * np.linalg.norm(self.along)
        at_end = (self.begins and share < 0.0) or (self.ends and share > 1.0)
        return bool(at_end and off > SAME_POSITION)


def bent_beam(
    first: NDArray[np.float64],
    second: NDArray[np.float64],
    along: NDArray[np.float64],
    share: float,
) -> NDArray[np.float64]:
    """Motion (6, n) at a share of the way between two points, as a beam without loads bends.

    Displacements across are the cubics of both ends' displacements and rotations (Hermite; slope
    is rotation, Euler and Bernoulli), those along and the twist are linear. A rigid motion of the
    ends is one of the beam.

    Parameters
    ----------
    first, second : (6, n) array of float
        Motion of the ends.
    along : (3,) array of float
        From the first to the second, m.
    share : float
        0 to 1.
    """
    return _at_share(_bending(along), share) @ np.vstack([first, second])


def _at_share(bending: NDArray[np.float64], share: float) -> NDArray[np.float64]:
    """Value (6, 12) of a polynomial of `_bending`."""
    return (share ** np.arange(4) @ bending).reshape(6, 12)


def _bending(along: NDArray[np.float64]) -> NDArray[np.float64]:
    """Cubic of the share of the way, as `bent_beam` has it: coefficients (4, 6 * 12).

    Motion (6,) per displacements and rotations of both ends (12,).
    """
    length = float(np.linalg.norm(along))
    axis = along / length
    lengthwise = np.outer(axis, axis)
    across = np.eye(3) - lengthwise
    crossed = _crossed_with(axis)
    # rotation to slope of the displacement along the axis, theta x axis
    turning = -crossed
    # in powers of the share: displacement of either end, and slope there, over the length
    values = np.array([[1.0, 0.0, -3.0, 2.0], [0.0, 1.0, -2.0, 1.0]])
    values = np.vstack([values, [[0.0, 0.0, 3.0, -2.0], [0.0, 0.0, -1.0, 1.0]]])
    slopes = np.hstack([values[:, 1:] * [1.0, 2.0, 3.0], np.zeros((4, 1))])
    bending = np.zeros((4, 6, 12))
    for end, straight in enumerate(([1.0, -1.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0])):
        motion = bending[:, :, 6 * end : 6 * end + 6]
        motion[:, :3, :3] = _times(straight, lengthwise) + _times(values[2 * end], across)
        motion[:, :3, 3:] = _times(length * values[2 * end + 1], across @ turning)
        motion[:, 3:, :3] = _times(slopes[2 * end] / length, crossed @ across)
        motion[:, 3:, 3:] = _times(straight, lengthwise)
        motion[:, 3:, 3:] += _times(slopes[2 * end + 1], crossed @ across @ turning)
    return bending.reshape(4, 72)


def _times(powers: ArrayLike, matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """Polynomial (4, 3, 3) of coefficients (4,) times a matrix."""
    return np.multiply.outer(np.asarray(powers), matrix)


def _crossed_with(vector: NDArray[np.float64]) -> NDArray[np.float64]:
    """Matrix (3, 3) of the cross product of a vector with another one behind it."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def reduced_part(
    name: str,
    structure: LinearStructure,
    positions: Mapping[str, ArrayLike],
    rails: Sequence[Sequence[str]] = (),
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
    return ImportedPart(name, super_element(structure, list(positions), highest), positions, rails)


def _check_rail(where: str, rail: Sequence[str], positions: Mapping[str, ArrayLike]) -> None:
    for name in rail:
        if name not in positions:
            known = ", ".join(f'"{one}"' for one in positions)
            raise StructureError(f'{where}: rail: there is no point "{name}"; there are {known}')
    if len(rail) < 2 or len(set(rail)) < len(rail):
        raise StructureError(f"{where}: rail must name two points or more, each once")


def _shown(position: NDArray[np.float64]) -> str:
    return "(" + ", ".join(f"{part:g}" for part in position) + ")"
