"""Lines that a machine is drawn by: edges of blocks, axes of beams, points of imported parts."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import minimum_spanning_tree
from scipy.spatial.distance import cdist

from chatter.description.machine.imported import ImportedSection
from chatter.description.machine.machine_file import MachineFile

_BEAM_POINTS = 13
#: corners of a block, of which neighbours differ in one place, are its edges
_CORNERS = tuple(itertools.product((-0.5, 0.5), repeat=3))
_EDGES = tuple(
    (a, b)
    for a, b in itertools.combinations(range(8), 2)
    if sum(p != q for p, q in zip(_CORNERS[a], _CORNERS[b], strict=True)) == 1
)
#: length of a line along a rail, m: none is left out for a shorter way
_ALONG_A_RAIL = 1e-12

Lines = Sequence[tuple[int, int]]


class PartOutline(NamedTuple):
    """Points of one part that are drawn, m, and which of them are joined."""

    part: str
    points: NDArray[np.float64]  # (p, 3)
    lines: Lines


def outlines(file: MachineFile) -> list[PartOutline]:
    """Outline of every part of a machine."""
    return [*_blocks(file), *_beams(file), *_imported(file)]


def _blocks(file: MachineFile) -> Iterator[PartOutline]:
    for name, body in file.body.items():
        centre = np.asarray(body.centre, dtype=np.float64)
        if body.size is None:
            yield PartOutline(name, centre[None, :], ())
        else:
            corners = centre + np.array(_CORNERS) * np.asarray(body.size)
            yield PartOutline(name, corners, _EDGES)


def _beams(file: MachineFile) -> Iterator[PartOutline]:
    joined = tuple((k, k + 1) for k in range(_BEAM_POINTS - 1))
    for name, beam in file.beam.items():
        axis = np.asarray(beam.axis, dtype=np.float64)
        length = sum(one.length for one in beam.segments)
        stations = np.linspace(0.0, length, _BEAM_POINTS)
        origin = np.asarray(beam.origin, dtype=np.float64)
        points = origin + stations[:, None] * (axis / np.linalg.norm(axis))
        yield PartOutline(name, points, joined)


def _imported(file: MachineFile) -> Iterator[PartOutline]:
    for name, section in file.imported.items():
        points = np.array([one.at for one in section.point.values()], dtype=np.float64)
        yield PartOutline(name, points, _joined_points(section, points))


def _joined_points(section: ImportedSection, points: NDArray[np.float64]) -> Lines:
    """Lines along the rails, and the shortest ones that join the other points to them."""
    row = {name: place for place, name in enumerate(section.point)}
    rails = [
        (row[first], row[second])
        for rail in section.rail
        for first, second in itertools.pairwise(rail)
    ]
    distance = np.maximum(cdist(points, points), _ALONG_A_RAIL)
    for first, second in rails:
        distance[first, second] = distance[second, first] = _ALONG_A_RAIL
    tree = np.argwhere(minimum_spanning_tree(distance).toarray() > 0.0)
    joined = [tuple(sorted(pair)) for pair in (*rails, *tree.tolist())]
    return list(dict.fromkeys((first, second) for first, second in joined))
