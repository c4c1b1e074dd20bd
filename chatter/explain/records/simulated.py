"""Simulated cuts, each made once for all the sensors that may have recorded it."""

from dataclasses import replace
from functools import lru_cache

from chatter.description.case import Case
from chatter.description.sections.process import Simulation
from chatter.simulation.result import SimulationResult
from chatter.simulation.setup import set_up
from chatter.simulation.simulate import as_measured, run_setup

#: cuts kept: a few runs before and after a change of their sensor, some megabytes each
_KEPT = 16


def over_revolutions(case: Case, revolutions: float) -> Case:
    """Return a case that is simulated over so many revolutions.

    Its other values stay, so that none of them needs to be checked again.
    """
    settings = case.simulation or Simulation()
    settings = settings.model_copy(update={"revolutions": revolutions, "duration": None})
    return case.model_copy(update={"simulation": settings})


def simulated(case: Case) -> SimulationResult:
    """Signals of a cut from rest, forces as the dynamometer of the case shows them.

    What the sensor does is no part of the cut: cuts that differ by their sensor are simulated once.
    """
    result = _simulated(case.model_copy(update={"dynamometer": None}))
    if case.dynamometer is None:
        return result
    step = result.setup.resolution.stride * result.setup.step
    setup = replace(result.setup, case=case)
    return replace(result, setup=setup, rows=as_measured(case, result.rows, step))


@lru_cache(_KEPT)
def _simulated(case: Case) -> SimulationResult:
    return run_setup(set_up(case))[0]
