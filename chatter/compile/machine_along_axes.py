"""The machine of a file along the travel of its axes, where it changes with it."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from chatter.compile.machine_parts import machine_parts
from chatter.description.machine.errors_by_key import machine_errors
from chatter.description.machine.machine_file import MachineFile
from dynamics.machine.along_axes import machines_at, machines_unreduced
from dynamics.machine.description import Condition, Machine
from dynamics.machine.moving_structure import MachinesAlong
from dynamics.reduction.modal_truncation import undamped_modes
from dynamics.structure.linear_structure import LinearStructure

#: travel of an axis below which the structure stays as it is, m
_LEAST_TRAVEL = 1e-3
#: travel from one position to the next, m, and positions at the most, by the number of axes
_APART = 0.05
_POSITIONS = {1: (5, 25), 2: (4, 8)}
_POSITIONS_OF_MORE = (3, 3)
#: of natural frequencies blended between two exact steps, what is aimed at, and exact steps along
#: all axes together at the most
_TOLERANCE, _MOST_STEPS = 5e-4, 160
#: modes whose frequencies are compared: up to the highest, or to 1 kHz, Hz
_HIGHEST = 1000.0
#: frequency below which a motion is one that nothing resists, Hz
_STILL = 1e-2
#: of a structure, over its largest entry: change that is rounding
_SAME = 1e-9
#: part of the distance between two positions by which one is moved to where the axis starts
_NEAR_START = 0.25

#: rows (n,) that are read, by name, of a machine with its axes at positions, m
Outputs = Callable[[Machine, Mapping[str, float]], Mapping[str, NDArray[np.float64]]]


def machine_along_axes(
    file: MachineFile,
    travelled: Mapping[str, tuple[float, float]],
    outputs: Outputs,
    count: int | None = None,
    conditions: Mapping[str, Condition] | None = None,
    positions: Mapping[str, float | str] | None = None,
    friction: bool = True,
) -> MachinesAlong | None:
    """Assemble the machine of a file at positions along what its axes travel.

    Parameters
    ----------
    file : MachineFile
    travelled : mapping of str to (float, float)
        Lowest and highest position that an axis is sent to, from where it starts, m.
    outputs : callable
        Machine and positions -> rows that are read, by name.
    count : int, optional
        Positions of each axis; by default one every 50 mm, 5 to 25 along one axis. The structure
        stays as it is at the start with 1.
    conditions, positions
        As for `chatter.compile.machine_parts.assembled_machine`; where the axes start.
    friction : bool
        Whether the frictions are kept.

    Returns
    -------
    MachinesAlong or None
        None where no axis travels far enough, or none changes the structure.

    Raises
    ------
    InputError
        If an axis would leave its travel, or the machine makes no sense at one of the positions: a
        nut off its screw.
    """
    start = {
        name: axis.position for name, axis in file.axis.items() if axis.travelling
    } | file.positions(positions or {})
    file.refuse_travel(
        {
            axis: (start[axis] + low, start[axis] + high)
            for axis, (low, high) in travelled.items()
            if axis in start
        }
    )
    if count == 1:
        return None

    def at(offsets: Sequence[Mapping[str, float]]) -> tuple[Machine, ...]:
        everywhere = [start | {axis: start[axis] + x for axis, x in one.items()} for one in offsets]
        parts = [machine_parts(file, one) for one in everywhere]
        with machine_errors(file.name):
            machines = machines_at(parts, conditions)
        return machines if friction else tuple(one.without_friction() for one in machines)

    def changes(axis: str) -> bool:
        """Whether an axis alone changes the machine, as its parts tell without any mode."""
        everywhere = [start | {axis: start[axis] + x} for x in _probes(*travelled[axis])]
        parts = [
            replace(machine_parts(file, one), damping_ratio=0.0, mode_damping=())
            for one in everywhere
        ]
        with machine_errors(file.name):
            return _changes(machines_unreduced(parts, conditions))

    highest = file.highest_frequency or _HIGHEST
    changing = [
        axis
        for axis, (low, high) in travelled.items()
        if high - low >= _LEAST_TRAVEL and not file.axis[axis].drive.is_rotary
    ]
    # of one axis alone the positions tell as well whether it changes anything
    probed = len(changing) > 1
    if probed:
        changing = [axis for axis in changing if changes(axis)]
    if not changing:
        return None
    grid = tuple(
        _positions(*travelled[axis], count or _count(travelled[axis], len(changing)))
        for axis in changing
    )
    offsets = [dict(zip(changing, one, strict=True)) for one in product(*grid)]
    first = next(number for number, offset in enumerate(offsets) if not any(offset.values()))
    order = [first, *(number for number in range(len(offsets)) if number != first)]
    assembled = dict(zip(order, at([offsets[number] for number in order]), strict=True))
    machines = tuple(assembled[number] for number in range(len(offsets)))
    if not probed and not _changes(machines):
        return None
    return MachinesAlong(
        tuple(changing),
        grid,
        machines,
        tuple(
            outputs(machine, start | {axis: start[axis] + x for axis, x in offset.items()})
            for machine, offset in zip(machines, offsets, strict=True)
        ),
        _parts_by_axis(machines, grid, first, highest),
    )


def machine_at_start(along: MachinesAlong) -> Machine:
    """Machine where the axes start."""
    offsets = product(*along.positions)
    return next(one for one, offset in zip(along.machines, offsets, strict=True) if not any(offset))


def _changes(machines: Sequence[Machine]) -> bool:
    """Whether a machine is another one at the second or a later position."""
    first = _entries(machines[0])
    return any(
        np.max(np.abs(mine - yours)) > _SAME * np.max(np.abs(mine))
        for other in machines[1:]
        for mine, yours in zip(first, _entries(other), strict=True)
    )


def _entries(machine: Machine) -> list[NDArray[np.float64]]:
    """Matrices and rows that travel may change."""
    structure = machine.structure
    return [
        structure.damping,
        structure.stiffness,
        *(drive.row for drive in machine.drives),
        *(friction.row for friction in machine.frictions),
        *(backlash.row for backlash in machine.backlashes),
        *structure.points.values(),
    ]


def _probes(low: float, high: float) -> tuple[float, float, float]:
    """Both ends of a travel and its middle, m."""
    return low, 0.5 * (low + high), high


def _parts_by_axis(
    machines: Sequence[Machine], grid: Sequence[NDArray[np.float64]], first: int, highest: float
) -> tuple[int, ...]:
    """Parts of the distances between positions at whose ends there are exact steps, by axis.

    Taken along each axis from the start; the machines are those of the grid, the first number is
    that at the start.
    """
    counts = [len(one) for one in grid]
    most = math.floor(_MOST_STEPS ** (1.0 / len(counts)))
    at_start = np.unravel_index(first, counts)
    numbers = np.arange(len(machines)).reshape(counts)
    found = []
    for axis, positions in enumerate(grid):
        line = tuple(slice(None) if one == axis else place for one, place in enumerate(at_start))
        along = [machines[number].structure for number in numbers[line]]
        parts = _parts(along, positions, highest)
        found.append(max(1, min(parts, math.ceil(most / (counts[axis] - 1)))))
    return tuple(found)


def _parts(
    structures: Sequence[LinearStructure], positions: NDArray[np.float64], highest: float
) -> int:
    """Parts of a distance between whose ends natural frequencies may be blended.

    Each position tells by how much the blend of its neighbours is in error there; the error goes
    with the square of the distance, and is largest in the middle.
    """
    error = 0.0
    neighbours = zip(
        zip(structures, structures[1:], structures[2:], strict=False),
        zip(positions, positions[1:], positions[2:], strict=False),
        strict=True,
    )
    for (before, here, behind), (start, middle, end) in neighbours:
        share = (middle - start) / (end - start)
        blend = (1.0 - share) * before.stiffness + share * behind.stiffness
        true, blended = (_frequencies(one) for one in (here, replace(here, stiffness=blend)))
        seen = (true > _STILL) & (true < highest)
        apart = np.max(np.abs(blended[seen] / true[seen] - 1.0), initial=0.0)
        error = max(error, apart / (4.0 * share * (1.0 - share)))
    return math.ceil(0.5 * math.sqrt(error / _TOLERANCE))


def _frequencies(structure: LinearStructure) -> NDArray[np.float64]:
    """Natural frequencies, Hz, ascending."""
    if not np.array_equal(structure.mass, np.eye(structure.size)):
        return undamped_modes(structure).frequency
    squared = np.linalg.eigvalsh(structure.stiffness)
    return np.sqrt(np.maximum(squared, 0.0)) / (2.0 * np.pi)


def _count(travelled: tuple[float, float], axes: int) -> int:
    """Positions of an axis, one of some that change the structure."""
    fewest, most = _POSITIONS.get(axes, _POSITIONS_OF_MORE)
    low, high = travelled
    return min(max(math.ceil((high - low) / _APART) + 1, fewest), most)


def _positions(low: float, high: float, count: int) -> NDArray[np.float64]:
    """Positions from the lowest to the highest, 0 among them."""
    evenly = np.linspace(min(low, 0.0), max(high, 0.0), max(count, 2))
    nearest = int(np.argmin(np.abs(evenly)))
    inside = 0 < nearest < len(evenly) - 1
    if inside and abs(evenly[nearest]) < _NEAR_START * (evenly[1] - evenly[0]):
        evenly[nearest] = 0.0
    return np.unique(np.append(evenly, 0.0))
