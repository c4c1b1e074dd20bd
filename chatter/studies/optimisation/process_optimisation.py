"""`optimum`: search, probability of the best cuts, and their confirmation in the time domain."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from chatter.compile.inclined_axis import refuse_inclined_axis
from chatter.description.case import Case
from chatter.description.case_or_path import takes_case_or_path
from chatter.description.errors import InputError
from chatter.description.progress import Progress, no_progress
from chatter.description.questioned import question_of_flutes
from chatter.description.unit_system import units_of
from chatter.studies.optimisation.candidate import Candidate
from chatter.studies.optimisation.exclusion import exclusions
from chatter.studies.optimisation.grid_search import (
    LEVELS,
    STARTS,
    best_of,
    refined,
    slices_at_radial_depth,
    starts_of,
)
from chatter.studies.optimisation.limits import LIMITED, Limits
from chatter.studies.optimisation.operating_point import OperatingPoint, model_with
from chatter.studies.optimisation.optimum import Optimum
from chatter.studies.optimisation.robustness import (
    RADIAL_DEPTH_STEPS,
    ROBUST_WORK,
    SIMULATED,
    candidates_of,
)
from chatter.studies.optimisation.sampled_cuts import Samples
from chatter.studies.optimisation.search_state import OptimumSearch
from chatter.studies.optimisation.speed_depth_slice import (
    SpeedDepthSlice,
    evaluated_slice,
    slice_from_record,
    slice_record,
)
from chatter.studies.optimisation.time_domain_verification import VERIFICATION_WORK, confirmed
from chatter.studies.uncertainty.sample_limits import check_counts

DEFAULT_SAMPLES, DEFAULT_SEED = 200, 1
#: sizes of the pieces of work against each other
_SLICE_WORK, _START_WORK = 100, 40


@takes_case_or_path
def optimum(
    case: Case,
    samples: int = DEFAULT_SAMPLES,
    seed: int = DEFAULT_SEED,
    progress: Progress = no_progress,
    folder: str | Path | None = None,
) -> Optimum:
    """Find the speed, depth, radial depth and feed of the highest removal rate within the limits.

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
    search = OptimumSearch(case, samples, seed, progress, folder)
    search.expect(_work(search))
    with search.cache as cache:
        try:
            return _found(case, search, seed)
        except KeyboardInterrupt:
            raise cache.search_interrupted() from None


def _work(search: OptimumSearch) -> int:
    """All pieces of the search, at the most that are to be expected."""
    grid_slices = search.limits.radial_depths.size * search.limits.feeds.size
    robust = STARTS + 2 * RADIAL_DEPTH_STEPS if search.drawn is not None else 0
    return (
        _SLICE_WORK * grid_slices
        + _START_WORK * STARTS
        + ROBUST_WORK * robust
        + VERIFICATION_WORK * SIMULATED
    )


def _found(case: Case, search: OptimumSearch, seed: int) -> Optimum:
    limits, drawn = search.limits, search.drawn
    grid_slices = [
        grid_slice
        for radial_depth in limits.radial_depths
        for grid_slice in _slices_at(search, float(radial_depth))
    ]
    points = [_refined(search, start) for start in starts_of(grid_slices)]
    candidates = confirmed(search, candidates_of(search, points))
    result = Optimum(
        case=case,
        limits=limits,
        candidates=tuple(replace(one, units=units_of(case)) for one in candidates),
        over_radial_depths=tuple(_best_of_radial_depths(grid_slices, limits)),
        grid_slice=_drawn_slice(search, candidates, grid_slices),
        exclusions=exclusions(grid_slices),
        points=sum(grid_slice.kept.size for grid_slice in grid_slices),
        samples=len(drawn) if drawn else 0,
        seed=seed,
        notes=(
            *search.model.notes,
            *_notes(case, limits, drawn),
            *question_of_flutes(
                case, max((one.point.axial_depth for one in candidates), default=0.0)
            ),
        ),
    )
    search.end()
    return result


def _slices_at(search: OptimumSearch, radial_depth: float) -> list[SpeedDepthSlice]:
    """Slices of the coarse grid at a radial depth and every feed."""
    model, limits = search.model, search.limits
    size = _SLICE_WORK * limits.feeds.size
    computed: list[SpeedDepthSlice] = []

    def compute() -> list:
        computed.extend(slices_at_radial_depth(model, limits, radial_depth, search.part(size)))
        return [slice_record(grid_slice) for grid_slice in computed]

    record = search.cache.record("radial depth", radial_depth, compute)
    search.done(size)
    return computed or [
        slice_from_record(one, model_with(model, radial_depth, float(feed)), limits)
        for one, feed in zip(record, limits.feeds, strict=True)
    ]


def _refined(search: OptimumSearch, start: OperatingPoint) -> OperatingPoint:
    model, limits, report = search.model, search.limits, search.part(_START_WORK)

    def compute() -> list:
        return list(refined(model, limits, start, lambda level: report(level, LEVELS)))

    point = OperatingPoint(*search.cache.record("refined", tuple(start), compute))
    search.done(_START_WORK)
    return point


def _refuse(case: Case) -> None:
    case.require("tool", "material", "cut", "structure")
    refuse_inclined_axis(case)
    if case.cut.speed_variation is not None:
        raise InputError(
            f"{case.name}: cut.speed_variation: the optimum is sought at a constant speed; "
            "leave it out"
        )


def _best_of_radial_depths(
    grid_slices: Sequence[SpeedDepthSlice], limits: Limits
) -> list[OperatingPoint]:
    """Best point of every radial depth that has one, of the coarse grid."""
    best = []
    for radial_depth in limits.radial_depths:
        points = [
            best_of(grid_slice)
            for grid_slice in grid_slices
            if np.isclose(grid_slice.case.width_of_cut, radial_depth)
        ]
        known = [point for point in points if point is not None]
        best += [max(known, key=lambda point: point.removal_rate)] if known else []
    return best


def _drawn_slice(
    search: OptimumSearch, candidates: Sequence[Candidate], grid_slices: Sequence[SpeedDepthSlice]
) -> SpeedDepthSlice:
    """Slice at the radial depth and feed of the best cut; else that with the most points left."""
    if not candidates:
        return max(grid_slices, key=lambda grid_slice: int(grid_slice.kept.sum()))
    limits, point = search.limits, candidates[0].point
    here = model_with(search.model, point.radial_depth, point.feed_per_tooth)
    for grid_slice in grid_slices:
        if grid_slice.case == here.case:
            return grid_slice
    return evaluated_slice(here, limits, limits.speeds, limits.depths, limits.extended_speeds())


def _notes(case: Case, limits: Limits, drawn: Samples | None) -> list[str]:
    notes = []
    missing = [key for key in LIMITED if key not in limits.most]
    if missing:
        notes.append(f"no limit is given by optimum.{', optimum.'.join(missing)}")
    if drawn is None:
        notes.append(
            f"nothing in the case is uncertain: stability keeps {limits.depth_margin:.3g} of the "
            f"critical depth and {limits.speed_margin:.3g} of the speed as margins"
        )
    section = case.optimum
    if section is not None and section.min_tool_life is not None:
        fastest = case.tool_life.cutting_speed_for(section.min_tool_life)
        notes.append(
            f"optimum.min_tool_life: an edge lasts {section.min_tool_life / 60.0:.3g} min up to "
            f"{units_of(case).cutting_speed.text(fastest)}; no higher speed is searched"
        )
    modes = case.structure.mode if case.structure else ()
    if any(mode.frequency_slope for mode in modes):
        notes.append("the search takes the modes at the speed of the case, not at each speed")
    return notes
