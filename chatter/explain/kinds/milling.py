"""Milling runs: forces and displacements predicted by the time-domain engine."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from chatter.description.case import Case
from chatter.description.units import rpm
from chatter.explain.criteria import NUMERICS_OF_ACCELERATION, NUMERICS_OF_SETTLED
from chatter.explain.data_checks.channel_assignment import wrong_assignment
from chatter.explain.data_checks.clock import clock_check
from chatter.explain.data_checks.displacement import wrong_displacements
from chatter.explain.data_checks.finding import SignalFinding
from chatter.explain.data_checks.samples import Columns, dropouts, sample_checks
from chatter.explain.data_checks.scale import wrong_scales
from chatter.explain.data_checks.spindle import wrong_speeds, wrong_teeth
from chatter.explain.kinds.axial_force import (
    note_of_axial_coefficients,
    undeclared_axial_coefficients,
)
from chatter.explain.kinds.kind import Cuts, Kind, Noise, Signals, Trial
from chatter.explain.measurement import Measurement, Run
from chatter.explain.parameters import Parameter, with_priors, within_reach
from chatter.explain.records.beginning import beginning_of
from chatter.explain.records.description import ACCELERATION, REST
from chatter.explain.records.from_rest import from_rest
from chatter.explain.records.recognition import from_rest_records, settled_records
from chatter.explain.records.records_by_case import settled_further, with_records_by
from chatter.explain.records.settling import without_too_slow
from chatter.explain.records.steady_record import SteadyRecord
from chatter.explain.residuals.by_channel import by_channel, over_time
from chatter.explain.residuals.over_runs import over_runs
from chatter.explain.residuals.over_variable import over_period, over_variable
from chatter.explain.residuals.spectrum import spectrum
from chatter.explain.residuals.variables import (
    MILLING_CONDITIONS,
    MILLING_FORMS,
    MILLING_MEASURES,
    MILLING_VARIABLES,
)
from chatter.simulation.setup import set_up

_FORCES = ("Fx", "Fy", "Fz")
_DISPLACEMENTS = ("x", "y", "z")
#: steps over those of predictions that are near enough for differences: two percent of a difference
_COARSER = 4
#: time for which axes move before a cut where differences are asked for, s
_SETTLED = 0.35
#: steps of the clock that no record of a cut has, s
_LONGEST_STEP = 0.02
#: conditions of a cut that a discriminating test may change: unit, reported over SI
_VARIED = {
    "cut.spindle_speed": ("rpm", rpm(1.0)),
    "cut.axial_depth": ("mm", 1e3),
    "cut.feed_per_tooth": ("mm", 1e3),
    "cut.radial_depth": ("mm", 1e3),
}
#: factors on these, and revolutions of such a test
_FACTORS = (0.5, 0.7, 1.4, 2.0)
_REVOLUTIONS = 10.0


class Milling(Kind):
    """Runs from rest as the tool meets full immersion, or where the cut is settled."""

    name = "milling"
    #: without a structure the tool is rigid
    sections = ("tool", "material", "cut")
    columns = (("time",), (*_FORCES, *_DISPLACEMENTS))
    variables = MILLING_VARIABLES
    forms = MILLING_FORMS
    conditions = MILLING_CONDITIONS
    measures = MILLING_MEASURES
    periodic_variable = "feed distance"
    sources = _FORCES
    diagnostics = (
        by_channel,
        spectrum,
        over_variable("tooth angle"),
        over_variable("spindle angle"),
        over_period("feed distance"),
        over_runs,
        over_time,
    )
    checks = (
        (
            # out of the plane of the cut a case may well predict nothing
            *sample_checks(Columns((*_FORCES, *_DISPLACEMENTS), may_rest=("Fz", "z"))),
            dropouts(Columns((*_FORCES, *_DISPLACEMENTS))),
            clock_check(_LONGEST_STEP),
        ),
        (wrong_speeds, wrong_teeth),
        (wrong_scales,),
        (wrong_assignment,),
        (wrong_displacements,),
    )

    def channels(self, run: Run) -> tuple[str, ...]:
        """Forces and motions that were recorded."""
        names = run.components or (*_FORCES, *_DISPLACEMENTS)
        return tuple(name for name in names if name in run.signals)

    def require(self, measurement: Measurement) -> None:
        """Raise InputError where the case lacks a section, or runs a channel that is predicted."""
        record = measurement.record
        if record is None or not any(one.is_vector for one in record.channels.values()):
            super().require(measurement)
            return
        measurement.case.require(*self.sections)

    def as_recorded(self, measurement: Measurement) -> tuple[Measurement, list[SignalFinding]]:
        """Runs in the axes of the case; where they are settled, if they do not begin from rest."""
        record, notes = measurement.record, []
        if record is None or record.begins == REST:
            record, notes = beginning_of(measurement, record)
        if record is None:
            return measurement, [*notes, *note_of_axial_coefficients(measurement)]
        make = settled_records if record.is_settled_only else from_rest_records
        found, new = make(measurement, record)
        return found, [*notes, *new, *note_of_axial_coefficients(found)]

    def prepared(self, measurement: Measurement) -> Measurement:
        """Return the measurement whose runs, where they are few, are judged in parts."""
        return measurement.in_parts()

    def coarse(self, case: Case, run: Run) -> Mapping[str, Any]:
        """A quarter of the steps; a machine that stays where it is, and settles for less long."""
        if case.on_machine:
            return _coarse_machine(case)
        if case.simulation is not None and case.simulation.steps:
            return {}
        steps = set_up(run.of(case)).resolution.steps_per_revolution
        return {"simulation.steps": steps // _COARSER}

    def predict(self, case: Case, run: Run) -> Signals:
        """Simulated signals at the samples of a run."""
        if isinstance(run.record, SteadyRecord):
            return run.record.predicted(case)
        return from_rest(case, run)

    def with_records_by(self, measurement: Measurement, case: Case) -> Measurement:
        """Return the measurement with its settled records as a case tells them."""
        return with_records_by(measurement, case)

    def refined(self, measurement: Measurement, case: Case) -> Measurement:
        """Return the measurement with settled records predicted by more revolutions."""
        return settled_further(with_records_by(measurement, case))

    def without_too_slow(
        self, measurement: Measurement, case: Case
    ) -> tuple[Measurement, list[SignalFinding]]:
        """Leave out records that need not have settled, by a case found."""
        return without_too_slow(measurement, case, "refitted")

    def revolution(self, run: Run) -> float | None:
        """Time of a revolution where a record is settled, s."""
        record = run.record
        return 2.0 * math.pi / record.recorded.speed if isinstance(record, SteadyRecord) else None

    def predicted_as(self, run: Run) -> str:
        """Revolutions and filter by which a settled record is predicted."""
        record = run.record
        if not isinstance(record, SteadyRecord):
            return ""
        return f"{record.revolutions} revolutions, filter {record.filter_order}"

    def known_noise(self, run: Run) -> Mapping[str, float]:
        """Standard deviation of channels whose noise the records tell."""
        return {name: one.noise for name, one in run.components.items() if one.noise > 0.0}

    def noise_beside(
        self, run: Run, predicted: Signals, noise: Mapping[str, float]
    ) -> Mapping[str, float]:
        """Standard deviation of every channel from the residual, where records do not tell it."""
        found = dict(super().noise_beside(run, predicted, noise))
        for name, one in run.components.items():
            further = NUMERICS_OF_SETTLED if isinstance(run.record, SteadyRecord) else 0.0
            if one.quantity == ACCELERATION:
                further = NUMERICS_OF_ACCELERATION
            level = float(np.sqrt(np.mean(run.signals[name] ** 2)))
            found[name] = math.hypot(found[name], further * level)
        return {**found, **self.known_noise(run)}

    def nuisance_parameters(self, measurement: Measurement) -> list[Parameter]:
        """Cutting coefficients and modal parameters, axial ones though none is declared."""
        paths = cutting_paths(measurement.case, ("Ktc", "Krc", "Kac", "Kte", "Kre", "Kae"))
        runout = measurement.case.tool.runout
        if runout is not None and runout.offset:
            paths.append("tool.runout.offset")
        declared = within_reach(with_priors(measurement, paths))
        return [*declared, *undeclared_axial_coefficients(measurement)]

    def cuts(self, measurement: Measurement) -> Cuts:
        """Cuts of the runs."""
        cuts = [run.of(measurement.case).cut for run in measurement.runs]
        return Cuts(
            np.array([cut.spindle_speed for cut in cuts]),
            np.array([cut.axial_depth for cut in cuts]),
        )

    def trials(self, measurement: Measurement, noise: Noise) -> list[Trial]:
        """Cuts as one that was made, with one condition changed."""
        run = measurement.runs[len(measurement.runs) // 2]
        made = run.of(measurement.case)
        step = float(np.median(np.diff(run.signals["time"])))
        told = (*_FORCES, *_DISPLACEMENTS)
        levels = {name: level for name, level in noise[run.name].items() if name in told}
        trials = []
        for path, (unit, scale) in _VARIED.items():
            value = made.get(path)
            for factor in _FACTORS if value else ():
                most = made.tool.diameter if path == "cut.radial_depth" else math.inf
                if value * factor > most:
                    continue
                speed = made.cut.spindle_speed * (factor if path == "cut.spindle_speed" else 1.0)
                time = np.arange(0.0, _REVOLUTIONS * 2.0 * math.pi / speed, step)
                overrides = {**run.overrides, path: float(value * factor)}
                trial = replace(
                    run,
                    overrides=overrides,
                    signals={"time": time},
                    whole=None,
                    part=None,
                    record=None,
                    components={},
                )
                name = path.partition(".")[2].replace("_", " ")
                number = value * factor * scale
                digits = f"{number:.0f}" if unit == "rpm" else f"{number:.3g}"
                words = f"a cut like {run.name} with the {name} at {digits} {unit}"
                trials.append(Trial(words, trial, levels))
        return trials


def _coarse_machine(case: Case) -> Mapping[str, Any]:
    """Overrides of a machine: its structure does not follow its axes, which come to speed soon."""
    found: dict[str, Any] = {"structure.travel_positions": 1}
    settling = case.structure.settling
    if settling is None or settling > _SETTLED:
        found["structure.settling"] = _SETTLED
    return found


def cutting_paths(case: Case, coefficients: tuple[str, ...]) -> list[str]:
    """Paths of the declared values of a cut: coefficients of the material, modes, damping."""
    paths = [f"material.{key}" for key in coefficients if getattr(case.material, key)]
    paths += structural_paths(case)
    if case.process_damping is not None and case.process_damping.coefficient:
        paths.append("process_damping.coefficient")
    return paths


def structural_paths(case: Case) -> list[str]:
    """Paths of the modal parameters of a case."""
    paths = []
    for index, mode in enumerate(case.structure.mode if case.structure else ()):
        inertia = "mass" if mode.mass is not None else "stiffness"
        paths += [f"structure.mode[{index}].{key}" for key in ("frequency", "damping", inertia)]
    return paths
