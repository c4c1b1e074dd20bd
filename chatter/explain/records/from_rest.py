"""Signals of a run that begins from rest as the tool meets full immersion."""

import math
from typing import cast

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.explain.measurement import Run
from chatter.explain.records.case_axes import USUAL, Component
from chatter.explain.records.description import (
    ACCELERATION,
    DRIVE_TORQUE,
    FORCE,
    SPINDLE_POWER,
    VELOCITY,
)
from chatter.explain.records.simulated import over_revolutions, simulated
from chatter.explain.records.slow_channels import over_revolution
from chatter.simulation.result import SimulationResult
from chatter.simulation.simulate import MachineResult

Array = NDArray[np.float64]

#: revolutions simulated beyond the end of a record
_BEYOND = 1e-3


def from_rest(case: Case, run: Run) -> dict[str, Array]:
    """Signals of a case with the overrides of the run, at the samples of the run."""
    at = run.signals["time"] - run.signals["time"][0]
    revolutions = float(at[-1]) * case.cut.spindle_speed / (2.0 * math.pi) + _BEYOND
    result = simulated(over_revolutions(case, revolutions))
    components = {**_ALWAYS, **{k: v for k, v in USUAL.items() if k in run.signals}}
    components |= run.components
    speed = case.cut.spindle_speed
    return {
        name: np.interp(at, result.time, predicted_signal(result, component, speed))
        for name, component in components.items()
    }


#: channels of every run, whether recorded or not
_ALWAYS = {name: USUAL[name] for name in ("Fx", "Fy", "Fz", "x", "y", "z")}


def predicted_signal(result: SimulationResult, component: Component, speed: float) -> Array:
    """Signal (n,) of a component of a simulated cut at its own times; speed in rad/s."""
    if component.quantity == SPINDLE_POWER:
        return over_revolution(result.power, result.time, speed)
    if component.quantity == DRIVE_TORQUE:
        # such a component is of a case on a machine alone
        return cast("MachineResult", result).torque_of(component.axis)
    source = result.force if component.quantity == FORCE else result.displacement
    values = source @ np.array(component.direction)
    for _ in range({VELOCITY: 1, ACCELERATION: 2}.get(component.quantity, 0)):
        values = np.gradient(values, result.time)
    return values
