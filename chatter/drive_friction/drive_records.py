"""Records of a drive from files and measurement folders, all along the slide or about the motor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy

from chatter.description.arrays import Array
from chatter.description.errors import InputError
from chatter.drive_friction.drive_columns import (
    DriveSignal,
    signal_of,
    slide_travel_per_angle,
    time_of,
)
from chatter.explain.measurement_file import read_measurement
from chatter.io.stated_columns import read_signal_table
from chatter.io.table import Table
from dynamics.frf.container import MeasurementError
from dynamics.friction.identification.record import DriveRecord

#: kind of an effort that needs a constant -> in words, and the options that give it
_ASKED = {
    "current": ("a current, in A", '--torque-constant "1.2 N*m/A", or --force-constant "80 N/A"'),
    "share": ("a share, in %", '--rated-torque "2.4 N*m", or --rated-force "900 N"'),
}


@dataclass(frozen=True)
class DriveSettings:
    """What the files of a drive cannot tell."""

    position: str | None = None  # heading of the column, where it does not tell
    velocity: str | None = None  # heading of the column
    effort: str | None = None  # heading of the column: force, torque or current
    columns: str | None = None  # headings of a file that has none
    lead: float | None = None  # travel of the slide for a revolution of the motor, m; above 0
    torque_constant: float | None = None  # of a motor, N m/A
    force_constant: float | None = None  # of a linear motor, N/A
    rated_torque: float | None = None  # torque of 100 %, N m
    rated_force: float | None = None  # force of 100 %, N


@dataclass(frozen=True, eq=False)
class DriveRecords:
    """Records of one axis in the units of one motion."""

    records: tuple[DriveRecord, ...]
    rotary: bool  # about the motor: rad and N m; otherwise along the slide: m and N
    declared_inertia: float | None = None  # of the case of a measurement folder, kg


def drive_records(
    files: Sequence[str | Path], settings: DriveSettings | None = None
) -> DriveRecords:
    """Records of files, or of the runs of a measurement folder of kind "axis".

    InputError if a file cannot be read, does not tell a signal, or the records are of different
    motions.
    """
    settings = settings or DriveSettings()
    if not files:
        raise InputError("friction: no record is given")
    paths = [Path(one) for one in files]
    if len(paths) == 1 and (paths[0].is_dir() or paths[0].name == "measurement.toml"):
        return _of_folder(paths[0])
    try:
        found = [_of_file(path, settings) for path in paths]
    except MeasurementError as error:
        raise InputError(str(error)) from error
    rotary = found[0][1]
    for path, (_, other) in zip(paths, found, strict=True):
        if other != rotary:
            raise InputError(
                f"{path}: is {_motion(other)}, {paths[0]} is {_motion(rotary)}; with the travel "
                "for a revolution of the motor, --lead, both are along the slide"
            )
    return DriveRecords(tuple(record for record, _ in found), rotary)


def _motion(rotary: bool) -> str:
    return "about the motor" if rotary else "along the slide"


def _of_folder(folder: Path) -> DriveRecords:
    measurement = read_measurement(folder)
    if measurement.kind != "axis":
        raise InputError(
            f'{folder}: kind = "{measurement.kind}"; friction is identified from kind = "axis", '
            "or from the files themselves"
        )
    try:
        records = tuple(
            DriveRecord(
                run.signals["time"],
                run.signals["position"],
                run.signals["velocity"],
                run.signals["force"],
                name=run.name,
            )
            for run in measurement.runs
        )
    except MeasurementError as error:
        raise InputError(f"{folder}: {error}") from error
    axis = measurement.case.axis
    return DriveRecords(records, False, None if axis is None else axis.moving_mass)


def _of_file(path: Path, settings: DriveSettings) -> tuple[DriveRecord, bool]:
    table = read_signal_table(path, settings.columns)
    time = time_of(table)
    position = signal_of(table, "position", settings.position)
    velocity = signal_of(table, "velocity", settings.velocity)
    effort = signal_of(table, "effort", settings.effort)
    if effort is None:
        raise InputError(_not_told(table, "effort", "force, torque or current"))
    if position is None and velocity is None:
        raise InputError(_not_told(table, "velocity", "velocity or position"))
    force = _force(path, effort, settings)
    rotary = _about_motor(position, velocity, force, settings)
    moved = None if position is None else _motion_of(path, position, rotary, settings)
    speed = None if velocity is None else _motion_of(path, velocity, rotary, settings)
    if speed is None:
        speed = np.gradient(moved, time)
    if moved is None:
        moved = scipy.integrate.cumulative_trapezoid(speed, time, initial=0.0)
    drive = _effort_of(path, force, rotary, settings)
    return DriveRecord(time, moved, speed, drive, name=path.name), rotary


def _not_told(table: Table, role: str, words: str) -> str:
    headings = ", ".join(f'"{column.heading}"' for column in table.columns)
    return (
        f"{table.path}: no heading tells the {words}; say which column it is by --{role}; there "
        f"are {headings}"
    )


def _force(path: Path, effort: DriveSignal, settings: DriveSettings) -> DriveSignal:
    """Effort as a force or a torque, whether it was recorded so, as a current or as a share."""
    if effort.kind in ("linear", "rotary"):
        return effort
    rotary, linear = (
        (settings.torque_constant, settings.force_constant)
        if effort.kind == "current"
        else (settings.rated_torque, settings.rated_force)
    )
    if (rotary is None) == (linear is None):
        words, options = _ASKED[effort.kind]
        problem = "is missing" if rotary is None else "is given twice"
        raise InputError(f"{path}: the effort is {words}; its size {problem}: {options}")
    if rotary is not None:
        return DriveSignal("rotary", rotary * effort.values)
    return DriveSignal("linear", linear * effort.values)


def _about_motor(
    position: DriveSignal | None,
    velocity: DriveSignal | None,
    force: DriveSignal,
    settings: DriveSettings,
) -> bool:
    """Whether all signals are about the motor, so that no lead is needed."""
    given = [one for one in (position, velocity, force) if one is not None]
    return settings.lead is None and all(one.kind == "rotary" for one in given)


def _motion_of(path: Path, signal: DriveSignal, rotary: bool, settings: DriveSettings) -> Array:
    if rotary or signal.kind == "linear":
        return signal.values
    return _per_angle(path, settings) * signal.values


def _effort_of(path: Path, force: DriveSignal, rotary: bool, settings: DriveSettings) -> Array:
    if rotary or force.kind == "linear":
        return force.values
    return force.values / _per_angle(path, settings)


def _per_angle(path: Path, settings: DriveSettings) -> float:
    if settings.lead is None:
        raise InputError(
            f"{path}: some signals are about the motor and some along the slide; the travel for a "
            'revolution of the motor is missing: --lead "10 mm"'
        )
    return slide_travel_per_angle(settings.lead)
