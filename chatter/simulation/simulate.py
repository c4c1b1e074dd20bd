"""Run a case in the time domain."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from chatter.description.case import Case
from chatter.description.errors import InputError, RunError
from chatter.description.progress import Progress, no_progress
from chatter.simulation.carved_workpiece import after_run, set_up_on
from chatter.simulation.cut_run import CutRun
from chatter.simulation.dynamometer import as_measured
from chatter.simulation.machine_result import MachineResult
from chatter.simulation.result import SimulationResult
from chatter.simulation.setup import Setup, set_up
from chatter.simulation.verdict import with_verdict
from dynamics.machine.groups import FrictionsOnPorts
from dynamics.machine.modal_structure import stored_energy

#: a run may be this long, in steps
_MOST_STEPS = 2_000_000_000


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
    RunError
        If the tool moves so far that the model no longer holds.

    Notes
    -----
    An interruption (Ctrl-C) ends the run, not the program: the result holds what was simulated.
    """
    if overrides:
        case = case.patch(overrides)
    setup = set_up(case) if workpiece is None else set_up_on(case, workpiece)
    result, done = run_setup(setup, progress)
    if not result.complete and not result.interrupted:
        body = "machine" if setup.on_machine is not None else "structure"
        raise RunError(
            f"{case.name}: after {done * setup.step:.4g} s the tool is displaced by more than "
            f"{setup.furthest * 1e3:.3g} mm, a share of its radius at which the model of the cut "
            f"no longer holds; the cut is far from stable, or the {body} too soft"
        )
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
    """Work of the cutting force on modes, energy dissipated in them and stored, J."""
    if cut.setup.on_machine is not None:
        return {}
    account, *frictions = cut.setup.structure.tables.implicit
    work, dissipated = account.energy
    rubbed = sum(group.work[0] for group in frictions if isinstance(group, FrictionsOnPorts))
    return {
        "work": float(work),
        "dissipated": float(dissipated + rubbed),
        "stored": stored_energy(account, cut.bus),
    }
