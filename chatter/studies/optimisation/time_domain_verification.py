"""Time-domain verification of candidates, side by side; less deep where a limit is exceeded.

Teeth that leave the cut, ploughing in full, contact and friction of modes act there, and the wall
is built up of the passes of the edges. The run starts from rest in the full cut, a push as large as
the cut itself gives. Below the limit of small vibration such a push may already lead to chatter
that stays (the bistable or unsafe zone of Dombovari, Barton, Wilson and Stepan 2011, Int. J.
Non-Linear Mech. 46:266), which the linear limit does not know.
"""

import math
import threading
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from dataclasses import replace

import numpy as np

from chatter.compile.structure import structure_of
from chatter.description.case import Case
from chatter.description.progress import Progress, no_progress
from chatter.engine.parallel import one_thread, worker_count
from chatter.simulation.result import SimulationResult
from chatter.simulation.setup import set_up
from chatter.simulation.simulate import run_setup
from chatter.simulation.verdict import with_verdict
from chatter.stability.model import MillingModel
from chatter.studies.optimisation.candidate import (
    EASING,
    EASINGS,
    TIME_DOMAIN,
    Candidate,
    Verification,
    max_usage,
)
from chatter.studies.optimisation.limits import LIMITED, Limits
from chatter.studies.optimisation.operating_point import case_at
from chatter.studies.optimisation.robustness import SIMULATED, with_probability
from chatter.studies.optimisation.search_state import OptimumSearch
from dynamics.modal.modes import Mode

#: a limit counts as held in the time domain up to this share above it
TOLERANCE = 0.03
#: size of a run against the other pieces of work, and runs of a candidate that is made less deep
_RUN_WORK, _RUNS_PER_VERIFICATION = 16, 5
#: size of a candidate against the other pieces of work
VERIFICATION_WORK = _RUN_WORK * _RUNS_PER_VERIFICATION


def confirmed(search: OptimumSearch, candidates: Sequence[Candidate]) -> list[Candidate]:
    """Candidates with their checks in the time domain: those that hold first, best first.

    Which of them are simulated does not depend on how many threads there are.
    """
    found = _side_by_side(search, candidates[:SIMULATED])
    for candidate in candidates[SIMULATED:]:
        if any(one.verification and one.verification.verified for one in found):
            found.append(candidate)
        else:
            found += _side_by_side(search, [candidate])
    return sorted(
        found,
        key=lambda one: (
            one.verification is not None and not one.verification.verified,
            -one.removal_rate,
        ),
    )


def _side_by_side(search: OptimumSearch, candidates: Sequence[Candidate]) -> list[Candidate]:
    """Candidates with their checks, each in a thread of its own."""
    stopped = threading.Event()
    report = search.parts(len(candidates), VERIFICATION_WORK)
    alone = one_thread if len(candidates) > 1 else nullcontext

    def verified(index: int) -> Candidate:
        try:
            with alone():
                return _Verifier(search, report[index], stopped).verified(candidates[index])
        finally:
            search.cache.close()

    with ThreadPoolExecutor(max_workers=min(worker_count(), max(len(candidates), 1))) as pool:
        try:
            futures = [pool.submit(verified, index) for index in range(len(candidates))]
            found = [future.result() for future in futures]
        except BaseException:
            # an interruption reaches this thread alone: tell the others
            stopped.set()
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    search.done(VERIFICATION_WORK * len(candidates))
    return found


class _Verifier:
    """Check of one candidate, in one thread; `stopped` is set where the search is interrupted."""

    def __init__(self, search: OptimumSearch, progress: Progress, stopped: threading.Event) -> None:
        self.search, self.runs = search, 0
        self._progress, self._stopped = progress, stopped

    def _report(self, done: int, total: int) -> None:
        if self._stopped.is_set():
            # ends a run as Ctrl-C does, and with it the check
            raise KeyboardInterrupt
        self._progress(
            min(self.runs * total + done, _RUNS_PER_VERIFICATION * total),
            _RUNS_PER_VERIFICATION * total,
        )

    def verified(self, candidate: Candidate) -> Candidate:
        """Candidate with its check; less deep where a limit is missed.

        The least depth that is tried at all tells whether there is one; a limit that is missed,
        unlike chatter, is mostly held at the first. Depths between them are tried only where it
        holds.
        """
        first = self._simulated(candidate)
        if first.verification.verified:
            return first
        fails, holds, best = 0, EASINGS + 1, first
        order = (EASINGS, 1) if first.verification.verdict == "chatter" else (1, EASINGS)
        while holds - fails > 1 and fails < EASINGS:
            number = next((one for one in order if fails < one < holds), (fails + holds) // 2)
            eased = self._eased(candidate, number)
            if eased is None:
                fails = number
            else:
                holds, best = number, eased
        return best

    def _eased(self, candidate: Candidate, number: int) -> Candidate | None:
        """Candidate made less deep by some steps; None if it does not hold all limits in time."""
        search = self.search
        depth = candidate.point.axial_depth * (1.0 - EASING * number)
        eased: Candidate | None = search.at(candidate.point._replace(axial_depth=depth))
        if search.drawn is not None:
            eased = with_probability(search.model, search.limits, eased, search.drawn)
        if eased is None or max_usage(eased) > 1.0:
            return None
        checked = self._simulated(replace(eased, active=(*eased.active, TIME_DOMAIN)))
        return checked if checked.verification.verified else None

    def _simulated(self, candidate: Candidate) -> Candidate:
        search = self.search

        def compute() -> Candidate:
            verification = verification_of(search.model, search.limits, candidate, self._report)
            return replace(candidate, verification=verification)

        checked = search.candidate("in time", candidate.point, compute)
        self.runs += 1
        # the rest of the candidate may have come by another way
        return replace(candidate, verification=checked.verification)


def verification_of(
    model: MillingModel, limits: Limits, candidate: Candidate, progress: Progress = no_progress
) -> Verification:
    """Simulate the cut of a candidate from rest, with the delayed chip.

    `progress` is called with (done, total) steps. KeyboardInterrupt is raised where a run was cut
    short: it shows nothing.
    """
    here = case_at(model.case, candidate.point).patch({"simulation": None, "stock": None})
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
    return Verification(verdict, **found, verified=verdict == "stable" and all(within))


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
        "power": result.mean_power,
        "torque": result.mean_torque,
        "deflection": float(np.linalg.norm(result.displacement[settled], axis=1).max()),
        "surface_error": max(walls, key=abs) if walls else math.nan,
    }
