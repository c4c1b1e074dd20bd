"""`optimum`: search, probability of the best cuts, and their confirmation in the time domain."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.progress import Progress, no_progress
from chatter.studies.optimisation.candidate import Candidate
from chatter.studies.optimisation.exclusion import exclusions
from chatter.studies.optimisation.grid_search import (
    LEVELS,
    STARTS,
    best_of,
    refined,
    sheets_of_width,
    starts_of,
)
from chatter.studies.optimisation.limits import LIMITED, Limits
from chatter.studies.optimisation.operating_point import Place, model_at
from chatter.studies.optimisation.optimum import Optimum
from chatter.studies.optimisation.robustness import (
    A_ROBUST,
    SIMULATED,
    WIDTH_STEPS,
    candidates_of,
)
from chatter.studies.optimisation.sampled_cuts import Samples
from chatter.studies.optimisation.search_state import KeptSearch
from chatter.studies.optimisation.speed_depth_slice import (
    Sheet,
    sheet_of,
    slice_from_record,
    slice_record,
)
from chatter.studies.optimisation.time_domain_verification import A_CHECK, confirmed
from chatter.studies.uncertainty.sample_limits import check_counts

DEFAULT_SAMPLES, DEFAULT_SEED = 200, 1
#: sizes of the pieces of work against each other
_A_SHEET, _A_START = 100, 40


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
        Keeps finished parts of the search in the result cache there, and reuses those of the same
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
    search = KeptSearch(case, samples, seed, progress, folder)
    search.expect(_work(search))
    with search.cache as cache:
        try:
            return _found(case, search, seed)
        except KeyboardInterrupt:
            raise cache.search_interrupted() from None


def _work(search: KeptSearch) -> int:
    """All pieces of the search, at the most that are to be expected."""
    sheets = search.limits.widths.size * search.limits.feeds.size
    robust = STARTS + 2 * WIDTH_STEPS if search.drawn is not None else 0
    return _A_SHEET * sheets + _A_START * STARTS + A_ROBUST * robust + A_CHECK * SIMULATED


def _found(case: Case, search: KeptSearch, seed: int) -> Optimum:
    limits, drawn = search.limits, search.drawn
    sheets = [sheet for width in limits.widths for sheet in _sheets(search, float(width))]
    places = [_refined(search, start) for start in starts_of(sheets)]
    candidates = confirmed(search, candidates_of(search, places))
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


def _sheets(search: KeptSearch, width: float) -> list[Sheet]:
    """Sheets of the coarse net at a width and every feed."""
    model, limits = search.model, search.limits
    size = _A_SHEET * limits.feeds.size
    computed: list[Sheet] = []

    def compute() -> list:
        computed.extend(sheets_of_width(model, limits, width, search.part(size)))
        return [slice_record(sheet) for sheet in computed]

    record = search.cache.record("width", width, compute)
    search.done(size)
    return computed or [
        slice_from_record(one, model_at(model, width, float(feed)), limits)
        for one, feed in zip(record, limits.feeds, strict=True)
    ]


def _refined(search: KeptSearch, start: Place) -> Place:
    model, limits, told = search.model, search.limits, search.part(_A_START)

    def compute() -> list:
        return list(refined(model, limits, start, lambda level: told(level, LEVELS)))

    place = Place(*search.cache.record("refined", tuple(start), compute))
    search.done(_A_START)
    return place


def _refuse(case: Case) -> None:
    case.require("tool", "material", "cut", "structure")
    if case.cut.speed_variation is not None:
        raise InputError(
            f"{case.name}: cut.speed_variation: the optimum is sought at a constant speed; "
            "leave it out"
        )


def _best_of_widths(sheets: Sequence[Sheet], limits: Limits) -> list[Place]:
    """Best place of every width that has one, of the coarse net."""
    best = []
    for width in limits.widths:
        places = [best_of(sheet) for sheet in sheets if np.isclose(sheet.case.width_of_cut, width)]
        known = [place for place in places if place is not None]
        best += [max(known, key=lambda place: place.removal_rate)] if known else []
    return best


def _shown_sheet(
    search: KeptSearch, candidates: Sequence[Candidate], sheets: Sequence[Sheet]
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
