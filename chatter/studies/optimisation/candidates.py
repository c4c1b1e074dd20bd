"""Candidates for the best cut: in round numbers, robust where something is uncertain."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from chatter.studies.optimisation.candidate import Candidate
from chatter.studies.optimisation.robustness import robust_candidate
from chatter.studies.optimisation.search import Place
from chatter.studies.optimisation.search_state import KeptSearch
from chatter.studies.optimisation.time_domain_verification import SIMULATED

#: steps over the width of the best robust cut
WIDTH_STEPS = 2
#: size of a robust candidate against the other pieces of work
A_ROBUST = 60
#: cuts that are alike within this share are one
_SAME = 0.02


def candidates_of(search: KeptSearch, places: Sequence[Place]) -> list[Candidate]:
    """Candidates in round numbers, best first, robust where something is uncertain."""
    found = [search.at(place) for place in places]
    found.sort(key=lambda one: -one.removal_rate)
    if search.drawn is not None:
        found = _robust(search, found)
    return _apart(sorted(found, key=lambda one: -one.removal_rate))


def _robust_at(search: KeptSearch, place: Place) -> Candidate | None:
    model, limits, drawn = search.model, search.limits, search.drawn
    found = search.candidate("robust", place, lambda: robust_candidate(model, limits, place, drawn))
    search.done(A_ROBUST)
    return found


def _robust(search: KeptSearch, candidates: Sequence[Candidate]) -> list[Candidate]:
    """Candidates that are robust, from candidates, best first; then the best over its width."""
    found: list[Candidate] = []
    for one in candidates:
        most = max((other.removal_rate for other in found), default=0.0)
        # what is robust of it cannot be more than all of it
        if len(found) < SIMULATED or one.removal_rate > most:
            robust = _robust_at(search, one.place)
            found += [] if robust is None else [robust]
    if found and search.limits.widths.size > 1:
        found += _at_other_widths(search, max(found, key=lambda one: one.removal_rate))
    return found


def _at_other_widths(search: KeptSearch, best: Candidate) -> list[Candidate]:
    """Robust candidates beside the best one that remove more, on the way to the best width."""
    better: list[Candidate] = []
    widths = search.limits.widths
    step = float(widths[1] - widths[0]) / 3.0
    for _ in range(WIDTH_STEPS):
        place = best.place
        beside = np.clip(place.radial_depth + np.array([-step, step]), widths[0], widths[-1])
        tried = [
            _robust_at(search, _at_width(place, float(width)))
            for width in beside
            if abs(width - place.radial_depth) > 0.1 * step
        ]
        known = [one for one in tried if one is not None and one.removal_rate > best.removal_rate]
        if known:
            best = max(known, key=lambda one: one.removal_rate)
            better.append(best)
        else:
            step /= 3.0
    return better


def _at_width(place: Place, width: float) -> Place:
    """Place of another width that removes as much."""
    return place._replace(
        radial_depth=width, axial_depth=place.axial_depth * place.radial_depth / width
    )


def _apart(candidates: Sequence[Candidate]) -> list[Candidate]:
    """Candidates without those that are nearly the same as a better one."""
    kept: list[Candidate] = []
    for one in candidates:
        cut = np.array(one.place[:4])
        if not any(np.allclose(cut, other.place[:4], rtol=_SAME) for other in kept):
            kept.append(one)
    return kept
