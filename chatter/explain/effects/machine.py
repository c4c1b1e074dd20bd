"""Effects of a machine: joints, gains and frictions that are not as declared."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from chatter.description.case import MACHINE_PATH, Case
from chatter.description.machine.drive import DriveSection
from chatter.description.machine.machine_file import MachineFile
from chatter.explain.effects.effect import Effect, Patch, Values, free
from chatter.explain.measurement import Measurement
from chatter.explain.parameters import Parameter

#: joints, and axes, of which each may be the one
_MOST_JOINTS, MOST_AXES = 24, 6
#: a factor that is tried, and its bounds
_FACTOR, _LEAST_FACTOR, _MOST_FACTOR = 0.05, 0.02, 50.0
_STARTS, _STARTS_IN_TIME = np.geomspace(0.25, 4.0, 17), (0.7, 1.0, 1.4)
#: keys of drives and loops that say how stiff they are
_STIFFNESS, _GAINS = "stiffness", ("position.gain", "velocity.proportional_gain")
#: keys of loops that delay what they pass on
_LAGS = ("current.time_constant", "velocity.integral_time")
#: keys of friction laws that say how much they resist, and factors that are tried
_RESISTING = ("coulomb", "static", "logarithmic", "viscous", "low_speed_viscous")
_STARTS_OF_FRICTION = (0.02, 0.1, 0.3, 0.6, 1.0, 1.5, 3.0)


class Joint(NamedTuple):
    """Stiffness of a machine that one factor may change."""

    name: str  # of the connector, or of the axis and the key of its drive
    values: dict[str, float]  # by path into the machine file


def joints(file: MachineFile) -> list[Joint]:
    """Connectors, and whatever of the drives has a stiffness."""
    found = []
    for name, connector in file.connector.items():
        values = connector.stiffness.model_dump(exclude_none=True)
        stiff = {f"connector.{name}.stiffness.{k}": v for k, v in values.items() if v}
        if stiff:
            found.append(Joint(name, stiff))
    for name, axis in file.axis.items():
        for key, value in _of_drive(axis.drive):
            found.append(Joint(f"{name}_{key}", {f"axis.{name}.drive.{key}": value}))
    return found


def _of_drive(drive: DriveSection | None) -> Iterator[tuple[str, float]]:
    for key, value in drive or ():
        if key.endswith(_STIFFNESS) and isinstance(value, float):
            yield key, value


def gains(file: MachineFile) -> list[Joint]:
    """Gains of the position and velocity loops of all axes."""
    return _of_loops(file, _GAINS)


def lags(file: MachineFile) -> list[Joint]:
    """Time constants of the current and velocity loops of all axes."""
    return _of_loops(file, _LAGS)


def _of_loops(file: MachineFile, keys: Sequence[str]) -> list[Joint]:
    return [
        Joint(f"{name}_{key.partition('.')[0]}", {f"axis.{name}.control.{key}": value})
        for name, axis in file.axis.items()
        if axis.control is not None
        for key in keys
        if isinstance(value := file.get(f"axis.{name}.control.{key}"), float)
    ]


def resistances(file: MachineFile) -> list[Joint]:
    """Forces of each friction that is declared."""
    found = []
    for name, law in file.friction.items():
        values = {
            f"friction.{name}.{key}": value
            for key in _RESISTING
            if isinstance(value := getattr(law, key, None), float) and value > 0.0
        }
        if values:
            found.append(Joint(name, values))
    return found


class Factor(Effect):
    """Values of the machine that are a factor off what is declared."""

    kinds = ("frf", "milling", "drive")
    most = _MOST_JOINTS

    def __init__(self, number: int = 0) -> None:
        self.number = number

    @property
    def variants(self) -> tuple[Effect, ...]:
        """One of them."""
        return tuple(type(self)(number) for number in range(self.most))

    def listed(self, file: MachineFile) -> Sequence[Joint]:
        """What may be another."""
        raise NotImplementedError

    def applies(self, measurement: Measurement) -> bool:
        """Of a machine that has so many, where none of the values is uncertain as declared."""
        case = measurement.case
        if not case.on_machine:
            return False
        listed = self.listed(case.machine_file())
        uncertain = {*measurement.tolerances, *case.deviations()}
        return self.number < len(listed) and not any(
            MACHINE_PATH + path in uncertain for path in listed[self.number].values
        )

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Factor on the declared values, named by what they belong to."""
        one = self.listed(measurement.case.machine_file())[self.number]
        bounds = {"lower": _LEAST_FACTOR, "upper": _MOST_FACTOR}
        return [free(one.name, 1.0, _FACTOR, "", **bounds)]

    def nothing(self, measurement: Measurement) -> Values:
        """The declared values."""
        return {one.name: 1.0 for one in self.parameters(measurement)}

    def starts(self, measurement: Measurement) -> list[Values]:
        """From a quarter to four times: a resonance must be met before a step leads to it.

        A cut and a move in time are simulated from few of them.
        """
        (one,) = self.parameters(measurement)
        factors = _STARTS if "frf" in measurement.kinds else _STARTS_IN_TIME
        return [{one.name: float(factor)} for factor in factors]

    def patch(self, case: Case, values: Values) -> Patch:
        """Values times the factor."""
        ((name, factor),) = values.items()
        one = next(one for one in self.listed(case.machine_file()) if one.name == name)
        return {MACHINE_PATH + path: float(factor) * v for path, v in one.values.items()}


class JointStiffness(Factor):
    """A guide, bearing, nut or belt that is softer or stiffer than declared."""

    name = "joint_stiffness"
    label = "stiffness of a joint"
    help = "a guide, bearing, nut or foundation of the machine is softer or stiffer than declared"

    def listed(self, file: MachineFile) -> Sequence[Joint]:
        """Connectors and drives."""
        return joints(file)


class DeclaredFriction(Factor):
    """A friction that is stronger or weaker than declared, or not there."""

    name = "declared_friction"
    label = "strength of a friction"
    help = "a friction that is declared of the machine is stronger or weaker, or next to none"
    kinds = ("drive",)

    def listed(self, file: MachineFile) -> Sequence[Joint]:
        """Frictions that are declared."""
        return resistances(file)

    def starts(self, measurement: Measurement) -> list[Values]:
        """From next to none to three times."""
        (one,) = self.parameters(measurement)
        return [{one.name: factor} for factor in _STARTS_OF_FRICTION]


class ControlGain(Factor):
    """A gain of a control loop that is not as declared."""

    name = "control_gain"
    label = "gain of a control loop"
    help = "a control loop of the machine has another gain than declared"

    def listed(self, file: MachineFile) -> Sequence[Joint]:
        """Loops of all axes."""
        return gains(file)


class ControlDelay(Factor):
    """A time constant of a control loop that is not as declared."""

    name = "control_delay"
    label = "time constant of a control loop"
    help = "a control loop of the machine is slower or faster than declared"
    kinds = ("frf", "drive")

    def listed(self, file: MachineFile) -> Sequence[Joint]:
        """Loops of all axes."""
        return lags(file)
