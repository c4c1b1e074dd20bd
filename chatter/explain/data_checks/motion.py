"""Axis moves: position, velocity, command and force against each other and the declared mass."""

import numpy as np
import scipy
from numpy.typing import NDArray

from chatter.explain.data_checks.finding import FATAL, RUN, SignalFinding, of_all_or_some
from chatter.explain.data_checks.scale import thousand
from chatter.explain.measurement import Measurement, Run

Vector = NDArray[np.float64]

#: low pass of all signals, of the sampling frequency
_CUT_OFF = 0.04
#: correlation from which on a factor between two signals means something, and below which they
#: have nothing to do with each other
_TOGETHER, _APART = 0.95, 0.3
#: factors that are still the same quantity
_SAME = 1.5
#: stroke below which velocity is noise, m
_LEAST_STROKE = 1e-3
#: standard errors by which a fitted mass must differ from zero
_SURE = 8.0


def wrong_motion(measurement: Measurement) -> list[SignalFinding]:
    """Velocities that are not those of the position, forces with the wrong sign or unit."""
    return [*_velocities(measurement), *_commands(measurement), *_forces(measurement)]


def _smooth(values: Vector) -> Vector:
    sections = scipy.signal.butter(4, 2.0 * _CUT_OFF, output="sos")
    return scipy.signal.sosfiltfilt(sections, values)


def _usable(run: Run, *names: str) -> bool:
    return all(name in run.signals for name in names) and run.signals["time"].size > 60


def _derivative(run: Run) -> Vector:
    step = float(np.median(np.diff(run.signals["time"])))
    return np.gradient(_smooth(run.signals["position"]), step)


def _velocities(measurement: Measurement) -> list[SignalFinding]:
    found = []
    for run in measurement.runs:
        if not _usable(run, "time", "position", "velocity"):
            continue
        of_position, velocity = _derivative(run), _smooth(run.signals["velocity"])
        together = _correlation(of_position, velocity)
        factor = float(of_position @ velocity / max(of_position @ of_position, 1e-300))
        if abs(together) > _TOGETHER and not 1.0 / _SAME < factor < _SAME:
            description = (
                f"{run.name}: velocity is {factor:.4g} times the derivative of position"
                f"{_cause(factor)}"
            )
        elif abs(together) < _APART and np.ptp(run.signals["position"]) > _LEAST_STROKE:
            description = (
                f"{run.name}: velocity is not the derivative of position (their correlation is "
                f"{together:.2f})"
            )
        else:
            continue
        found.append(SignalFinding(RUN, run.name, "velocity", description))
    about = "position, velocity and time contradict each other in {count} of {runs} runs"
    if found:
        about += f"; {found[0].description}".replace("{", "(").replace("}", ")")
    return of_all_or_some(found, measurement, about)


def _cause(factor: float) -> str:
    if -_SAME < factor < -1.0 / _SAME:
        return ": one of them has its sign turned"
    if thousand(abs(factor)):
        return ": the unit of one of them, or of time, is wrong by 1000"
    if 1.0 / _SAME < abs(factor) * 60.0 < _SAME or 1.0 / _SAME < abs(factor) / 60.0 < _SAME:
        return ": one of them counts in minutes"
    return ""


def _commands(measurement: Measurement) -> list[SignalFinding]:
    found = []
    for run in measurement.runs:
        if not _usable(run, "time", "position", "command"):
            continue
        command, position = run.signals["command"], run.signals["position"]
        if np.ptp(command) < _LEAST_STROKE or not np.all(np.isfinite(command)):
            continue
        together = _correlation(command, position)
        factor = float(np.std(position) / np.std(command))
        if abs(together) > _TOGETHER and (together < 0.0 or thousand(factor)):
            turned = " turned round" if together < 0.0 else ""
            description = f"{run.name}: position is {factor:.4g} times the command{turned}"
            found.append(SignalFinding(RUN, run.name, "position", description))
    about = "position contradicts the command, in sign or unit, in {count} of {runs} runs"
    return of_all_or_some(found, measurement, about)


def _forces(measurement: Measurement) -> list[SignalFinding]:
    """Force against mass times acceleration, and against the work that friction takes."""
    declared = measurement.case.axis.moving_mass if measurement.case.axis else None
    if not declared:
        return []
    turned, units = [], []
    masses = []
    for run in measurement.runs:
        if not _usable(run, "time", "position", "force"):
            continue
        mass, error, work = apparent_mass(run)
        if abs(mass) < _SURE * error:
            continue
        masses.append(mass)
        factor = mass / declared
        if thousand(abs(factor)):
            description = (
                f"{run.name}: the force is {factor:.3g} times the declared mass times the "
                "acceleration: the unit of force, position or time is wrong"
            )
            units.append(SignalFinding(RUN, run.name, "force", description))
        elif factor < -0.3 and work < 0.0:
            description = (
                f"{run.name}: the sign of the force is turned: it brakes where the axis speeds up "
                f"(apparent mass {mass:.4g} kg, declared {declared:.4g} kg) and does {work:.3g} J "
                "of work on the whole"
            )
            turned.append(SignalFinding(RUN, run.name, "force", description))
    found = of_all_or_some(
        turned, measurement, "the sign of the force is turned in {count} of {runs} runs"
    )
    found += of_all_or_some(
        units, measurement, "the unit of force, position or time is wrong in {count} of {runs} runs"
    )
    typical = float(np.median(masses)) / declared if masses else 1.0
    if not found and (typical > 4.0 or 0.0 < typical < 0.25):
        description = (
            f"the forces move a mass of {typical * declared:.4g} kg; the case declares "
            f"{declared:.4g} kg"
        )
        found.append(SignalFinding(FATAL, "", "force", description))
    return found


def apparent_mass(run: Run) -> tuple[float, float, float]:
    """Mass by which the force follows the acceleration, kg, its standard error, and the work, J.

    Least squares with viscous and Coulomb friction and an offset beside it.
    """
    step = float(np.median(np.diff(run.signals["time"])))
    velocity = _derivative(run)
    force = _smooth(run.signals["force"])
    # a sense that does not jump at rest, where noise has it
    slow = 0.02 * float(np.max(np.abs(velocity))) + 1e-12
    columns = np.column_stack(
        [np.gradient(velocity, step), velocity, np.tanh(velocity / slow), np.ones(velocity.size)]
    )
    size = np.linalg.norm(columns, axis=0) + 1e-300
    scaled = columns / size
    solution = np.linalg.lstsq(scaled, force, rcond=None)[0]
    residual = force - scaled @ solution
    # samples within the low pass are one
    free = max(force.size * 2.0 * _CUT_OFF - 4.0, 1.0)
    variance = float(residual @ residual) / force.size * np.linalg.pinv(scaled.T @ scaled)[0, 0]
    error = float(np.sqrt(variance * force.size / free)) / size[0]
    work = float(np.sum(force * velocity) * step)
    return float(solution[0] / size[0]), error, work


def _correlation(a: Vector, b: Vector) -> float:
    a, b = a - a.mean(), b - b.mean()
    return float(a @ b / max(np.sqrt((a @ a) * (b @ b)), 1e-300))
