"""What the linear analysis says of cuts over a value of the case, beside their simulations."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import NamedTuple

from scipy.optimize import brentq

from chatter.description.case import Case
from chatter.description.errors import InputError, RunError
from chatter.io.result_files import finite_or_none
from chatter.stability.forced_vibration import neglected_in_steady_cut
from chatter.stability.model import milling_model
from chatter.stability.neglected_effects import CHATTER, EDGE_FORCES, STABLE
from chatter.stability.registry import chosen_method, fixed_steps, with_multiplier
from chatter.stability.resting_friction import neglected_resting_friction
from chatter.stability.steady_flank import about_steady_motion

#: of a limit, relative to itself and to the way between the cuts on either side
_TOLERANCE = 1e-6
#: why verdicts may differ near a limit; by how much edge forces raise one: docs/methods.md
_DURATION = "near the limit the duration of the run may decide (simulation.revolutions)"
_HIGHER = ", and edge forces that set in at a chip of zero may raise the limit by some percent"


class Simulated(NamedTuple):
    """A cut that was simulated, and what the linear analysis says of it."""

    value: float  # of the path that varies, SI
    verdict: str
    spectral_radius: float  # nan where the linear analysis does not take the cut


class Disagreement(NamedTuple):
    """Neighbouring cuts of which simulation and linear analysis say the opposite."""

    first: float  # value of the path, SI
    last: float
    cuts: int
    simulated: str  # "stable" or "chatter"
    reason: str  # sentence on the first of them

    def summary(self) -> dict:
        """Return the disagreement as JSON knows it."""
        return {
            "from": self.first,
            "to": self.last,
            "cuts": self.cuts,
            "simulated": self.simulated,
            "because": self.reason,
        }


class LinearLimits(NamedTuple):
    """Limits of the linear analysis over a value of the case.

    Cuts between two simulated ones are looked at only where stability changes between them.
    """

    method: str
    limits: tuple[float, ...]  # values of the path at which stability is lost or regained, SI
    unstable: tuple[tuple[float, float], ...]  # values between which it says chatter, SI
    disagreements: tuple[Disagreement, ...]
    reason: str = ""  # why there is no linear analysis

    def summary(self) -> dict:
        """Return the content of `linear_analysis` in summary.json."""
        return {
            "method": self.method or None,
            "limits": [finite_or_none(limit) for limit in self.limits],
            "unstable": [list(ends) for ends in self.unstable],
            "disagreements": [one.summary() for one in self.disagreements],
            "not_taken_because": self.reason or None,
        }


#: of no cuts
NO_LIMITS = LinearLimits("", (), (), ())


def linear_spectral_radius(case: Case) -> float:
    """Spectral radius of the cut of a case; nan where the linear analysis does not take it."""
    try:
        return _radius(case)
    except (InputError, RunError):
        return math.nan


def linear_limits(case: Case, path: str, cuts: Sequence[Simulated]) -> LinearLimits:
    """Limits of the linear analysis between cuts, and where simulation says otherwise.

    Parameters
    ----------
    case : Case
    path : str
        Dotted path of the value that varies.
    cuts : sequence of Simulated

    Returns
    -------
    LinearLimits
    """
    cuts = sorted(cuts, key=lambda cut: cut.value)
    known = [cut for cut in cuts if math.isfinite(cut.spectral_radius)]
    if not known:
        return LinearLimits("", (), (), (), _why_not(case))
    whole = isinstance(case.get(path), int)
    limits, unstable = [], []
    start = known[0].value if known[0].spectral_radius >= 1.0 else None
    for before, after in itertools.pairwise(known):
        if (before.spectral_radius >= 1.0) == (after.spectral_radius >= 1.0):
            continue
        middle = 0.5 * (before.value + after.value)
        limit = middle if whole else _limit_between(case, path, before, after)
        limits.append(limit)
        if start is None:
            start = limit
        else:
            unstable.append((start, limit))
            start = None
    if start is not None:
        unstable.append((start, known[-1].value))
    method = with_multiplier(chosen_method(case, "auto")).name
    return LinearLimits(method, tuple(limits), tuple(unstable), _disagreements(case, path, cuts))


def _radius(case: Case) -> float:
    moves = case.stock is not None or (case.simulation is not None and case.simulation.has_own_path)
    if moves:
        raise InputError(
            f"{case.name}: the engagement changes along the run; the linear analysis takes one "
            "that stays"
        )
    method = with_multiplier(chosen_method(case, "auto"))
    model = milling_model(case)
    method.check(model)
    beside = about_steady_motion(model, *model.operating_point)
    return abs(method.multiplier(beside, fixed_steps(case)).value)


def _why_not(case: Case) -> str:
    """Why the linear analysis takes none of the cuts."""
    try:
        _radius(case)
    except (InputError, RunError) as error:
        return str(error).removeprefix(f"{case.name}: ")
    return "it takes none of the values of the range"


def _limit_between(case: Case, path: str, before: Simulated, after: Simulated) -> float:
    """Value at which the spectral radius is one, between two of which it lies on either side."""

    def growth_rate(value: float) -> float:
        if value in ends:
            return ends[value]
        return _logarithm(_radius(case.patch({path: value})))

    ends = {cut.value: _logarithm(cut.spectral_radius) for cut in (before, after)}
    near = _TOLERANCE * (after.value - before.value)
    return float(brentq(growth_rate, before.value, after.value, rtol=_TOLERANCE, xtol=near))


def _logarithm(radius: float) -> float:
    return math.log(max(radius, 1e-30))


def _disagreements(case: Case, path: str, cuts: Sequence[Simulated]) -> tuple[Disagreement, ...]:
    """Runs of neighbouring cuts of which the verdicts are opposite."""
    found = []
    for opposite, group in itertools.groupby(cuts, _opposite):
        alike = list(group)
        if not opposite:
            continue
        reason = _reason(case.patch({path: alike[0].value}), alike[0])
        found.append(
            Disagreement(alike[0].value, alike[-1].value, len(alike), alike[0].verdict, reason)
        )
    return tuple(found)


def _opposite(cut: Simulated) -> str:
    """Verdict of the simulation where that of the linear analysis is the other one, else empty."""
    if cut.verdict not in (STABLE, CHATTER) or not math.isfinite(cut.spectral_radius):
        return ""
    linear = STABLE if cut.spectral_radius < 1.0 else CHATTER
    return cut.verdict if cut.verdict != linear else ""


def _reason(case: Case, cut: Simulated) -> str:
    """Sentence of the linear analysis on a cut of which it says otherwise."""
    method = with_multiplier(chosen_method(case, "auto"))
    model = milling_model(case)
    try:
        neglected = (*neglected_resting_friction(model), *neglected_in_steady_cut(model, method))
    except (InputError, RunError):
        neglected = ()
    if cut.spectral_radius < 1.0:
        verdict, why = STABLE, [one.because for one in neglected if one.lowest < 1.0]
        why = why or [f"{_DURATION}, and large vibration goes on where small vibration dies out"]
    else:
        verdict, why = CHATTER, [one.because for one in neglected if one.highest > 1.0]
        edge = any(one.name == EDGE_FORCES for one in neglected)
        why = why or [f"{_DURATION}{_HIGHER if edge else ''}"]
    radius = f"spectral radius {cut.spectral_radius:.4g}"
    return f"the linear analysis says {verdict} ({radius}): {'; '.join(why)}"
