"""Stability of the control loops of a machine, before it is run.

Without friction, limits and resolution the machine is linear and, over a common period of its
samples, time-invariant. Its map over that period is found column by column with the very kernels
that run it, and its eigenvalues decide.
"""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.compile.linearised_machine import LinearisedMachine
from chatter.description.errors import InputError
from chatter.description.machine.machine_file import MachineFile
from chatter.engine.loop import Laws, run
from dynamics.control.cascade import DriveController
from dynamics.control.current_loop import RegulatedMotor
from dynamics.control.sampling import ControlError
from dynamics.machine.description import Machine
from dynamics.machine.groups import ControlledDrives
from dynamics.machine.steps import StructureSteps
from dynamics.machine.tables import StructureTables, machine_tables
from dynamics.structure.linear_structure import StructureError

#: growth, 1/s, below which a motion counts as neutral: that of an axis nothing brings back
_NEUTRAL = 1e-3
#: steps of the common period beyond which the samples have no useful one
_LONGEST_PERIOD = 200_000
#: steps over which the frequency of a motion is evaluated
_OBSERVED_STEPS = 4096


@dataclass(frozen=True, eq=False)
class LoopMotion:
    """Motion of the closed loops that grows fastest, or decays slowest.

    Parameters
    ----------
    growth_rate : float
        1/s.
    frequency : float
        Hz.
    drive : str
        Drive that puts the most work into it.
    """

    growth_rate: float
    frequency: float
    drive: str

    @property
    def stable(self) -> bool:
        """Whether it dies out, or at least does not grow."""
        return self.growth_rate <= _NEUTRAL


class _DecisiveMotion(NamedTuple):
    """Motion of the closed loops that decides on stability, before its frequency is looked for."""

    growth_rate: float  # 1/s
    motion: NDArray[np.float64]  # (states,)
    tables: StructureTables
    drives: ControlledDrives


def least_stable_motion(machine: Machine, step: float) -> LoopMotion | None:
    """Motion of the closed loops that decides on stability; None without control.

    Parameters
    ----------
    machine : Machine
    step : float
        s.

    Raises
    ------
    InputError
        If a sample time does not fit the step.
    """
    decisive = _decisive_motion(machine, step)
    if decisive is None:
        return None
    return _described(machine, decisive)


def _described(machine: Machine, decisive: _DecisiveMotion) -> LoopMotion:
    """Motion with its frequency and the drive that feeds it."""
    frequency, index = _strongest_frequency(
        decisive.tables, decisive.drives, decisive.motion, decisive.growth_rate
    )
    return LoopMotion(decisive.growth_rate, frequency, machine.drives[index].name)


def _decisive_motion(machine: Machine, step: float) -> _DecisiveMotion | None:
    """Motion over a common period that grows fastest; None without control."""
    if not machine.drives:
        return None
    linear = replace(
        machine,
        frictions=(),
        preloads=(),
        backlashes=(),
        drives=tuple(
            drive._replace(controller=without_limits(drive.controller)) for drive in machine.drives
        ),
    )
    try:
        tables = machine_tables(linear, step)
    except (StructureError, ControlError) as error:
        raise InputError(str(error)) from error
    drives = tables.explicit[0]
    period = _common_period(drives)
    transition = _map_over(tables, drives, period)
    # what nothing ever changes stays at zero, and what nothing reads is no motion
    still = np.all(transition == np.eye(len(transition)), axis=1)
    still |= _unread(transition, len(tables.bus.state))
    multipliers, vectors = np.linalg.eig(transition[~still][:, ~still])
    decisive = int(np.argmax(np.abs(multipliers)))
    motion = np.zeros(len(transition), dtype=np.complex128)
    motion[~still] = vectors[:, decisive]
    time = period * step
    growth = math.log(max(abs(multipliers[decisive]), 1e-300)) / time
    return _DecisiveMotion(growth, motion.real, tables, drives)


def refuse_unstable_control(machine: Machine, step: float, file: MachineFile | None = None) -> None:
    """Refuse a machine whose control loops are unstable.

    Raises
    ------
    InputError
        Naming the drive, the frequency and the growth, with the file that it was made of and its
        unlikely values where it is given.
    """
    decisive = _decisive_motion(machine, step)
    if decisive is None or decisive.growth_rate <= _NEUTRAL:
        return
    motion = _described(machine, decisive)
    gains = {drive.name: drive.controller for drive in machine.drives}[motion.drive]
    time = gains.velocity.integral_time
    integral = f"integral time {time:g} s" if math.isfinite(time) else "no integral part"
    where = f"{file.name}: axis.{motion.drive}" if file is not None else f'axis "{motion.drive}"'
    unstable = (
        f"{where}: its control loop is unstable: a motion of about "
        f"{motion.frequency:.3g} Hz grows by {motion.growth_rate:.3g} 1/s; velocity gain "
        f"{gains.velocity.proportional_gain:g} N m s/rad, {integral}, "
        f"position gain {gains.position.gain:g} 1/s"
    )
    raise InputError([unstable, *(() if file is None else file.notes)])


def refuse_unstable_structure(structure: object) -> None:
    """Refuse a linearised machine whose control loops are unstable; other structures have none."""
    if isinstance(structure, LinearisedMachine):
        refuse_unstable_control(structure.cut.machine, structure.cut.file.step, structure.cut.file)


def without_limits(controller: DriveController) -> DriveController:
    """Same controller without limits and resolution: its linear counterpart."""
    current = controller.current
    if isinstance(current, RegulatedMotor):
        current = replace(current, voltage_limit=math.inf)
    return replace(
        controller,
        position=replace(controller.position, velocity_limit=math.inf),
        velocity=replace(controller.velocity, torque_limit=math.inf),
        measuring=replace(controller.measuring, encoder_resolution=0.0, scale_resolution=0.0),
        current=current,
    )


def _common_period(drives: ControlledDrives) -> int:
    """Steps after which all samples and the rings of their history stand as before."""
    slots = drives.control.history.shape[2]
    period = math.lcm(*(int(samples) * slots for samples in drives.control.samples.ravel()))
    if period > _LONGEST_PERIOD:
        raise InputError(
            f"the sample times of the drives have a common period of {period} steps; "
            "choose sample times that are multiples of one another"
        )
    return period


def _states(tables: StructureTables, drives: ControlledDrives) -> list[NDArray[np.float64]]:
    """Flat views of everything that is remembered from step to step."""
    control = drives.control
    return [
        tables.bus.state,
        control.state.reshape(-1),
        control.history.reshape(-1),
        control.filter_state.reshape(-1),
    ]


def _ports_follow_state(bus: StructureSteps) -> None:
    bus.u[:] = bus.state @ bus.displacement
    bus.v[:] = bus.state @ bus.velocity


def _map_over(
    tables: StructureTables, drives: ControlledDrives, period: int
) -> NDArray[np.float64]:
    states = _states(tables, drives)
    sizes = [state.size for state in states]
    transition = np.empty((sum(sizes), sum(sizes)))
    laws, column = Laws(tables.explicit), 0
    for chosen, size in zip(states, sizes, strict=True):
        for index in range(size):
            for state in states:
                state[:] = 0.0
            chosen[index] = 1.0
            _ports_follow_state(tables.bus)
            run(laws, tables.bus, 0, 0, period)
            transition[:, column] = np.concatenate(states)
            column += 1
    return transition


def _unread(transition: NDArray[np.float64], structure: int) -> NDArray[np.bool_]:
    """Memory of the controllers that moves nothing but itself and what is unread too."""
    others = transition != 0.0
    np.fill_diagonal(others, val=False)
    unread = np.zeros(len(transition), dtype=bool)
    while True:
        more = ~np.any(others[~unread], axis=0)
        more[:structure] = False
        if np.array_equal(more, unread):
            return unread
        unread = more


def _strongest_frequency(
    tables: StructureTables, drives: ControlledDrives, motion: NDArray[np.float64], growth: float
) -> tuple[float, int]:
    """Strongest frequency of a motion, Hz, at the drive that puts the most work into it."""
    start = 0
    states = _states(tables, drives)
    for state in states:
        state[:] = motion[start : start + state.size].reshape(state.shape)
        start += state.size
    _ports_follow_state(tables.bus)
    # what is linear may be scaled at each step, so that no growth leaves the numbers
    kept = math.exp(-growth * tables.bus.step)
    laws = Laws(tables.explicit)
    speed = np.empty((_OBSERVED_STEPS, len(drives.port)))
    work = np.zeros(len(drives.port))
    for i in range(_OBSERVED_STEPS):
        run(laws, tables.bus, i, 0, 1)
        speed[i] = tables.bus.v[drives.port]
        travel = tables.bus.u[drives.port] - tables.bus.u_before[drives.port]
        work += tables.bus.force[drives.port] * travel
        for state in (*states, tables.bus.u, tables.bus.v):
            state *= kept
    index = int(np.argmax(work))
    lines = np.abs(np.fft.rfft(np.hanning(_OBSERVED_STEPS) * speed[:, index]))
    return float(np.argmax(lines) / (_OBSERVED_STEPS * tables.bus.step)), index
