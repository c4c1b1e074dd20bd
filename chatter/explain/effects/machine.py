"""Effects of a machine: friction of an axis, joints and gains that are not as declared."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from chatter.description.case import MACHINE_PATH, Case
from chatter.description.machine.axis import AxisSection
from chatter.description.machine.drive import DriveSection
from chatter.description.machine.machine_file import MachineFile
from chatter.explain.effects.effect import Effect, Patch, Reported, Values, free
from chatter.explain.fitting import Parameter
from chatter.explain.measurement import Measurement

#: joints, and axes, of which each may be the one
_MOST_JOINTS, MOST_AXES = 24, 6
#: a factor that is tried, and its bounds
_FACTOR, _LEAST_FACTOR, _MOST_FACTOR = 0.05, 0.02, 50.0
_STARTS, _STARTS_IN_TIME = np.geomspace(0.25, 4.0, 17), (0.7, 1.0, 1.4)
#: friction that is tried at two parts, over that of typical ones: what holds at rest is sharp
_SHARES, _VISCOUS_SHARE = (0.05, 0.3, 1.0, 2.0, 3.5, 6.0, 12.0), 0.05
#: keys of drives and loops that say how stiff they are
_STIFFNESS, _GAINS = "stiffness", ("position.gain", "velocity.proportional_gain")
#: keys of loops that delay what they pass on
_LAGS = ("current.time_constant", "velocity.integral_time")


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


class _Factor(Effect):
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


class JointStiffness(_Factor):
    """A guide, bearing, nut or belt that is softer or stiffer than declared."""

    name = "joint_stiffness"
    label = "stiffness of a joint"
    help = "a guide, bearing, nut or foundation of the machine is softer or stiffer than declared"

    def listed(self, file: MachineFile) -> Sequence[Joint]:
        """Connectors and drives."""
        return joints(file)


class ControlGain(_Factor):
    """A gain of a control loop that is not as declared."""

    name = "control_gain"
    label = "gain of a control loop"
    help = "a control loop of the machine has another gain than declared"

    def listed(self, file: MachineFile) -> Sequence[Joint]:
        """Loops of all axes."""
        return gains(file)


class ControlDelay(_Factor):
    """A time constant of a control loop that is not as declared."""

    name = "control_delay"
    label = "time constant of a control loop"
    help = "a control loop of the machine is slower or faster than declared"
    kinds = ("frf", "drive")

    def listed(self, file: MachineFile) -> Sequence[Joint]:
        """Loops of all axes."""
        return lags(file)


class RubbingPart(NamedTuple):
    """Where an axis rubs: key of its target, word in names, units and typical sizes."""

    target: str  # key of the friction law's `on`
    law: str  # name of the friction law in the machine, before the axis
    named: str  # before the axis, in names of parameters
    force: str  # unit of friction
    damping: str  # unit of viscous friction
    stiffness: str  # unit of friction over displacement
    sizes: dict[str, float]  # typical friction, by key of the law
    hysteresis_slope: float  # friction is built up within some tenths of a mm or of a mrad

    def unit(self, key: str) -> str:
        """Unit of a quantity of the friction law."""
        return self.force if key == "coulomb" else self.damping


GUIDE = RubbingPart(
    "axis", "guide_", "", "N", "N*s/m", "N/m",
    {"coulomb": 20.0, "viscous": 200.0}, 1e4,
)  # fmt: skip
MOTOR = RubbingPart(
    "motor", "motor_", "motor_", "N*m", "N*m*s/rad", "N*m/rad",
    {"coulomb": 0.02, "viscous": 2e-3}, 1e4,
)  # fmt: skip


class AxisFriction(Effect):
    """Friction of the guides, of the motor, or of both, of an axis that has none declared there."""

    name = "axis_friction"
    label = "friction of an axis"
    help = "guides or motor of an axis of the machine rub: a spring at rest, a damper in motion"
    kinds = ("frf", "milling", "drive")
    parts: tuple[RubbingPart, ...] = (GUIDE,)

    def __init__(self, number: int = 0) -> None:
        self.number = number

    @property
    def variants(self) -> tuple[Effect, ...]:
        """Of one of the axes, at one of the parts."""
        forms = (AxisFriction, MotorFriction)
        return tuple(form(number) for number in range(MOST_AXES) for form in forms)

    @property
    def richer(self) -> tuple[Effect, ...]:
        """At both parts of the same axis."""
        return (FrictionOfGuideAndMotor(self),)

    def applies(self, measurement: Measurement) -> bool:
        """Of a machine with so many axes without friction there."""
        case = measurement.case
        return case.on_machine and self.number < len(self._axes(case.machine_file()))

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Quantities of the friction laws, named by part and axis."""
        axis = self.axis(measurement)
        return [
            free(f"{key}_{part.named}{axis}", 0.0, part.sizes[key], part.unit(key), lower=0.0)
            for part in self.parts
            for key in part.sizes
        ]

    def starts(self, measurement: Measurement) -> list[Values]:
        """Little, and as much as of a sliding guide."""
        sizes = {one.name: one.size for one in self.parameters(measurement)}
        return [{name: share * size for name, size in sizes.items()} for share in (0.05, 1.0, 5.0)]

    def patch(self, case: Case, values: Values) -> Patch:
        """Friction with hysteresis at every part; none where it is nothing."""
        del case
        given: Patch = {}
        for part, axis, own in self._laws(values):
            if own["coulomb"] > 0.0:
                given[f"{MACHINE_PATH}friction.{part.law}{axis}"] = {
                    "law": "tanh-hysteresis",
                    "on": {part.target: axis},
                    **own,
                    "hysteresis_slope": part.hysteresis_slope,
                }
        return given

    def reported(self, values: Values) -> Reported:
        """Friction, and its stiffness before it slides."""
        told: Reported = {}
        for part, axis, own in self._laws(values):
            for key, value in own.items():
                told[f"{key}_{part.named}{axis}"] = (value, part.unit(key))
            stiffness = own["coulomb"] * part.hysteresis_slope
            told[f"presliding_stiffness_{part.named}{axis}"] = (stiffness, part.stiffness)
        return told

    def axis(self, measurement: Measurement) -> str:
        """Axis that rubs."""
        return self._axes(measurement.case.machine_file())[self.number]

    def _axes(self, file: MachineFile) -> list[str]:
        """Axes under control that no friction is declared on, at any of the parts."""
        rubbed = {
            getattr(one.on, part.target) for one in file.friction.values() for part in self.parts
        }
        return [
            name
            for name, axis in file.axis.items()
            if axis.control is not None and name not in rubbed and self._has_parts(axis)
        ]

    def _has_parts(self, axis: AxisSection) -> bool:
        """Whether the motor of an axis turns, where that is one of the parts."""
        turns = axis.drive is not None and not axis.drive.motor_is_linear
        return MOTOR not in self.parts or turns

    def _laws(self, values: Values) -> Iterator[tuple[RubbingPart, str, dict[str, float]]]:
        """Place, axis, and quantities of the law there."""
        for part in self.parts:
            begins = f"coulomb_{part.named}"
            axis = next(key for key in values if key.startswith(begins)).removeprefix(begins)
            own = {key: float(values[f"{key}_{part.named}{axis}"]) for key in part.sizes}
            yield part, axis, own


class MotorFriction(AxisFriction):
    """Friction of the bearings and the nut of an axis, as its motor feels it."""

    parts = (MOTOR,)


class FrictionOfGuideAndMotor(AxisFriction):
    """Friction of guides and motor of an axis of which one was found to rub."""

    parts = (GUIDE, MOTOR)

    def __init__(self, found: AxisFriction) -> None:
        super().__init__(found.number)
        self._found = found

    @property
    def richer(self) -> tuple[Effect, ...]:
        """None."""
        return ()

    @property
    def mistaken_for(self) -> tuple[str, ...]:
        """Between two parts that hold lies what is compliant."""
        return (JointStiffness.name, ControlGain.name, ControlDelay.name)

    def applies(self, measurement: Measurement) -> bool:
        """Of an axis that has no friction declared at either part."""
        case = measurement.case
        return case.on_machine and self.axis(measurement) in self._axes(case.machine_file())

    def starts(self, measurement: Measurement) -> list[Values]:
        """Every Coulomb friction of the one part with every one of the other."""
        axis = self.axis(measurement)
        return [
            {
                f"{key}_{part.named}{axis}": size * (share if key == "coulomb" else _VISCOUS_SHARE)
                for part, share in zip(self.parts, shares, strict=True)
                for key, size in part.sizes.items()
            }
            for shares in itertools.product(_SHARES, repeat=len(self.parts))
        ]

    def axis(self, measurement: Measurement) -> str:
        """Axis of the friction that was found."""
        return self._found.axis(measurement)
