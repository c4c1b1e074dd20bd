"""Lobe diagrams over any path of a case: the limit depth over one, a map over two."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.progress import Progress, no_progress
from chatter.engine.parallel import Executor, one_thread, sweep
from chatter.io.result_files import finite_or_none
from chatter.stability.model import milling_model
from chatter.stability.registry import (
    GRIDS,
    chosen_method,
    radius_by_collocation,
    resolution,
    zero_order_of,
)
from chatter.stability.search_range import depths_at_one_speed
from chatter.studies.model import fingerprint, patched
from chatter.studies.parameter_axis import (
    DEPTH_PATH,
    SPEED_PATH,
    AxisGiven,
    axis_of,
    speed_axis,
    standing_number,
)
from chatter.studies.result_cache import ResultCache
from chatter.studies.results_over_axes import PathLimits, StabilityMap
from chatter.studies.whatif.variation import Value, Variation

#: values of a range that gives no count: of a curve, and of each side of a map
_CURVE_COUNT, _MAP_COUNT = 60, 40
#: notes of single points that are told
_MOST_NOTES = 3

#: records of points: (function, points, what they are) -> list
Each = Callable[..., "list[dict[str, Any]]"]


class _Point(NamedTuple):
    """A patched case, and speeds (rad/s) and depths (m) at which its radius is wanted."""

    case: Case
    method: str
    speeds: tuple[float, ...] = ()
    depths: tuple[float, ...] = ()


def lobes_over(
    case: Case,
    x: AxisGiven | None = None,
    y: AxisGiven | None = None,
    method: str | None = None,
    progress: Progress = no_progress,
    cluster: str | Executor | None = None,
    folder: str | Path | None = None,
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
    cluster : str or Executor, optional
        Where they are computed, as for `chatter.studies.executor.open_executor`; here by default.
    folder : path, optional
        On a cluster, keeps finished points or columns in the result cache there.

    Returns
    -------
    PathLimits or StabilityMap

    Raises
    ------
    InputError
        If a path or range is wrong, or a patched case is.
    RunError
        If it is interrupted.
    """
    name, _ = chosen_method(case, method)
    each = _each if cluster is None else partial(_kept, cluster, folder)
    if y is None:
        if x is None:
            raise InputError("a path is wanted for x or y; chatter.lobes draws over speed")
        axis = axis_of(x, case, "--x", _CURVE_COUNT)
        if axis.path == DEPTH_PATH:
            raise InputError(
                f"--x {DEPTH_PATH}: the limit is an axial depth itself; with --y it makes a map"
            )
        return _limits_over(case, axis, name, partial(each, progress))
    across = axis_of(x, case, "--x", _MAP_COUNT) if x is not None else speed_axis(case)
    upwards = axis_of(y, case, "--y", _MAP_COUNT)
    if across.path == upwards.path:
        raise InputError(f"--x and --y are both {across.path}; a map needs two paths")
    return _map_over(case, across, upwards, name, partial(each, progress))


def _limits_over(case: Case, axis: Variation, method: str, each: Each) -> PathLimits:
    labels = [f"{axis.path} = {value.label}" for value in axis.values]
    points = [
        _Point(_patched(case, [(axis, value)], label), method)
        for value, label in zip(axis.values, labels, strict=True)
    ]
    found = each(_limit_at, points, "values")
    reasons = _reasons(found, case.name, labels)
    frequencies = [np.nan if one["frequency"] is None else one["frequency"] for one in found]
    searched = [np.nan if one["searched_to"] is None else one["searched_to"] for one in found]
    return PathLimits(
        case=case,
        method=method,
        axis=axis,
        crossings=tuple(np.array(one["crossings"], dtype=np.float64) for one in found),
        chatter_frequency=np.array(frequencies),
        bifurcation=tuple(one["bifurcation"] for one in found),
        searched_to=np.array(searched),
        standing=standing_number(case, axis),
        reasons=reasons,
        notes=_notes(_told(found, reasons)),
    )


def _limit_at(point: _Point) -> dict[str, Any]:
    """Limits of a case at its speed, as JSON knows it, or why there is none."""
    case = point.case
    try:
        limits_of = chosen_method(case, point.method)[1]
        model = milling_model(case)
        speeds = np.array([case.cut.spindle_speed])
        depths = depths_at_one_speed(case, zero_order_of(model, speeds))
        limit = limits_of(model, speeds, depths, resolution(case), no_progress)
    except InputError as error:
        return {
            "crossings": [], "frequency": None, "bifurcation": "none", "searched_to": None,
            "notes": [], "refused": list(error.messages),
        }  # fmt: skip
    return {
        "crossings": limit.crossings[0].tolist(),
        "frequency": finite_or_none(float(limit.chatter_frequency[0])),
        "bifurcation": limit.bifurcation[0],
        "searched_to": float(depths[-1]),
        "notes": list(model.notes),
        "refused": [],
    }


def _map_over(case: Case, x: Variation, y: Variation, method: str, each: Each) -> StabilityMap:
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
    lines, labels = [], []
    for _, places in groups:
        row, column = places[0]
        chosen = [(x, x.values[column]), (y, y.values[row])]
        if others is not None:
            chosen = [(axis, value) for axis, value in chosen if axis is others]
        labels.append(" and ".join(f"{axis.path} = {value.label}" for axis, value in chosen))
        lines.append(_line_along(_patched(case, chosen, labels[-1]), method, along, own))
    found = each(_radius_along, lines, "columns")
    reasons = _reasons(found, case.name, labels)
    radius = np.full((len(rows), len(columns)), np.nan)
    for (_, places), line, why in zip(groups, found, reasons, strict=True):
        for (j, i), value in zip(places, line["radius"], strict=not why):
            radius[j, i] = value
    left_out = {label: why for label, why in zip(labels, reasons, strict=True) if why}
    notes = _notes(_told(found, reasons))
    if method not in ("collocation", *GRIDS):
        notes = (*notes, f"the map is by collocation; {method} gives no spectral radius")
    standing = (standing_number(case, x), standing_number(case, y))
    return StabilityMap(case, method, x, y, radius, standing, notes, left_out)


def _line_along(case: Case, method: str, along: Variation | None, own: list) -> _Point:
    """Points of a case along its inner path, if there is one."""
    count = max(1, len(own))
    speeds = np.full(count, case.cut.spindle_speed)
    depths = np.full(count, case.cut.axial_depth)
    if along is not None and along.path == SPEED_PATH:
        speeds = np.array([cut.spindle_speed for cut in own])
    elif along is not None:
        depths = np.array([cut.axial_depth for cut in own])
    return _Point(case, method, tuple(speeds.tolist()), tuple(depths.tolist()))


def _radius_along(line: _Point) -> dict[str, Any]:
    """Spectral radius of a case at some speeds and depths, as JSON knows it, or why none."""
    radius_at = GRIDS.get(line.method, radius_by_collocation)
    points = np.array(line.speeds), np.array(line.depths)
    try:
        model = milling_model(line.case)
        radius = radius_at(model, *points, resolution(line.case), no_progress)
    except InputError as error:
        return {"radius": [], "notes": [], "refused": list(error.messages)}
    return {"radius": radius.tolist(), "notes": list(model.notes), "refused": []}


def _inner(case: Case, x: Variation, y: Variation) -> str:
    """Axis along which one compiled case serves all points; "" where neither is so."""
    on_machine = case.structure is not None and case.structure.machine is not None
    # a machine is linearised at the speed of the case
    for path in (DEPTH_PATH, *(() if on_machine else (SPEED_PATH,))):
        for name, axis in (("x", x), ("y", y)):
            if axis.path == path:
                return name
    return ""


def _patched(case: Case, chosen: Sequence[tuple[Variation, Value]], label: str) -> Case:
    """Case at values of axes, which are named where they describe no case."""
    patch = {path: given for _, value in chosen for path, given in value.patch.items()}
    try:
        return patched(case, patch)
    except InputError as error:
        raise InputError([f"at {label}: {text}" for text in error.messages]) from None


def _each(
    progress: Progress,
    function: Callable[[_Point], dict[str, Any]],
    points: Sequence[_Point],
    noun: str,  # noqa: ARG001  (that of what is kept)
) -> list[dict[str, Any]]:
    """Records of all points, in threads; each is computed in one."""

    def at(places: NDArray[np.int64]) -> list[dict[str, Any]]:
        with one_thread():
            return [function(points[place]) for place in places]

    return [record for chunk in sweep(at, len(points), progress, 1) for record in chunk]


def _kept(
    cluster: str | Executor,
    folder: str | Path | None,
    progress: Progress,
    function: Callable[[_Point], dict[str, Any]],
    points: Sequence[_Point],
    noun: str,
) -> list[dict[str, Any]]:
    """Records of all points on a cluster, kept as they come."""
    with ResultCache(folder, function.__name__) as cache:
        keys = [
            cache.key(fingerprint(one.case), repr((one.method, one.speeds, one.depths)))
            for one in points
        ]
        return cache.evaluate(function, points, keys, noun, cluster, progress)


def _reasons(found: Sequence[dict[str, Any]], name: str, labels: Sequence[str]) -> tuple[str, ...]:
    """Why there is no result, empty where there is; refused where there is none at all."""
    reasons = tuple(" ".join(one["refused"]).removeprefix(f"{name}: ") for one in found)
    if all(reasons):
        raise InputError(f"{name}: at {labels[0]}, and at every other value: {reasons[0]}")
    return reasons


def _told(found: Sequence[dict[str, Any]], reasons: Sequence[str]) -> list[tuple[str, ...]]:
    return [tuple(one["notes"]) for one, why in zip(found, reasons, strict=True) if not why]


def _notes(told: Sequence[tuple[str, ...]]) -> tuple[str, ...]:
    """Notes of all points first, then some of those that hold at single ones."""
    distinct = list(dict.fromkeys(note for notes in told for note in notes))
    everywhere = [note for note in distinct if all(note in notes for notes in told)]
    single = [f"at some values: {note}" for note in distinct if note not in everywhere]
    return (*everywhere, *single[:_MOST_NOTES])
