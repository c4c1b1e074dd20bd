"""Run a case in the time domain."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.description.case_or_path import takes_case_or_path
from chatter.description.errors import InputError
from chatter.description.progress import Progress, no_progress
from chatter.description.units import rpm
from chatter.simulation.carved_workpiece import after_run, set_up_on
from chatter.simulation.cut_run import CutRun
from chatter.simulation.displaced_too_far import DisplacedTooFarError
from chatter.simulation.result import SimulationResult
from chatter.simulation.setup import Setup, set_up
from chatter.simulation.verdict import with_verdict
from dynamics.machine.groups import FrictionsOnPorts
from dynamics.machine.modal_structure import stored_energy
from dynamics.machine.tables import energy_of_structure
from dynamics.matrix_exponential import exact_step

#: a run may be this long, in steps
_MOST_STEPS = 2_000_000_000
#: filters of resonances kept: a search asks for the same ones of every run
_FILTERS_KEPT = 1024


@takes_case_or_path
def simulate(
    case: Case,
    overrides: Mapping[str, Any] | None = None,
    progress: Progress = no_progress,
    workpiece: SimulationResult | None = None,
) -> SimulationResult:
    """Simulate the cut of a case from rest in full immersion.

    A machine that the case names runs in the air first, until its axes have their feed; the cut
    then begins in full immersion, or where the tool meets the stock.

    Parameters
    ----------
    case : Case
        `[simulation]` gives the chip and the length of the run; a case without a structure is
        cut by a rigid tool.
    overrides : mapping of str to value, optional
        Patched into the case first, such as {"cut.axial_depth": "2 mm"}.
    progress : callable, optional
        Called with (done, total) steps.
    workpiece : SimulationResult, optional
        Run that has carved the workpiece before, as its `[stock]` was; the case cuts what that
        run has left, with the same resolution, and needs no `[stock]`. That run stays as it is.

    Returns
    -------
    SimulationResult
        A `MachineResult` where a machine makes the cut.

    Raises
    ------
    InputError
        If the case lacks something or asks for what cannot be simulated, cannot cut the workpiece
        given, or its machine cannot make the cut.
    DisplacedTooFarError
        If the tool moves so far that the model no longer holds; its `result` is the run until then.

    Notes
    -----
    An interruption (Ctrl-C) ends the run, not the program: the result holds what was simulated.
    """
    if overrides:
        case = case.patch(overrides)
    setup = set_up(case) if workpiece is None else set_up_on(case, workpiece)
    result, _ = run_setup(setup, progress)
    if not result.complete and not result.interrupted:
        raise DisplacedTooFarError(result)
    return with_verdict(result)


def run_setup(setup: Setup, progress: Progress = no_progress) -> tuple[SimulationResult, int]:
    """Run what was set up, once, and return the signals and the number of steps done.

    Where the tool moves too far the run ends there; the result is not complete.
    """
    stride, steps = setup.resolution.stride, setup.steps
    if steps > _MOST_STEPS:
        raise InputError(
            f"{setup.case.name}: simulation: the run has {steps:.3g} steps; at most "
            f"{_MOST_STEPS:.0e} are allowed: shorten it, or give fewer simulation.steps"
        )
    cut = CutRun(setup, stride, steps)
    done = cut.steps(steps, progress=progress)
    rows = max(done, 0) // stride + 1
    signals = {
        "setup": setup if cut.stock is None else after_run(setup, cut.stock),
        "rows": as_measured(setup.case, cut.rows[:rows], stride * setup.step),
        "between": cut.between[:rows],
        "energy": _energy(cut),
        "complete": done == steps,
        "interrupted": cut.interrupted,
    }
    if setup.on_machine is None:
        return SimulationResult(**signals), done
    return MachineResult(
        **signals,
        ports=setup.structure.tables.port,
        moved=cut.ports.displacement[:rows],
        moving=cut.ports.velocity[:rows],
        driven=cut.ports.force[:rows],
        start_angle=cut.angle if setup.turned_by_port else math.nan,
    ), done


def _energy(cut: CutRun) -> dict[str, float]:
    """Work of the cutting force on modes, energy dissipated in them and stored, J.

    Of a machine whose structure follows its axes: work of all forces, and of the travel as well.
    """
    if cut.setup.on_machine is not None:
        energy = energy_of_structure(cut.setup.structure.tables)
        return {"cut" if name == "loads" else name: value for name, value in energy.items()}
    account, *frictions = cut.setup.structure.tables.implicit
    work, dissipated = account.energy
    rubbed = sum(group.work[0] for group in frictions if isinstance(group, FrictionsOnPorts))
    return {
        "work": float(work),
        "dissipated": float(dissipated + rubbed),
        "stored": stored_energy(account, cut.bus),
    }


def as_measured(case: Case, rows: NDArray[np.float64], step: float) -> NDArray[np.float64]:
    """Rows of a record whose forces have gone through the dynamometer of a case.

    Rows (n, c) with the forces, N, in the first three columns, a step apart, s; the same where the
    case has no [dynamometer].
    """
    sensor = case.dynamometer
    if sensor is None or len(rows) < 2:
        return rows
    measured = rows.copy()
    for column, axis in enumerate("xyz"):
        force = rows[:, column]
        for one in sensor.along(axis):
            seen = through_resonance(force[:, None], one.frequency, one.damping, step)[:, 0]
            # static shares: what goes through none is seen as it is
            measured[:, column] += one.share * (seen - force)
    return measured


def through_resonance(
    force: NDArray[np.float64], frequency: float, damping: float, step: float
) -> NDArray[np.float64]:
    """Answer (n, k) of m''/w^2 + 2 D m'/w + m = f to forces (n, k) that are linear in steps.

    Natural frequency, Hz, damping D and step, s; the sensor is at rest at the first row, where a
    force may set in at once. Exact for a force that varies linearly from row to row.
    """
    # slow to import, and few cases have a dynamometer
    from scipy.signal import lfilter

    ramped, held, denominator = _resonance_filter(frequency, damping, step)
    # what is there at the first row is held from there on, and did not rise to it before
    first = force[:1]
    rest = lfilter(ramped, denominator, force - first, axis=0)
    if not np.any(first):
        return rest
    return rest + first * lfilter(held, denominator, np.ones((len(force), 1)), axis=0)


@lru_cache(_FILTERS_KEPT)
def _resonance_filter(
    frequency: float, damping: float, step: float
) -> tuple[tuple[float, ...], tuple[float, ...], tuple[float, ...]]:
    """Numerators of the z transfer of a resonance, and its denominator.

    For a force that is linear in a step, and for one that is held over it.
    """
    omega = 2.0 * math.pi * frequency
    matrix = omega * np.array([[0.0, 1.0], [-1.0, -2.0 * damping]])
    transition, held, ramp = exact_step(matrix, np.array([[0.0], [omega]]), step)
    held, ramp = held[:, 0], ramp[:, 0]
    # z transfer from the force at the beginning and at the end of a step
    trace, determinant = np.trace(transition), np.linalg.det(transition)
    ahead, behind = ramp, held - ramp
    first = [0.0, ahead[0], transition[0, 1] * ahead[1] - transition[1, 1] * ahead[0]]
    last = [0.0, behind[0], transition[0, 1] * behind[1] - transition[1, 1] * behind[0]]
    ramped = (first[1], first[2] + last[1], last[2])
    constant = (0.0, held[0], transition[0, 1] * held[1] - transition[1, 1] * held[0])
    return ramped, constant, (1.0, -trace, determinant)


#: port of the rotation of the tool
_TURNING = "tool turn"


@dataclass(frozen=True)
class MachineResult(SimulationResult):
    """Signals of a cut on a machine.

    Parameters
    ----------
    ports : mapping of str to int
        Column of each port of the machine in the following.
    moved, moving, driven : (n, p) array of float
        Displacement, m (rad), velocity, m/s, and force, N (N m), of the machine's ports: drives
        ("drive Y"), scales ("scale Y"), frictions ("friction guide"), the tool ("tool x").
    start_angle : float
        Of the spindle where the cut begins, rad.
    """

    ports: Mapping[str, int] = None
    moved: NDArray[np.float64] = None
    moving: NDArray[np.float64] = None
    driven: NDArray[np.float64] = None
    start_angle: float = 0.0

    @cached_property
    def spindle_angle(self) -> NDArray[np.float64]:
        """Angle (n,) turned by the spindle since the cut began, rad."""
        if not self.setup.turned_by_port:
            return super().spindle_angle
        return self.moved[:, self.ports[_TURNING]] - self.start_angle

    @cached_property
    def spindle_speed(self) -> NDArray[np.float64]:
        """Speed (n,) of the spindle, rad/s."""
        if not self.setup.turned_by_port:
            return super().spindle_speed
        return self.moving[:, self.ports[_TURNING]]

    def torque_of(self, drive: str) -> NDArray[np.float64]:
        """Torque (n,) of a drive by its name, N m (N of a linear one)."""
        return self.driven[:, self.ports[f"drive {drive}"]]

    def position_of(self, drive: str) -> NDArray[np.float64]:
        """Position (n,) at the scale of a drive's axis, m."""
        return self.moved[:, self.ports[f"scale {drive}"]]

    def summary(self) -> dict:
        """Return the content of summary.json."""
        summary = super().summary()
        machine = self.setup.on_machine.machine
        axes = self.setup.on_machine.file.axis
        summary["machine"] = {
            "file": self.setup.on_machine.file.name,
            "drives": {
                drive.name: {
                    "peak_effort": float(np.abs(self.torque_of(drive.name)).max(initial=0.0)),
                    "mean_effort": float(self.torque_of(drive.name)[self.settled].mean()),
                    "effort_unit": "N" if axes[drive.axis].drive.motor_is_linear else "N*m",
                }
                for drive in machine.drives
            },
            "spindle_speed_rpm": {
                "least": float(rpm(self.spindle_speed.min())),
                "mean": float(rpm(self.spindle_speed[self.settled].mean())),
            },
        }
        return summary
