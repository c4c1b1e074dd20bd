"""Columns of k drives for the time loop, from their specifications."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dynamics.control.cascade import DriveController
from dynamics.control.filters import UNFILTERED
from dynamics.control.sampling import ControlError

#: columns of `ControlTable.state`: set points held between samples, sums, filter and plant states
VELOCITY_SET, TORQUE_SET, CURRENT_INPUT, TORQUE_FED = 0, 1, 2, 3
TORQUE_SUM, VOLTAGE_SUM, REFERENCE_FIRST, REFERENCE_SECOND = 4, 5, 6, 7
LAST_ANGLE, PLANT_FIRST, PLANT_SECOND = 8, 9, 10
#: of a test: added to the torque set point before the filters, written from outside
TORQUE_INJECTED = 11
STATES = 12

#: channels of `ControlTable.history`, each delayed by `ControlTable.delays`
SET_POSITION, SET_VELOCITY, MEASURED_POSITION, POSITION_OUTPUT, SET_TORQUE = 0, 1, 2, 3, 4
MEASURED_VELOCITY, VELOCITY_OUTPUT, MEASURED_CURRENT, CURRENT_OUTPUT = 5, 6, 7, 8
CHANNELS = 9


class ControlTable(NamedTuple):
    """k drives and their state; `state`, `history` and `filter_state` are written by the step."""

    samples: NDArray[np.int64]  # steps per sample of position, velocity, current loop, (k, 3)
    delays: NDArray[np.int64]  # samples, (k, CHANNELS)
    transmission: NDArray[np.float64]  # m/rad, (k,)
    scale: NDArray[np.float64]  # 1: position from the scale, 0: from the encoder, (k,)
    resolution: NDArray[np.float64]  # of encoder rad and scale m, (k, 2)
    difference: NDArray[np.float64]  # 1/s: of encoder positions; 0: the motor's velocity, (k,)
    position_gain: NDArray[np.float64]  # 1/s, (k,)
    velocity_limit: NDArray[np.float64]  # m/s, (k,)
    velocity_fed: NDArray[np.float64]  # share, (k,)
    torque_fed: NDArray[np.float64]  # N m per m/s^2, (k,)
    proportional: NDArray[np.float64]  # N m s/rad, (k,)
    integral: NDArray[np.float64]  # N m s/rad per sample, (k,)
    torque_limit: NDArray[np.float64]  # N m, (k,)
    reference: NDArray[np.float64]  # b0, b1, b2, a1, a2, (k, 5)
    filters: NDArray[np.float64]  # b0, b1, b2, a1, a2, (k, F, 5)
    input_law: NDArray[np.float64]  # rows of current_loop.InputLaw, (k, 6)
    plant: NDArray[np.float64]  # transition 4, entry 2, torque 2, feedthrough 1, (k, 9)
    state: NDArray[np.float64]  # (k, STATES)
    history: NDArray[np.float64]  # rings of past samples, (k, CHANNELS, longest delay + 1)
    filter_state: NDArray[np.float64]  # (k, F, 2)


def control_table(controllers: Sequence[DriveController], step: float) -> ControlTable:
    """Return the columns of drives at rest at position 0.

    At a step of the simulation, s. ControlError if there is no drive, or a sample time is no whole
    multiple of the step.
    """
    if not controllers:
        raise ControlError("control table: no drive given")
    count = len(controllers)
    sections = max(len(drive.filters) for drive in controllers)
    delays = np.array([_delays(drive) for drive in controllers], dtype=np.int64)
    filters = np.tile(UNFILTERED, (count, sections, 1))
    for k, drive in enumerate(controllers):
        for index, spec in enumerate(drive.filters):
            filters[k, index] = spec.sampled(drive.current_timing.sample_time)
    laws = [drive.current.input_law(drive.current_timing.sample_time) for drive in controllers]
    table = ControlTable(
        samples=np.array([drive.steps_per_sample(step) for drive in controllers], dtype=np.int64),
        delays=delays,
        transmission=_column([drive.measuring.transmission for drive in controllers]),
        scale=_column([drive.measuring.position == "scale" for drive in controllers]),
        resolution=_column(
            [
                (drive.measuring.encoder_resolution, drive.measuring.scale_resolution)
                for drive in controllers
            ]
        ),
        difference=_column([_difference(drive) for drive in controllers]),
        position_gain=_column([drive.position.gain for drive in controllers]),
        velocity_limit=_column([drive.position.velocity_limit for drive in controllers]),
        velocity_fed=_column([drive.feedforward.velocity for drive in controllers]),
        torque_fed=_column(
            [drive.feedforward.inertia / drive.measuring.transmission for drive in controllers]
        ),
        proportional=_column([drive.velocity.proportional_gain for drive in controllers]),
        integral=_column([drive.integral_gain for drive in controllers]),
        torque_limit=_column([drive.velocity.torque_limit for drive in controllers]),
        reference=_column([_reference(drive) for drive in controllers]),
        filters=filters,
        input_law=_column(laws),
        plant=_column([_plant(drive, step) for drive in controllers]),
        state=np.zeros((count, STATES)),
        history=np.zeros((count, CHANNELS, int(delays.max()) + 1)),
        filter_state=np.zeros((count, sections, 2)),
    )
    for column in table[:-3]:
        column.flags.writeable = False
    return table


def _column(values: ArrayLike) -> NDArray[np.float64]:
    return np.array(values, dtype=np.float64)


def _difference(drive: DriveController) -> float:
    return (
        1.0 / drive.velocity.timing.sample_time if drive.measuring.velocity == "difference" else 0.0
    )


def _reference(drive: DriveController) -> NDArray[np.float64]:
    model = drive.velocity.reference_model
    return UNFILTERED if model is None else model.sampled(drive.velocity.timing.sample_time)


def _plant(drive: DriveController, step: float) -> NDArray[np.float64]:
    plant = drive.current.plant()
    transition, entry = plant.sampled(step)
    return np.array([*transition.ravel(), *entry, *plant.torque, plant.feedthrough])


def _delays(drive: DriveController) -> list[int]:
    """Samples of each channel, in their order."""
    position, velocity, current = drive.timings
    return [
        drive.position.set_point_delay,
        drive.feedforward.velocity_delay,
        position.measuring,
        position.output_delay,
        drive.feedforward.torque_delay,
        velocity.measuring,
        velocity.output_delay,
        current.measuring,
        current.output_delay,
    ]
