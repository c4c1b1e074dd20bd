"""`optimum`: search, probability of the best cuts, and their confirmation in the time domain."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from chatter.best_cut.candidate import Candidate, candidate_at, max_usage
from chatter.best_cut.confirmation import time_check
from chatter.best_cut.exclusion import exclusions
from chatter.best_cut.limits import LIMITED, Limits, limits_of
from chatter.best_cut.records import (
    candidate_from,
    record_of_candidate,
    record_of_sheets,
    sheets_from,
)
from chatter.best_cut.result import Optimum
from chatter.best_cut.robustness import robust_candidate, with_probability
from chatter.best_cut.sampled_cuts import Samples, samples_of
from chatter.best_cut.search import (
    LEVELS,
    STARTS,
    Place,
    best_of,
    refined,
    sheets_of_width,
    starts_of,
)
from chatter.best_cut.sheet import Sheet, sheet_of
from chatter.best_cut.width_and_feed import model_at
from chatter.case import Case
from chatter.errors import InputError
from chatter.kept_results import KeptPieces
from chatter.model import milling_model
from chatter.monte_carlo.propagation import check_counts
from chatter.stability.sweep import Progress, no_progress
from chatter.what_if.finished import key_of
from chatter.what_if.subject import fingerprint

DEFAULT_SAMPLES, DEFAULT_SEED = 200, 1
#: candidates that are simulated in the time domain; more where these do not hold there
_SIMULATED = 3
#: steps over the width of the best robust cut
_WIDTH_STEPS = 2
#: cuts that are alike within this share are one
_SAME = 0.02
#: what is taken off the depth, a share of it and how often, where a limit is missed in time
_EASING, _EASINGS = 0.03, 6
#: sizes of the pieces of work against each other
_A_SHEET, _A_START, _A_ROBUST, _A_RUN = 100, 40, 60, 16
#: runs in the time domain of a candidate that is made less deep
_RUNS_A_CHECK = 5
#: named as what limits a cut that was made less deep so
TIME_DOMAIN = "time domain"


class _Search:
    """What all pieces of a search share: the case compiled, what is kept of it, progress."""

    def __init__(
        self,
        case: Case,
        samples: int,
        seed: int,
        progress: Progress,
        folder: str | Path | None,
    ) -> None:
        self.model = milling_model(case)
        self.limits = limits_of(case, self.model)
        self.drawn = samples_of(self.model, samples, seed)
        self.kept = KeptPieces(folder, key_of("optimum", fingerprint(case)))
        #: what pieces depend on where something is uncertain
        self.draw = (samples, seed) if self.drawn is not None else None
        sheets = self.limits.widths.size * self.limits.feeds.size
        robust = STARTS + 2 * _WIDTH_STEPS if self.drawn is not None else 0
        self._progress, self.finished = progress, 0
        self.total = _A_SHEET * sheets + _A_START * STARTS + _A_ROBUST * robust
        self.total += _A_RUN * _RUNS_A_CHECK * _SIMULATED + 1

    def part(self, size: int) -> Progress:
        """Progress of a piece of this size."""
        return lambda done, total: self._tell(self.finished + size * done // max(total, 1))

    def done(self, size: int) -> None:
        """Count a piece of this size."""
        self.reach(self.finished + size)

    def reach(self, finished: int) -> None:
        """Count all up to a place: a piece that needed fewer steps than it might is finished."""
        self.finished = max(finished, self.finished)
        self._tell(self.finished)

    def _tell(self, finished: int) -> None:
        self._progress(min(finished, self.total - 1), self.total)

    def end(self) -> None:
        """Say that nothing is left to do."""
        self._progress(self.total, self.total)


def optimum(
    case: Case,
    samples: int = DEFAULT_SAMPLES,
    seed: int = DEFAULT_SEED,
    progress: Progress = no_progress,
    folder: str | Path | None = None,
) -> Optimum:
    """Find the speed, depth, width and feed of the highest removal rate within the limits.

    Parameters
    ----------
    case : Case
        `[optimum]` gives ranges and limits; values such as "1650 +- 80 MPa" are what the cut must
        be robust to.
    samples : int
        Of the uncertain values.
    seed : int
        Of the random numbers.
    progress : callable, optional
        Called with (done, total) parts of the work.
    folder : path, optional
        Keeps finished pieces of the search in points.jsonl there, and reuses those of the same
        case.

    Returns
    -------
    Optimum
        Its `best` is None where no cut keeps all limits; `why_nothing` then says what excludes
        everything.

    Raises
    ------
    InputError
        If the case lacks something or asks for what cannot be computed.
    RunError
        If it is interrupted; finished pieces are in the folder.
    """
    check_counts(samples, 2, seed)
    _refuse(case)
    search = _Search(case, samples, seed, progress, folder)
    try:
        return _found(case, search, seed)
    except KeyboardInterrupt:
        raise search.kept.interrupted() from None


def _found(case: Case, search: _Search, seed: int) -> Optimum:
    limits, drawn = search.limits, search.drawn
    sheets = [sheet for width in limits.widths for sheet in _sheets(search, float(width))]
    places = [_refined(search, start) for start in starts_of(sheets)]
    candidates = _confirmed(search, _candidates(search, places))
    result = Optimum(
        case=case,
        limits=limits,
        candidates=tuple(candidates),
        over_widths=tuple(_best_of_widths(sheets, limits)),
        sheet=_shown_sheet(search, candidates, sheets),
        exclusions=exclusions(sheets),
        points=sum(sheet.kept.size for sheet in sheets),
        samples=len(drawn) if drawn else 0,
        seed=seed,
        notes=(*search.model.notes, *_notes(case, limits, drawn)),
    )
    search.end()
    return result


def _sheets(search: _Search, width: float) -> list[Sheet]:
    """Sheets of the coarse net at a width and every feed."""
    model, limits = search.model, search.limits
    size = _A_SHEET * limits.feeds.size
    computed: list[Sheet] = []

    def compute() -> list:
        computed.extend(sheets_of_width(model, limits, width, search.part(size)))
        return record_of_sheets(computed)

    record = search.kept.piece("width", width, compute)
    search.done(size)
    return computed or sheets_from(record, model, limits, width)


def _refined(search: _Search, start: Place) -> Place:
    model, limits, told = search.model, search.limits, search.part(_A_START)

    def compute() -> list:
        return list(refined(model, limits, start, lambda level: told(level, LEVELS)))

    place = Place(*search.kept.piece("refined", tuple(start), compute))
    search.done(_A_START)
    return place


def _refuse(case: Case) -> None:
    case.require("tool", "material", "cut", "structure")
    if case.cut.speed_variation is not None:
        raise InputError(
            f"{case.name}: cut.speed_variation: the optimum is sought at a constant speed; "
            "leave it out"
        )


def _candidates(search: _Search, places: Sequence[Place]) -> list[Candidate]:
    """Candidates in round numbers, best first, robust where something is uncertain."""
    found = [_at(search, place) for place in places]
    found.sort(key=lambda one: -one.removal_rate)
    if search.drawn is not None:
        found = _robust(search, found)
    return _apart(sorted(found, key=lambda one: -one.removal_rate))


def _kept_candidate(
    search: _Search, name: str, place: Place, compute: Callable[[], Candidate | None]
) -> Candidate | None:
    """Candidate of a place, or that it has none, computed if it is not known yet."""
    inputs = (tuple(place), search.draw)
    record = search.kept.piece(name, inputs, lambda: record_of_candidate(compute()))
    return candidate_from(record)


def _at(search: _Search, place: Place) -> Candidate:
    model, limits = search.model, search.limits
    return _kept_candidate(search, "place", place, lambda: candidate_at(model, limits, place))


def _robust_at(search: _Search, place: Place) -> Candidate | None:
    model, limits, drawn = search.model, search.limits, search.drawn
    found = _kept_candidate(
        search, "robust", place, lambda: robust_candidate(model, limits, place, drawn)
    )
    search.done(_A_ROBUST)
    return found


def _robust(search: _Search, candidates: Sequence[Candidate]) -> list[Candidate]:
    """Candidates that are robust, from candidates, best first; then the best over its width."""
    found: list[Candidate] = []
    for one in candidates:
        most = max((other.removal_rate for other in found), default=0.0)
        # what is robust of it cannot be more than all of it
        if len(found) < _SIMULATED or one.removal_rate > most:
            robust = _robust_at(search, one.place)
            found += [] if robust is None else [robust]
    if found and search.limits.widths.size > 1:
        found += _at_other_widths(search, max(found, key=lambda one: one.removal_rate))
    return found


def _at_other_widths(search: _Search, best: Candidate) -> list[Candidate]:
    """Robust candidates beside the best one that remove more, on the way to the best width."""
    better: list[Candidate] = []
    widths = search.limits.widths
    step = float(widths[1] - widths[0]) / 3.0
    for _ in range(_WIDTH_STEPS):
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


def _confirmed(search: _Search, candidates: Sequence[Candidate]) -> list[Candidate]:
    """Candidates with their checks in the time domain: those that hold first, best first."""
    found: list[Candidate] = []
    for number, candidate in enumerate(candidates):
        if number >= _SIMULATED and any(one.time and one.time.held for one in found):
            found.append(candidate)
            continue
        begun = search.finished
        found.append(_held_in_time(search, candidate))
        search.reach(begun + _RUNS_A_CHECK * _A_RUN)
    return sorted(
        found, key=lambda one: (one.time is not None and not one.time.held, -one.removal_rate)
    )


def _held_in_time(search: _Search, candidate: Candidate) -> Candidate:
    """Candidate with its check in the time domain; less deep where a limit is missed there.

    The least depth that is tried at all tells whether there is one; a limit that is missed, unlike
    chatter, is mostly held at the first. Depths between them are tried only where it holds.
    """
    first = _simulated(search, candidate)
    if first.time.held:
        return first
    fails, holds, best = 0, _EASINGS + 1, first
    order = (_EASINGS, 1) if first.time.verdict == "chatter" else (1, _EASINGS)
    while holds - fails > 1 and fails < _EASINGS:
        number = next((one for one in order if fails < one < holds), (fails + holds) // 2)
        eased = _eased(search, candidate, number)
        if eased is None:
            fails = number
        else:
            holds, best = number, eased
    return best


def _eased(search: _Search, candidate: Candidate, number: int) -> Candidate | None:
    """Candidate made less deep by some steps; None if it does not hold all limits in time."""
    depth = candidate.place.axial_depth * (1.0 - _EASING * number)
    eased = _at(search, candidate.place._replace(axial_depth=depth))
    if search.drawn is not None:
        eased = with_probability(search.model, search.limits, eased, search.drawn)
    if eased is None or max_usage(eased) > 1.0:
        return None
    checked = _simulated(search, replace(eased, active=(*eased.active, TIME_DOMAIN)))
    return checked if checked.time.held else None


def _simulated(search: _Search, candidate: Candidate) -> Candidate:
    def compute() -> Candidate:
        time = time_check(search.model, search.limits, candidate, search.part(_A_RUN))
        return replace(candidate, time=time)

    checked = _kept_candidate(search, "in time", candidate.place, compute)
    search.done(_A_RUN)
    # the rest of the candidate may have come by another way
    return replace(candidate, time=checked.time)


def _best_of_widths(sheets: Sequence[Sheet], limits: Limits) -> list[Place]:
    """Best place of every width that has one, of the coarse net."""
    best = []
    for width in limits.widths:
        places = [best_of(sheet) for sheet in sheets if np.isclose(sheet.case.width_of_cut, width)]
        known = [place for place in places if place is not None]
        best += [max(known, key=lambda place: place.removal_rate)] if known else []
    return best


def _shown_sheet(
    search: _Search, candidates: Sequence[Candidate], sheets: Sequence[Sheet]
) -> Sheet:
    """Sheet at the width and feed of the best cut; else that with the most points left."""
    if not candidates:
        return max(sheets, key=lambda sheet: int(sheet.kept.sum()))
    limits, place = search.limits, candidates[0].place
    here = model_at(search.model, place.radial_depth, place.feed_per_tooth)
    for sheet in sheets:
        if sheet.case == here.case:
            return sheet
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
