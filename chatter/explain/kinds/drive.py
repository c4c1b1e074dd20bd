"""Moves of an axis of a machine: torque and position predicted by the machine in time."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.explain.data_checks.clock import clock_check
from chatter.explain.data_checks.samples import Columns, dropouts, sample_checks
from chatter.explain.kinds.frf import machine_paths
from chatter.explain.kinds.kind import Array, Cuts, Kind, Signals, of_sections
from chatter.explain.measurement import Measurement, Run
from chatter.explain.parameters import Parameter, with_priors
from chatter.explain.residuals.by_channel import by_channel
from chatter.explain.residuals.over_variable import over_variable
from chatter.explain.residuals.variables import AXIS_FORMS, AXIS_VARIABLES
from chatter.simulation.virtual_tests.recorded_move import recorded_move

#: steps of the clock that no record of a move has, s
_LONGEST_STEP = 0.2
#: speed at the first sample, over the highest, from which on a record begins in motion
_IN_MOTION = 0.02
_EFFORTS = ("torque", "force")
#: recorded position -> how far it is behind the set point, which is what is predicted
_BEHIND = {"position": "motor_error", "scale": "tracking_error"}
_COLUMNS = Columns((*_EFFORTS, *_BEHIND), optional=("velocity",))


class Drive(Kind):
    """Moves of an axis of a machine from rest, along the set points of its control."""

    name = "drive"
    sections = ("structure",)
    columns = (("time",), ("command",), (*_EFFORTS, *_BEHIND))
    variables = AXIS_VARIABLES
    forms = AXIS_FORMS
    periodic_variable = "position"
    diagnostics = (
        by_channel,
        over_variable("velocity"),
        over_variable("direction"),
        over_variable("travel since reversal"),
        over_variable("position"),
        over_variable("acceleration"),
    )
    checks = ((*sample_checks(_COLUMNS), dropouts(_COLUMNS), clock_check(_LONGEST_STEP)),)

    def require(self, measurement: Measurement) -> None:
        """Raise InputError where runs lack what is needed: set points, an axis under control."""
        super().require(measurement)
        for run in measurement.runs:
            _refuse_begun(measurement, run)

    def channels(self, run: Run) -> tuple[str, ...]:
        """Torque or force of the drive, and how far its positions are behind the set points."""
        names = (*_EFFORTS, *_BEHIND.values())
        return tuple(name for name in names if name in run.signals)

    def prepared(self, measurement: Measurement) -> Measurement:
        """Return the measurement with the axis of every run, and positions behind set points."""
        runs = [_behind_set_points(run) for run in measurement.runs]
        for run in runs:
            axis_of(measurement.case, run)
        return measurement.with_runs(runs).in_parts()

    def predict(self, case: Case, run: Run) -> Signals:
        """Efforts and positions behind the set points at the samples of a run."""
        time = run.signals["time"] - run.signals["time"][0]
        name = axis_of(case, run)
        move = recorded_move(case, name, time, run.signals["command"])
        positions = {"motor_error": move.motor, "tracking_error": move.scale}
        found = {}
        for channel in self.channels(run):
            if channel in positions:
                values = (move.wanted - positions[channel])[:, 0]
                found[channel] = _centred(np.interp(time, move.time, values, left=0.0))
            else:
                found[channel] = np.interp(time, move.time, move.effort[:, 0], left=0.0)
        if "force" in found and move.effort_unit(0) != "N":
            found["force"] = found["force"] / _transmission(case, name)
        return found

    def coarse(self, case: Case, run: Run) -> Mapping[str, Any]:
        """A machine whose structure does not follow its axes."""
        del run
        return {} if case.structure.travel_positions == 1 else {"structure.travel_positions": 1}

    def reduced(self, case: Case, run: Run) -> Case:
        """Return the machine alone: nothing is cut."""
        del run
        return of_sections(case, self.sections)

    def nuisance_parameters(self, measurement: Measurement) -> list[Parameter]:
        """What of the machine is declared as uncertain."""
        return with_priors(measurement, machine_paths(measurement.case))

    def cuts(self, measurement: Measurement) -> Cuts:
        """None: a machine that moves may have no tool."""
        if measurement.case.cut is None:
            return Cuts(np.empty(0), np.empty(0))
        return super().cuts(measurement)


def axis_of(case: Case, run: Run) -> str:
    """Axis of a machine that a run moves: the one named, or the only one that feeds."""
    if run.axis:
        return run.axis
    feeding = [
        name
        for name, one in case.machine_file().axis.items()
        if one.control is not None and one.drive is not None and not one.drive.is_rotary
    ]
    if len(feeding) != 1:
        known = ", ".join(feeding) or "none"
        raise InputError(
            f'{run.name}: axis is missing; it names the axis that moves, such as axis = "Y"; the '
            f"machine has {known} under control"
        )
    return feeding[0]


def _transmission(case: Case, axis: str) -> float:
    """Travel of an axis per angle of its motor, m/rad."""
    return float(case.machine_file().axis[axis].drive.spec().transmission)


def _behind_set_points(run: Run) -> Run:
    """Run with its positions as distances behind the set points, whose offset nobody knows."""
    signals = dict(run.signals)
    command = signals["command"]
    for name, behind in _BEHIND.items():
        if name in signals:
            signals[behind] = _centred(command - signals.pop(name))
    signals["velocity"] = np.gradient(command, signals["time"])
    signals["position"] = command
    return replace(run, signals=signals)


def _centred(values: Array) -> Array:
    return values - values.mean()


def _refuse_begun(measurement: Measurement, run: Run) -> None:
    """Refuse a record that begins in motion: what the machine did before is not known."""
    time, command = run.signals["time"], run.signals["command"]
    velocity = np.abs(np.diff(command) / np.maximum(np.diff(time), 1e-12))
    fastest = float(np.max(velocity, initial=0.0))
    where = measurement.folder / run.name
    if fastest == 0.0:
        raise InputError(f"{where}: command never changes; a move is required")
    if velocity[0] > _IN_MOTION * fastest:
        raise InputError(
            f"{where}: command begins at {1e3 * velocity[0]:.3g} mm/s; a record of a machine is to "
            "begin at rest"
        )
