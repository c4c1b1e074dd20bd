"""Milling runs: forces and displacements predicted by the time-domain engine."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.explain.measurement import Measurement, Run
from chatter.explain.selection.fitting import Parameter
from chatter.explain.selection.prior import tolerated
from chatter.explain.selection.problem import scaled_difference
from chatter.simulation.setup import set_up
from chatter.simulation.simulate import run_setup

_FORCES = ("Fx", "Fy", "Fz")
_DISPLACEMENTS = ("x", "y", "z")
#: of steps beyond the end of a record
_BEYOND = 1e-3


class Milling:
    """Runs from rest at the moment the tool meets full immersion."""

    name = "milling"

    def channels(self, run: Run) -> tuple[str, ...]:
        """Forces and displacements that were recorded."""
        return tuple(name for name in (*_FORCES, *_DISPLACEMENTS) if name in run.signals)

    def prepared(self, measurement: Measurement) -> Measurement:
        """Measurement whose runs, where they are few, are judged in parts."""
        runs = [
            replace(run, signals={**run.signals, "whole time": run.signals["time"]})
            for run in measurement.runs
        ]
        # a channel that is no good may be missing in some runs
        columns = ("time", *{name for run in measurement.runs for name in run.signals})
        return replace(measurement, runs=tuple(runs)).in_parts(columns)

    def predict(self, case: Case, run: Run) -> Mapping[str, NDArray[np.float64]]:
        """Simulated signals at the samples of a run."""
        whole = run.signals["whole time"]
        duration = float(whole[-1] - whole[0])
        turns = duration * case.cut.spindle_speed / (2.0 * math.pi) + _BEYOND
        lasting = case.patch({"simulation.revolutions": turns})
        result, _ = run_setup(set_up(lasting))
        at = run.signals["time"] - whole[0]
        found = {}
        for axis in range(3):
            found[_FORCES[axis]] = np.interp(at, result.time, result.force[:, axis])
            found[_DISPLACEMENTS[axis]] = np.interp(at, result.time, result.displacement[:, axis])
        return found

    def residuals(self, case: Case, run: Run, noise: Mapping[str, float]) -> NDArray[np.float64]:
        """Predicted less measured over the noise."""
        return scaled_difference(self, case, run, noise)

    def uncertain(self, measurement: Measurement) -> list[Parameter]:
        """Cutting coefficients and modal parameters."""
        case = measurement.case
        keys = ("Ktc", "Krc", "Kac", "Kte", "Kre", "Kae")
        paths = [f"material.{key}" for key in keys if getattr(case.material, key)]
        paths += structural_paths(case)
        if case.process_damping is not None and case.process_damping.coefficient:
            paths.append("process_damping.coefficient")
        if case.tool.runout is not None and case.tool.runout.offset:
            paths += ["tool.runout.offset"]
        return tolerated(measurement, paths)


def structural_paths(case: Case) -> list[str]:
    """Paths of the modal parameters of a case."""
    paths = []
    for place, mode in enumerate(case.structure.mode if case.structure else ()):
        inertia = "mass" if mode.mass is not None else "stiffness"
        paths += [f"structure.mode[{place}].{key}" for key in ("frequency", "damping", inertia)]
    return paths
