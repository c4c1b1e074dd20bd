"""Axis moves: the motor's force predicted along the measured motion."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from chatter.description.case import Case
from chatter.explain.data_checks.clock import clock_check
from chatter.explain.data_checks.motion import wrong_motion
from chatter.explain.data_checks.samples import Columns, dropouts, sample_checks
from chatter.explain.kinds import axis_record
from chatter.explain.kinds.axis_record import AxisRecord
from chatter.explain.kinds.kind import Kind, Noise, Signals, Trial
from chatter.explain.measurement import Measurement, Run
from chatter.explain.parameters import Parameter, with_priors
from chatter.explain.residuals.by_channel import by_channel
from chatter.explain.residuals.over_runs import over_runs
from chatter.explain.residuals.over_variable import over_period, over_variable
from chatter.explain.residuals.variables import (
    AXIS_CONDITIONS,
    AXIS_FORMS,
    AXIS_MEASURES,
    AXIS_VARIABLES,
)
from dynamics.friction.axis_force import AxisForce

#: steps of the clock that no record of a move has, s
_LONGEST_STEP = 0.2
_COLUMNS = Columns(
    ("position", "force", "velocity", "command"),
    needed=("position", "force"),
    optional=("velocity", "command"),
    may_rest=("command",),
)
#: of a discriminating test: rate of samples, Hz, time, s, and the slow speed over the fastest
_RATE, _LASTING, _SLOW = 1000.0, 1.0, 0.02
#: parts of a few moves: short ones, so that holdout parts lie among those fitted
_PARTS = 12
#: typical delay between the channels of a record, and the longest, over the time of a sample
_DELAY, _LONGEST_DELAY = 0.5, 20.0
#: values of an axis that are declared
_DECLARED = (
    "moving_mass",
    "viscous_friction",
    "coulomb_friction",
    "static_friction",
    "stribeck_velocity",
    "presliding_stiffness",
    "presliding_damping",
    "quadratic_drag",
)


class Axis(Kind):
    """Moves of a feed axis, whose motion is measured along with the force."""

    name = "axis"
    sections = ("axis",)
    estimates_noise = False
    columns = (("time",), ("position",), ("force",))
    variables = AXIS_VARIABLES
    forms = AXIS_FORMS
    conditions = AXIS_CONDITIONS
    measures = AXIS_MEASURES
    periodic_variable = "position"
    sources = ("force",)
    diagnostics = (
        by_channel,
        over_variable("velocity"),
        over_variable("direction"),
        over_variable("travel since reversal"),
        over_variable("position"),
        over_period("position"),
        over_variable("acceleration"),
        over_runs,
    )
    checks = (
        (*sample_checks(_COLUMNS), dropouts(_COLUMNS), clock_check(_LONGEST_STEP)),
        (wrong_motion,),
    )

    def channels(self, run: Run) -> tuple[str, ...]:
        """The force, and the travel of the motor ahead of the slide where there is any."""
        return ("force", "backlash") if "backlash" in run.signals else ("force",)

    def reported_channels(self, run: Run) -> tuple[str, ...]:
        """Channel whose error is reported."""
        return ("force",)

    def prepared(self, measurement: Measurement) -> Measurement:
        """Return the measurement whose force went through the low pass of the prediction."""
        law = axis_force(measurement.case)
        forces = [np.median(np.abs(run.signals["force"])) for run in measurement.runs]
        # a dry friction of a typical size where none is declared
        rubbing = AxisForce(law.mass, law.viscous, law.coulomb or float(np.median(forces)))
        ahead = axis_record.motor_runs_ahead(measurement.runs)
        runs, begun = [], 0.0
        for run in measurement.runs:
            made = axis_record.prepared(run, begun, rubbing)
            runs.append(
                axis_record.with_motor(made, run, _slide_force(law, made)) if ahead else made
            )
            begun += float(run.signals["time"][-1] - run.signals["time"][0])
        return measurement.with_runs(runs).in_parts(_PARTS)

    def refined(self, measurement: Measurement, case: Case) -> Measurement:
        """Return the measurement whose samples count as far as the force of a case is certain."""
        runs = []
        for run in measurement.runs:
            law = replace(axis_force(run.of(case)), backlash=0.0)
            weights = axis_record.force_weights(run.record, law)
            force = weights if run.part is None else weights[run.part]
            runs.append(replace(run, weights={**run.weights, "force": force}))
        return measurement.with_runs(runs)

    def predict(self, case: Case, run: Run) -> Signals:
        """Force at the samples kept, N, and travel of the motor ahead of the slide, m."""
        law, motor = axis_force(case), run.record.motor
        record: axis_record.AxisRecord = run.record
        acceleration = None if motor is None else motor.acceleration
        warm_up = case.axis.warm_up
        begun = 0.0 if warm_up is not None and warm_up.begins == "move" else record.begun
        force = law.along(*record.motion, record.step, begun, acceleration)
        for term in case.empirical:
            if not term.is_of_a_cut:
                position, velocity, _ = record.motion
                force = force + term.value_at(position if term.over == "position" else velocity)
        delay = case.axis.force_delay / record.step
        found = {"force": axis_record.kept(force, delay)}
        if motor is not None:
            ahead = 0.5 * case.axis.backlash * axis_record.driving_flank(_slide_force(law, run))
            found["backlash"] = axis_record.centred(axis_record.kept(ahead), motor.weights)
        return found

    def known_noise(self, run: Run) -> Mapping[str, float]:
        """Standard deviation of the noise of every channel, from its scatter."""
        return run.record.noise

    def nuisance_parameters(self, measurement: Measurement) -> list[Parameter]:
        """Mass and frictions that are declared, and the delay between force and motion.

        No recorder is told to sample both at one instant, and a part of a sample is enough to bias
        the mass and what damps.
        """
        axis = measurement.case.axis
        delay = _delay(axis.force_delay, _step(measurement))
        declared = [f"axis.{key}" for key in _DECLARED if getattr(axis, key)]
        return [*with_priors(measurement, declared), delay]

    def trials(self, measurement: Measurement, noise: Noise) -> list[Trial]:
        """An axis at rest, and slow and fast moves both ways."""
        level = {"force": noise[measurement.runs[0].name]["force"]}
        fastest = max(float(np.abs(run.signals["velocity"]).max()) for run in measurement.runs)
        speeds = {"at rest": 0.0, "slowly to and fro": _SLOW * fastest, "to and fro": fastest}
        return [
            Trial(f"the force of the axis {how}, at {speed * 1e3:.3g} mm/s", _move(speed), level)
            for how, speed in speeds.items()
        ]


def _step(measurement: Measurement) -> float:
    """Median time between the samples of a record, s."""
    runs = [run.whole or run for run in measurement.runs]
    steps = [
        run.record.step if run.record is not None else np.median(np.diff(run.signals["time"]))
        for run in runs
    ]
    return float(np.median(steps))


def _delay(declared: float, step: float) -> Parameter:
    """Delay of the force, of which nothing is known; recorders may be started by hand."""
    bounds = {"lower": -_LONGEST_DELAY * step, "upper": _LONGEST_DELAY * step}
    size = _DELAY * step
    return Parameter("axis.force_delay", declared, size, prior=False, unit="s", **bounds)


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


def _slide_force(law: AxisForce, run: Run) -> axis_record.Array:
    """Force (n,), N, that the slide asks of its drive."""
    slide = replace(law, backlash=0.0, motor_mass=0.0)
    record: axis_record.AxisRecord = run.record
    return slide.along(*record.motion, record.step)


def _move(speed: float) -> Run:
    """Sine of one period with a highest speed, m/s."""
    time = np.arange(0.0, _LASTING, 1.0 / _RATE)
    rate = 2.0 * math.pi / _LASTING
    motion = axis_record.Motion(
        -speed / rate * np.cos(rate * time),
        speed * np.sin(rate * time),
        speed * rate * np.cos(rate * time),
    )
    return Run("trial", {}, {}, record=AxisRecord(motion, 1.0 / _RATE))
