"""Columns that a kind of measurement needs: their names, and those of unusual headings."""

from __future__ import annotations

from collections.abc import Mapping

from chatter.description.errors import InputError
from chatter.explain.measurement import Measurement

#: kind -> columns of which all are needed, and groups of which one is enough
NEEDED: Mapping[str, tuple[tuple[str, ...], ...]] = {
    "milling": (("time",), ("Fx", "Fy", "Fz", "x", "y", "z")),
    "axis": (("time",), ("position",), ("force",)),
    "stability": (("spindle_speed",), ("axial_depth",), ("stable",)),
    "frf": (("frequency",), ("real",), ("imag",)),
}


def require_columns(measurement: Measurement) -> None:
    """Raise InputError naming every run that lacks a column, what it has and what is wanted."""
    problems = []
    for run in measurement.runs:
        missing = [
            " or ".join(group)
            for group in NEEDED[measurement.kind]
            if not any(name in run.signals for name in group)
        ]
        if missing:
            wanted = ", ".join(" or ".join(group) for group in NEEDED[measurement.kind])
            problems.append(
                f"{measurement.folder / run.name}: column {', '.join(missing)} is missing; there "
                f"are {', '.join(run.signals)}; a run of kind {measurement.kind} needs {wanted}"
            )
    if problems:
        raise InputError(problems)
