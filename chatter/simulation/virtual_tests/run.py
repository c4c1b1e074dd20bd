"""Run a machine in time, in chunks, with progress."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from chatter.description.errors import InputError, RunError
from chatter.description.progress import Progress, no_progress
from chatter.engine.machine_loop import Record, run
from dynamics.control.sampling import ControlError
from dynamics.machine.description import Machine
from dynamics.machine.groups import ControlledDrives
from dynamics.machine.loop import Loads
from dynamics.machine.tables import MachineTables, machine_tables
from dynamics.structure.linear_structure import StructureError
from dynamics.trajectory.set_points import SetPoints

_STEPS_A_CHUNK = 20_000
#: displacement, m or rad, that no axis travels in one configuration
_FURTHEST = 1e5


@dataclass(frozen=True, eq=False)
class MachineRun:
    """Signals of a run, from the first recorded step on.

    Parameters
    ----------
    time : (n,) array of float
        s.
    displacement, velocity, force : mapping of str to (n,) array of float
        Of every port recorded: m, m/s, N (rad, rad/s, N m): drives ("drive Y": angle and torque
        of the motor), scales ("scale Y"), frictions ("friction guide": force with which it
        acts on its motion), loads and outputs by their own names.
    interrupted : bool
    """

    time: NDArray[np.float64]
    displacement: Mapping[str, NDArray[np.float64]]
    velocity: Mapping[str, NDArray[np.float64]]
    force: Mapping[str, NDArray[np.float64]]
    interrupted: bool = False


@dataclass(frozen=True, eq=False)
class RunInputs:
    """What drives a machine through a run.

    Parameters
    ----------
    duration : float
        s.
    points : SetPoints, optional
        Of all axes.
    loads : mapping of str to (row (n,), force (steps+1,)), optional
        Forces, N, at the ends of steps, linear in between, along rows of the structure.
    injected : mapping of str to (steps,) array of float, optional
        Torque added to the set point of a drive by its name, N m.
    outputs : mapping of str to (n,) array of float, optional
        Rows read.
    stride : int
        Steps from one recorded row to the next.
    """

    duration: float
    points: SetPoints | None = None
    loads: Mapping[str, tuple[NDArray[np.float64], NDArray[np.float64]]] = field(
        default_factory=dict
    )
    injected: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    outputs: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    stride: int = 1


def run_machine(
    machine: Machine, step: float, inputs: RunInputs, progress: Progress = no_progress
) -> MachineRun:
    """Run a machine from rest.

    Parameters
    ----------
    machine : Machine
    step : float
        s.
    inputs : RunInputs
    progress : callable, optional
        Called with (done, total) steps.

    Raises
    ------
    InputError
        If names, lengths or sample times do not fit.
    RunError
        If the machine runs away.

    Notes
    -----
    An interruption (Ctrl-C) ends the run, not the program: what was run is returned.
    """
    total = round(inputs.duration / step)
    if total < 1:
        raise InputError(f"the run of {inputs.duration:g} s is shorter than a step of {step:g} s")
    _check_lengths(machine, inputs, total)
    try:
        tables = machine_tables(
            machine,
            step,
            inputs.points,
            {name: row for name, (row, _) in inputs.loads.items()},
            inputs.outputs,
        )
    except (StructureError, ControlError) as error:
        raise InputError(str(error)) from error
    parts: list[Record] = []
    done = 0
    interrupted = False
    try:
        while done < total:
            count = min(_STEPS_A_CHUNK, total - done)
            record = _record(tables, done, count, inputs.stride)
            groups = _with_injected(tables.groups, machine, inputs.injected, done, count)
            loads = Loads(tables.loads.port, _chunk_of_loads(inputs, done, count))
            made = run(groups, tables.steps, loads, record, done, _FURTHEST)
            rows = (done + made) // inputs.stride - done // inputs.stride
            parts.append(Record(inputs.stride, record.port, *(a[:rows] for a in record[2:])))
            done += made
            progress(done, total)
            if made < count:
                raise RunError(
                    f"after {done * step:.4g} s the machine has run away: a control loop is "
                    "unstable, or a force pushes an axis that nothing holds"
                )
    except KeyboardInterrupt:
        interrupted = True
    return _collected(tables, parts, step, inputs.stride, interrupted)


def _check_lengths(machine: Machine, inputs: RunInputs, total: int) -> None:
    for name, (row, force) in inputs.loads.items():
        if row.shape != (machine.structure.size,):
            raise InputError(
                f'load "{name}": a row of {row.size} freedoms; the machine has '
                f"{machine.structure.size}"
            )
        if len(force) != total + 1:
            raise InputError(
                f'load "{name}": {len(force)} forces for {total} steps; one more than steps'
            )
    known = [drive.name for drive in machine.drives]
    for name, torque in inputs.injected.items():
        if name not in known:
            there = ", ".join(f'"{one}"' for one in known) or "none"
            raise InputError(f'there is no controlled drive "{name}"; there are {there}')
        if len(torque) != total:
            raise InputError(f'drive "{name}": {len(torque)} torques injected over {total} steps')


def _record(tables: MachineTables, done: int, count: int, stride: int) -> Record:
    ports = np.arange(len(tables.port), dtype=np.int64)
    rows = (done + count) // stride - done // stride
    shape = (rows, len(ports))
    return Record(stride, ports, np.empty(shape), np.empty(shape), np.empty(shape))


def _chunk_of_loads(inputs: RunInputs, done: int, count: int) -> NDArray[np.float64]:
    chunk = np.empty((count + 1, len(inputs.loads)))
    for column, (_, force) in enumerate(inputs.loads.values()):
        chunk[:, column] = force[done : done + count + 1]
    return chunk


def _with_injected(
    groups: Sequence, machine: Machine, injected: Mapping, done: int, count: int
) -> tuple:
    torque = np.zeros((count, len(machine.drives)))
    for column, drive in enumerate(machine.drives):
        if drive.name in injected:
            torque[:, column] = injected[drive.name][done : done + count]
    return tuple(
        group._replace(injected=torque) if isinstance(group, ControlledDrives) else group
        for group in groups
    )


def _collected(
    tables: MachineTables, parts: Sequence[Record], step: float, stride: int, interrupted: bool
) -> MachineRun:
    columns = {
        what: np.concatenate([getattr(part, what) for part in parts])
        if parts
        else np.empty((0, len(tables.port)))
        for what in ("displacement", "velocity", "force")
    }
    count = len(columns["force"])
    signals = {
        what: {name: values[:, place] for name, place in tables.port.items()}
        for what, values in columns.items()
    }
    return MachineRun(step * stride * np.arange(1, count + 1), **signals, interrupted=interrupted)
