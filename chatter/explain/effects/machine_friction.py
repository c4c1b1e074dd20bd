"""Friction of an axis of a machine that has none declared: at guides, motor or both."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import NamedTuple

from chatter.description.case import MACHINE_PATH, Case
from chatter.description.machine.axis import AxisSection
from chatter.description.machine.machine_file import MachineFile
from chatter.explain.effects.effect import Effect, Patch, Reported, Values, free
from chatter.explain.effects.machine import MOST_AXES
from chatter.explain.measurement import Measurement
from chatter.explain.parameters import KnownByFactor, Parameter

#: friction that is tried at two parts, over that of typical ones: what holds at rest is sharp
_SHARES, _VISCOUS_SHARE = (0.05, 0.3, 1.0, 2.0, 3.5, 6.0, 12.0), 0.05
#: what is tried of a Stribeck curve: friction over that of typical ones, what it is more at the
#: onset of sliding, over it, and velocity over which that falls, over typical ones
_SLIDING, _ONSETS, _FALLS = (1.0, 3.0, 6.0), (0.2, 0.6), (0.2, 1.0, 5.0)


class RubbingPart(NamedTuple):
    """Where an axis rubs: key of its target, word in names, units and typical sizes."""

    target: str  # key of the friction law's `on`
    law: str  # name of the friction law in the machine, before the axis
    named: str  # before the axis, in names of parameters
    force: str  # unit of friction
    damping: str  # unit of viscous friction
    stiffness: str  # unit of friction over displacement
    sizes: dict[str, float]  # typical friction, by key of the law
    velocity: tuple[float, str]  # over which a Stribeck curve typically falls, and its unit
    hysteresis_slope: float  # friction is built up within some tenths of a mm or of a mrad
    per: str  # unit of what the slope and the decay over speed are inverses of

    def unit(self, key: str) -> str:
        """Unit of a quantity of the friction law."""
        return self.force if key == "coulomb" else self.damping


GUIDE = RubbingPart(
    "axis", "guide_", "", "N", "N*s/m", "N/m",
    {"coulomb": 20.0, "viscous": 200.0}, (5e-3, "m/s"), 1e4, "m",
)  # fmt: skip
MOTOR = RubbingPart(
    "motor", "motor_", "motor_", "N*m", "N*m*s/rad", "N*m/rad",
    {"coulomb": 0.02, "viscous": 2e-3}, (3.0, "rad/s"), 1e4, "rad",
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
        """Of one of the axes, at one of the parts or at both."""
        found: list[Effect] = []
        for number in range(MOST_AXES):
            guide = AxisFriction(number)
            found += [guide, MotorFriction(number), FrictionOfGuideAndMotor(guide)]
        return tuple(found)

    @property
    def richer(self) -> tuple[Effect, ...]:
        """At both parts of the axis, with a Stribeck curve, or with what it is at low speed."""
        return (FrictionOfGuideAndMotor(self), StribeckFriction(self), LowSpeedFriction(self))

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
        """Friction at every part; none where it is nothing."""
        del case
        return {
            f"{MACHINE_PATH}friction.{part.law}{axis}": {
                "on": {part.target: axis},
                **own,
                **self._law_keys(part, axis, own, values),
            }
            for part, axis, own in self._laws(values)
            if own["coulomb"] > 0.0
        }

    def _law_keys(
        self, part: RubbingPart, axis: str, own: Values, values: Values
    ) -> dict[str, object]:
        """Law and the keys that the quantities do not give: friction with hysteresis."""
        del own
        slope = self._hysteresis_slope(part, axis, values)
        return {"law": "tanh-hysteresis", "hysteresis_slope": slope}

    def _hysteresis_slope(self, part: RubbingPart, axis: str, values: Values) -> float:
        """Typical one, over displacement; FRFs at rest tell its product with the friction."""
        del axis, values
        return part.hysteresis_slope

    def reported(self, values: Values) -> Reported:
        """Friction, and its stiffness before it slides."""
        told: Reported = {}
        for part, axis, own in self._laws(values):
            for key, value in own.items():
                told[f"{key}_{part.named}{axis}"] = (value, part.unit(key))
            slope = self._hysteresis_slope(part, axis, values)
            stiffness = _stiffness(slope, own["coulomb"])
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


class LowSpeedFriction(AxisFriction):
    """Friction with a hysteresis of its own, and viscous friction that is higher at low speed.

    At rest the one is stiffness and the other damping, which no friction in motion tells.
    """

    def __init__(self, found: AxisFriction) -> None:
        super().__init__(found.number)
        self._found = found
        self.parts = found.parts

    @property
    def richer(self) -> tuple[Effect, ...]:
        """None."""
        return ()

    def applies(self, measurement: Measurement) -> bool:
        """Of an axis of which FRFs were measured, that has no friction declared at these parts."""
        if "frf" not in measurement.kinds or not self._found.applies(measurement):
            return False
        return self.axis(measurement) in self._axes(measurement.case.machine_file())

    def axis(self, measurement: Measurement) -> str:
        """Axis of the simpler friction."""
        return self._found.axis(measurement)

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Those in motion, and of every part its hysteresis and what it is at low speed."""
        axis = self.axis(measurement)
        found = super().parameters(measurement)
        for part in self.parts:
            slope, decay = part.hysteresis_slope, 1.0 / part.velocity[0]
            found += [
                KnownByFactor(
                    f"hysteresis_slope_{part.named}{axis}",
                    slope, slope, 0.1 * slope, 10.0 * slope, unit=f"1/{part.per}",
                ),
                free(
                    f"low_speed_viscous_{part.named}{axis}",
                    0.0, 5.0 * part.sizes["viscous"], part.damping, lower=0.0,
                ),
                KnownByFactor(
                    f"low_speed_decay_{part.named}{axis}",
                    decay, decay, 0.02 * decay, 50.0 * decay, unit=f"s/{part.per}",
                ),
            ]  # fmt: skip
        return found

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

    def _law_keys(
        self, part: RubbingPart, axis: str, own: Values, values: Values
    ) -> dict[str, object]:
        """Friction with hysteresis, and its viscous friction at low speed."""
        further = {
            key: float(values[f"{key}_{part.named}{axis}"])
            for key in ("low_speed_viscous", "low_speed_decay")
        }
        return super()._law_keys(part, axis, own, values) | further

    def _hysteresis_slope(self, part: RubbingPart, axis: str, values: Values) -> float:
        """Own one, over displacement."""
        return float(values[f"hysteresis_slope_{part.named}{axis}"])

    def reported(self, values: Values) -> Reported:
        """Friction, its stiffness before it slides, and what it is at low speed."""
        told = dict(super().reported(values))
        for part, axis, _ in self._laws(values):
            units = {"low_speed_viscous": part.damping, "low_speed_decay": f"s/{part.per}"}
            for key, unit in units.items():
                name = f"{key}_{part.named}{axis}"
                told[name] = (float(values[name]), unit)
        return told


class FrictionOfGuideAndMotor(LowSpeedFriction):
    """Friction of guides and motor of an axis.

    Between two parts that hold lies what is compliant: with one of them a stiffness, a gain or a
    delay that is not as declared would stand for the other.
    """

    def __init__(self, found: AxisFriction) -> None:
        super().__init__(found)
        self.parts = (GUIDE, MOTOR)


class StribeckFriction(AxisFriction):
    """Friction of an axis that is higher at low speed: a LuGre law where one was found to rub.

    Its bristles are as stiff at rest, for their friction, as the law without a Stribeck curve.
    """

    def __init__(self, found: AxisFriction) -> None:
        super().__init__(found.number)
        self._found = found
        self.parts = found.parts

    @property
    def richer(self) -> tuple[Effect, ...]:
        """None."""
        return ()

    def applies(self, measurement: Measurement) -> bool:
        """Of an axis that moves in records and has no friction declared at that part."""
        return "drive" in measurement.kinds and self._found.applies(measurement)

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Those of the friction found, and what it is more at the onset of sliding."""
        axis = self.axis(measurement)
        (part,) = self.parts
        size, (velocity, unit) = part.sizes["coulomb"], part.velocity
        return [
            *super().parameters(measurement),
            free(f"onset_{part.named}{axis}", 0.0, size, part.force, lower=0.0),
            Parameter(
                f"stribeck_velocity_{part.named}{axis}",
                velocity, velocity, 0.02 * velocity, 50.0 * velocity, True, unit,
            ),
        ]  # fmt: skip

    def starts(self, measurement: Measurement) -> list[Values]:
        """Frictions, and Stribeck curves that are low and high, steep and flat."""
        axis = self.axis(measurement)
        (part,) = self.parts
        typical, (velocity, _) = part.sizes, part.velocity
        return [
            {
                f"coulomb_{part.named}{axis}": share * typical["coulomb"],
                f"viscous_{part.named}{axis}": typical["viscous"],
                f"onset_{part.named}{axis}": onset * share * typical["coulomb"],
                f"stribeck_velocity_{part.named}{axis}": fall * velocity,
            }
            for share, onset, fall in itertools.product(_SLIDING, _ONSETS, _FALLS)
        ]

    def _law_keys(
        self, part: RubbingPart, axis: str, own: Values, values: Values
    ) -> dict[str, object]:
        """LuGre law with its Stribeck curve."""
        return {
            "law": "lugre",
            "static": own["coulomb"] + float(values[f"onset_{part.named}{axis}"]),
            "stribeck_velocity": float(values[f"stribeck_velocity_{part.named}{axis}"]),
            "bristle_stiffness": _stiffness(part.hysteresis_slope, own["coulomb"]),
        }

    def reported(self, values: Values) -> Reported:
        """Friction with its stiffness, and its Stribeck curve."""
        told = dict(super().reported(values))
        (part,) = self.parts
        for name, value in values.items():
            if name.startswith(f"onset_{part.named}"):
                told[name] = (float(value), part.force)
            elif name.startswith("stribeck_velocity_"):
                told[name] = (float(value), part.velocity[1])
        return told


def _stiffness(slope: float, coulomb: float) -> float:
    """Stiffness of a friction at rest: of a branch that begins there, twice slope times force."""
    return 2.0 * slope * coulomb
