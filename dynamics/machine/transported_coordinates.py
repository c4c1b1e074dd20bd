"""Few coordinates that a machine keeps while its axes travel.

At each position the machine is reduced as one that stays there: to its modes and the static shapes
of its ports. The motions kept are others at the next position, and so are signs and order of the
modes; they are turned among themselves until they are as close to those of a neighbour as they can
be (orthogonal Procrustes problem over the mass; Panzer, Mohring, Eid and Lohmann 2010,
at-Automatisierungstechnik 58:475, and Amsallem and Farhat 2008, AIAA Journal 46:1803). A
coordinate then means the same at all positions but for the motion that leaves its place within a
travel: its inertia goes with the square of the speed of the axis over the length within which
shapes change and the circular frequency, and is left out.
"""

from collections.abc import Sequence

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from dynamics.machine.description import Machine, MachineParts, in_coordinates, reduced_to
from dynamics.reduction.modal_truncation import Modes, undamped_modes
from dynamics.structure.linear_structure import LinearStructure

#: cosine of the angle between what is kept at neighbouring positions, at the least
_LEAST_COSINE = 0.6
#: modes above the highest frequency that are kept where those below it change their places
_FURTHER_MODES = (0, 1, 2)
#: of an angle between rigid motions at two positions, which must be the same
_SAME_RIGID = 1e-6


def in_transported_coordinates(
    full: Sequence[Machine], parts: MachineParts
) -> tuple[Machine, ...] | None:
    """Reduce a machine at positions of its axes to coordinates that follow each other.

    Parameters
    ----------
    full : sequence of Machine
        With all freedoms, of one mass, at positions that lie close enough; the first gives the
        first coordinates.
    parts : MachineParts
        With the highest frequency and the points whose static answer is kept.

    Returns
    -------
    tuple of Machine or None
        One a position, of unit mass; None where what is kept at one position is no neighbour of
        what is kept at the others.
    """
    modes = [one.modes or undamped_modes(one.structure) for one in full]
    if parts.highest_frequency is None:
        return None
    highest = parts.highest_frequency
    count = max(int(np.searchsorted(one.frequency, highest, side="right")) for one in modes)
    for further in _FURTHER_MODES:
        machines = _reduced(full, modes, count + further, parts.kept_points)
        turned = None if machines is None else _turned(full, machines)
        if turned is not None:
            return turned
    return None


def _reduced(
    full: Sequence[Machine], modes: Sequence[Modes], count: int, kept: Sequence[str] | None
) -> list[Machine] | None:
    """Machine at each position in as many coordinates; None where it has not as many."""

    def of_modes(one: Machine, all_modes: Modes, number: int) -> Machine:
        few = Modes(all_modes.frequency[:number], all_modes.shapes[:, :number])
        return reduced_to(one, few, kept)

    machines = [of_modes(one, its, count) for one, its in zip(full, modes, strict=True)]
    size = max(one.structure.size for one in machines)
    for number, one in enumerate(machines):
        lacking = size - one.structure.size
        if lacking:
            machines[number] = of_modes(full[number], modes[number], count + lacking)
    return machines if all(one.structure.size == size for one in machines) else None


def _turned(full: Sequence[Machine], machines: Sequence[Machine]) -> tuple[Machine, ...] | None:
    """Machines turned towards their neighbours, from the first one on; None if one has none."""
    mass = full[0].structure.mass
    rigid = [_rigid_motions(one.structure) for one in machines]
    if len(set(rigid)) != 1:
        return None
    bases = np.array([one.basis for one in machines])
    count, freedoms, size = bases.shape
    flat = bases.transpose(1, 0, 2).reshape(freedoms, count * size)
    overlap = (flat.T @ (mass @ flat)).reshape(count, size, count, size)
    closeness = np.einsum("asbt,asbt->ab", overlap, overlap)
    turns = {0: np.eye(size)}
    while len(turns) < count:
        there = list(turns)
        others = [one for one in range(count) if one not in turns]
        near = closeness[np.ix_(there, others)]
        row, column = np.unravel_index(np.argmax(near), near.shape)
        neighbour, new = there[row], others[column]
        turn = _turn(overlap[new, :, neighbour] @ turns[neighbour], rigid[0])
        if turn is None:
            return None
        turns[new] = turn
    return tuple(
        in_coordinates(one, _seen_by(few.structure, turn), few.basis @ turn)
        for one, few, (_, turn) in zip(full, machines, sorted(turns.items()), strict=True)
    )


def _rigid_motions(structure: LinearStructure) -> int:
    """Number of coordinates that nothing resists; they come first."""
    return int(np.sum(~np.any(structure.stiffness != 0.0, axis=1)))


def _turn(overlap: NDArray[np.float64], rigid: int) -> NDArray[np.float64] | None:
    """Rotation of coordinates (m, m) that brings them closest, rigid and elastic ones apart.

    The overlap is that of the motions to be turned, by row, with those aimed at. None where they
    are too far from each other.
    """
    turn = np.zeros_like(overlap)
    for part, least in ((slice(0, rigid), 1.0 - _SAME_RIGID), (slice(rigid, None), _LEAST_COSINE)):
        left, cosines, right = scipy.linalg.svd(overlap[part, part])
        if np.min(cosines, initial=1.0) < least:
            return None
        turn[part, part] = left @ right
    return turn


def _seen_by(structure: LinearStructure, turn: NDArray[np.float64]) -> LinearStructure:
    """Structure of unit mass in coordinates that are turned."""
    damping, stiffness = (turn.T @ part @ turn for part in (structure.damping, structure.stiffness))
    return LinearStructure(
        np.eye(len(turn)),
        0.5 * (damping + damping.T),
        0.5 * (stiffness + stiffness.T),
        {name: motion @ turn for name, motion in structure.points.items()},
    )
