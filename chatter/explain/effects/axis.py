"""Effects of a feed axis."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from chatter.description.case import Case
from chatter.explain.kinds.kind import Effect
from chatter.explain.measurement import Measurement
from chatter.explain.selection.fitting import Parameter

Values = Mapping[str, float]
_KIND = ("axis",)


def _free(name: str, start: float, size: float, unit: str, **bounds: float) -> Parameter:
    return Parameter(name, start, size, prior=False, unit=unit, **bounds)


def _typical_force(measurement: Measurement) -> float:
    forces = np.concatenate([run.signals["force"] for run in measurement.runs])
    return float(np.median(np.abs(forces)))


def _named(**units: str):
    """Numbers to tell: the parameters under the names of the laws."""

    def told(values: Values) -> Mapping[str, tuple[float, str]]:
        return dict(zip(units, zip(values.values(), units.values(), strict=True), strict=True))

    return told


def _keys(*names: str):
    """Patch that writes values to keys of [axis]."""

    def patch(case: Case, values: Values) -> dict[str, Any]:  # noqa: ARG001
        return {f"axis.{name}": float(values[name]) for name in names}

    return patch


def _force(name: str, **bounds: float):
    def parameters(measurement: Measurement) -> Sequence[Parameter]:
        return [_free(name, 0.0, 0.05 * _typical_force(measurement), "N", **bounds)]

    return parameters


def _coulomb_of(measurement: Measurement) -> float:
    return measurement.case.axis.coulomb_friction or _typical_force(measurement)


def _stribeck_parameters(measurement: Measurement) -> Sequence[Parameter]:
    coulomb = _coulomb_of(measurement)
    return [
        _free("above", 0.1 * coulomb, 0.1 * coulomb, "N", lower=0.0, upper=3.0 * coulomb),
        _free("stribeck_velocity", 5e-3, 2e-3, "m/s", lower=1e-3, upper=0.3),
    ]


def _stribeck(case: Case, values: Values) -> dict[str, Any]:
    return {
        "axis.static_friction": case.axis.coulomb_friction + float(values["above"]),
        "axis.stribeck_velocity": float(values["stribeck_velocity"]),
    }


def _presliding_parameters(measurement: Measurement) -> Sequence[Parameter]:
    # sliding begins after some micrometres
    stiffness = _coulomb_of(measurement) / 3e-5
    return [
        _free("presliding_stiffness", stiffness, 0.3 * stiffness, "N/m", lower=1e-3 * stiffness),
        _free("presliding_damping", 1e3, 1e3, "N*s/m", lower=0.0),
    ]


def _presliding_starts(measurement: Measurement) -> Sequence[Values]:
    coulomb = _coulomb_of(measurement)
    return [
        {"presliding_stiffness": coulomb / way, "presliding_damping": 500.0}
        for way in (3e-6, 1e-5, 4e-5, 2e-4)
    ]


def _cogging_parameters(measurement: Measurement) -> Sequence[Parameter]:
    force = 0.05 * _typical_force(measurement)
    return [
        _free("sine", 0.0, force, "N"),
        _free("cosine", 0.0, force, "N"),
        _free("period", 0.01, 2e-5, "m", lower=2e-4, upper=0.5),
    ]


def _cogging(case: Case, values: Values) -> dict[str, Any]:  # noqa: ARG001
    amplitude = math.hypot(values["sine"], values["cosine"])
    phase = math.atan2(values["cosine"], values["sine"])
    return {
        "axis.cogging": {
            "amplitude": amplitude,
            "period": float(values["period"]),
            "phase": phase % (2.0 * math.pi),
        }
    }


def _cogging_told(values: Values) -> Mapping[str, tuple[float, str]]:
    phase = math.atan2(values["cosine"], values["sine"])
    return {
        "amplitude": (math.hypot(values["sine"], values["cosine"]), "N"),
        "period": (values["period"], "m"),
        "phase": (phase % (2.0 * math.pi), "rad"),
    }


def _cogging_starts(measurement: Measurement) -> Sequence[Values]:
    travel = max(float(np.ptp(run.signals["position"])) for run in measurement.runs)
    count = 60
    # evenly spaced in turns over the travel, so that none is missed
    return [{"period": travel / turns} for turns in np.linspace(1.0, 20.0, count)]


def _backlash_parameters(measurement: Measurement) -> Sequence[Parameter]:
    gap = _free("backlash", 2e-5, 5e-6, "m", lower=0.0, upper=1e-3)
    if not _motor_seen(measurement):
        return [gap]
    mass = measurement.case.axis.moving_mass
    return [gap, _free("motor_mass", 0.2 * mass, 0.05 * mass, "kg", lower=0.0, upper=mass)]


def _motor_seen(measurement: Measurement) -> bool:
    """Whether the motion of the motor was measured beside that of the slide."""
    return any("play" in run.signals for run in measurement.runs)


def _backlash(case: Case, values: Values) -> dict[str, Any]:  # noqa: ARG001
    return {f"axis.{key}": float(value) for key, value in values.items()}


def _backlash_starts(measurement: Measurement) -> Sequence[Values]:  # noqa: ARG001
    return [{"backlash": way} for way in (3e-6, 1e-5, 3e-5, 1e-4)]


def _warm_up_parameters(measurement: Measurement) -> Sequence[Parameter]:
    lasting = sum(float(np.ptp(run.signals["time"])) for run in measurement.runs)
    return [
        _free("share", 0.0, 0.05, "", lower=-0.9, upper=20.0),
        _free(
            "time", 0.4 * lasting, 0.2 * lasting, "s", lower=0.02 * lasting, upper=20.0 * lasting
        ),
    ]


def _warm_up(case: Case, values: Values) -> dict[str, Any]:  # noqa: ARG001
    return {"axis.warm_up": {key: float(values[key]) for key in ("share", "time")}}


def _drag_parameters(measurement: Measurement) -> Sequence[Parameter]:
    fastest = max(float(np.abs(run.signals["velocity"]).max()) for run in measurement.runs)
    size = 0.05 * _typical_force(measurement) / fastest**2
    return [_free("quadratic_drag", 0.0, size, "N*s^2/m^2", lower=0.0)]


def _dry(measurement: Measurement) -> bool:
    return measurement.case.axis.coulomb_friction > 0.0


AXIS_EFFECTS: tuple[Effect, ...] = (
    Effect(
        "coulomb_friction",
        _KIND,
        lambda m: not _dry(m),
        _force("coulomb_friction", lower=0.0),
        _keys("coulomb_friction"),
        says="a friction that does not depend on speed opposes every motion",
        told=_named(coulomb="N"),
    ),
    Effect(
        "stribeck",
        _KIND,
        lambda m: m.case.axis.static_friction is None,
        _stribeck_parameters,
        _stribeck,
        says="friction is higher at low speed",
    ),
    Effect(
        "presliding",
        _KIND,
        lambda m: m.case.axis.presliding_stiffness is None,
        _presliding_parameters,
        _keys("presliding_stiffness", "presliding_damping"),
        _presliding_starts,
        says="friction is a spring before it slides",
        told=_named(sigma0="N/m", sigma1="N*s/m"),
    ),
    Effect(
        "asymmetry",
        _KIND,
        lambda m: not m.case.axis.asymmetry,
        _force("asymmetry"),
        _keys("asymmetry"),
        says="friction differs with the direction",
    ),
    Effect(
        "offset",
        _KIND,
        lambda m: not m.case.axis.offset,
        _force("offset"),
        _keys("offset"),
        says="a constant force is held, as of weight",
    ),
    Effect(
        "quadratic_drag",
        _KIND,
        lambda m: not m.case.axis.quadratic_drag,
        _drag_parameters,
        _keys("quadratic_drag"),
        says="resistance grows with the square of speed",
    ),
    Effect(
        "cogging",
        _KIND,
        lambda m: m.case.axis.cogging is None,
        _cogging_parameters,
        _cogging,
        _cogging_starts,
        says="a force repeats along the axis",
        told=_cogging_told,
    ),
    Effect(
        "backlash",
        _KIND,
        lambda m: not m.case.axis.backlash,
        _backlash_parameters,
        _backlash,
        _backlash_starts,
        says="the motor crosses a gap at every reversal",
    ),
    Effect(
        "warm_up",
        _KIND,
        lambda m: m.case.axis.warm_up is None,
        _warm_up_parameters,
        _warm_up,
        says="friction falls while the axis moves",
    ),
)
