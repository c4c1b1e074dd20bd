"""A run of what was set up: chunks of steps, between which the stock follows the tool."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from chatter.description.progress import Progress, no_progress
from chatter.engine.cut import (
    CutOnPorts,
    PrescribedSpindle,
    SpindleOnPort,
    ToolAlongPath,
    ToolOnModes,
    ToolOnPorts,
    TurningPath,
    tool_point_on_modes,
)
from chatter.engine.interruption import interruptions_deferred
from chatter.engine.loop import Laws, run
from chatter.engine.record import PortRecord, cut_record, port_record
from chatter.simulation.carved_workpiece import FollowingStock
from chatter.simulation.setup import Setup
from chatter.simulation.spindle import bins_at, counted_spindle, prescribed_path, prescribed_spindle
from chatter.simulation.start_in_stock import clear_position
from chatter.simulation.tool_course import ToolCourse
from chatter.simulation.workpiece import STEPS_A_CHUNK, follows, reach_of, steps_a_chunk
from cutting.chip.delayed_chip import DelayedCut
from cutting.chip.discrete_chip import DiscreteCut
from cutting.chip.regeneration import motion_before
from cutting.chip.tool_point import ToolPoint, tool_point
from cutting.dexel.carving import dexel_flush
from cutting.dexel.stock import DexelStock
from dynamics.machine.tables import modal_tables

#: share of a step by which an instant lies behind one that rounding may have moved
_JUST_BEHIND = 1e-3


class CutRun:
    """Steps of a cut from rest; a machine has run in the air before, until it has its feed.

    The set-up, which holds the state, serves one run. The stride is from one row of the records to
    the next; their size follows from the steps of the whole run. `done` counts the steps done, -1
    before the start has been evaluated; `rows` (n, 7) are the record at the tool point, `between`
    (n, 7) what happens between them, `ports` the record of the ports of a machine, or None; `angle`
    is that of the spindle where the cut begins, rad, of a machine that turns it.
    """

    def __init__(self, setup: Setup, stride: int, steps: int) -> None:
        self.setup = setup
        self.interrupted = False
        self.stock = _following_stock(setup)
        self.bus = setup.structure.tables.bus
        self.point = _tool_point(setup)
        self.ports: PortRecord | None = None
        if setup.on_machine is not None:
            self.ports = port_record(steps // stride + 1, len(self.bus.u), stride, 0)
        self.record(stride, 0, steps)
        self._run_in_the_air()
        port = setup.structure.tables.port
        self._tool = _tool(setup)
        self._in_air = False
        if setup.turned_by_port:
            self.angle = float(self.bus.u[port["tool turn"]])
        self.done = -1
        self._carve_before()

    def record(self, stride: int, first: int, steps: int) -> None:
        """Begin a record of the tool point, from a step on over so many."""
        record = cut_record(self.point, steps // stride + 1, stride, first)
        self.rows, self.between = record.rows, record.between
        ports = () if self.ports is None else (self.ports,)
        self._observers = (record, *ports)

    def _run_in_the_air(self) -> None:
        """Let a machine come to its feed."""
        structure = self.setup.structure
        if structure.settling:
            laws = Laws(structure.tables.explicit, (), structure.tables.implicit)
            with interruptions_deferred():
                run(laws, self.bus, 0, 0, structure.settling)

    def _carve_before(self) -> None:
        """Carve the workpiece with the tool at rest for the turns before the start."""
        setup = self.setup
        if not setup.revolutions_before:
            return
        if setup.on_machine is not None:
            # the tool turns and is fed as prescribed, whatever the machine does
            rigid = replace(
                setup.structure,
                modes=(),
                tables=modal_tables((), setup.step),
                on_machine=None,
                settling=0,
            )
            self.stock = CutRun(replace(setup, structure=rigid), 1, 0).stock
            return
        self.done -= setup.revolutions_before * setup.resolution.steps_per_revolution
        self.steps(-1)
        setup.groups[0].removed[0] = 0.0

    def steps(
        self,
        last: int,
        share: Callable[[NDArray[np.int64]], NDArray[np.float64]] | None = None,
        progress: Progress = no_progress,
    ) -> int:
        """Go on to a step and return the number of the last one done.

        The force ramp `share` is the share of the cutting force that the structure feels at steps
        by their numbers (n,); 1 by default. Progress is called with (done, total) steps.
        """
        tables, before = self.setup.structure.tables, self.setup.structure.settling
        while self.done < last:
            count = min(self._chunk, last - self.done, self._steps_to_change())
            laws = Laws(
                tables.explicit, (self._cut(count, share),), tables.implicit, self._observers
            )
            try:
                with interruptions_deferred():
                    ran = run(laws, self.bus, self.done, before, count)
                self.done += ran
                progress(self.done, last)
            except KeyboardInterrupt:
                self.interrupted = True
                break
            if ran < count:
                break
        return self.done

    @property
    def _chunk(self) -> int:
        """Steps between two moves of the stock."""
        if self.stock is None:
            return STEPS_A_CHUNK
        return steps_a_chunk(self.setup.case, self.setup.slices, self.setup.resolution)

    def _cut(
        self, count: int, share: Callable[[NDArray[np.int64]], NDArray[np.float64]] | None
    ) -> CutOnPorts:
        """Cut over the next steps."""
        setup = self.setup
        number = np.arange(self.done, self.done + count + 1)
        time = number * setup.step
        path = prescribed_path(setup.path, time, None if share is None else share(number))
        groups, tool = setup.groups, self._tool
        if self.stock is not None:
            groups = (self.stock.follow(float(path.x[0])), *groups[1:])
        if isinstance(setup.path, ToolCourse):
            groups = self._laws_of(setup.path, float(time[0]))
            path = TurningPath(*path, self._heading(setup.path, time))
            if isinstance(tool, ToolOnPorts):
                tool = ToolAlongPath(tool.port, tool.origin, *self._travel(setup.path, time))
        return CutOnPorts(
            laws=groups,
            spindle=self._spindle(number, time),
            path=path,
            point=self.point,
            tool=tool,
            furthest=setup.furthest if setup.modes or setup.on_machine else math.inf,
        )

    def _steps_to_change(self) -> int:
        """Steps to where the tool of a program next enters or leaves the air."""
        path = self.setup.path
        if not isinstance(path, ToolCourse):
            return STEPS_A_CHUNK
        step = self.setup.step
        change = path.next_change((self.done + _JUST_BEHIND) * step)
        if math.isinf(change):
            return STEPS_A_CHUNK
        return max(1, math.ceil(change / step - _JUST_BEHIND) - self.done)

    def _laws_of(self, course: ToolCourse, time: float) -> tuple:
        """Laws at the tool point from a time on: none where the tool is in the air."""
        setup = self.setup
        cuts = course.cuts_at(max(time, 0.0) + _JUST_BEHIND * setup.step)
        if cuts and self._in_air:
            self._enter(course, time)
        if not cuts and not self._in_air:
            _finish_carving(setup.groups[0])
        self._in_air = not cuts
        return setup.groups if cuts else ()

    def _enter(self, course: ToolCourse, time: float) -> None:
        """Let the tool come out of the air: what it found before is no more."""
        setup = self.setup
        cut = setup.groups[0]
        if isinstance(cut, DiscreteCut):
            clear_position(
                setup.case, cut, setup.slices, course.position_at(np.array([time]))[:, 0]
            )
        elif isinstance(cut, DelayedCut):
            cut.history[...] = self._motion_up_to(course, time)

    def _motion_up_to(self, course: ToolCourse, time: float) -> NDArray[np.float64]:
        """Motion over the last revolution of a tool that has come straight, by bins (2, b, 3)."""
        setup, bins = self.setup, self.setup.resolution.steps_per_revolution
        if setup.turned_by_port:
            turning = setup.structure.tables.port["tool turn"]
            bin_now = (float(self.bus.u[turning]) - self.angle) * bins / (2.0 * math.pi)
        else:
            bin_now = float(setup.spindle.angle_at(np.array(time))) * bins / (2.0 * math.pi)
        speed = float(setup.spindle.speed_at(np.array([time + _JUST_BEHIND * setup.step]))[0])
        whole = math.floor(bin_now)
        behind = np.arange(bins, -1, -1) + bin_now - whole
        before = behind * (2.0 * math.pi / (bins * speed))
        motion = course.trajectory.at(np.array([time]))
        places = motion.position[0, :2, None] - before * motion.velocity[0, :2, None]
        # the row of a bin is that of the spindle angle at which the tool was there
        return np.roll(motion_before(places), whole % bins, axis=1)

    def _heading(self, course: ToolCourse, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Direction of the feed, bins of a revolution."""
        bins = self.setup.resolution.steps_per_revolution
        turned = course.heading_at(time) / (2.0 * math.pi)
        # rounding must not make a whole revolution of a direction just below +x
        return np.minimum(np.mod(turned, 1.0) * bins, np.nextafter(bins, 0.0))

    def _travel(
        self, course: ToolCourse, time: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Travel since the start that the axes of the machine make, m, and velocity, (n, 3)."""
        motion = course.trajectory.at(time)
        start = course.trajectory.at(np.zeros(1)).position
        made = np.array([axis in self.setup.on_machine.travels for axis in "xyz"], dtype=np.float64)
        return made * (motion.position - start), made * motion.velocity

    def _spindle(
        self, number: NDArray[np.int64], time: NDArray[np.float64]
    ) -> PrescribedSpindle | SpindleOnPort:
        setup, bins = self.setup, self.setup.resolution.steps_per_revolution
        if setup.turned_by_port:
            turning = setup.structure.tables.port["tool turn"]
            return SpindleOnPort(turning, self.angle, bins)
        if setup.on_machine is None and setup.spindle.has_constant_speed:
            return counted_spindle(setup.spindle, time, number, bins)
        return prescribed_spindle(setup.spindle, time, bins_at(setup.spindle, time, bins), bins)


def _finish_carving(cut: object) -> None:
    """Carry out the cuts that wait for an edge to move on, which it does not in the air."""
    if isinstance(cut, DiscreteCut) and isinstance(cut.stock, DexelStock):
        dexel_flush(cut.stock)


def _tool_point(setup: Setup) -> ToolPoint:
    """Tool point at rest."""
    if setup.on_machine is None:
        return tool_point_on_modes(setup.structure.tables.bus)
    return tool_point()


def _tool(setup: Setup) -> ToolOnModes | ToolOnPorts:
    """Ports of the tool; what the axes of a machine do not feed is prescribed."""
    if setup.on_machine is None:
        return ToolOnModes()
    tables = setup.structure.tables
    port = np.array([tables.port[f"tool {axis}"] for axis in "xyz"], dtype=np.int64)
    if isinstance(setup.path, ToolCourse):
        return ToolOnPorts(port, tables.bus.u[port], np.zeros(3))
    feed = setup.path.feed if setup.on_machine.feeds else 0.0
    return ToolOnPorts(port, tables.bus.u[port], np.array([feed, 0.0, 0.0]))


def _following_stock(setup: Setup) -> FollowingStock | None:
    """Stock that follows the tool; None where it is held as a whole, or there is none."""
    cut = setup.groups[0]
    if not (isinstance(cut, DiscreteCut) and follows(setup.case, setup.path)):
        return None
    size = cut.stock.spacing
    return FollowingStock(setup.case, cut, reach_of(setup.case, setup.cutter, setup.slices, size))
