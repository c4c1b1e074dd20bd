"""A move of a machine's axes: where they went, and where they should have gone."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path as FilePath
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from chatter.compile.linearised_friction import rigid_motion
from chatter.description.brief_repr import BriefRepr
from chatter.description.errors import InputError
from chatter.description.formatting import to_digits
from chatter.description.progress import Progress, no_progress
from chatter.engine.loop_stability import refuse_unstable_control
from chatter.io.presentation import presentation
from chatter.io.result_files import NotebookResult, as_json, write_results
from chatter.simulation.virtual_tests.run import MachineRun, RunInputs, run_machine
from dynamics.machine.description import Drive, Machine
from dynamics.machine.moving_structure import MachinesAlong
from dynamics.trajectory.motion import Trajectory, TrajectoryError
from dynamics.trajectory.path import Path, contour_error
from dynamics.trajectory.set_points import SetPoints, set_points
from dynamics.trajectory.spatial_path import PathInSpace

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: share of its way by which an axis is left behind
_LEFT_BEHIND = 0.5
#: errors of the summary, and where they are read
_PLACES_OF_ERRORS = {"motor_error_um": "motor", "tracking_error_um": "scale",
                     "tool_error_um": "tool"}  # fmt: skip


@dataclass(frozen=True, eq=False)
class MovePlan:
    """A trajectory for some axes."""

    trajectory: Trajectory  # one column an axis
    axes: Sequence[str]  # names, in the order of the columns
    cycle: float  # interpolation cycle of the control, s
    standstill: float = 0.0  # before the move, s
    afterwards: float = 0.1  # time simulated behind its end, s
    #: for the contour error: a plane path of the first two axes, or one in space of all of them
    path: Path | PathInSpace | None = None
    #: s, of the trajectory, between which the axes are to be on the path; always by default
    part: tuple[float, float] | None = None


@dataclass(frozen=True, eq=False, repr=False)
class MoveResult(BriefRepr, NotebookResult):
    """Signals of a move; columns are the axes of the plan."""

    name: str
    axes: tuple[str, ...]
    time: NDArray[np.float64]  # (n,), s
    wanted: NDArray[np.float64]  # (n, axes), set points, m, counted from the start
    velocity: NDArray[np.float64]  # (n, axes), at the motor, m/s
    motor: NDArray[np.float64]  # (n, axes), position by the motor's encoder, m
    scale: NDArray[np.float64]  # (n, axes), position at the direct measuring system, m
    tool: NDArray[np.float64] | None  # (n, axes), at the tool against the workpiece, m
    #: (n, axes), torque of the motors, N m, or force of linear ones, N; summed over those of an
    #: axis
    effort: NDArray[np.float64]
    #: (n,), distance of the tool (of the motors without tool point) from the path, m; with a sign
    #: where the path is plane
    contour: NDArray[np.float64] | None
    friction: dict[str, NDArray[np.float64]]  # (n,), forces of the frictions, N
    interrupted: bool
    #: of each axis, "N" of linear motors and "N*m" of others; none where motors are not known
    effort_units: tuple[str, ...] = ()
    #: J, over the move: work of motors and preloads, what frictions took, work of the travel in
    #: the strained structure, dissipated in it, stored in addition
    energy: dict[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()  # on how the move begins

    def effort_unit(self, column: int) -> str:
        """Unit of the effort of an axis."""
        return self.effort_units[column] if self.effort_units else "N or N*m"

    @property
    def tracking_error(self) -> NDArray[np.float64]:
        """Set point less position at the scale, m, (n, axes)."""
        return self.wanted - self.scale

    def summary(self) -> dict:
        """Largest errors and efforts, for people and machines."""
        axes = {}
        for column, axis in enumerate(self.axes):
            axes[axis] = {
                "tracking_error_um": _largest(self.tracking_error[:, column], 1e6),
                "motor_error_um": _largest((self.wanted - self.motor)[:, column], 1e6),
                "effort": _largest(self.effort[:, column], 1.0),
                "effort_unit": self.effort_unit(column),
            }
            if self.tool is not None:
                error = (self.wanted - self.tool)[:, column]
                axes[axis]["tool_error_um"] = _largest(error, 1e6)
        contour = None if self.contour is None else _largest(self.contour, 1e6)
        return {
            "machine": self.name,
            "duration_s": float(self.time[-1]) if self.time.size else 0.0,
            "axes": axes,
            "contour_error_um": contour,
            "interrupted": self.interrupted,
            "energy_J": self.energy,
            "notes": [*self.notes, *self.left_behind()],
        }

    def left_behind(self) -> list[str]:
        """Sentences on axes that do not follow their set points."""
        told = []
        for column, axis in enumerate(self.axes):
            travel = float(np.ptp(self.wanted[:, column])) if self.time.size else 0.0
            error = float(np.abs(self.tracking_error[:, column]).max(initial=0.0))
            if error > _LEFT_BEHIND * travel > 0.0:
                effort = float(np.abs(self.effort[:, column]).max())
                told.append(
                    f"axis {axis} does not follow: it is up to {1e3 * error:.4g} mm behind on a "
                    f"way of {1e3 * travel:.4g} mm, with at most {effort:.4g} "
                    f"{self.effort_unit(column).replace('*', ' ')}"
                )
        return told

    def sentences(self) -> list[str]:
        """Largest contour error, errors and effort of every axis, and axes that do not follow."""
        summary = self.summary()
        contour = summary["contour_error_um"]
        told = [] if contour is None else [f"largest contour error {to_digits(contour, 4)} um"]
        for axis, largest in summary["axes"].items():
            effort = f"{to_digits(largest['effort'], 4)} {largest['effort_unit'].replace('*', ' ')}"
            errors = ", ".join(
                f"{to_digits(largest[key], 4)} um at the {place}"
                for key, place in _PLACES_OF_ERRORS.items()
                if key in largest
            )
            told.append(f"axis {axis}: tracking error at most {errors}; effort at most {effort}")
        return [*told, *self.notes, *self.left_behind()]

    def plot(self) -> Figure:
        """Picture of the move."""
        return presentation("plots.move").plot_move(self)

    def save(self, folder: str | FilePath) -> list[FilePath]:
        """Write move.csv, move.png and summary.json."""
        texts = {"move.csv": self._csv(), "summary.json": as_json(self.summary())}
        return write_results(folder, texts, {"move.png": self.plot()})

    def _csv(self) -> str:
        names, columns = ["time [s]"], [self.time]
        for index, axis in enumerate(self.axes):
            names += [f"{axis} set [m]", f"{axis} motor [m]", f"{axis} scale [m]"]
            columns += [self.wanted[:, index], self.motor[:, index], self.scale[:, index]]
            if self.tool is not None:
                names.append(f"{axis} tool [m]")
                columns.append(self.tool[:, index])
            names += [f"{axis} velocity [m/s]", f"{axis} effort [{self.effort_unit(index)}]"]
            columns += [self.velocity[:, index], self.effort[:, index]]
        if self.contour is not None:
            names.append("contour error [m]")
            columns.append(self.contour)
        rows = np.column_stack(columns)
        lines = [",".join(f"{value:.9g}" for value in row) for row in rows]
        return "\n".join([",".join(names), *lines]) + "\n"


def move_axes(
    name: str,
    machine: Machine,
    step: float,
    plan: MovePlan,
    tool: NDArray[np.float64] | None = None,
    progress: Progress = no_progress,
    along: MachinesAlong | None = None,
) -> MoveResult:
    """Move the axes of a machine along a trajectory.

    The name is that of the machine, the step in s; `tool` (3, n) holds the rows of the tool's
    displacement against the workpiece, x, y, z. The structure follows the axes where it is given
    along them; the machine is that at their start. InputError if an axis is unknown or not under
    control, a loop is unstable, or the interpolation cycle does not fit the step; RunError if the
    machine runs away.
    """
    refuse_unstable_control(machine, step)
    return axes_moved(name, machine, step, plan, tool, progress, along)


def axes_moved(
    name: str,
    machine: Machine,
    step: float,
    plan: MovePlan,
    tool: NDArray[np.float64] | None = None,
    progress: Progress = no_progress,
    along: MachinesAlong | None = None,
) -> MoveResult:
    """Move the axes of a machine as `move_axes` does, without asking first for stable loops.

    A machine whose loops are unstable runs away: RunError.
    """
    motions = [rigid_motion(machine, {axis: 1.0}) for axis in plan.axes]
    points = _set_points(machine, plan, step)
    rows = (
        {} if tool is None else {f"tool {direction}": tool[i] for i, direction in enumerate("xyz")}
    )
    duration = len(points.position) * points.steps * step + plan.afterwards
    finer = _records_a_cycle(machine, points.steps)
    stride = points.steps // finer
    inputs = RunInputs(
        duration, points, outputs=rows, stride=stride, along=along, energy_accounted=True
    )
    run = _by_cycle(run_machine(machine, step, inputs, progress), finer)
    columns = [machine.axes.index(axis) for axis in plan.axes]
    # a row is read at the end of its cycle, when the next set point holds
    index = np.minimum(np.arange(1, len(run.time) + 1), len(points.position) - 1)
    wanted = points.position[index][:, columns]
    tip = None if tool is None else _at_tool(run, tool, motions)
    motor = _mean_of_drives(
        machine, plan.axes, lambda one: _travel(one) * run.displacement[f"drive {one.name}"]
    )
    contour = _contour(plan, run.time, motor if tip is None else tip)
    return MoveResult(
        name,
        tuple(plan.axes),
        run.time,
        wanted,
        _mean_of_drives(
            machine, plan.axes, lambda one: _travel(one) * run.velocity[f"drive {one.name}"]
        ),
        motor,
        _mean_of_drives(machine, plan.axes, lambda one: run.displacement[f"scale {one.name}"]),
        tip,
        _efforts(machine, run, plan.axes),
        contour,
        {one.name: -run.force[f"friction {one.name}"] for one in machine.frictions},
        run.interrupted,
        energy=dict(run.energy),
    )


def _contour(
    plan: MovePlan, time: NDArray[np.float64], travel: NDArray[np.float64]
) -> NDArray[np.float64] | None:
    """Distance from the path of axes that travelled from its start, m; None without a path.

    It is 0 where they are not to be on the path, in a run-in.
    """
    if plan.path is None:
        return None
    if isinstance(plan.path, PathInSpace):
        return plan.path.distance(travel)
    start = np.asarray(plan.trajectory.at(0.0).position, dtype=np.float64)[:2]
    error = contour_error(plan.path, travel[:, :2] + start).error
    if plan.part is None:
        return error
    begin, end = (plan.standstill + one for one in plan.part)
    return np.where((time >= begin) & (time <= end), error, 0.0)


def _records_a_cycle(machine: Machine, steps: int) -> int:
    """Records in a cycle of the set points: one a sample of the fastest velocity loop."""
    fastest = min(drive.controller.velocity.timing.sample_time for drive in machine.drives)
    slowest = max(drive.controller.position.timing.sample_time for drive in machine.drives)
    wanted = max(1, round(slowest / fastest))
    return max(count for count in range(1, wanted + 1) if steps % count == 0)


def _by_cycle(run: MachineRun, finer: int) -> MachineRun:
    """Motion at the end of every cycle, and the mean of the forces over it.

    The torque is a staircase of the loops inside; a sample of it would alias them.
    """
    rows = len(run.time) // finer

    def last(values: NDArray) -> NDArray[np.float64]:
        return values[finer - 1 :: finer][:rows]

    def mean(values: NDArray) -> NDArray[np.float64]:
        return values[: rows * finer].reshape(rows, finer).mean(axis=1)

    return MachineRun(
        last(run.time),
        {name: last(values) for name, values in run.displacement.items()},
        {name: last(values) for name, values in run.velocity.items()},
        {name: mean(values) for name, values in run.force.items()},
        run.interrupted,
        run.energy,
    )


def _travel(drive: Drive) -> float:
    """Travel per angle of a drive, m/rad."""
    return drive.controller.measuring.transmission


def _largest(values: NDArray[np.float64], factor: float) -> float:
    return float(np.max(np.abs(values), initial=0.0)) * factor


def _set_points(machine: Machine, plan: MovePlan, step: float) -> SetPoints:
    try:
        points = set_points(plan.trajectory, plan.cycle, step, plan.standstill)
    except TrajectoryError as error:
        raise InputError(str(error)) from error
    if points.position.shape[1] != len(plan.axes):
        raise InputError(
            f"the move has {points.position.shape[1]} axes, but {len(plan.axes)} are named: "
            f"{', '.join(plan.axes)}"
        )
    for axis in plan.axes:
        if axis not in machine.axes:
            known = ", ".join(f'"{one}"' for one in machine.axes)
            raise InputError(f'the move asks for axis "{axis}"; the machine has {known}')
    position, velocity, acceleration = np.zeros((3, len(points.position), len(machine.axes)))
    columns = [machine.axes.index(axis) for axis in plan.axes]
    # the machine stands at rest where the move begins
    position[:, columns] = points.position - points.position[0]
    velocity[:, columns] = points.velocity
    acceleration[:, columns] = points.acceleration
    return SetPoints(position, velocity, acceleration, points.steps)


def _at_tool(run: MachineRun, tool: NDArray, motions: Sequence[NDArray]) -> NDArray[np.float64]:
    """Axis coordinates (n, axes) of the tool against the workpiece."""
    moved = np.array([run.displacement[f"tool {direction}"] for direction in "xyz"])
    directions = np.array([tool @ direction for direction in motions]).T
    return np.linalg.lstsq(directions, moved, rcond=None)[0].T


def _mean_of_drives(
    machine: Machine, axes: Sequence[str], signal: Callable[[Drive], NDArray]
) -> NDArray[np.float64]:
    """Signal of each axis, (n, axes): the mean over its drives."""
    return np.array(
        [
            np.mean([signal(drive) for drive in machine.drives if drive.axis == axis], axis=0)
            for axis in axes
        ]
    ).T


def _efforts(machine: Machine, run: MachineRun, axes: Sequence[str]) -> NDArray[np.float64]:
    sums = [
        sum(run.force[f"drive {one.name}"] for one in machine.drives if one.axis == axis)
        for axis in axes
    ]
    return np.array(sums).T
