"""The machine of a file along the travel of its axes, where it changes with it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.compile.machine_parts import machine_parts
from chatter.description.machine.errors_by_key import machine_errors
from chatter.description.machine.machine_file import MachineFile
from dynamics.machine.along_axes import in_common_coordinates, machines_at, machines_unreduced
from dynamics.machine.description import Condition, Machine, MachineParts
from dynamics.machine.moving_structure import MachinesAlong
from dynamics.machine.transported_coordinates import in_transported_coordinates
from dynamics.reduction.modal_truncation import undamped_modes
from dynamics.structure.linear_structure import LinearStructure

#: travel of an axis below which the structure stays as it is, m
_LEAST_TRAVEL = 1e-3
#: travel from one position to the next, m, that of short travels, of a few positions; and positions
#: at the least and at the most, by the number of axes
_APART, _APART_OF_FEW, _FEW = 0.05, 0.025, 5
_POSITIONS = {1: (3, 25), 2: (4, 8)}
_POSITIONS_OF_MORE = (3, 3)
#: of natural frequencies blended between two exact steps, what is aimed at, and exact steps along
#: all axes together at the most
_TOLERANCE, _MOST_STEPS = 1e-3, 160
#: modes whose frequencies are compared: up to the highest, or to 1 kHz, Hz
_HIGHEST = 1000.0
#: frequency below which a motion is one that nothing resists, Hz
_STILL = 1e-2
#: of a structure, over its largest entry: change that is rounding
_SAME = 1e-9
#: part of the distance between two positions by which one is moved to where the axis starts
_NEAR_START = 0.25
#: part of a distance between positions that is rounding
_ROUNDING = 1e-6

#: travels of a file whose machines are kept for the next move or cut along them
_KEPT = 4

#: rows (n,) that are read, by name, of a machine with its axes at positions, m
Outputs = Callable[[Machine, Mapping[str, float]], Mapping[str, NDArray[np.float64]]]


class StateOfMachine(NamedTuple):
    """State that a machine is moved in."""

    #: as for `chatter.compile.machine_parts.assembled_machine`; positions are where the axes start
    conditions: Mapping[str, Condition] | None = None
    positions: Mapping[str, float | str] | None = None
    friction: bool = True  # whether the frictions are kept
    in_cut: bool = False  # with the couplings of [contact]


#: as the file has it
AS_IN_FILE = StateOfMachine()


def machine_along_axes(
    file: MachineFile,
    travelled: Mapping[str, tuple[float, float]],
    outputs: Outputs,
    count: int | None = None,
    state: StateOfMachine = AS_IN_FILE,
    here: Machine | None = None,
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
        Positions of each axis; by default one every 50 mm along one axis, 25 at the most, and one
        every 25 mm of a travel below 100 mm, 3 at the least. The structure stays as it is at the
        start with 1.
    state : StateOfMachine
    here : Machine, optional
        Machine where the axes start, in that state, if it was assembled already.

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
    } | file.positions(state.positions or {})
    file.refuse_travel(
        {
            axis: (start[axis] + low, start[axis] + high)
            for axis, (low, high) in travelled.items()
            if axis in start
        }
    )
    if count == 1:
        return None
    travelled = {axis: _without_slivers(*ends) for axis, ends in travelled.items()}
    kept = file.once("along the axes", dict)
    key = repr((travelled, count, start, state))
    if key not in kept:
        while len(kept) >= _KEPT:
            del kept[next(iter(kept))]
        kept[key] = _travelling(_Places(file, start, state, here), travelled, count)
    found = kept[key]
    if found is None:
        return None
    machines = found.machines
    if not state.friction:
        machines = tuple(one.without_friction() for one in machines)
    rows = tuple(
        outputs(machine, start | {axis: start[axis] + x for axis, x in offset.items()})
        for machine, offset in zip(machines, _offsets(found.grid), strict=True)
    )
    return MachinesAlong(tuple(found.grid), tuple(found.grid.values()), machines, rows, found.parts)


def _without_slivers(low: float, high: float) -> tuple[float, float]:
    """Ends of a travel, m, of which one that is next to the start is there.

    A program may return to the start but for rounding, or overshoot it.
    """
    if high - low < _LEAST_TRAVEL:
        return low, high
    return low if -low > _LEAST_TRAVEL else 0.0, high if high > _LEAST_TRAVEL else 0.0


class _Travelling(NamedTuple):
    """Machine of a file at a grid of positions of the axes that change it."""

    grid: dict[str, NDArray[np.float64]]  # offsets of each axis, m
    machines: tuple[Machine, ...]
    parts: tuple[int, ...]  # as in `MachinesAlong`


def _travelling(
    places: _Places, travelled: Mapping[str, tuple[float, float]], count: int | None
) -> _Travelling | None:
    """Machine along its axes; None where no axis travels far enough, or none changes it."""
    file = places.file
    changing = [
        axis
        for axis, (low, high) in travelled.items()
        if high - low >= _LEAST_TRAVEL and not file.axis[axis].drive.is_rotary
    ]
    # of one axis alone the positions tell as well whether it changes anything
    probed = len(changing) > 1
    if probed:
        changing = [axis for axis in changing if places.change_along(axis, travelled[axis])]
    if not changing:
        return None
    grid, machines = _on_grid(places, {axis: travelled[axis] for axis in changing}, count)
    if not probed and not _changes(machines):
        return None
    parts = _parts_by_axis(
        machines, tuple(grid.values()), _first(_offsets(grid)), file.highest_frequency or _HIGHEST
    )
    return _Travelling(grid, machines, parts)


class _Places:
    """Unreduced machines of a file at offsets of its axes, m, each assembled once."""

    def __init__(
        self,
        file: MachineFile,
        start: Mapping[str, float],
        state: StateOfMachine,
        here: Machine | None,
    ) -> None:
        self.file, self.start, self.state = file, start, state
        self.known: dict[tuple[float, ...], Machine] = {}
        # one that was not reduced may have lost its frictions
        if here is not None and (here.unreduced is not None or state.friction):
            self.known[tuple(start.values())] = here.unreduced or here

    def change_along(self, axis: str, travelled: tuple[float, float]) -> bool:
        """Whether an axis alone changes the machine, as its parts tell without any mode."""
        _, machines = self._assembled(
            [{axis: x} for x in _probes(*travelled)],
            lambda parts: replace(parts, damping_ratio=0.0, mode_damping=()),
            machines_unreduced,
        )
        return _changes([replace(one, structure=one.assembly.structure) for one in machines])

    def machines(
        self, offsets: Sequence[Mapping[str, float]]
    ) -> tuple[list[MachineParts], list[Machine]]:
        """Parts and machine at each of some offsets."""
        return self._assembled(offsets, lambda parts: parts, machines_at)

    def _assembled(
        self,
        offsets: Sequence[Mapping[str, float]],
        adapted: Callable[[MachineParts], MachineParts],
        assemble: Callable[..., list[Machine]],
    ) -> tuple[list[MachineParts], list[Machine]]:
        everywhere = [
            {**self.start, **{axis: self.start[axis] + x for axis, x in one.items()}}
            for one in offsets
        ]
        keys = [tuple(one.values()) for one in everywhere]
        parts = [adapted(machine_parts(self.file, one, self.state.in_cut)) for one in everywhere]
        with machine_errors(self.file.name):
            machines = assemble(parts, self.state.conditions, [self.known.get(key) for key in keys])
        self.known.update(zip(keys, machines, strict=True))
        return parts, machines


def _on_grid(
    places: _Places, travelled: Mapping[str, tuple[float, float]], count: int | None
) -> tuple[dict[str, NDArray[np.float64]], tuple[Machine, ...]]:
    """Positions along axes, m, and the machine in few coordinates at each of the grid of them."""
    usual = {axis: count or _count(ends, len(travelled)) for axis, ends in travelled.items()}
    more = {axis: max(number, _FEW) for axis, number in usual.items()}
    # where few positions are too far apart for coordinates that follow each other, more are not
    tried = [usual] if count or len(travelled) > 1 or more == usual else [usual, more]
    for counts in tried:
        grid = {axis: _positions(*travelled[axis], counts[axis]) for axis in travelled}
        offsets = _offsets(grid)
        first = _first(offsets)
        order = [first, *(number for number in range(len(offsets)) if number != first)]
        parts, full = places.machines([offsets[number] for number in order])
        found = in_transported_coordinates(full, parts[0])
        if found is not None:
            break
    if found is None:
        with machine_errors(places.file.name):
            found = in_common_coordinates(full, parts[0])
    machines = dict(zip(order, found, strict=True))
    return grid, tuple(machines[number] for number in range(len(offsets)))


def _offsets(grid: Mapping[str, NDArray[np.float64]]) -> list[dict[str, float]]:
    """Offsets of the axes, m, at every place of a grid; the last axis varies fastest."""
    return [dict(zip(grid, one, strict=True)) for one in product(*grid.values())]


def _first(offsets: Sequence[Mapping[str, float]]) -> int:
    """Number of the place where the axes start."""
    return next(number for number, offset in enumerate(offsets) if not any(offset.values()))


def machine_at_start(along: MachinesAlong) -> Machine:
    """Machine where the axes start."""
    grid = dict(zip(along.axes, along.positions, strict=True))
    return along.machines[_first(_offsets(grid))]


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
    travel = travelled[1] - travelled[0]
    few = min(math.ceil(travel / _APART_OF_FEW - _ROUNDING) + 1, _FEW)
    return min(max(math.ceil(travel / _APART - _ROUNDING) + 1, few, fewest), most)


def _positions(low: float, high: float, count: int) -> NDArray[np.float64]:
    """Positions from the lowest to the highest, 0 among them."""
    evenly = np.linspace(min(low, 0.0), max(high, 0.0), max(count, 2))
    nearest = int(np.argmin(np.abs(evenly)))
    inside = 0 < nearest < len(evenly) - 1
    if inside and abs(evenly[nearest]) < _NEAR_START * (evenly[1] - evenly[0]):
        evenly[nearest] = 0.0
    return np.unique(np.append(evenly, 0.0))
