"""Friction and inertia of the Mandelli M5's axes from torque records: equation 1, Table 1."""

from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

import chatter
from chatter.description.machine.machine_file import MachineFile
from chatter.plots import style
from chatter.report.published_against_obtained import CALIBRATED, RECOVERED, Finding
from dynamics.friction.identification.filtering import LowPass
from dynamics.friction.identification.linear_fit import LinearFriction, fit_linear
from dynamics.friction.identification.record import DriveRecord

LEAD = 0.020  # m; the belt's ratio is 1, so motor and driving screw turn alike
TABLE_1 = {"Y": (3.57, 0.0105, 0.0192), "Z": (3.87, 0.075, 0.0272)}
J_AS_PRINTED = 0.192  # kg m^2, of Y
IDENTIFYING = ("slow_forward", "slow_backward", "fast_forward", "fast_backward")
TORQUE_NOISE, SPEED_NOISE = 0.2, 0.05  # N m and rad/s, standard deviations
LOW_PASS = LowPass(30.0)
SLOWEST = 3.0  # rad/s


class Identified(NamedTuple):
    """Friction and inertia of an axis from its torque records."""

    fit: LinearFriction
    records: list[DriveRecord]
    other: DriveRecord  # not fitted
    residual: float  # on it, rms over rms, both behind the low-pass


def torque_record(machine: MachineFile, axis: str, name: str, seed: int) -> DriveRecord:
    """Simulated record of a move about the driving screw, with noise."""
    run = chatter.move(machine.patch({f"move.{name}.axes": [axis]}), name)
    random = np.random.default_rng(seed)
    per_travel = 2.0 * np.pi / LEAD
    # the torque is the mean over a cycle, so the motion has to be that of its middle
    middle, angle, speed = (
        0.5 * (one[1:] + one[:-1])
        for one in (run.time, run.motor[:, 0] * per_travel, run.velocity[:, 0] * per_travel)
    )
    torque = run.effort[1:, 0]
    return DriveRecord(
        middle,
        angle,
        speed + SPEED_NOISE * random.standard_normal(speed.size),
        torque + TORQUE_NOISE * random.standard_normal(torque.size),
        name=f"{axis}, {name}",
    )


def identified(machine: MachineFile, axis: str) -> Identified:
    """Equation 1 in the least-squares sense, judged on another profile."""
    records = [torque_record(machine, axis, name, k) for k, name in enumerate(IDENTIFYING)]
    fit = fit_linear(records, low_pass=LOW_PASS, minimum_speed=SLOWEST)
    other = torque_record(machine, axis, "other_profile", 9)
    wanted, predicted = filtered_torques(fit, other)
    moving = np.abs(other.velocity) > SLOWEST
    error = np.sqrt(np.mean((predicted - wanted)[moving] ** 2) / np.mean(wanted[moving] ** 2))
    return Identified(fit, records, other, float(error))


def filtered_torques(fit: LinearFriction, record: DriveRecord) -> tuple[NDArray, NDArray]:
    """Torque of a record, and that of the fitted equation, behind the same low-pass."""
    quiet = LOW_PASS.apply(record.velocity, record.sample_time)
    predicted = fit.effort(quiet, np.gradient(quiet, record.sample_time))
    return (LOW_PASS.apply(one, record.sample_time) for one in (record.effort, predicted))


def plot_friction(found: dict[str, Identified]) -> Figure:
    """Torque over speed of the records fitted, and the other profile, as figure 7."""
    figure = style.new_figure(9.0, 6.2)
    panels = figure.subplots(2, 2)
    for row, (axis, one) in enumerate(found.items()):
        left, right = panels[row]
        for record in one.records:
            left.plot(record.time, record.effort, color=style.RED, linewidth=0.6)
            left.plot(record.time, filtered_fit(one.fit, record), color=style.BLUE, linewidth=1.3)
        left.set_title(f"{axis}: records fitted, 4 and 24 m/min, both ways")
        right.plot(
            one.other.time, one.other.effort, color=style.RED, linewidth=0.6, label="simulated"
        )
        right.plot(
            one.other.time,
            filtered_fit(one.fit, one.other),
            color=style.BLUE,
            linewidth=1.3,
            label="equation 1 as fitted",
        )
        right.set_title(f"{axis}: another profile (Fig. 7)")
        right.legend(fontsize=8, frameon=False)
        for axes in (left, right):
            axes.set_xlabel("time [s]")
            axes.set_ylabel("motor torque [N m]")
            style.finish(axes)
    return figure


def filtered_fit(fit: LinearFriction, record: DriveRecord) -> NDArray:
    """Torque of the fitted equation where it is one: not at rest."""
    torque = tuple(filtered_torques(fit, record))[1]
    return np.where(np.abs(record.velocity) > SLOWEST, torque, np.nan)


def friction_findings(found: dict[str, Identified]) -> list[Finding]:
    rows = []
    for axis, one in found.items():
        coulomb, viscous, inertia = TABLE_1[axis]
        rows += [
            Finding(
                f"{axis}: tau_st", coulomb, one.fit.value("coulomb"), "N m", "Table 1", RECOVERED
            ),
            Finding(
                f"{axis}: mu", viscous, one.fit.value("viscous"), "N m s", "Table 1", RECOVERED
            ),
        ]
        if axis == "Y":
            rows.append(
                Finding(
                    "Y: J_eq as printed",
                    J_AS_PRINTED,
                    one.fit.value("inertia"),
                    "kg m^2",
                    "Table 1",
                    RECOVERED,
                )
            )
        reading = "Y: J_eq read as 0.0192" if axis == "Y" else "Z: J_eq"
        rows += [
            Finding(reading, inertia, one.fit.value("inertia"), "kg m^2", "Table 1", CALIBRATED),
            Finding(
                f"{axis}: torque left unexplained on another profile",
                "curves agree",
                f"{100.0 * one.residual:.2g} %",
                "",
                "Fig. 7",
                RECOVERED,
            ),
        ]
    return rows
