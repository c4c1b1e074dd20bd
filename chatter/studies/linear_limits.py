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
from chatter.stability.beside_simulation import linear_spectral_radius, verdict_of
from chatter.stability.neglected_effects import CHATTER, STABLE
from chatter.stability.registry import chosen_method, with_multiplier

#: of a limit, relative to itself and to the way between the cuts on either side
_TOLERANCE = 1e-6


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


def spectral_radius_or_nan(case: Case) -> float:
    """Spectral radius of the cut of a case; nan where the linear analysis does not take it."""
    try:
        return linear_spectral_radius(case)
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


def _why_not(case: Case) -> str:
    """Why the linear analysis takes none of the cuts."""
    try:
        linear_spectral_radius(case)
    except (InputError, RunError) as error:
        return str(error).removeprefix(f"{case.name}: ")
    return "it takes none of the values of the range"


def _limit_between(case: Case, path: str, before: Simulated, after: Simulated) -> float:
    """Value at which the spectral radius is one, between two of which it lies on either side."""

    def growth_rate(value: float) -> float:
        if value in ends:
            return ends[value]
        return _logarithm(linear_spectral_radius(case.patch({path: value})))

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
    return verdict_of(case, cut.spectral_radius, cut.verdict).sentence()
