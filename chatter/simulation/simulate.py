"""Run a case in the time domain."""

from __future__ import annotations

import math

import numpy as np

from chatter.description.case import Case
from chatter.description.errors import InputError, RunError
from chatter.description.progress import Progress, no_progress
from chatter.engine.loop import COLUMNS, Record, run
from chatter.simulation.carved_workpiece import FollowingStock, after_run, set_up_on
from chatter.simulation.dynamometer import as_measured
from chatter.simulation.result import SimulationResult
from chatter.simulation.setup import Setup, set_up
from chatter.simulation.spindle import prescribed
from chatter.simulation.workpiece import STEPS_A_CHUNK, follows, reach_of, steps_a_chunk
from cutting.chip.discrete_chip import DiscreteCut
from cutting.chip.tool_point import tool_point
from cutting.dexel.stock import DexelStock
from dynamics.modal.modal_steps import ModalSteps, modal_steps, stored_energy

#: a run may be this long, in steps
_MOST_STEPS = 2_000_000_000


def simulate(
    case: Case,
    progress: Progress = no_progress,
    workpiece: SimulationResult | None = None,
) -> SimulationResult:
    """Simulate the cut of a case from rest in full immersion.

    Parameters
    ----------
    case : Case
        `[simulation]` gives the chip and the length of the run; a case without a structure is
        cut by a rigid tool.
    progress : callable, optional
        Called with (done, total) steps.
    workpiece : SimulationResult, optional
        Run that has carved the workpiece before, as its `[stock]` was; the case cuts what that
        run has left, with the same resolution, and needs no `[stock]`. That run stays as it is.

    Returns
    -------
    SimulationResult

    Raises
    ------
    InputError
        If the case lacks something or asks for what cannot be simulated, or cannot cut the
        workpiece given.
    RunError
        If the tool moves so far that the model no longer holds.

    Notes
    -----
    An interruption (Ctrl-C) ends the run, not the program: the result holds what was simulated.
    """
    if workpiece is None and case.structure is not None and case.structure.machine is not None:
        from chatter.simulation.on_machine.simulate import simulate_on_machine

        return simulate_on_machine(case, progress)
    setup = set_up(case) if workpiece is None else set_up_on(case, workpiece)
    result, done = run_setup(setup, progress)
    if done < setup.resolution.steps and not result.interrupted:
        raise RunError(
            f"{case.name}: after {done * setup.step:.4g} s the tool is displaced by more than "
            f"{setup.furthest * 1e3:.3g} mm, a share of its radius at which the model of the cut "
            "no longer holds; the cut is far from stable, or the structure too soft"
        )
    return result


def _following_stock(setup: Setup) -> FollowingStock | None:
    """Stock that follows the tool; None where it is held as a whole, or there is none."""
    cut = setup.groups[0]
    if not (isinstance(cut, DiscreteCut) and follows(setup.case, setup.path)):
        return None
    size = cut.stock.spacing if isinstance(cut.stock, DexelStock) else cut.stock.cell
    return FollowingStock(setup.case, cut, reach_of(setup.case, setup.cutter, setup.slices, size))


class ChunkedRun:
    """Steps of a run in chunks, between which the stock follows the tool.

    Parameters
    ----------
    setup : Setup
        For one run: its groups change.
    """

    def __init__(self, setup: Setup) -> None:
        self.setup = setup
        self.interrupted = False
        self.stock = _following_stock(setup)
        self.chunk = STEPS_A_CHUNK
        if self.stock is not None:
            self.chunk = steps_a_chunk(setup.case, setup.slices, setup.resolution)

    def steps(
        self,
        modes: ModalSteps,
        furthest: float,
        record: Record,
        first: int,
        last: int,
        progress: Progress = no_progress,
        ramp: int = 0,
    ) -> int:
        """Do the steps first + 1 to last from rest and return the last one done.

        Parameters
        ----------
        modes : ModalSteps
        furthest : float
            Displacement at which the run is left, m.
        record : Record
        first, last : int
        progress : callable
            Called with (done, total) steps.
        ramp : int
            Steps over which the structure comes to feel the cutting force.
        """
        setup, bins = self.setup, self.setup.resolution.steps_a_turn
        point, scratch = tool_point(), np.zeros((len(modes.mass), 2))
        # a rigid tool, which carves before the start, has no modes that rub
        frictions = setup.frictions if len(modes.mass) else ()
        done, groups = first, setup.groups
        while done < last:
            count = min(self.chunk, last - done)
            turns = prescribed(setup.spindle, setup.path, bins, setup.step, done, count, ramp)
            if self.stock is not None:
                groups = (self.stock.follow(float(turns.x[0])), *setup.groups[1:])
            try:
                ran = run(
                    groups,
                    modes,
                    frictions,
                    point,
                    turns,
                    record,
                    scratch,
                    done,
                    furthest,
                    bins,
                )
                done += ran
                progress(done, last)
            except KeyboardInterrupt:
                self.interrupted = True
                break
            if ran < count:
                break
        return done

    def carve_before(self, record: Record) -> None:
        """Carve the workpiece with the tool at rest for the turns before the start."""
        count = self.setup.turns_before * self.setup.resolution.steps_a_turn
        # a stride beyond the end of the run before records nothing
        unrecorded = Record(count + 2, record.rows)
        rigid = modal_steps((), self.setup.step)
        self.steps(rigid, math.inf, unrecorded, -1 - count, -1)
        self.setup.groups[0].removed[0] = 0.0


def run_setup(setup: Setup, progress: Progress = no_progress) -> tuple[SimulationResult, int]:
    """Run what was set up, once, and return the result and the number of steps done."""
    resolution = setup.resolution
    steps = resolution.steps
    if steps > _MOST_STEPS:
        raise InputError(
            f"{setup.case.name}: simulation: the run has {steps:.3g} steps; at most "
            f"{_MOST_STEPS:.0e} are allowed: shorten it, or give fewer simulation.steps"
        )
    modes = modal_steps(setup.modes, setup.step)
    record = Record(resolution.stride, np.zeros((steps // resolution.stride + 1, len(COLUMNS))))
    cut = ChunkedRun(setup)
    if setup.turns_before:
        cut.carve_before(record)
    furthest = setup.furthest if setup.modes else math.inf
    done = cut.steps(modes, furthest, record, -1, steps, progress)
    rows = done // resolution.stride + 1
    work, dissipated = modes.energy
    result = SimulationResult(
        setup=setup if cut.stock is None else after_run(setup, cut.stock),
        rows=as_measured(setup.case, record.rows[:rows], resolution.stride * setup.step),
        energy={
            "work": float(work),
            "dissipated": float(dissipated),
            "stored": stored_energy(modes),
        },
        complete=done == steps,
        interrupted=cut.interrupted,
    )
    return result, done
