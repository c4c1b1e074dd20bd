"""Lobe diagrams over any path of a case: the limit depth over one, a map over two."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from chatter.case import Case
from chatter.errors import InputError
from chatter.methods import (
    GRIDS,
    chosen_method,
    radius_by_collocation,
    resolution,
    zero_order_of,
)
from chatter.model import milling_model
from chatter.path_axis import (
    DEPTH_PATH,
    SPEED_PATH,
    AxisGiven,
    axis_of,
    speed_axis,
    standing_number,
)
from chatter.path_results import PathLimits, StabilityMap
from chatter.search_range import depths_at_one_speed
from chatter.stability.sweep import Progress, no_progress, one_thread, sweep
from chatter.what_if.subject import patched
from chatter.what_if.variation import Variation

#: values of a range that gives no count: of a curve, and of each side of a map
_CURVE_COUNT, _MAP_COUNT = 60, 40
#: notes of single points that are told
_MOST_NOTES = 3

Result = TypeVar("Result")


def lobes_over(
    case: Case,
    x: AxisGiven | None = None,
    y: AxisGiven | None = None,
    method: str | None = None,
    progress: Progress = no_progress,
) -> PathLimits | StabilityMap:
    """Limit depth over a path of a case; with `y`, the spectral radius over two.

    Parameters
    ----------
    case : Case
    x : str or (str, sequence), optional
        ``"cut.radial_depth=0.5 mm..10 mm:40"``, or a path and its values; in a map the spindle
        speeds of the case's diagram by default.
    y : str or (str, sequence), optional
        As x.
    method : str, optional
        As for `chatter.lobes`.
    progress : callable, optional
        Called with (done, total) points or columns.

    Returns
    -------
    PathLimits or StabilityMap

    Raises
    ------
    InputError
        If a path or range is wrong, or a patched case is.
    """
    name, _ = chosen_method(case, method)
    if y is None:
        if x is None:
            raise InputError("a path is wanted for x or y; chatter.lobes draws over speed")
        axis = axis_of(x, case, "--x", _CURVE_COUNT)
        if axis.path == DEPTH_PATH:
            raise InputError(
                f"--x {DEPTH_PATH}: the limit is an axial depth itself; with --y it makes a map"
            )
        return _limits_over(case, axis, name, progress)
    across = axis_of(x, case, "--x", _MAP_COUNT) if x is not None else speed_axis(case)
    upwards = axis_of(y, case, "--y", _MAP_COUNT)
    if across.path == upwards.path:
        raise InputError(f"--x and --y are both {across.path}; a map needs two paths")
    return _map_over(case, across, upwards, name, progress)


def _limits_over(case: Case, axis: Variation, method: str, progress: Progress) -> PathLimits:
    cases = [patched(case, value.patch) for value in axis.values]

    def limit_at(place: int) -> tuple:
        here = cases[place]
        limits_of = chosen_method(here, method)[1]
        model = milling_model(here)
        speeds = np.array([here.cut.spindle_speed])
        depths = depths_at_one_speed(here, zero_order_of(model, speeds))
        return limits_of(model, speeds, depths, resolution(here), no_progress), depths, model.notes

    found = _each(limit_at, len(cases), progress)
    limits = [limit for limit, _, _ in found]
    return PathLimits(
        case=case,
        method=method,
        axis=axis,
        crossings=tuple(limit.crossings[0] for limit in limits),
        chatter_frequency=np.array([float(limit.chatter_frequency[0]) for limit in limits]),
        bifurcation=tuple(limit.bifurcation[0] for limit in limits),
        searched_to=np.array([depths[-1] for _, depths, _ in found]),
        standing=standing_number(case, axis),
        notes=_notes([notes for _, _, notes in found]),
    )


def _map_over(
    case: Case, x: Variation, y: Variation, method: str, progress: Progress
) -> StabilityMap:
    inner = _inner(case, x, y)
    columns, rows = range(len(x.values)), range(len(y.values))
    if inner == "x":
        groups = [(j, [(j, i) for i in columns]) for j in rows]
    elif inner == "y":
        groups = [(i, [(j, i) for j in rows]) for i in columns]
    else:
        groups = [(None, [(j, i)]) for j in rows for i in columns]
    along = {"x": x, "y": y}.get(inner)
    # what the inner path makes of the case does not depend on the other one
    own = [patched(case, value.patch).cut for value in along.values] if along else []
    others = {"x": y, "y": x}.get(inner)
    cases = [
        patched(case, others.values[outer].patch)
        if others
        else patched(case, {**x.values[points[0][1]].patch, **y.values[points[0][0]].patch})
        for outer, points in groups
    ]

    def radius_of(place: int) -> tuple:
        here = cases[place]
        model = milling_model(here)
        count = len(groups[place][1])
        speeds = np.full(count, here.cut.spindle_speed)
        depths = np.full(count, here.cut.axial_depth)
        if along is not None and along.path == SPEED_PATH:
            speeds = np.array([cut.spindle_speed for cut in own])
        elif along is not None:
            depths = np.array([cut.axial_depth for cut in own])
        radius_at = GRIDS.get(method, radius_by_collocation)
        return radius_at(model, speeds, depths, resolution(here), no_progress), model.notes

    found = _each(radius_of, len(cases), progress)
    radius = np.empty((len(rows), len(columns)))
    for (_, points), (values, _) in zip(groups, found, strict=True):
        for (j, i), value in zip(points, values, strict=True):
            radius[j, i] = value
    notes = _notes([notes for _, notes in found])
    if method not in ("collocation", *GRIDS):
        notes = (*notes, f"the map is by collocation; {method} gives no spectral radius")
    standing = (standing_number(case, x), standing_number(case, y))
    return StabilityMap(case, method, x, y, radius, standing, notes)


def _inner(case: Case, x: Variation, y: Variation) -> str:
    """Axis along which one compiled case serves all points; "" where neither is so."""
    on_machine = case.structure is not None and case.structure.machine is not None
    # a machine is linearised at the speed of the case
    for path in (DEPTH_PATH, *(() if on_machine else (SPEED_PATH,))):
        for name, axis in (("x", x), ("y", y)):
            if axis.path == path:
                return name
    return ""


def _each(function: Callable[[int], Result], count: int, progress: Progress) -> list[Result]:
    """Results of all places, in threads; each is computed in one."""

    def at(places: NDArray[np.int64]) -> list[Result]:
        with one_thread():
            return [function(int(place)) for place in places]

    return [result for chunk in sweep(at, count, progress, 1) for result in chunk]


def _notes(told: Sequence[tuple[str, ...]]) -> tuple[str, ...]:
    """Notes of all points first, then some of those that hold at single ones."""
    distinct = list(dict.fromkeys(note for notes in told for note in notes))
    everywhere = [note for note in distinct if all(note in notes for notes in told)]
    single = [f"at some values: {note}" for note in distinct if note not in everywhere]
    return (*everywhere, *single[:_MOST_NOTES])
