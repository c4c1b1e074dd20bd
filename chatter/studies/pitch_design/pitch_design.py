"""`pitch`: the rule, the families, the search over all angles, and limits before and after."""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from chatter.compile.cutter import pitch_angles
from chatter.compile.inclined_axis import refuse_inclined_axis
from chatter.description.arrays import Array
from chatter.description.case import Case
from chatter.description.case_or_path import takes_case_or_path
from chatter.description.errors import InputError
from chatter.description.progress import Progress, no_progress
from chatter.description.sections.optimisation import PitchDesign
from chatter.stability.forced_vibration import neglected_edge_forces, neglected_in_steady_cut
from chatter.stability.methods.collocation import multipliers as collocation
from chatter.stability.methods.collocation.collocation_method import COLLOCATION
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.methods.zeroth_order.limits import zero_order_of
from chatter.stability.model import MillingModel, milling_model
from chatter.stability.neglected_effects import lowest_factor, notes_of
from chatter.stability.resting_friction import limits_with_resting_friction
from chatter.stability.search_range import maximum_depth, spindle_speeds
from chatter.studies.model import fingerprint
from chatter.studies.pitch_design.families import families
from chatter.studies.pitch_design.pitch_result import FamilyCurve, PitchResult
from chatter.studies.pitch_design.pitch_search import DIFFERENCES, MAX_MOVES, Design, PitchSearch
from chatter.studies.result_cache import ResultCache

_DEPTHS = 40
#: speeds at which the designs are ranked, to one of the search
FINER = 5
#: differences of the rule that are reported
_RULE_COUNT = 8


@takes_case_or_path
def pitch(
    case: Case, progress: Progress = no_progress, folder: str | Path | None = None
) -> PitchResult:
    """Find pitch angles that raise the limits of a tool over a range of speeds.

    Parameters
    ----------
    case : Case
        `[pitch_design]` gives speeds, bounds and goal.
    progress : callable, optional
        Called with (done, total) designs.
    folder : path, optional
        Keeps the limits of finished designs in the result cache there, and reuses those of the same
        case.

    Returns
    -------
    PitchResult
        Its `best` is the pitch of the case itself where none found is better.

    Raises
    ------
    InputError
        If the case lacks something or its tool has one tooth.
    RunError
        If it is interrupted; finished designs are in the folder.
    """
    case.require("tool", "material", "cut", "structure")
    refuse_inclined_axis(case)
    if case.tool.teeth < 2:
        raise InputError(f"{case.name}: tool.teeth: one tooth has no pitch to choose")
    with ResultCache(folder, "pitch", fingerprint(case)) as cache:
        try:
            return _designed(case, cache, progress)
        except KeyboardInterrupt:
            raise cache.search_interrupted() from None


def _designed(case: Case, cache: ResultCache, progress: Progress) -> PitchResult:
    section = case.pitch_design or PitchDesign()
    model = milling_model(case)
    wide, fine = _speeds(case, section)
    kinds = families(case.tool.teeth)
    total = len(kinds) * DIFFERENCES + MAX_MOVES + 1
    done = iter(range(1, 10 * total))
    search = PitchSearch(
        case, wide, _depths(case, section, model), section.goal, section.max_pitch_ratio,
        lambda: progress(min(next(done), total), total), cache,
    )  # fmt: skip
    original = search.design("the case", np.degrees(pitch_angles(case)))
    even = search.design("even", np.full(case.tool.teeth, 360.0 / case.tool.teeth))
    slowest = float(wide[even.limits.argmin()])
    frequency = _chatter_frequency(case, search, even, slowest)
    middle = 0.5 * float(wide[0] + wide[-1])
    curves = []
    for kind in kinds:
        differences, designs = search.of_family(kind)
        rule = kind.cancelling(case.tool.teeth, middle, frequency, _RULE_COUNT)
        curves.append(
            FamilyCurve(kind.name, differences, tuple(designs), rule[rule <= differences[-1]])
        )
    start = max((one for curve in curves for one in curve.designs), key=lambda one: one.score)
    free = search.improved(start)
    # of designs with the same angles the last gives the name
    distinct = {one.pitch: one for one in (free, *(curve.best for curve in curves), original)}
    ranked = _ranked_on(search, list(distinct.values()), fine)
    progress(total, total)
    return PitchResult(
        case=case,
        goal=section.goal,
        max_pitch_ratio=section.max_pitch_ratio,
        max_depth=float(search.depths[-1]),
        original=next(one for one in ranked if one.pitch == original.pitch),
        designs=ranked,
        curves=tuple(curves),
        chatter_frequency=frequency / (2.0 * math.pi),
        design_speed=middle,
        speeds=fine,
        notes=(*model.notes, *_notes_on_best(search, ranked[0])),
    )


def _ranked_on(search: PitchSearch, designs: Sequence[Design], speeds: Array) -> tuple[Design, ...]:
    """Designs with their limits at and between finer speeds, best first."""
    finer = [search.refined(one, speeds) for one in designs]
    certain = [_with_certain(search.model_of(one.pitch), one) for one in finer]
    return tuple(sorted(certain, key=lambda one: -one.score))


def _notes_on_best(search: PitchSearch, best: Design) -> tuple[str, ...]:
    """Say what the limits of the best design leave out in the cut of the case."""
    found = neglected_in_steady_cut(search.model_of(best.pitch), COLLOCATION, best.limits)
    return notes_of(found)


def _with_certain(model: MillingModel, design: Design) -> Design:
    """Design with what edge forces and resting frictions leave of its lowest limit."""
    at_rest = limits_with_resting_friction(model, zero_order_of(model, spindle_speeds(model.case)))
    effects = neglected_edge_forces(
        model, model.case.cut.axial_depth, np.array([design.lowest_limit])
    )
    kept = lowest_factor(effects)
    taken_by = [f"{one.name} that set in at a chip of zero" for one in effects if kept < 1.0]
    if at_rest.of_lowest < 1.0:
        taken_by.append("frictions of axes at rest")
    return replace(design, kept=at_rest.of_lowest * kept, taken_by=tuple(taken_by))


def _speeds(case: Case, section: PitchDesign) -> tuple[Array, Array]:
    """Speeds of the search and of the ranking, rad/s."""
    if section.speeds is not None:
        first, last = section.speeds.from_, section.speeds.to
    else:
        first, last = spindle_speeds(case)[[0, -1]]
    finer = FINER * (section.count - 1) + 1
    return np.linspace(first, last, section.count), np.linspace(first, last, finer)


def _depths(case: Case, section: PitchDesign, model: MillingModel) -> Array:
    if section.depths is not None:
        return np.linspace(0.0, section.depths.to, section.depths.count + 1)[1:]
    max_depth = maximum_depth(case, zero_order_of(model, spindle_speeds(case)))
    return np.linspace(0.0, max_depth, _DEPTHS + 1)[1:]


def _chatter_frequency(case: Case, search: PitchSearch, even: Design, speed: float) -> float:
    """Chatter frequency of the uniform-pitch tool where its limit is lowest, rad/s."""
    depth = even.lowest_limit
    model = milling_model(case.patch({"tool.pitch": None}))
    cut = element_cut(model, float(search.depths[-1]))
    return 2.0 * math.pi * collocation.chatter_frequency(cut, speed, depth)
