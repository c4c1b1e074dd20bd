"""A machine at several positions of its axes, always in the same coordinates.

What carries the state of a machine from one position to the next must mean the same at both. Beams
therefore have nodes wherever they are joined at any of the positions. A reduction keeps few motions
at each, which follow one another (`machine.transported_coordinates`); where they are too far apart
it keeps the motions that are needed at any position: modes up to the highest frequency and static
shapes of all. What they have in common is found by their energy (proper orthogonal decomposition):
of the strain energy of a mode or a static shape, and so of the compliance that it gives, next to
nothing is lost. The motions kept are orthonormal over the mass, which no travel changes.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import scipy.linalg
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
from dynamics.structure.bodies import MeshedPart
from dynamics.structure.linear_structure import LinearStructure, StructureError

#: part of the energy of one mode or static shape that may be left out
_LEFT_OUT = 3e-4
#: inertia over energy, at the lowest frequency, below which a motion has no mass
_WITHOUT_MASS = 1e-13
#: of masses at two positions, from one another
_SAME_MASS = 1e-9


def machines_at(
    positions: Sequence[MachineParts],
    conditions: Mapping[str, Condition] | None = None,
    known: Sequence[Machine | None] = (),
) -> list[Machine]:
    """Assemble a machine at positions of its axes, in the freedoms of all of its parts.

    Parameters
    ----------
    positions : sequence of MachineParts
        The same parts at each; that at the first gives the first coordinates.
    conditions : mapping of str to {"control", "brake", "free"}, optional
        As for `dynamics.machine.description.machine`.
    known : sequence of (Machine or None)
        Unreduced machines that were assembled already at the positions, in these conditions.

    Returns
    -------
    list of Machine
        One a position, of one mass.

    Raises
    ------
    StructureError
        If the machine makes no sense at one of them, or the mass changes along the travel.
    """
    full = machines_unreduced(positions, conditions, known)
    first = full[0]
    for other in full[1:]:
        _require_same_mass(first, other)
    rubbing = {one.name: one for one in positions[0].frictions if one.mode is not None}
    return [first, *(_with_modes_followed(one, first, rubbing) for one in full[1:])]


def in_common_coordinates(full: Sequence[Machine], parts: MachineParts) -> tuple[Machine, ...]:
    """Reduce a machine at positions of its axes to the motions of all of them.

    The parts are those at the first position, with the highest frequency and the points whose
    static answer is kept.
    """
    basis = _common_basis(full, parts)
    if basis is None:
        return tuple(full)
    return tuple(in_coordinates(one, _projected(one.structure, basis), basis) for one in full)


def machines_unreduced(
    positions: Sequence[MachineParts],
    conditions: Mapping[str, Condition] | None = None,
    known: Sequence[Machine | None] = (),
) -> list[Machine]:
    """Assemble a machine at positions of its axes as `machines_at` does, whatever its mass.

    Frictions on modes have the modes of their number at each. Arguments and errors as there.
    """
    all_known = [*known, *[None] * (len(positions) - len(known))]
    machines: list[Machine] = []
    for parts, before in zip(_in_one_mesh(positions, conditions), all_known, strict=True):
        neighbour = machines[0] if machines else None
        machines.append(_completed(parts, conditions, before, neighbour))
    return machines


def _completed(
    parts: MachineParts,
    conditions: Mapping[str, Condition] | None,
    known: Machine | None,
    neighbour: Machine | None,
) -> Machine:
    """Machine of parts, with the damping of its modes; what is known of it is not made again."""
    if known is None or not _of_mesh(known, parts):
        return full_machine(parts, conditions, neighbour=neighbour)
    damped = parts.damping_ratio != 0.0 or parts.mode_damping
    if damped and known.modes is None:
        return full_machine(parts, conditions, known.assembly)
    return known


def _of_mesh(known: Machine, parts: MachineParts) -> bool:
    """Whether the beams of an assembled machine have the nodes that those of parts have."""
    return all(
        _stations(known.assembly.parts[beam.name]) == _stations(beam) for beam in parts.beams
    )


def _stations(beam: MeshedPart) -> list[float]:
    """Where a beam has nodes because something is joined there, m."""
    return sorted(set(np.round(beam.stations, 12)))


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
    meshed = {one.name: one.with_stations(everywhere[one.name]) for one in positions[0].beams}

    def meshed_anew(one: MeshedPart) -> MeshedPart:
        # its matrices are made once
        return meshed[one.name].begun_at(one.origin)

    return [replace(parts, beams=[meshed_anew(one) for one in parts.beams]) for parts in positions]


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
    modes = full[0].modes or undamped_modes(full[0].structure)
    if parts.highest_frequency is None:
        if modes.shapes.shape[1] == len(mass):
            return None
        shapes = [(one.modes or undamped_modes(one.structure)).shapes for one in full]
    else:
        shapes = [reduced(one, parts.highest_frequency, parts.kept_points).basis for one in full]
    elastic = modes.frequency[modes.frequency > 0.0]
    lowest = 2.0 * np.pi * (elastic[0] if elastic.size else 1.0)
    # rigid motions count too: by their kinetic energy at the lowest frequency
    energy = np.mean([one.structure.stiffness for one in full], axis=0) + lowest**2 * mass
    common = _in_common(np.hstack(shapes), energy)
    inertia, turned = _principal(common, mass)
    common = common @ turned[:, lowest**2 * inertia > _WITHOUT_MASS]
    for _ in range(2):  # once more for the digits that cancelled
        inertia, turned = _principal(common, mass)
        common = common @ (turned / np.sqrt(inertia))
    return common


def _in_common(shapes: NDArray[np.float64], energy: NDArray[np.float64]) -> NDArray[np.float64]:
    """Motions (n, m), orthonormal over an energy (n, n), that hold shapes (n, k) but for little."""
    root = scipy.linalg.cholesky(energy, lower=True)
    seen = root.T @ shapes
    left, singular, _ = np.linalg.svd(seen / np.linalg.norm(seen, axis=0), full_matrices=False)
    return scipy.linalg.solve_triangular(root.T, left[:, singular**2 > _LEFT_OUT])


def _principal(
    motions: NDArray[np.float64], matrix: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Principal values (m,) and directions (m, m) of a matrix over motions (n, m)."""
    over = motions.T @ (matrix @ motions)
    values, directions = np.linalg.eigh(0.5 * (over + over.T))
    return values, directions


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
