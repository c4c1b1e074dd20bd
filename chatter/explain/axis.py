"""Axis moves: the motor's force predicted along the measured motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import scipy.ndimage
import scipy.signal
from numpy.typing import NDArray

from chatter.case import Case
from chatter.errors import InputError
from chatter.explain.fitting import Parameter
from chatter.explain.measurement import USABLE, Measurement, Run
from chatter.explain.problem import scaled_difference
from chatter.explain.tolerance import tolerated
from dynamics.axis_force import AxisForce

#: low pass of motion and force alike, and samples kept a cycle of it
_CUT_OFF = 0.08  # of the sampling frequency
_KEPT = 4
_MOTION_CUT_OFF = 0.15
#: speed below which noise decides on the direction, m/s, and how much less a sample there counts
_NEAR_REST, _DOUBT = 1e-4, 20.0
#: weight of the low pass on samples that can be used from which on one kept is used
_ALL_USABLE = 0.999
#: samples on either side, and degree, of the polynomials through a motion that creeps
_BESIDE, _DEGREE = 40, 3
#: samples on either side of a reversal in which noise decides on the direction
_TURNING = 3
#: signals at the samples kept
_KEPT_COLUMNS = ("force", "time", "position", "velocity", "certainty", "certainty of error")
_NEEDED = ("time", "position", "force")


class Axis:
    """Moves of a feed axis, whose motion is measured along with the force."""

    name = "axis"

    def channels(self, run: Run) -> tuple[str, ...]:  # noqa: ARG002
        """The force alone."""
        return ("force",)

    def prepared(self, measurement: Measurement) -> Measurement:
        """Measurement whose force went through the low pass that the prediction goes through.

        Raises
        ------
        InputError
            If a run lacks a channel.
        """
        runs, begun = [], 0.0
        for run in measurement.runs:
            missing = [name for name in _NEEDED if name not in run.signals]
            if missing:
                raise InputError(f"{run.name}: channel {', '.join(missing)} is missing")
            runs.append(replace(run, signals=_prepared(run.signals, begun)))
            begun += float(run.signals["time"][-1] - run.signals["time"][0])
        return replace(measurement, runs=tuple(runs)).in_parts(_KEPT_COLUMNS)

    def predict(self, case: Case, run: Run) -> Mapping[str, NDArray[np.float64]]:
        """Force at the samples kept, N."""
        signals = run.signals
        force = axis_force(case).along(
            signals["motion position"],
            signals["motion velocity"],
            signals["motion acceleration"],
            float(signals["motion step"][0]),
            float(signals["motion begun"][0]),
        )
        begin, end = signals.get("part", (0, None))
        return {"force": _kept(force)[begin:end]}

    def residuals(self, case: Case, run: Run, noise: Mapping[str, float]) -> NDArray[np.float64]:
        """Predicted less measured over the noise, which near rest is that of the direction too."""
        return scaled_difference(self, case, run, noise) * run.signals["certainty"]

    def weights(self, run: Run) -> NDArray[np.float64]:
        """Weight (n,) of the samples of a run in its error."""
        return run.signals["certainty of error"]

    def uncertain(self, measurement: Measurement) -> list[Parameter]:
        """Mass and frictions that are declared."""
        axis = measurement.case.axis
        keys = (
            "moving_mass",
            "viscous_friction",
            "coulomb_friction",
            "static_friction",
            "stribeck_velocity",
            "presliding_stiffness",
            "presliding_damping",
            "quadratic_drag",
        )
        return tolerated(measurement, [f"axis.{key}" for key in keys if getattr(axis, key)])


def axis_force(case: Case) -> AxisForce:
    """Force law of the axis of a case."""
    axis = case.axis
    cogging, warm_up = axis.cogging, axis.warm_up
    return AxisForce(
        mass=axis.moving_mass,
        viscous=axis.viscous_friction,
        coulomb=axis.coulomb_friction,
        static=axis.static_friction,
        stribeck_velocity=axis.stribeck_velocity or 0.01,
        presliding_stiffness=axis.presliding_stiffness,
        presliding_damping=axis.presliding_damping,
        asymmetry=axis.asymmetry,
        offset=axis.offset,
        quadratic_drag=axis.quadratic_drag,
        cogging_amplitude=cogging.amplitude if cogging else 0.0,
        cogging_period=cogging.period if cogging else 0.01,
        cogging_phase=cogging.phase if cogging else 0.0,
        backlash=axis.backlash,
        warm_up_share=warm_up.share if warm_up else 0.0,
        warm_up_time=warm_up.time if warm_up else 1.0,
    )


def _prepared(signals: Mapping[str, NDArray], begun: float) -> dict[str, NDArray[np.float64]]:
    step = float(np.median(np.diff(signals["time"])))
    position = _smooth(signals["position"], _MOTION_CUT_OFF)
    velocity = _velocity(position, step)
    force = _kept(signals["force"])
    usable = _kept(signals.get(USABLE, np.ones(velocity.size))) > _ALL_USABLE
    turning = np.abs(np.diff(np.sign(velocity), prepend=0.0)) > 0.0
    turning = scipy.ndimage.maximum_filter1d(turning, 2 * _TURNING + 1)
    at_rest = np.abs(velocity) < _NEAR_REST
    return {
        "time": signals["time"][::_KEPT][: force.size],
        "force": force,
        "position": _kept(signals["position"]),
        "velocity": _kept(velocity),
        "certainty": _certainty(at_rest) * usable,
        "certainty of error": _certainty(at_rest | turning) * usable,
        "motion position": position,
        "motion velocity": velocity,
        "motion acceleration": np.gradient(velocity, step),
        "motion step": np.array([step]),
        "motion begun": np.array([begun]),
    }


def _certainty(doubtful: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Weight of the samples kept, less where samples are doubtful."""
    return 1.0 / (1.0 + _DOUBT * np.clip(_kept(doubtful.astype(np.float64)), 0.0, 1.0))


def _velocity(position: NDArray[np.float64], step: float) -> NDArray[np.float64]:
    """Velocity (n,), m/s; where the axis creeps, over more samples.

    Near rest the direction of friction hangs on velocities that are far below the noise of a
    difference of positions.
    """
    velocity = np.gradient(position, step)
    nearby = scipy.ndimage.maximum_filter1d(np.abs(velocity), 2 * _BESIDE + 1)
    creeping = scipy.signal.savgol_filter(position, 2 * _BESIDE + 1, _DEGREE, 1, step)
    return np.where(nearby < _NEAR_REST, creeping, velocity)


def _smooth(values: NDArray[np.float64], cut_off: float) -> NDArray[np.float64]:
    sections = scipy.signal.butter(4, 2.0 * cut_off, output="sos")
    return scipy.signal.sosfiltfilt(sections, values)


def _kept(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return _smooth(values, _CUT_OFF)[::_KEPT]
