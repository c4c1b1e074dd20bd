"""Candidates simulated in the time domain, with all that the linear search leaves out.

Teeth that leave the cut, ploughing in full, contact and friction of modes act there, and the wall
is built up of the passes of the edges. The run starts from rest in the full cut, a push as large as
the cut itself gives. Below the limit of small vibration such a push may already lead to chatter
that stays (the bistable or unsafe zone of Dombovari, Barton, Wilson and Stepan 2011, Int. J.
Non-Linear Mech. 46:266), which the linear limit does not know.
"""

from __future__ import annotations

import math

import numpy as np

from chatter.compile.structure import structure_of
from chatter.description.case import Case
from chatter.description.progress import Progress, no_progress
from chatter.simulation.result import SimulationResult
from chatter.simulation.setup import set_up
from chatter.simulation.simulate import run_setup
from chatter.simulation.verdict import with_verdict
from chatter.stability.model import MillingModel
from chatter.studies.optimisation.candidate import Candidate, TimeCheck, case_at
from chatter.studies.optimisation.limits import LIMITED, Limits
from dynamics.modal.modes import Mode

#: a limit counts as held in the time domain up to this share above it
TOLERANCE = 0.03


def time_check(
    model: MillingModel, limits: Limits, candidate: Candidate, progress: Progress = no_progress
) -> TimeCheck:
    """Simulate the cut of a candidate from rest, with the delayed chip.

    Parameters
    ----------
    model : MillingModel
    limits : Limits
    candidate : Candidate
    progress : callable, optional
        Called with (done, total) steps.

    Raises
    ------
    KeyboardInterrupt
        A run that was cut short shows nothing.
    """
    here = case_at(model.case, candidate.place).patch({"simulation": None, "stock": None})
    setup = set_up(here, _modes(model, here))
    result, _ = run_setup(setup, progress)
    if result.interrupted:
        raise KeyboardInterrupt
    verdict = "chatter" if not result.complete else _verdict(result)
    found = _measured(result)
    within = [
        abs(found[LIMITED[key]]) <= most * (1.0 + TOLERANCE)
        for key, most in limits.most.items()
        if math.isfinite(found[LIMITED[key]])
    ]
    return TimeCheck(verdict, **found, held=verdict == "stable" and all(within))


def _modes(model: MillingModel, here: Case) -> tuple[Mode, ...] | None:
    """Modes at the speed of a cut; those of the search where they cannot depend on it.

    A machine has its own.
    """
    if here.structure.machine is not None:
        return None
    slopes = any(mode.frequency_slope for mode in here.structure.mode)
    return structure_of(here).modes if slopes else model.structure.modes


def _verdict(result: SimulationResult) -> str:
    detection = with_verdict(result).detection
    return "not judged" if detection is None else detection.verdict


def _measured(result: SimulationResult) -> dict[str, float]:
    settled = result.settled
    walls = [wall.largest_location_error for wall in result.finish.walls]
    return {
        "power": float(result.power[settled].mean()),
        "torque": float(result.torque[settled].mean()),
        "deflection": float(np.linalg.norm(result.displacement[settled], axis=1).max()),
        "surface_error": max(walls, key=abs) if walls else math.nan,
    }
