"""Axial coefficients of a case that declares none, where an axial force was measured."""

from __future__ import annotations

import numpy as np

from chatter.explain.data_checks.finding import NOTE, SignalFinding
from chatter.explain.measurement import Measurement, Run
from chatter.explain.parameters import Parameter

#: scatter of the axial force over that of the forces in the plane of the cut, from which on it is
#: more than what a dynamometer couples into it or noise
_MEASURED = 0.1
#: typical sizes: of the cutting coefficient as a share of Ktc, and of the edge coefficient, N/m
_CUTTING, _EDGE = 0.03, 1000.0
_PATHS, _UNITS = ("material.Kac", "material.Kae"), ("N/m^2", "N/m")


def undeclared_axial_coefficients(measurement: Measurement) -> list[Parameter]:
    """Axial coefficients as free parameters; none where the case declares one or Fz is nothing.

    Nobody who leaves them out of a case means that no axial force is there.
    """
    material = measurement.case.material
    if material is None or not material.Ktc or material.Kac or material.Kae:
        return []
    runs = [run for run in measurement.runs if run.kind in ("", "milling")]
    if not runs or not all(_has_axial_force(run) for run in runs):
        return []
    sizes = (_CUTTING * material.Ktc, _EDGE)
    return [
        Parameter(path, 0.0, size, lower=0.0, prior=False, unit=unit)
        for path, size, unit in zip(_PATHS, sizes, _UNITS, strict=True)
    ]


def note_of_axial_coefficients(measurement: Measurement) -> list[SignalFinding]:
    """Note that such coefficients are fitted."""
    if not undeclared_axial_coefficients(measurement):
        return []
    words = (
        "the case declares no axial coefficients: material.Kac and material.Kae are fitted beside"
        " the others"
    )
    return [SignalFinding(NOTE, "", "Fz", words)]


def _has_axial_force(run: Run) -> bool:
    """Whether an axial force varies that is not small beside those in the plane of the cut."""
    if "Fz" not in run.signals:
        return False
    in_plane = [float(np.std(run.signals[name])) for name in ("Fx", "Fy") if name in run.signals]
    return bool(in_plane) and float(np.std(run.signals["Fz"])) > _MEASURED * max(in_plane)
