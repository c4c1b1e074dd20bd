"""Run a machine in time, in chunks, with progress."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from chatter.description.errors import InputError, RunError
from chatter.description.progress import Progress, no_progress
from chatter.engine.interruption import interruptions_deferred
from chatter.engine.loop import Laws, run
from chatter.engine.record import port_record
from dynamics.control.sampling import ControlError
from dynamics.machine.description import Machine
from dynamics.machine.groups import ControlledDrives
from dynamics.machine.moving_structure import MachinesAlong
from dynamics.machine.tables import energy_of_structure, machine_tables, with_energy_account
from dynamics.machine.travel_limit import TravelLimit
from dynamics.structure.linear_structure import StructureError
from dynamics.trajectory.set_points import SetPoints

_STEPS_A_CHUNK = 20_000
#: of a record of all ports, at the most
_MOST_BYTES = 1.5e9
#: displacement, m or rad, that no axis travels in one configuration
_FURTHEST = 1e5


@dataclass(frozen=True, eq=False)
class MachineRun:
    """Signals (n,) of a run, from the first recorded step on.

    Of every port recorded: drives ("drive Y": angle and torque of the motor), scales ("scale Y"),
    frictions ("friction guide": force with which it acts on its motion), loads and outputs by their
    own names.
    """

    time: NDArray[np.float64]  # s
    displacement: Mapping[str, NDArray[np.float64]]  # m or rad
    velocity: Mapping[str, NDArray[np.float64]]  # m/s or rad/s
    force: Mapping[str, NDArray[np.float64]]  # N or N m
    interrupted: bool = False
    #: J, since the start, as `dynamics.machine.energy.energy_of`; empty where not accounted for
    energy: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class RunInputs:
    """What drives a machine through a run."""

    duration: float  # s
    points: SetPoints | None = None  # of all axes
    #: row (n,) of the structure, and force (steps + 1,), N, at the ends of steps, linear in between
    loads: Mapping[str, tuple[NDArray[np.float64], NDArray[np.float64]]] = field(
        default_factory=dict
    )
    #: (steps,), torque added to the set point of a drive by its name, N m
    injected: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    outputs: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)  # (n,), rows read
    stride: int = 1  # steps from one recorded row to the next
    along: MachinesAlong | None = None  # structure along axes that it follows
    energy_accounted: bool = False  # also of a structure that stays as it is, for a fifth more time


def _check_memory(rows: int, ports: int, duration: float) -> None:
    """Refuse a record of three signals of every port that fits no memory."""
    size = 3 * 8 * rows * ports
    if size > _MOST_BYTES:
        raise InputError(
            f"the run of {duration:.4g} s records {rows} rows of {ports} places of the machine, "
            f"{size / 1e9:.2g} GB; at most {_MOST_BYTES / 1e9:g} GB are allowed: shorten it, by "
            "fewer averages or a shorter period of a test"
        )


def run_machine(
    machine: Machine, step: float, inputs: RunInputs, progress: Progress = no_progress
) -> MachineRun:
    """Run a machine from rest, by steps in s.

    An interruption (Ctrl-C) ends the run, not the program: what was run is returned. InputError if
    names, lengths or sample times do not fit, RunError if the machine runs away.
    """
    total = round(inputs.duration / step)
    if total < 1:
        raise InputError(f"the run of {inputs.duration:g} s is shorter than a step of {step:g} s")
    _check_lengths(machine, inputs, total)
    try:
        tables = machine_tables(
            machine, step, inputs.points, inputs.loads, inputs.outputs, along=inputs.along
        )
        if inputs.energy_accounted:
            tables = with_energy_account(tables, machine)
    except (StructureError, ControlError) as error:
        raise InputError(str(error)) from error
    stride = inputs.stride
    _check_memory(total // stride, len(tables.port), inputs.duration)
    record = port_record(total // stride, len(tables.port), stride, stride)
    laws = Laws(
        _with_injected(tables.explicit, machine, inputs.injected, total),
        (TravelLimit(_FURTHEST),),
        tables.implicit,
        (record,),
    )
    done, interrupted = 0, False
    # a long trajectory takes its time to plan, which is no pace of the steps
    progress(done, total)
    try:
        while done < total:
            count = min(_STEPS_A_CHUNK, total - done)
            with interruptions_deferred():
                ran = run(laws, tables.bus, done, 0, count)
            done += ran
            progress(done, total)
            if ran < count:
                raise RunError(
                    f"after {done * step:.4g} s the machine has run away: a control loop is "
                    "unstable, or a force acts on an axis that nothing holds"
                )
    except KeyboardInterrupt:
        interrupted = True
    rows = done // stride
    signals = {
        what: {name: getattr(record, what)[:rows, index] for name, index in tables.port.items()}
        for what in ("displacement", "velocity", "force")
    }
    time = step * stride * np.arange(1, rows + 1)
    return MachineRun(time, **signals, interrupted=interrupted, energy=energy_of_structure(tables))


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


def _with_injected(held: tuple, machine: Machine, injected: Mapping, total: int) -> tuple:
    """Laws with the torques of a test over all steps."""
    if not injected:
        return held
    torque = np.zeros((total, len(machine.drives)))
    for column, drive in enumerate(machine.drives):
        if drive.name in injected:
            torque[:, column] = injected[drive.name]
    return tuple(
        group._replace(injected=torque) if isinstance(group, ControlledDrives) else group
        for group in held
    )
