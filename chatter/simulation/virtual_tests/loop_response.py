"""Closed position and velocity loop of an axis: in the z-domain, and by a sweep of its set point.

Both answer the component at the frequency of a sinusoidal set point that the loop samples; images
of the sampling are other frequencies.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chatter.description.errors import InputError
from chatter.simulation.virtual_tests.run import MachineRun, RunInputs, run_machine
from dynamics.control.cascade import DriveController, Feedforward, LoopTiming, PositionController
from dynamics.control.response import ControllerResponse, controller_response
from dynamics.control.sampling import ControlError, zero_order_hold_response
from dynamics.frf.excitation.chirp import linear_chirp
from dynamics.frf.excitation.signal import ExcitationError
from dynamics.machine.description import Drive, Machine
from dynamics.machine.harmonic import Linearised, receptance
from dynamics.trajectory.set_points import SetPoints

#: part of a sweep's first period in which the axis comes to speed
_RAMP = 0.5

Loop = Literal["position", "velocity"]
Response = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class LoopResponse:
    """Frequency responses of the closed loops of an axis."""

    frequency: NDArray[np.float64]  # (m,), Hz
    #: (m,), what the position controller measures (scale or encoder) per position set point, with
    #: the feedforward of the machine; m/m
    position: Response
    velocity: Response  # (m,), at the motor per velocity set point, position loop open; (m/s)/(m/s)


def loop_response(
    machine: Machine,
    step: float,
    axis: str,
    frequency: ArrayLike,
    frictions: Mapping[str, Linearised] | None = None,
) -> LoopResponse:
    """Closed loops of an axis in closed form; the other axes stay under their control.

    The controllers are sampled on the step, s. Several drives of an axis get the same set point,
    their mean answers. Frequencies (m,) are in Hz, above 0, not a half multiple of a loop's
    sampling frequency. Frictions are linearised as told by name (see
    `chatter.simulation.virtual_tests.frf.linearised_frictions`); those not named are left out.

    The set point turns into torque by the sampled cascade (`dynamics.control.response`), and torque
    into motion by the receptance of the machine with its loops closed
    (`dynamics.machine.harmonic`). Velocity and acceleration set points are the derivatives of the
    position set point, as a trajectory gives them.

    InputError if the axis is not under control, a frequency not above 0, or a sample time does not
    fit.
    """
    lines = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    if not (np.all(np.isfinite(lines)) and np.all(lines > 0.0)):
        raise InputError(f'loops of axis "{axis}": frequencies must be above 0 Hz')
    jw = 2j * np.pi * lines
    alone = velocity_controlled(machine, axis)
    try:
        position = _answer(
            machine,
            step,
            axis,
            lines,
            frictions,
            measured_position,
            lambda one: one.x_set + jw * one.v_set + jw**2 * one.a_set,
        )
        turned = _answer(alone, step, axis, lines, frictions, motor_position, lambda one: one.v_set)
    except ControlError as error:
        raise InputError(f'axis "{axis}": {error}') from error
    return LoopResponse(lines, position, jw * turned)


def velocity_controlled(machine: Machine, axis: str) -> Machine:
    """Same machine with the position loop of an axis open.

    Its velocity set point is that of the trajectory, read at the sample time of the velocity loop.

    InputError if the axis is not under control.
    """
    names = {drive.name for drive in _drives_of(machine, axis)}
    drives = tuple(
        drive._replace(controller=_without_position_loop(drive.controller))
        if drive.name in names
        else drive
        for drive in machine.drives
    )
    return replace(machine, drives=drives)


def measured_position(drive: Drive) -> NDArray[np.float64]:
    """Row of what the position controller of a drive measures, as travel in m."""
    if drive.controller.measuring.position == "scale":
        return drive.scale
    return motor_position(drive)


def motor_position(drive: Drive) -> NDArray[np.float64]:
    """Row of the motor's angle, as travel in m."""
    return drive.row * drive.controller.measuring.transmission


class LoopSweep(NamedTuple):
    """Chirp of a set point, on top of a steady travel in which the frictions slide."""

    loop: Loop
    band: tuple[float, float]  # Hz
    amplitude: float  # of the set point, m or m/s
    period: float = 1.0  # s
    velocity: float = 0.0  # of the axis, m/s
    leading: int = 1  # periods run before that which counts


def loop_by_sweep(
    machine: Machine, step: float, axis: str, sweep: LoopSweep
) -> tuple[NDArray[np.float64], Response]:
    """Frequencies (m,), Hz, and response (m,) of a closed loop by a sweep in time.

    Frequencies are the lines of the period within the band. The response is as in `LoopResponse`,
    the step in s. Where the axis travels, the amplitude of the sweep should not turn the motion
    round. InputError if the axis is not under control or the sweep makes no sense, RunError if the
    machine runs away.
    """
    tested = velocity_controlled(machine, axis) if sweep.loop == "velocity" else machine
    drives = _drives_of(tested, axis)
    cycle = drives[0].controller.position.timing.sample_time
    try:
        signal = linear_chirp(
            *sweep.band, round(sweep.period / cycle) * cycle, sweep.amplitude, cycle
        )
    except ExcitationError as error:
        raise InputError(f'sweep of axis "{axis}": {error}') from error
    values = signal.repeated(1, sweep.leading)
    answer = _swept(tested, step, axis, sweep, values)
    if sweep.velocity:
        answer = answer - _swept(tested, step, axis, sweep, np.zeros_like(values))
    last = signal.period * round(cycle / step)
    wanted = np.fft.rfft(signal.values)[signal.lines] / signal.period
    got = np.fft.rfft(answer[-last:])[signal.lines] / last
    return signal.frequency, got / wanted


def _drives_of(machine: Machine, axis: str) -> list[Drive]:
    drives = [drive for drive in machine.drives if drive.axis == axis]
    if not drives:
        known = ", ".join(f'"{drive.axis}"' for drive in machine.drives) or "none"
        raise InputError(f'axis "{axis}" is not under control; there are {known}')
    return drives


def _without_position_loop(controller: DriveController) -> DriveController:
    timing = LoopTiming(controller.velocity.timing.sample_time)
    return replace(
        controller,
        position=PositionController(0.0, timing, controller.position.velocity_limit),
        feedforward=Feedforward(velocity=1.0),
    )


def _answer(
    machine: Machine,
    step: float,
    axis: str,
    lines: NDArray[np.float64],
    frictions: Mapping[str, Linearised] | None,
    read: Callable[[Drive], NDArray[np.float64]],
    per_set_point: Callable[[ControllerResponse], Response],
) -> Response:
    """Mean motion of the drives of an axis per set point of all of them."""
    drives = _drives_of(machine, axis)
    output = sum(read(drive) for drive in drives) / len(drives)
    rows = np.vstack([output, *(drive.row for drive in drives)])
    closed = receptance(machine, lines, rows, step, frictions)
    hold = zero_order_hold_response(lines, step)
    return sum(
        closed[:, 0, index]
        * hold
        * per_set_point(controller_response(drive.controller, step, lines))
        for index, drive in enumerate(drives, start=1)
    )


def _swept(
    machine: Machine, step: float, axis: str, sweep: LoopSweep, values: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Answer of the loop at the steps, from the first set point on."""
    drives = _drives_of(machine, axis)
    cycle = drives[0].controller.position.timing.sample_time
    points = _swept_points(machine, axis, sweep, values, cycle, round(cycle / step))
    read = measured_position if sweep.loop == "position" else motor_position
    output = sum(read(drive) for drive in drives) / len(drives)
    run = run_machine(
        machine, step, RunInputs(len(values) * cycle, points, outputs={"read": output})
    )
    return np.concatenate([[0.0], _column(run, sweep.loop)[:-1]])


def _column(run: MachineRun, loop: Loop) -> NDArray[np.float64]:
    return run.displacement["read"] if loop == "position" else run.velocity["read"]


def _swept_points(
    machine: Machine,
    axis: str,
    sweep: LoopSweep,
    values: NDArray[np.float64],
    cycle: float,
    steps: int,
) -> SetPoints:
    """Set points of all axes: a steady travel, and the sweep with its derivatives."""
    count = len(values)
    column = machine.axes.index(axis)
    position, velocity, acceleration = (np.zeros((count, len(machine.axes))) for _ in range(3))
    # gently to speed, so that frictions elsewhere are not left strained by a jolt
    share = np.minimum(np.arange(count) * cycle / (_RAMP * sweep.period), 1.0)
    velocity[:, column] = sweep.velocity * 0.5 * (1.0 - np.cos(np.pi * share))
    position[:, column] = cycle * (np.cumsum(velocity[:, column]) - velocity[:, column])
    if sweep.loop == "velocity":
        velocity[:, column] += values
    else:
        # whole periods of a signal within its band: derivatives by its lines are exact
        jw = 2j * np.pi * np.fft.rfftfreq(count, cycle)
        lines = np.fft.rfft(values)
        position[:, column] += values
        velocity[:, column] += np.fft.irfft(jw * lines, count)
        acceleration[:, column] = np.fft.irfft(jw**2 * lines, count)
    return SetPoints(position, velocity, acceleration, steps)
