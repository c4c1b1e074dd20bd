"""Run a case in the time domain."""

from __future__ import annotations

import math

import numpy as np

from chatter.case import Case
from chatter.errors import InputError, RunError
from chatter.simulation.engine import COLUMNS, Record, run
from chatter.simulation.result import SimulationResult
from chatter.simulation.setup import Setup, set_up
from chatter.simulation.spindle import prescribed
from chatter.stability.sweep import Progress, no_progress
from cutting.tool_point import tool_point
from dynamics.modal_steps import modal_steps, stored_energy

#: steps between two looks at the keyboard and the progress bar
_STEPS_A_CHUNK = 20_000
#: a run may be this long, in steps
_MOST_STEPS = 2_000_000_000


def simulate(case: Case, progress: Progress = no_progress) -> SimulationResult:
    """Simulate the cut of a case from rest in full immersion.

    Parameters
    ----------
    case : Case
        `[simulation]` gives the chip and the length of the run; a case without a structure is
        cut by a rigid tool.
    progress : callable, optional
        Called with (done, total) steps.

    Returns
    -------
    SimulationResult

    Raises
    ------
    InputError
        If the case lacks something or asks for what cannot be simulated.
    RunError
        If the tool moves so far that the model no longer holds.
    """
    setup = set_up(case)
    result, done = run_setup(setup, progress)
    if done < setup.resolution.steps:
        raise RunError(
            f"{case.name}: after {done * setup.step:.4g} s the tool is displaced by more than "
            f"{setup.furthest * 1e3:.3g} mm, a share of its radius at which the model of the cut "
            "no longer holds; the cut is far from stable, or the structure too soft"
        )
    return result


def _run_before(setup: Setup, record: Record) -> None:
    """Carve the workpiece with the tool at rest for the turns before the start."""
    bins = setup.resolution.steps_a_turn
    count = setup.turns_before * bins
    rigid = modal_steps((), setup.step)
    turns = prescribed(setup.spindle, setup.path, bins, setup.step, -1 - count, count)
    # a stride beyond the end of the chunk records nothing
    unrecorded = Record(count + 2, record.rows)
    run(setup.groups, rigid, tool_point(), turns, unrecorded, np.zeros((0, 2)), 0, math.inf, bins)
    setup.groups[0].removed[0] = 0.0


def run_setup(setup: Setup, progress: Progress = no_progress) -> tuple[SimulationResult, int]:
    """Run what was set up, once, and return the result and the number of steps done."""
    resolution = setup.resolution
    steps, bins = resolution.steps, resolution.steps_a_turn
    if steps > _MOST_STEPS:
        raise InputError(
            f"{setup.case.name}: simulation: the run has {steps:.3g} steps; at most "
            f"{_MOST_STEPS:.0e} are allowed: shorten it, or give fewer simulation.steps"
        )
    modes = modal_steps(setup.modes, setup.step)
    point = tool_point()
    record = Record(resolution.stride, np.zeros((steps // resolution.stride + 1, len(COLUMNS))))
    scratch = np.zeros((len(setup.modes), 2))
    if setup.turns_before:
        _run_before(setup, record)
    furthest = setup.furthest if setup.modes else math.inf
    done = -1
    while done < steps:
        count = min(_STEPS_A_CHUNK, steps - done)
        turns = prescribed(setup.spindle, setup.path, bins, setup.step, done, count)
        ran = run(setup.groups, modes, point, turns, record, scratch, done, furthest, bins)
        done += ran
        progress(done, steps)
        if ran < count:
            break
    rows = done // resolution.stride + 1
    work, dissipated = modes.energy
    result = SimulationResult(
        setup=setup,
        rows=record.rows[:rows],
        energy={
            "work": float(work),
            "dissipated": float(dissipated),
            "stored": stored_energy(modes),
        },
        complete=done == steps,
    )
    return result, done
