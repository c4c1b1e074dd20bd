"""What the linear analysis says of a cut that was simulated, and why where it says otherwise."""

from __future__ import annotations

from dataclasses import dataclass

from chatter.description.errors import InputError, RunError
from chatter.simulation.result import SimulationResult
from chatter.stability.forced_vibration import neglected_in_steady_cut
from chatter.stability.model import milling_model
from chatter.stability.neglected_effects import CHATTER, STABLE, NeglectedEffect
from chatter.stability.registry import chosen_method, fixed_steps, with_multiplier
from chatter.stability.resting_friction import neglected_resting_friction
from chatter.stability.steady_flank import about_steady_motion


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
        lower = self.verdict == STABLE
        reasons = "; ".join(
            effect.because
            for effect in self.neglected
            if (effect.lowest < 1.0 if lower else effect.highest > 1.0)
        )
        why = reasons or (
            "near the limit the duration of the run may decide (simulation.revolutions), and large "
            "vibration goes on where small vibration would die out"
        )
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
    case = result.case
    moves = case.stock is not None or (case.simulation is not None and case.simulation.has_own_path)
    if moves or result.detection is None or result.detection.verdict not in (STABLE, CHATTER):
        return None
    try:
        method = with_multiplier(chosen_method(case, "auto"))
        model = milling_model(case)
        method.check(model)
        beside = about_steady_motion(model, *model.operating_point)
        radius = abs(method.multiplier(beside, fixed_steps(case)).value)
        neglected = neglected_resting_friction(model), neglected_in_steady_cut(model, method)
    except (InputError, RunError):
        return None
    verdict = STABLE if radius < 1.0 else CHATTER
    effects = (*neglected[0], *neglected[1])
    return LinearVerdict(verdict, result.detection.verdict, method.name, radius, effects)
