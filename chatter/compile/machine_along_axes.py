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
from dynamics.machine.along_axes import machines_at
from dynamics.machine.description import Condition, Machine
from dynamics.machine.moving_structure import MachinesAlong
from dynamics.reduction.modal_truncation import undamped_modes

#: travel of an axis below which the structure stays as it is, m
_LEAST_TRAVEL = 1e-3
#: travel from one position to the next, m, and positions at the most, by the number of axes
_APART = 0.05
_POSITIONS = {1: (5, 25), 2: (4, 8)}
_POSITIONS_OF_MORE = (3, 3)
#: of natural frequencies blended between two exact steps, what is aimed at, and exact steps along
#: all axes together at the most
_TOLERANCE, _MOST_STEPS = 2e-4, 160
#: modes whose frequencies are compared: up to the highest, or to 1 kHz, Hz
_HIGHEST = 1000.0
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
        If the machine makes no sense at one of the positions: a nut off its screw.
    """
    if count == 1:
        return None
    start = {
        name: axis.position for name, axis in file.axis.items() if axis.travelling
    } | file.positions(positions or {})

    def at(offsets: Sequence[Mapping[str, float]]) -> tuple[Machine, ...]:
        everywhere = [start | {axis: start[axis] + x for axis, x in one.items()} for one in offsets]
        parts = [machine_parts(file, one) for one in everywhere]
        with machine_errors(file.name):
            machines = machines_at(parts, conditions)
        return machines if friction else tuple(one.without_friction() for one in machines)

    highest = file.highest_frequency or _HIGHEST
    changing = [
        axis
        for axis, (low, high) in travelled.items()
        if high - low >= _LEAST_TRAVEL and not file.axis[axis].drive.is_rotary
    ]
    # of one axis alone the positions tell as well whether it changes anything
    probed = {axis: at(_probes(axis, *travelled[axis])) for axis in changing if len(changing) > 1}
    changing = [axis for axis in changing if axis not in probed or _changes(probed[axis])]
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
    if not probed and len(grid[0]) > 2:
        middle = len(grid[0]) // 2
        share = (grid[0][middle] - grid[0][0]) / (grid[0][-1] - grid[0][0])
        cells = [_cells((machines[0], machines[middle], machines[-1]), highest, share)]
    else:
        cells = [
            _cells(probed.get(axis) or at(_probes(axis, *travelled[axis])), highest)
            for axis in changing
        ]
    most = math.floor(_MOST_STEPS ** (1.0 / len(changing)))
    parts = tuple(
        math.ceil(min(number, most) / (len(one) - 1))
        for number, one in zip(cells, grid, strict=True)
    )
    return MachinesAlong(
        tuple(changing),
        grid,
        machines,
        tuple(
            outputs(machine, start | {axis: start[axis] + x for axis, x in offset.items()})
            for machine, offset in zip(machines, offsets, strict=True)
        ),
        parts,
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
        *structure.points.values(),
    ]


def _probes(axis: str, low: float, high: float) -> list[dict[str, float]]:
    """Both ends of a travel and its middle."""
    return [{axis: low}, {axis: 0.5 * (low + high)}, {axis: high}]


def _cells(machines: Sequence[Machine], highest: float, share: float = 0.5) -> int:
    """Cells of a travel between whose ends natural frequencies may be blended.

    From the machine at both ends and at a share of the way between; the error of a blend goes with
    the square of the distance, and is largest in the middle.
    """
    first, middle, last = (one.structure for one in machines)
    blend = (1.0 - share) * first.stiffness + share * last.stiffness
    halfway = replace(first, stiffness=blend)
    true, blended = (undamped_modes(one).frequency for one in (middle, halfway))
    count = int(np.searchsorted(true, highest))
    true, blended = true[:count], blended[:count]
    elastic = true > 0.0
    error = np.max(np.abs(blended[elastic] / true[elastic] - 1.0), initial=0.0)
    error /= 4.0 * share * (1.0 - share)
    return max(1, math.ceil(math.sqrt(error / _TOLERANCE)))


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
