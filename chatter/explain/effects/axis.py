"""Effects of a feed axis: its friction, offset, cogging."""

from collections.abc import Collection, Mapping
from typing import ClassVar

import numpy as np

from chatter.description.case import Case
from chatter.explain.effects.effect import Effect, Patch, Reported, Signals, Values, free, polar
from chatter.explain.effects.sines_of_position import LEAST_PERIOD, strongest_sines
from chatter.explain.measurement import Measurement, Run
from chatter.explain.parameters import Parameter

#: speed below which an axis rests or creeps, m/s, and samples kept for which it does at the least:
#: more than the low pass of the force spreads a jump over
_AT_REST, _LEAST_RESTING = 1e-4, 8


def typical_force(measurement: Measurement) -> float:
    """Median of the absolute force of all moves, N."""
    forces = np.concatenate([run.signals["force"] for run in measurement.runs])
    return float(np.median(np.abs(forces)))


def _coulomb_of(measurement: Measurement) -> float:
    return measurement.case.axis.coulomb_friction or typical_force(measurement)


def has_dry_friction(measurement: Measurement, effects: Collection[str]) -> bool:
    """Whether a dry friction is declared, or is among effects that were found."""
    return bool(measurement.case.axis.coulomb_friction) or CoulombFriction.name in effects


def rests_without_force(run: Run) -> bool:
    """Whether an axis rests some time in a move while its force is no more than noise."""
    resting = np.abs(run.signals["velocity"]) < _AT_REST
    intervals = np.flatnonzero(np.diff(resting, prepend=False, append=False)).reshape(-1, 2)
    return any(
        end - begin >= _LEAST_RESTING
        and abs(float(np.mean(run.signals["force"][begin:end]))) < run.record.noise["force"]
        for begin, end in intervals
    )


class AxisValue(Effect):
    """A value of [axis] under the name of the effect, of the size of a share of the typical force.

    Bounds of the value are "lower" and "upper".
    """

    kinds = ("axis",)
    section = "axis"
    unit = "N"

    def __init__(self, **bounds: float) -> None:
        self.bounds = bounds

    def applies(self, measurement: Measurement) -> bool:
        """Where no value is declared."""
        return not getattr(measurement.case.axis, self.name)

    def size(self, measurement: Measurement) -> float:
        """Typical size of the value."""
        return 0.05 * typical_force(measurement)

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """The value."""
        return [free(self.name, 0.0, self.size(measurement), self.unit, **self.bounds)]


class CoulombFriction(AxisValue):
    """Coulomb friction."""

    name = "coulomb_friction"
    label = "Coulomb friction"
    help = "a friction that does not depend on speed opposes every motion"

    def reported(self, values: Values) -> Reported:
        """The friction."""
        return {"coulomb": (values[self.name], "N")}


class Asymmetry(AxisValue):
    """Friction that differs with the direction."""

    name = "asymmetry"
    label = "asymmetry of friction"
    help = "friction differs with the direction"

    def applies_beside(self, measurement: Measurement, others: Collection[str]) -> bool:
        """Where there is a dry friction; of none, a difference would drive the axis one way."""
        return has_dry_friction(measurement, others)


class QuadraticDrag(AxisValue):
    """Resistance with the square of speed."""

    name = "quadratic_drag"
    label = "quadratic drag"
    help = "resistance grows with the square of speed"
    unit = "N*s^2/m^2"

    def size(self, measurement: Measurement) -> float:
        """Typical size of the value."""
        fastest = max(float(np.abs(run.signals["velocity"]).max()) for run in measurement.runs)
        return super().size(measurement) / fastest**2


class Stribeck(Effect):
    """Static friction above the Coulomb friction."""

    name = "stribeck"
    label = "Stribeck friction"
    help = "friction is higher at low speed"
    kinds = ("axis",)

    def applies(self, measurement: Measurement) -> bool:
        """Where no static friction is declared."""
        return measurement.case.axis.static_friction is None

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Static friction above the Coulomb friction, and Stribeck velocity."""
        coulomb = _coulomb_of(measurement)
        return [
            free("above", 0.1 * coulomb, 0.1 * coulomb, "N", lower=0.0, upper=3.0 * coulomb),
            free("stribeck_velocity", 5e-3, 2e-3, "m/s", lower=1e-3, upper=0.3),
        ]

    def nothing(self, measurement: Measurement) -> Values:
        """No friction above the Coulomb friction."""
        return {"above": 0.0}

    def patch(self, case: Case, values: Values) -> Patch:
        """Static friction and Stribeck velocity."""
        return {
            "axis.static_friction": case.axis.coulomb_friction + float(values["above"]),
            "axis.stribeck_velocity": float(values["stribeck_velocity"]),
        }


class Presliding(Effect):
    """Stiffness and damping of friction before it slides."""

    name = "presliding"
    label = "presliding"
    help = "friction is a spring before it slides"
    kinds = ("axis",)
    section = "axis"
    declared = "axis.presliding_stiffness"

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Stiffness and damping."""
        # sliding begins after some micrometres
        k = _coulomb_of(measurement) / 3e-5
        return [
            free("presliding_stiffness", k, 0.3 * k, "N/m", lower=1e-3 * k),
            free("presliding_damping", 1e3, 1e3, "N*s/m", lower=0.0),
        ]

    def starts(self, measurement: Measurement) -> list[Values]:
        """Travels before sliding."""
        coulomb = _coulomb_of(measurement)
        return [
            {"presliding_stiffness": coulomb / travel, "presliding_damping": 500.0}
            for travel in (3e-6, 1e-5, 4e-5, 2e-4)
        ]

    def reported(self, values: Values) -> Reported:
        """Under the names of the LuGre model."""
        return {
            "sigma0": (values["presliding_stiffness"], "N/m"),
            "sigma1": (values["presliding_damping"], "N*s/m"),
        }


class WarmUp(Effect):
    """Friction that falls from a share above its later value."""

    name = "warm_up"
    label = "warm-up"
    help = "friction falls while the axis moves"
    kinds = ("axis",)
    section = "axis.warm_up"
    declared = "axis.warm_up"
    begins: ClassVar[str] = "day"

    @property
    def variants(self) -> tuple[Effect, ...]:
        """Over the day, or within every move."""
        return (self, WarmUpOfMove())

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Share and time."""
        total = sum(float(np.ptp(run.signals["time"])) for run in measurement.runs)
        return [
            free("share", 0.0, 0.05, "", lower=-0.9, upper=20.0),
            free("time", 0.4 * total, 0.2 * total, "s", lower=0.02 * total, upper=20.0 * total),
        ]

    def patch(self, case: Case, values: Values) -> Patch:
        """Warm-up of the axis, and from when on."""
        return {**super().patch(case, values), "axis.warm_up.begins": self.begins}


class WarmUpOfMove(WarmUp):
    """Friction that falls within each move and is back at the next."""

    begins = "move"

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Share and time."""
        longest = max(float(np.ptp((run.whole or run).signals["time"])) for run in measurement.runs)
        bounds = {"lower": 0.01 * longest, "upper": 10.0 * longest}
        return [
            free("share", 0.0, 0.05, "", lower=-0.9, upper=20.0),
            free("time", 0.3 * longest, 0.1 * longest, "s", **bounds),
        ]

    def starts(self, measurement: Measurement) -> list[Values]:
        """Times from short to long."""
        longest = self.parameters(measurement)[1].start / 0.3
        return [{"share": 0.1, "time": share * longest} for share in (0.05, 0.15, 0.5)]


class Offset(AxisValue):
    """Constant force."""

    name = "offset"
    label = "constant force"
    help = "a constant force is held, as of weight"

    def applies_beside(self, measurement: Measurement, others: Collection[str]) -> bool:
        """Where a dry friction may hold it at rest, or no rest is known to be free of force."""
        if has_dry_friction(measurement, others):
            return True
        runs = {id(run.whole or run): run.whole or run for run in measurement.runs}
        return not any(rests_without_force(run) for run in runs.values())


class Cogging(Effect):
    """Sine of the position, as two components so that none is singular where there is none."""

    name = "cogging"
    label = "cogging"
    help = "a force repeats along the axis"
    kinds = ("axis",)
    declared = "axis.cogging"

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Both components, and the period."""
        force = 0.05 * typical_force(measurement)
        return [
            free("sine", 0.0, force, "N"),
            free("cosine", 0.0, force, "N"),
            free("period", 0.01, 2e-5, "m", lower=LEAST_PERIOD, upper=0.5),
        ]

    def patch(self, case: Case, values: Values) -> Patch:
        """Cogging of the axis."""
        return {"axis.cogging": {key: value for key, (value, _) in self.reported(values).items()}}

    def starts(self, measurement: Measurement) -> list[Values]:
        """None: the residual proposes the periods."""
        return []

    def proposed(self, measurement: Measurement, predicted: Mapping[str, Signals]) -> list[Values]:
        """Sines of the position that take most of the residual force away."""
        runs = [run for run in measurement.runs if "force" in predicted.get(run.name, {})]
        if not runs:
            return []
        position = np.concatenate([run.signals["position"] for run in runs])
        force = np.concatenate(
            [run.signals["force"] - predicted[run.name]["force"] for run in runs]
        )
        weight = np.concatenate(
            [run.weight("force") * np.ones(run.signals["force"].size) for run in runs]
        )
        return [
            {"sine": sine, "cosine": cosine, "period": period}
            for sine, cosine, period in strongest_sines(position, force, weight**2)
        ]

    def reported(self, values: Values) -> Reported:
        """Amplitude, period and phase."""
        amplitude, phase = polar(values["sine"], values["cosine"])
        return {
            "amplitude": (amplitude, "N"),
            "period": (float(values["period"]), "m"),
            "phase": (phase, "rad"),
        }
