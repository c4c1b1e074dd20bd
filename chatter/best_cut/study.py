"""`optimum`: search, probability of the best cuts, and their confirmation in the time domain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from chatter.best_cut.candidate import Candidate, candidate_at, max_usage
from chatter.best_cut.confirmation import time_check
from chatter.best_cut.exclusion import exclusions
from chatter.best_cut.limits import LIMITED, Limits, limits_of
from chatter.best_cut.result import Optimum
from chatter.best_cut.robustness import (
    Samples,
    robust_candidate,
    samples_of,
    with_probability,
)
from chatter.best_cut.search import (
    LEVELS,
    STARTS,
    Place,
    best_of,
    coarse_sheets,
    refined,
    starts_of,
)
from chatter.best_cut.sheet import Sheet, sheet_of
from chatter.best_cut.width_and_feed import model_at
from chatter.case import Case
from chatter.errors import InputError
from chatter.model import MillingModel, milling_model
from chatter.monte_carlo.propagation import check_counts
from chatter.stability.sweep import Progress, no_progress

DEFAULT_SAMPLES, DEFAULT_SEED = 200, 1
#: candidates that are simulated in the time domain; more where these do not hold there
_SIMULATED = 3
#: steps over the width of the best robust cut
_WIDTH_STEPS = 2
#: cuts that are alike within this share are one
_SAME = 0.02
#: what is taken off the depth, a share of it and how often, where a limit is missed in time
_EASING, _EASINGS = 0.03, 6
#: named as what limits a cut that was made less deep so
TIME_DOMAIN = "time domain"


class _Work:
    """Progress over pieces of work of about the same size."""

    def __init__(self, progress: Progress, total: int) -> None:
        self.progress, self.total, self.finished = progress, total, 0

    def done(self, pieces: int = 1) -> None:
        self.finished = min(self.finished + pieces, self.total)
        self.progress(self.finished, self.total)


def optimum(
    case: Case,
    samples: int = DEFAULT_SAMPLES,
    seed: int = DEFAULT_SEED,
    progress: Progress = no_progress,
) -> Optimum:
    """Find the speed, depth, width and feed of the highest removal rate within the limits.

    Parameters
    ----------
    case : Case
        `[optimum]` gives ranges and limits; values such as "1650 +- 80 MPa" are what stability
        must be robust to.
    samples : int
        Of the uncertain values.
    seed : int
        Of the random numbers.
    progress : callable, optional
        Called with (done, total) pieces of work.

    Returns
    -------
    Optimum
        Its `best` is None where no cut keeps all limits; `why_nothing` then says what excludes
        everything.

    Raises
    ------
    InputError
        If the case lacks something or asks for what cannot be computed.
    """
    check_counts(samples, 2, seed)
    _refuse(case)
    model = milling_model(case)
    limits = limits_of(case, model)
    drawn = samples_of(case, samples, seed)
    pieces = limits.widths.size * limits.feeds.size
    work = _Work(progress, pieces + STARTS * (LEVELS + 1) + _SIMULATED + 1)
    sheets = coarse_sheets(model, limits, work.done)
    places = [refined(model, limits, start, work.done) for start in starts_of(sheets)]
    candidates = _candidates(model, limits, places, drawn, work)
    candidates = _confirmed(model, limits, candidates, drawn, work)
    result = Optimum(
        case=case,
        limits=limits,
        candidates=tuple(candidates),
        over_widths=tuple(_best_of_widths(sheets, limits)),
        sheet=_shown_sheet(model, limits, candidates, sheets),
        exclusions=exclusions(sheets),
        points=sum(sheet.kept.size for sheet in sheets),
        samples=len(drawn) if drawn else 0,
        seed=seed,
        notes=(*model.notes, *_notes(case, limits, drawn)),
    )
    work.done(work.total)
    return result


def _refuse(case: Case) -> None:
    case.require("tool", "material", "cut", "structure")
    if case.cut.speed_variation is not None:
        raise InputError(
            f"{case.name}: cut.speed_variation: the optimum is sought at a constant speed; "
            "leave it out"
        )


def _candidates(
    model: MillingModel, limits: Limits, places: Sequence[Place], drawn: Samples | None, work: _Work
) -> list[Candidate]:
    """Candidates in round numbers, best first, robust where something is uncertain."""
    found = [candidate_at(model, limits, place) for place in places]
    found.sort(key=lambda one: -one.removal_rate)
    if drawn is not None:
        found = _robust(model, limits, found, drawn, work)
    return _apart(sorted(found, key=lambda one: -one.removal_rate))


def _robust(
    model: MillingModel,
    limits: Limits,
    candidates: Sequence[Candidate],
    drawn: Samples,
    work: _Work,
) -> list[Candidate]:
    """Candidates that are robust, from candidates, best first; then the best over its width."""
    found: list[Candidate] = []
    for one in candidates:
        most = max((other.removal_rate for other in found), default=0.0)
        # what is robust of it cannot be more than all of it
        if len(found) < _SIMULATED or one.removal_rate > most:
            robust = robust_candidate(model, limits, one.place, drawn)
            found += [] if robust is None else [robust]
        work.done()
    if found and limits.widths.size > 1:
        best = max(found, key=lambda one: one.removal_rate)
        found += _at_other_widths(model, limits, best, drawn)
    return found


def _at_other_widths(
    model: MillingModel, limits: Limits, best: Candidate, drawn: Samples
) -> list[Candidate]:
    """Robust candidates beside the best one that remove more, on the way to the best width."""
    better: list[Candidate] = []
    step = float(limits.widths[1] - limits.widths[0]) / 3.0
    for _ in range(_WIDTH_STEPS):
        place = best.place
        beside = np.clip(
            place.radial_depth + np.array([-step, step]), limits.widths[0], limits.widths[-1]
        )
        tried = [
            robust_candidate(model, limits, _at_width(place, float(width)), drawn)
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


def _confirmed(
    model: MillingModel,
    limits: Limits,
    candidates: Sequence[Candidate],
    drawn: Samples | None,
    work: _Work,
) -> list[Candidate]:
    """Candidates with their checks in the time domain: those that hold first, best first."""
    found: list[Candidate] = []
    for number, candidate in enumerate(candidates):
        if number >= _SIMULATED and any(one.time and one.time.held for one in found):
            found.append(candidate)
            continue
        found.append(_held_in_time(model, limits, candidate, drawn))
        work.done()
    return sorted(
        found, key=lambda one: (one.time is not None and not one.time.held, -one.removal_rate)
    )


def _held_in_time(
    model: MillingModel, limits: Limits, candidate: Candidate, drawn: Samples | None
) -> Candidate:
    """Candidate with its check in the time domain; less deep where a limit is missed there."""
    first = checked = replace(candidate, time=time_check(model, limits, candidate))
    for number in range(1, _EASINGS + 1):
        if checked.time.held:
            return checked
        depth = candidate.place.axial_depth * (1.0 - _EASING * number)
        eased = candidate_at(model, limits, candidate.place._replace(axial_depth=depth))
        if drawn is not None:
            eased = with_probability(model, limits, eased, drawn)
        if eased is not None and max_usage(eased) <= 1.0:
            active = (*eased.active, TIME_DOMAIN)
            checked = replace(eased, time=time_check(model, limits, eased), active=active)
    return checked if checked.time.held else first


def _best_of_widths(sheets: Sequence[Sheet], limits: Limits) -> list[Place]:
    """Best place of every width that has one, of the coarse net."""
    best = []
    for width in limits.widths:
        places = [best_of(sheet) for sheet in sheets if np.isclose(sheet.case.width_of_cut, width)]
        known = [place for place in places if place is not None]
        best += [max(known, key=lambda place: place.removal_rate)] if known else []
    return best


def _shown_sheet(
    model: MillingModel, limits: Limits, candidates: Sequence[Candidate], sheets: Sequence[Sheet]
) -> Sheet:
    """Sheet at the width and feed of the best cut; else that with the most points left."""
    if not candidates:
        return max(sheets, key=lambda sheet: int(sheet.kept.sum()))
    place = candidates[0].place
    here = model_at(model, place.radial_depth, place.feed_per_tooth)
    return sheet_of(here, limits, limits.speeds, limits.depths, limits.looked_at_beyond())


def _notes(case: Case, limits: Limits, drawn: Samples | None) -> list[str]:
    notes = []
    missing = [key for key in LIMITED if key not in limits.most]
    if missing:
        notes.append(f"no limit is given by optimum.{', optimum.'.join(missing)}")
    if drawn is None:
        notes.append(
            f"nothing in the case is uncertain: stability keeps {limits.depth_margin:.3g} of the "
            f"limit depth and {limits.speed_margin:.3g} of the speed as margins"
        )
    modes = case.structure.mode if case.structure else ()
    if any(mode.frequency_slope for mode in modes):
        notes.append("the search takes the modes at the speed of the case, not at each speed")
    return notes
