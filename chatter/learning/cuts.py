"""Cutting tests to learn from: a CSV table, or a measurement folder of kind "stability"."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.given_path import path_given
from chatter.description.kinds_of_files import refuse_other_file
from chatter.explain.measurement import Measurement, Run
from chatter.explain.measurement_file import read_measurement
from chatter.io.headings import named
from chatter.io.signals import read_signals
from chatter.io.stated_columns import read_signal_table
from chatter.io.table import split_heading
from chatter.learning.idle_power import with_power_understood
from chatter.learning.records_of_cuts import ANGLE, MAGNITUDE, with_multipliers
from dynamics.frf.container import MeasurementError

#: what of a test can be compared with a prediction
READINGS = ("stable", "chatter_frequency", "spindle_power", MAGNITUDE, ANGLE)
#: number of the test in the order of its table, as a column of every run
TEST = "test"
#: diameters of the tool beyond which no cut is
_MOST_DIAMETERS = 20.0
_NEEDED = ("spindle_speed", "axial_depth")


def read_cuts(path: str | Path, case: Case) -> Measurement:
    """Read cutting tests of a case.

    A table has `spindle_speed`, `axial_depth` and one or more of `stable`, `chatter_frequency` and
    `spindle_power`, with their units; `feed_per_tooth`, `radial_depth` and `cut_time` where they
    differ from the case; `record`, a number n, where the vibration of a stable cut lies in
    record-n.csv beside the table. InputError if it is missing or has no such column.
    """
    path = path_given(path, "a table of cuts")
    refuse_other_file(path, "measurement")
    if path.is_dir() or path.suffix == ".toml":
        measurement = read_measurement(path, case)
        if measurement.kind != "stability":
            raise InputError(
                f'{path}: kind: "{measurement.kind}" is none to learn from; "stability" is'
            )
    else:
        _require_unit_of_speed(path)
        run = Run(path.name, {}, read_signals(path))
        measurement = Measurement("stability", path.stem, path.parent, case, (run,))
    return with_one_run_a_reading(measurement)


def _require_unit_of_speed(path: Path) -> None:
    """Ask for the unit of a spindle speed: a bare number would be in rad/s."""
    try:
        headings = [column.heading for column in read_signal_table(path).columns]
    except MeasurementError as error:
        raise InputError(str(error)) from error
    for heading in headings:
        if not split_heading(heading)[1] and named(path, heading)[0] == "spindle_speed":
            raise InputError(
                f"{path}: column {heading} has no unit; write it in the heading, such as "
                '"spindle_speed [rpm]"'
            )


def with_one_run_a_reading(measurement: Measurement) -> Measurement:
    """Measurement with a run of the verdicts, one of the frequencies and one of the powers."""
    (run,) = measurement.runs
    where = measurement.folder / run.name
    for name in _NEEDED:
        if name not in run.signals:
            raise InputError(
                f"{where}: column {name} is missing; there are {', '.join(run.signals)}"
            )
        values = run.signals[name]
        if not np.all(np.isfinite(values) & (values > 0.0)):
            row = int(np.argmin(np.isfinite(values) & (values > 0.0))) + 1
            raise InputError(f"{where}: {name}, row {row}: {values[row - 1]:g} is not above 0")
    _refuse_depths_in_metres(where, run, measurement.case)
    run = with_multipliers(run, measurement.folder, measurement.case)
    run = with_power_understood(run, measurement)
    numbered = {**run.signals, TEST: np.arange(run.signals[_NEEDED[0]].size, dtype=float)}
    run = replace(run, signals=numbered)
    runs = [one for name in READINGS if (one := _of_reading(run, name)) is not None]
    if not runs:
        raise InputError(f"{where}: there is no column {', '.join(READINGS)} to learn from")
    return measurement.with_runs(runs)


def _refuse_depths_in_metres(where: Path, run: Run, case: Case) -> None:
    """Refuse a depth that no tool cuts: of a column without a unit it is in m."""
    depths, diameter = run.signals["axial_depth"], case.tool.diameter
    row = int(np.argmax(depths))
    if depths[row] > _MOST_DIAMETERS * diameter:
        raise InputError(
            f"{where}: axial_depth, row {row + 1}: {1e3 * depths[row]:.4g} mm are "
            f"{depths[row] / diameter:.3g} diameters of the tool; the unit stands in the heading, "
            'such as "axial_depth [mm]"'
        )


def _of_reading(run: Run, name: str) -> Run | None:
    """Tests that have a reading; None if there is none."""
    if name not in run.signals:
        return None
    signals = run.signals
    usable = np.isfinite(signals[name])
    if name in ("chatter_frequency", "spindle_power"):
        usable &= signals[name] > 0.0
    if name == "chatter_frequency" and "stable" in signals:
        # of a stable test it is that of forced vibration
        usable &= ~(signals["stable"] > 0.5)
    if not usable.any():
        return None
    own = {column: values[usable] for column, values in signals.items()}
    return replace(run, name=name.replace("_", " "), signals=own, record=name)
