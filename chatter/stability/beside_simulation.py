"""What the linear analysis says of a cut that was simulated, and why where it says otherwise."""

from __future__ import annotations

from dataclasses import dataclass

from chatter.description.case import Case
from chatter.description.errors import InputError, RunError
from chatter.simulation.result import SimulationResult
from chatter.stability.forced_vibration import neglected_in_steady_cut
from chatter.stability.misfit_of_modes import neglected_misfit_of_modes
from chatter.stability.model import MillingModel, milling_model
from chatter.stability.neglected_effects import (
    CHATTER,
    EDGE_FORCES,
    STABLE,
    NeglectedEffect,
    reasons_of,
)
from chatter.stability.registry import chosen_method, fixed_steps, with_multiplier
from chatter.stability.resting_friction import neglected_resting_friction
from chatter.stability.stability_method import StabilityMethod
from chatter.stability.steady_flank import about_steady_motion

#: why verdicts may differ near a limit
_DURATION = "near the limit the duration of the run may decide (simulation.revolutions)"
_LARGE = ", and large vibration goes on where small vibration dies out"


@dataclass(frozen=True)
class LinearVerdict:
    """Linear verdict on a cut beside that of its simulation.

    Parameters
    ----------
    verdict, simulated : str
        By the linear analysis and by the simulation: ``"stable"`` or ``"chatter"``.
    method : str
    spectral_radius : float
        Magnitude of the dominant multiplier of the linear analysis; below 1 is stable.
    neglected : tuple of NeglectedEffect
        What the linear analysis leaves out in this cut.
    """

    verdict: str
    simulated: str
    method: str
    spectral_radius: float
    neglected: tuple[NeglectedEffect, ...]

    @property
    def agrees(self) -> bool:
        """Whether both verdicts are the same."""
        return self.verdict == self.simulated

    def sentence(self) -> str:
        """Verdict in words, with the reason where it is another than that of the simulation."""
        radius = f"{self.method}, spectral radius {self.spectral_radius:.4g}"
        if self.agrees:
            return f"the linear analysis agrees ({radius})"
        stable = self.verdict == STABLE
        reasons = reasons_of(self.neglected, stable=stable)
        if not stable and all(effect.name == EDGE_FORCES for effect in self.neglected):
            # a short run tells nothing of slow growth, whatever edge forces do
            reasons = [*reasons, _DURATION]
        why = "; ".join(reasons) or f"{_DURATION}{_LARGE if stable else ''}"
        return f"the linear analysis says {self.verdict} ({radius}): {why}"

    def summary(self) -> dict:
        """Return the content of `linear_analysis` in summary.json."""
        return {
            "verdict": self.verdict,
            "agrees": self.agrees,
            "method": self.method,
            "spectral_radius": self.spectral_radius,
            "neglected_effects": [effect.summary() for effect in self.neglected],
        }


def linear_verdict(result: SimulationResult) -> LinearVerdict | None:
    """Linear verdict on the cut of a simulation.

    None where the simulation has no verdict, where the engagement changes along the run, or where
    the linear analysis cannot take the case.
    """
    if result.detection is None or result.detection.verdict not in (STABLE, CHATTER):
        return None
    try:
        radius = linear_spectral_radius(result.case)
    except (InputError, RunError):
        return None
    return verdict_of(result.case, radius, result.detection.verdict)


def linear_spectral_radius(case: Case) -> float:
    """Spectral radius of the cut of a case that is simulated.

    InputError where its engagement changes along the run; InputError or RunError where the linear
    analysis cannot take it.
    """
    moves = case.stock is not None or (case.simulation is not None and case.simulation.has_own_path)
    if moves:
        raise InputError(
            f"{case.name}: the engagement changes along the run; the linear analysis takes one "
            "that stays"
        )
    method, model = _analysis_of(case)
    method.check(model)
    beside = about_steady_motion(model, *model.operating_point)
    return abs(method.multiplier(beside, fixed_steps(case)).value)


def verdict_of(case: Case, spectral_radius: float, simulated: str) -> LinearVerdict:
    """Linear verdict by the spectral radius of a cut, beside that of its simulation.

    Without neglected effects where it cannot be said what the linear analysis leaves out.
    """
    method, model = _analysis_of(case)
    try:
        effects = (
            *neglected_resting_friction(model),
            *neglected_misfit_of_modes(model, method),
            *neglected_in_steady_cut(model, method),
        )
    except (InputError, RunError):
        effects = ()
    verdict = STABLE if spectral_radius < 1.0 else CHATTER
    return LinearVerdict(verdict, simulated, method.name, spectral_radius, effects)


def _analysis_of(case: Case) -> tuple[StabilityMethod, MillingModel]:
    return with_multiplier(chosen_method(case, "auto")), milling_model(case)
