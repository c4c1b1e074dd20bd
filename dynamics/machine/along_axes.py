"""A machine at several positions of its axes, always in the same coordinates.

What carries the state of a machine from one position to the next must mean the same at both. Beams
therefore have nodes wherever they are joined at any of the positions, and a reduction keeps the
motions that are needed at any of them: modes up to the highest frequency and static shapes of all
positions, made orthogonal over the mass, which no travel changes.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from dynamics.machine.description import (
    Condition,
    FrictionAt,
    Machine,
    MachineParts,
    full_machine,
    in_coordinates,
    meshed_beams,
    reduced,
)
from dynamics.reduction.modal_truncation import undamped_modes
from dynamics.structure.linear_structure import LinearStructure, StructureError

#: part of a motion's inertia below which the motions before hold it already
_NOTHING_NEW = 1e-6
#: of masses at two positions, from one another
_SAME_MASS = 1e-9


def machines_at(
    positions: Sequence[MachineParts], conditions: Mapping[str, Condition] | None = None
) -> tuple[Machine, ...]:
    """Assemble a machine at positions of its axes, in the coordinates of all of them.

    Parameters
    ----------
    positions : sequence of MachineParts
        The same parts at each; that at the first gives the first coordinates.
    conditions : mapping of str to {"control", "brake", "free"}, optional
        As for `dynamics.machine.description.machine`.

    Returns
    -------
    tuple of Machine
        One a position.

    Raises
    ------
    StructureError
        If the machine makes no sense at one of them, or the mass changes along the travel.
    """
    full = [full_machine(parts, conditions) for parts in _in_one_mesh(positions, conditions)]
    first = full[0]
    for other in full[1:]:
        _require_same_mass(first, other)
    rubbing = {one.name: one for one in positions[0].frictions if one.mode is not None}
    full = [first, *(_with_modes_followed(one, first, rubbing) for one in full[1:])]
    basis = _common_basis(full, positions[0])
    if basis is None:
        return tuple(full)
    return tuple(in_coordinates(one, _projected(one.structure, basis), basis) for one in full)


def _in_one_mesh(
    positions: Sequence[MachineParts], conditions: Mapping[str, Condition] | None
) -> list[MachineParts]:
    """Parts whose beams have nodes wherever they are joined at any position."""
    if not positions[0].beams:
        return list(positions)
    stations: dict[str, list[float]] = {}
    for parts in positions:
        for beam in meshed_beams(parts, conditions):
            stations.setdefault(beam.name, []).extend(beam.stations)
    everywhere = {name: sorted(set(np.round(found, 12))) for name, found in stations.items()}
    return [
        replace(parts, beams=[one.with_stations(everywhere[one.name]) for one in parts.beams])
        for parts in positions
    ]


def _require_same_mass(first: Machine, other: Machine) -> None:
    one, two = first.structure.mass, other.structure.mass
    if one.shape != two.shape or np.max(np.abs(one - two)) > _SAME_MASS * np.max(np.abs(one)):
        raise StructureError(
            "the mass of the structure changes with the position of an axis; its state cannot be "
            "carried from one position to the next"
        )


def _with_modes_followed(
    machine: Machine, first: Machine, rubbing: Mapping[str, FrictionAt]
) -> Machine:
    """Machine whose frictions on modes stay on the modes that they have at the first position."""
    if not rubbing:
        return machine
    shapes = undamped_modes(machine.structure).shapes
    followed = []
    for one, before in zip(machine.frictions, first.frictions, strict=True):
        if one.name not in rubbing:
            followed.append(one)
            continue
        # the row is mass times shape: its product with a shape is 1 for the same one
        alike = before.row @ shapes
        mode = int(np.argmax(np.abs(alike)))
        shape = shapes[:, mode] * np.sign(alike[mode])
        followed.append(one._replace(row=machine.structure.mass @ shape))
    return replace(machine, frictions=tuple(followed))


def _common_basis(full: Sequence[Machine], parts: MachineParts) -> NDArray[np.float64] | None:
    """Motions (n, m), orthonormal over the mass, that hold those of every position.

    None where every freedom is kept.
    """
    mass = full[0].structure.mass
    basis = np.zeros((len(mass), 0))
    for machine in full:
        if parts.highest_frequency is None:
            shapes = (machine.modes or undamped_modes(machine.structure)).shapes
            if shapes.shape[1] == len(mass):
                return None
        else:
            shapes = reduced(machine, parts.highest_frequency, parts.kept_points).basis
        basis = np.hstack([basis, _beyond(shapes, basis, mass)])
    return basis


def _beyond(
    shapes: NDArray[np.float64], basis: NDArray[np.float64], mass: NDArray[np.float64]
) -> NDArray[np.float64]:
    """What shapes (n, k) have beyond a basis, orthonormal over the mass."""
    new = shapes / np.sqrt(np.einsum("nk,nk->k", shapes, mass @ shapes))
    for _ in range(2):  # once more for the digits that cancelled
        new = new - basis @ (basis.T @ (mass @ new))
    inertia = new.T @ (mass @ new)
    squared, turned = np.linalg.eigh(0.5 * (inertia + inertia.T))
    kept = squared > _NOTHING_NEW
    new = new @ (turned[:, kept] / np.sqrt(squared[kept]))
    new = new - basis @ (basis.T @ (mass @ new))
    # rounding of small remainders: orthonormal to the last digit
    inertia = new.T @ (mass @ new)
    squared, turned = np.linalg.eigh(0.5 * (inertia + inertia.T))
    return new @ (turned / np.sqrt(squared))


def _projected(structure: LinearStructure, basis: NDArray[np.float64]) -> LinearStructure:
    damping, stiffness = (
        basis.T @ (part @ basis) for part in (structure.damping, structure.stiffness)
    )
    return LinearStructure(
        np.eye(basis.shape[1]),
        0.5 * (damping + damping.T),
        0.5 * (stiffness + stiffness.T),
        {name: motion @ basis for name, motion in structure.points.items()},
    )
