"""Axis moves: the motor's force predicted along the measured motion."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import scipy.integrate
import scipy.ndimage
import scipy.signal
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.explain.measurement import USABLE, Measurement, Run
from chatter.explain.residuals.noise import white_level
from chatter.explain.selection.fitting import Parameter
from chatter.explain.selection.prior import tolerated
from chatter.explain.selection.problem import scaled_difference
from dynamics.friction.axis_force import AxisForce

#: low pass of motion and force alike, and samples kept a cycle of it
_CUT_OFF = 0.08  # of the sampling frequency
_KEPT = 4
_MOTION_CUT_OFF, _FINER_CUT_OFF = 0.15, 0.3
#: speed of an axis that creeps, m/s
_NEAR_REST = 1e-4
#: weight of the low pass on samples that can be used from which on one kept is used
_ALL_USABLE = 0.999
#: samples on either side, and degree, of the polynomials through a motion that creeps
_BESIDE, _DEGREE = 40, 3
#: standard deviations of the noise from which the motor runs ahead
_AHEAD = 12.0
#: samples kept on either side for which a doubt holds, and at the ends, and the least weight
_NEARBY, _ENDS, _LEAST_CERTAIN = 1, 8, 0.02
#: share of a dry friction that is in doubt while an axis creeps
_CREEP_DOUBT = 0.1
#: share of the force to which it can be followed along a motion that was measured
_FOLLOWED = 0.01
#: signals at the samples kept
_KEPT_COLUMNS = ("force", "time", "position", "velocity", "certainty")
_PLAY_COLUMNS = ("play", "play certainty")
#: share of the usual force from which on its sign says which flank of a backlash drives
_DRIVES = 0.3
#: samples kept on either side of a crossing of the backlash, and their weight
_CROSSING, _IN_CROSSING = 8, 0.02
_NEEDED = ("time", "position", "force")


class Axis:
    """Moves of a feed axis, whose motion is measured along with the force."""

    name = "axis"
    #: the noise is known from the scatter of the signals themselves
    noise_is_white = False

    def channels(self, run: Run) -> tuple[str, ...]:
        """The force, and the way of the motor ahead of the slide where there is any."""
        return ("force", "play") if "play" in run.signals else ("force",)

    def judged(self, run: Run) -> tuple[str, ...]:  # noqa: ARG002
        """Channel whose error is told."""
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
        rubbing, ahead = _rubbing(measurement), _runs_ahead(measurement)
        for run in measurement.runs:
            signals = _prepared(run.signals, begun, rubbing)
            signals |= _of_motor(measurement.case, run.signals, signals) if ahead else {}
            runs.append(replace(run, signals=signals))
            begun += float(run.signals["time"][-1] - run.signals["time"][0])
        return replace(measurement, runs=tuple(runs)).in_parts(
            (*_KEPT_COLUMNS, *_PLAY_COLUMNS) if ahead else _KEPT_COLUMNS
        )

    def reweighted(self, measurement: Measurement, case: Case) -> Measurement:
        """Measurement whose samples count as far as the force of a case is certain there."""
        runs = []
        for run in measurement.runs:
            law = replace(axis_force(run.of(case)), backlash=0.0)
            begin, end = run.signals.get("part", (0, None))
            certainty = _certainty(run.signals, law)[begin:end]
            runs.append(replace(run, signals={**run.signals, "certainty": certainty}))
        return replace(measurement, runs=tuple(runs))

    def predict(self, case: Case, run: Run) -> Mapping[str, NDArray[np.float64]]:
        """Force at the samples kept, N."""
        signals = run.signals
        force = axis_force(case).along(
            signals["motion position"],
            signals["motion velocity"],
            signals["motion acceleration"],
            float(signals["motion step"][0]),
            float(signals["motion begun"][0]),
            signals.get("motor acceleration"),
        )
        begin, end = signals.get("part", (0, None))
        found = {"force": _kept(force)[begin:end]}
        if "play" in signals:
            ahead = 0.5 * case.axis.backlash * _driven_way(_of_slide(case, signals))
            found["play"] = _centred(_kept(ahead), signals["whole play certainty"])[begin:end]
        return found

    def residuals(self, case: Case, run: Run, noise: Mapping[str, float]) -> NDArray[np.float64]:
        """Predicted less measured over the noise, which near rest is that of the direction too."""
        left = scaled_difference(self, case, run, noise)
        certainty = [
            run.signals[name] for name in ("certainty", "play certainty") if name in run.signals
        ]
        return left * np.concatenate(certainty)

    def weights(self, run: Run) -> NDArray[np.float64]:
        """Weight (n,) of the samples of a run in its error."""
        return run.signals["certainty"]

    def noise(self, run: Run) -> dict[str, float]:
        """Standard deviation of the noise of every channel."""
        noise = {"force": float(run.signals["noise"][0])}
        if "play" in run.signals:
            noise["play"] = float(run.signals["noise"][1])
        return noise

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
        motor_mass=axis.motor_mass or 0.0,
        warm_up_share=warm_up.share if warm_up else 0.0,
        warm_up_time=warm_up.time if warm_up else 1.0,
    )


def _rubbing(measurement: Measurement) -> AxisForce:
    """Force of the declared axis with a dry friction, of a typical size where none is declared."""
    declared = axis_force(measurement.case)
    forces = [np.median(np.abs(run.signals["force"])) for run in measurement.runs]
    coulomb = declared.coulomb or float(np.median(forces))
    return AxisForce(declared.mass, declared.viscous, coulomb)


def _prepared(
    signals: Mapping[str, NDArray], begun: float, rubbing: AxisForce
) -> dict[str, NDArray[np.float64]]:
    step = float(np.median(np.diff(signals["time"])))
    motion = _motion(signals["position"], step, _MOTION_CUT_OFF)
    force = _kept(signals["force"])
    prepared = {
        "time": signals["time"][::_KEPT][: force.size],
        "force": force,
        "position": _kept(signals["position"]),
        "velocity": _kept(motion[1]),
        "motion as measured": signals["position"],
        "motion position": motion[0],
        "motion velocity": motion[1],
        "motion acceleration": motion[2],
        "motion step": np.array([step]),
        "motion begun": np.array([begun]),
        "noise": np.array([_noise(signals["force"])]),
        "usable when kept": _kept(signals.get(USABLE, np.ones(motion[0].size))) > _ALL_USABLE,
    }
    return {**prepared, "certainty": _certainty(prepared, rubbing)}


def _motion(position: NDArray[np.float64], step: float, cut_off: float) -> tuple[NDArray, ...]:
    """Position, velocity and acceleration (n,) of a smoothed motion."""
    smooth = _smooth(position, cut_off)
    velocity = _velocity(smooth, step)
    return smooth, velocity, np.gradient(np.gradient(smooth, step), step)


def _certainty(prepared: Mapping[str, NDArray], rubbing: AxisForce) -> NDArray[np.float64]:
    """Weight of the samples kept: 1, or less where the force hangs on how the motion is smoothed.

    At a reversal a dry friction jumps within less than the motion is resolved to. How far off its
    force may be is seen from a motion smoothed less. Of an axis that creeps, the speed says little
    about a friction without presliding.
    """
    step, begun = float(prepared["motion step"][0]), float(prepared["motion begun"][0])
    forces = [
        _kept(rubbing.along(*_motion(prepared["motion as measured"], step, cut_off), step, begun))
        for cut_off in (_MOTION_CUT_OFF, _FINER_CUT_OFF)
    ]
    doubt = scipy.ndimage.maximum_filter1d(np.abs(forces[1] - forces[0]), 2 * _NEARBY + 1)
    if rubbing.presliding_stiffness is None:
        creeps = np.abs(prepared["motion velocity"]) < _NEAR_REST
        doubt += (
            _CREEP_DOUBT * rubbing.coulomb * np.clip(_kept(creeps.astype(np.float64)), 0.0, 1.0)
        )
    certainty = 1.0 / np.hypot(1.0, doubt / max(float(prepared["noise"][0]), 1e-12))
    certainty[:_ENDS] = certainty[-_ENDS:] = _LEAST_CERTAIN
    return np.maximum(certainty, _LEAST_CERTAIN) * prepared["usable when kept"]


def _noise(force: NDArray[np.float64]) -> float:
    """Standard deviation, N, of the force about what can be told of it along a motion."""
    return math.hypot(_noise_of(force), _FOLLOWED * float(np.sqrt(np.mean(force**2))))


def _noise_of(signal: NDArray[np.float64]) -> float:
    """Standard deviation of the noise of a signal at the samples kept."""
    # second differences of white noise have six times its variance; the low pass takes the rest
    return white_level(np.diff(signal, 2)) * math.sqrt(2.0 * _CUT_OFF / 6.0)


def _slip(signals: Mapping[str, NDArray]) -> NDArray[np.float64]:
    """Velocity (n,), m/s, of the motor's encoder beyond that of the position."""
    step = float(np.median(np.diff(signals["time"])))
    return signals["velocity"] - np.gradient(_smooth(signals["position"], _MOTION_CUT_OFF), step)


def _runs_ahead(measurement: Measurement) -> bool:
    """Whether the motor's velocity is not that of the position, but runs ahead of it at times."""
    if any("velocity" not in run.signals for run in measurement.runs):
        return False
    slips = [_slip(run.signals) for run in measurement.runs]
    return any(np.abs(_kept(slip)[_ENDS:-_ENDS]).max() > _AHEAD * _noise_of(slip) for slip in slips)


def _of_motor(
    case: Case, signals: Mapping[str, NDArray], prepared: Mapping[str, NDArray]
) -> dict[str, NDArray[np.float64]]:
    """Motion of the motor from its velocity, and its way ahead of the slide."""
    step = float(np.median(np.diff(signals["time"])))
    motor = scipy.integrate.cumulative_trapezoid(signals["velocity"], dx=step, initial=0.0)
    play = _kept(motor - signals["position"])
    crossing = np.abs(np.diff(_driven_way(_of_slide(case, prepared)), prepend=0.0)) > 0.0
    near = scipy.ndimage.maximum_filter1d(_kept_any(crossing), 2 * _CROSSING + 1)
    certainty = np.where(near, _IN_CROSSING, 1.0)
    # what noise of the velocity adds up to
    drift = white_level(_slip(signals)) * step * math.sqrt(motor.size)
    smooth = _smooth(signals["velocity"], _MOTION_CUT_OFF)
    return {
        "motor acceleration": np.gradient(smooth, step),
        "play": _centred(play, certainty),
        "play certainty": certainty,
        "whole play certainty": certainty,
        "noise": np.array([_noise(signals["force"]), drift]),
    }


def _of_slide(case: Case, signals: Mapping[str, NDArray]) -> NDArray[np.float64]:
    """Force (n,), N, that the slide asks of its drive."""
    names = ("motion position", "motion velocity", "motion acceleration")
    law = replace(axis_force(case), backlash=0.0, motor_mass=0.0)
    return law.along(*(signals[name] for name in names), float(signals["motion step"][0]))


def _driven_way(force: NDArray[np.float64]) -> NDArray[np.float64]:
    """Which flank drives, 1 or -1, (n,); where there is hardly a force, the one that did."""
    drives = np.abs(force) > _DRIVES * np.median(np.abs(force))
    place = np.maximum.accumulate(np.where(drives, np.arange(force.size), 0))
    return np.sign(force)[place]


def _kept_any(flags: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether any of the samples about those kept is flagged."""
    return scipy.ndimage.maximum_filter1d(flags, 2 * _KEPT + 1)[::_KEPT]


def _centred(values: NDArray[np.float64], weight: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values without their weighted mean, which the motor's encoder does not know."""
    return values - np.average(values, weights=weight)


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
