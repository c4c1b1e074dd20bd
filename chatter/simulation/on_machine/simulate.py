"""Run a case on its machine in the time domain."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.description.errors import RunError
from chatter.description.progress import Progress, no_progress
from chatter.description.units import rpm
from chatter.engine.loop import COLUMNS, Record
from chatter.engine.machine_cut_loop import CoupledRecord, run_coupled
from chatter.engine.machine_loop import advance
from chatter.simulation.carved_workpiece import after_run
from chatter.simulation.on_machine.setup import MachineSetup, set_up_machine, tool_side
from chatter.simulation.result import SimulationResult
from chatter.simulation.simulate import ChunkedRun
from cutting.chip.tool_point import tool_point
from dynamics.machine.loop import Loads

#: columns of the cut in a record
_CUT_COLUMNS = 9
_STEPS_A_CHUNK = 20_000


@dataclass(frozen=True)
class MachineResult(SimulationResult):
    """Signals of a cut on a machine.

    Parameters
    ----------
    turned : (n, 2) array of float
        Angle, rad, and speed, rad/s, of the spindle.
    ports : mapping of str to int
        Column of each port of the machine in the following.
    moved, driven : (n, p) array of float
        Displacement, m (rad), and force held, N (N m), of the machine's ports: drives ("drive Y"),
        scales ("scale Y"), frictions ("friction guide").
    """

    turned: NDArray[np.float64] = None
    ports: Mapping[str, int] = None
    moved: NDArray[np.float64] = None
    driven: NDArray[np.float64] = None

    @cached_property
    def time(self) -> NDArray[np.float64]:
        """Time (n,) of the rows since the cut began, s."""
        stride = self.setup.resolution.stride
        return self.setup.step * stride * np.arange(1, len(self.rows) + 1)

    @cached_property
    def spindle_angle(self) -> NDArray[np.float64]:
        """Angle (n,) turned by the spindle since the cut began, rad."""
        return self.turned[:, 0]

    @cached_property
    def spindle_speed(self) -> NDArray[np.float64]:
        """Speed (n,) of the spindle, rad/s."""
        return self.turned[:, 1]

    def torque_of(self, drive: str) -> NDArray[np.float64]:
        """Torque (n,) of a drive by its name, N m (N of a linear one)."""
        return self.driven[:, self.ports[f"drive {drive}"]]

    def position_of(self, drive: str) -> NDArray[np.float64]:
        """Position (n,) at the scale of a drive's axis, m."""
        return self.moved[:, self.ports[f"scale {drive}"]]

    def summary(self) -> dict:
        """Return the content of summary.json."""
        told = super().summary()
        machine = self.setup.on_machine.machine
        told["machine"] = {
            "file": self.setup.on_machine.file.name,
            "drives": {
                drive.name: {
                    "peak_effort": float(np.abs(self.torque_of(drive.name)).max(initial=0.0)),
                    "mean_effort": float(self.torque_of(drive.name)[self.settled].mean()),
                }
                for drive in machine.drives
            },
            "spindle_speed_rpm": {
                "least": float(rpm(self.spindle_speed.min())),
                "mean": float(rpm(self.spindle_speed[self.settled].mean())),
            },
        }
        return told


def simulate_on_machine(
    case: Case, progress: Progress = no_progress, setup: MachineSetup | None = None
) -> MachineResult:
    """Simulate the cut of a case together with the machine that it names.

    The machine first runs in the air until its axes have their feed; then the cut begins, in full
    immersion, or where the tool meets the stock.

    Parameters
    ----------
    case : Case
    progress : callable, optional
        Called with (done, total) steps.
    setup : MachineSetup, optional
        For one run: it holds the state.

    Raises
    ------
    InputError
        If the case cannot be simulated or the machine cannot make the cut.
    RunError
        If the tool moves so far that the model no longer holds.
    """
    setup = set_up_machine(case) if setup is None else setup
    s, machine = setup.tables.steps, setup.tables.groups
    still = Loads(np.zeros(0, dtype=np.int64), np.zeros((2, 0)))
    advance(machine, s, still, 0, setup.settling)
    tool, point = tool_side(setup), tool_point()
    record = _record(setup)
    cut = ChunkedRun(setup)
    if setup.turns_before:
        cut.carve_before(Record(1, np.zeros((1, len(COLUMNS)))))
    total, done, interrupted = setup.steps, -1, False
    groups = setup.groups
    while done < total:
        count = min(cut.chunk, _STEPS_A_CHUNK, total - done)
        if cut.stock is not None:
            groups = (cut.stock.follow(setup.path.feed * max(done, 0) * setup.step), *groups[1:])
        try:
            ran = run_coupled(
                groups, machine, s, tool, point, record, setup.settling, done, count, setup.furthest
            )
            done += ran
            progress(done, total)
        except KeyboardInterrupt:
            interrupted = True
            break
        if ran < count:
            break
    if done < total and not interrupted:
        raise RunError(
            f"{case.name}: after {done * setup.step:.4g} s the tool is displaced by more than "
            f"{setup.furthest * 1e3:.3g} mm, a share of its radius at which the model of the cut "
            "no longer holds; the cut is far from stable, or the machine too soft"
        )
    rows = max(done, 0) // record.stride
    return MachineResult(
        setup=setup if cut.stock is None else after_run(setup, cut.stock),
        rows=record.cut[:rows, :7],
        energy={},
        complete=done == total,
        interrupted=interrupted,
        turned=record.cut[:rows, 7:],
        ports=setup.tables.port,
        moved=record.displacement[:rows],
        driven=record.force[:rows],
    )


def _record(setup: MachineSetup) -> CoupledRecord:
    stride = setup.resolution.stride
    rows = setup.steps // stride
    ports = np.arange(len(setup.tables.port), dtype=np.int64)
    shape = (rows, len(ports))
    return CoupledRecord(
        stride, np.empty((rows, _CUT_COLUMNS)), ports, np.empty(shape), np.empty(shape)
    )
