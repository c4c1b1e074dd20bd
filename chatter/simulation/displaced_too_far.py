"""A run that ends early because the tool moves so far that the model of the cut no longer holds."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from chatter.description.errors import RunError

if TYPE_CHECKING:
    from chatter.simulation.result import SimulationResult


class DisplacedTooFarError(RunError):
    """The tool is displaced by more than the model of the cut allows.

    Parameters
    ----------
    result : SimulationResult
        Signals until then, not complete and without a verdict; it can be saved.
    """

    def __init__(self, result: SimulationResult) -> None:
        setup = result.setup
        body = "machine" if setup.on_machine is not None else "structure"
        when = f"after {result.time[-1]:.4g} s the tool is displaced by more than "
        far = f"{setup.furthest * 1e3:.3g} mm"
        self.result = replace(result, why_no_verdict=f"{when}{far}; the run ends there")
        super().__init__(
            f"{result.case.name}: {when}{far}, a share of its radius at which the model of the cut "
            f"no longer holds; the cut is far from stable, or the {body} too soft"
        )
