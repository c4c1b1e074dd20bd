"""Stability diagrams over any path of a case: the critical depth over one, a map over two."""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from chatter.description.arrays import Array
from chatter.description.case import Case
from chatter.description.case_or_path import takes_case_or_path
from chatter.description.errors import InputError
from chatter.description.progress import Progress, no_progress
from chatter.engine.parallel import Executor
from chatter.io.result_files import finite_or_none
from chatter.stability.diagram import DiagramAxis, StabilityDiagram, StabilityMap
from chatter.stability.edge_force_onset import REPORTED_ONSET
from chatter.stability.forced_vibration import neglected_edge_forces
from chatter.stability.limit_curve import LimitCurve, first_crossings
from chatter.stability.lobes import lobes as lobes_of
from chatter.stability.lobes import map_over_speed
from chatter.stability.methods.zeroth_order.limits import zero_order_of
from chatter.stability.model import MillingModel, milling_model
from chatter.stability.registry import METHODS, chosen_method, fixed_steps, with_radius
from chatter.stability.search_range import (
    axial_depths,
    depths_at_one_speed,
    maximum_depth,
    spindle_speeds,
)
from chatter.studies.executor import ThreadExecutor
from chatter.studies.model import fingerprint, patched
from chatter.studies.parameter_axis import (
    DEPTH_PATH,
    SPEED_PATH,
    AxisGiven,
    axis_of,
    case_value,
    speed_axis,
)
from chatter.studies.result_cache import ResultCache
from chatter.studies.whatif.variation import Value, Variation

#: values of a range that gives no count: of a curve, and of each side of a map
_CURVE_COUNT, _MAP_COUNT = 60, 40
#: speeds of a block of the grid that a worker of a cluster computes
_SPEEDS_PER_BLOCK = 4
#: notes of single points that are reported
_MOST_NOTES = 3

#: records of points: (function, points, what they are) -> list
Each = Callable[..., "list[dict[str, Any]]"]


class _Point(NamedTuple):
    """A patched case, and speeds (rad/s) and depths (m) at which its radius is required."""

    case: Case
    method: str
    speeds: tuple[float, ...] = ()
    depths: tuple[float, ...] = ()


@takes_case_or_path
def lobes(
    case: Case,
    method: str | None = None,
    grid: bool = False,
    progress: Progress = no_progress,
    cluster: str | Executor | None = None,
    folder: str | Path | None = None,
) -> StabilityDiagram:
    """Compute the stability lobe diagram of a case.

    Parameters
    ----------
    case, method, grid, progress
        As of `chatter.stability.lobes.lobes`.
    cluster : str or Executor, optional
        Where the grid is computed, as for `chatter.studies.executor.open_executor`; here by
        default.
    folder : path, optional
        On a cluster, keeps finished blocks of the grid in the result cache there.

    Returns
    -------
    StabilityDiagram
    """
    if not grid or cluster is None:
        return lobes_of(case, method, grid, progress)
    diagram = lobes_of(case, method, progress=progress)
    chosen = METHODS[diagram.method]
    speeds = spindle_speeds(case)
    depths = axial_depths(case, maximum_depth(case, diagram.zero_order))
    lines = []
    for first in range(0, len(speeds), _SPEEDS_PER_BLOCK):
        points = np.meshgrid(speeds[first : first + _SPEEDS_PER_BLOCK], depths)
        lines.append(_Point(case, chosen.name, *(tuple(part.ravel().tolist()) for part in points)))
    found = _kept(cluster, folder, progress, _radius_along, lines, "blocks of the grid")
    for block in found:
        if block["refused"]:
            raise InputError(block["refused"])
    blocks = [np.reshape(block["radius"], (len(depths), -1)) for block in found]
    computed = map_over_speed(case, chosen, speeds, depths, np.concatenate(blocks, axis=1))
    return replace(diagram, grid=computed)


@takes_case_or_path
def lobes_over(
    case: Case,
    x: AxisGiven | None = None,
    y: AxisGiven | None = None,
    method: str | None = None,
    progress: Progress = no_progress,
    cluster: str | Executor | None = None,
    folder: str | Path | None = None,
) -> StabilityDiagram | StabilityMap:
    """Critical depth over a path of a case; with `y`, the spectral radius over two.

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
        Keeps finished points or columns in the result cache there.

    Returns
    -------
    StabilityDiagram or StabilityMap

    Raises
    ------
    InputError
        If a path or range is wrong, or a patched case is.
    RunError
        If it is interrupted.
    """
    name = chosen_method(case, method).name
    each = partial(_kept, cluster or ThreadExecutor(), folder)
    if y is None:
        if x is None:
            raise InputError("a path is required for x or y; chatter.lobes draws over speed")
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


def _diagram_axis(case: Case, axis: Variation) -> DiagramAxis:
    labels = tuple(value.label for value in axis.values)
    values = np.array(axis.numbers)
    return DiagramAxis(axis.path, axis.unit, values, labels, case_value(case, axis))


def _limits_over(case: Case, axis: Variation, method: str, each: Each) -> StabilityDiagram:
    labels = [f"{axis.path} = {value.label}" for value in axis.values]
    points = [_Point(one, method) for one in _cases_along(case, axis)]
    found = each(_limit_at, points, "values")
    reasons = _reasons(found, case.name, labels)
    crossings = tuple(np.array(one["crossings"], dtype=np.float64) for one in found)
    max_depth = _column(found, "max_depth")
    limits = LimitCurve(
        spindle_speed=np.array([point.case.cut.spindle_speed for point in points]),
        critical_depth=np.where(np.isnan(max_depth), np.nan, first_crossings(crossings)),
        chatter_frequency=_column(found, "frequency"),
        bifurcation=tuple(one["bifurcation"] for one in found),
        crossings=crossings,
        steps=np.zeros(len(points), dtype=np.int64),
    )
    return StabilityDiagram(
        case=case,
        method=method,
        axis=_diagram_axis(case, axis),
        limits=limits,
        max_depth=max_depth,
        notes=(*_notes(_notes_of(found, reasons)), *_note_on_edge_forces(found, labels)),
        reasons=reasons,
    )


def _column(found: Sequence[dict[str, Any]], key: str) -> Array:
    return np.array([np.nan if one[key] is None else one[key] for one in found])


def _limit_at(point: _Point) -> dict[str, Any]:
    """Limits of a case at its speed, as JSON knows it, or why there is none."""
    case = point.case
    try:
        chosen = chosen_method(case, point.method)
        model = milling_model(case)
        speeds = np.array([case.cut.spindle_speed])
        depths = depths_at_one_speed(case, zero_order_of(model, speeds))
        limit = chosen.limits(model, speeds, depths, fixed_steps(case), no_progress)
    except InputError as error:
        return {
            "crossings": [], "frequency": None, "bifurcation": "none", "max_depth": None,
            "notes": [], "refused": list(error.messages),
        }  # fmt: skip
    return {
        "crossings": limit.crossings[0].tolist(),
        "frequency": finite_or_none(float(limit.chatter_frequency[0])),
        "bifurcation": limit.bifurcation[0],
        "max_depth": float(depths[-1]),
        "notes": list(model.notes),
        "refused": [],
        "edge_forces": _share_of_edge_forces(model, limit) if chosen.is_linear else 0.0,
    }


def _share_of_edge_forces(model: MillingModel, limit: LimitCurve) -> float:
    """Part of a limit that edge forces may take, 1 or more where they leave nothing certain."""
    found = neglected_edge_forces(model, model.case.cut.axial_depth, limit.critical_depth)
    return max((one.share for one in found), default=0.0)


def _note_on_edge_forces(found: Sequence[dict[str, Any]], labels: Sequence[str]) -> tuple[str, ...]:
    """Say by how much edge forces that set in at a chip of zero may lower the limits, and where."""
    shares = [one.get("edge_forces", 0.0) for one in found]
    most = max(range(len(shares)), key=shares.__getitem__)
    if shares[most] < REPORTED_ONSET:
        return ()
    largest = (
        f"may lower these limits by up to {shares[most]:.0%}"
        if shares[most] < 1.0
        else f"are up to {shares[most]:.3g} times as stiff as the chip"
    )
    return (
        f"edge forces that set in at a chip of zero {largest} ({labels[most]}), which linear "
        "methods leave out; `chatter check` says it of each cut, the time domain decides "
        "(--method time-domain)",
    )


def _map_over(case: Case, x: Variation, y: Variation, method: str, each: Each) -> StabilityMap:
    inner = _inner(case, x, y)
    # what the inner path makes of the case does not depend on the other one
    own = [patched(case, value.patch).cut for value in inner.values] if inner else []
    outer = [axis for axis in (y, x) if axis is not inner]
    lines, labels = [], []
    for values in itertools.product(*(axis.values for axis in outer)):
        chosen = list(zip(outer, values, strict=True))[::-1]
        labels.append(" and ".join(f"{axis.path} = {value.label}" for axis, value in chosen))
        lines.append(_line_along(_patched(case, chosen, labels[-1]), method, inner, own))
    found = each(_radius_along, lines, "columns")
    reasons = _reasons(found, case.name, labels)
    unknown = [np.nan] * max(1, len(own))
    radius = np.array([line["radius"] or unknown for line in found])
    radius = radius.T if inner is y else radius.reshape(len(y.values), len(x.values))
    excluded = {label: why for label, why in zip(labels, reasons, strict=True) if why}
    notes = _notes(_notes_of(found, reasons))
    if not METHODS[method].gives_radius:
        notes = (*notes, f"the map is by collocation; {method} gives no spectral radius")
    axes = _diagram_axis(case, x), _diagram_axis(case, y)
    return StabilityMap(case, method, *axes, radius, notes, excluded)


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


@lru_cache(maxsize=2)
def _model_of(case: Case) -> MillingModel:
    """Model of a case, kept: the blocks of a grid share it."""
    return milling_model(case)


def _radius_along(line: _Point) -> dict[str, Any]:
    """Spectral radius of a case at some speeds and depths, as JSON knows it, or why none."""
    chosen = with_radius(METHODS[line.method])
    points = np.array(line.speeds), np.array(line.depths)
    try:
        model = _model_of(line.case)
        radius = chosen.radius(model, *points, fixed_steps(line.case), no_progress)
    except InputError as error:
        return {"radius": [], "notes": [], "refused": list(error.messages)}
    return {"radius": radius.tolist(), "notes": list(model.notes), "refused": []}


def _inner(case: Case, x: Variation, y: Variation) -> Variation | None:
    """Axis along which one compiled case serves all points; None where neither is so."""
    on_machine = case.structure is not None and case.structure.machine is not None
    # a machine is linearised at the speed of the case
    paths = (DEPTH_PATH,) if on_machine else (DEPTH_PATH, SPEED_PATH)
    return next((axis for path in paths for axis in (x, y) if axis.path == path), None)


def _patched(case: Case, chosen: Sequence[tuple[Variation, Value]], label: str) -> Case:
    """Case at values of axes, which are named where they describe no case."""
    patch = {path: given for _, value in chosen for path, given in value.patch.items()}
    try:
        return patched(case, patch)
    except InputError as error:
        raise InputError([f"at {label}: {text}" for text in error.messages]) from None


def _cases_along(case: Case, axis: Variation) -> list[Case]:
    """Case at every value of an axis.

    InputError where some describe no case, with what of the range is left.
    """
    cases, refused = {}, {}
    for value in axis.values:
        try:
            cases[value.number] = patched(case, value.patch)
        except InputError as error:
            refused[value.number] = (value.label, error.messages)
    if not refused:
        return list(cases.values())
    label, messages = next(iter(refused.values()))
    left = ""
    if cases:
        ends = f"{min(cases):.6g} to {max(cases):.6g} {axis.unit}".rstrip()
        left = f"; {len(cases)} of the {len(axis.values)} values make a cut, {ends}"
    raise InputError([f"at {axis.path} = {label}: {text}{left}" for text in messages])


def _kept(
    cluster: str | Executor,
    folder: str | Path | None,
    progress: Progress,
    function: Callable[[_Point], dict[str, Any]],
    points: Sequence[_Point],
    noun: str,
) -> list[dict[str, Any]]:
    """Records of all points, kept as they come."""
    of_case = {case: fingerprint(case) for case in {one.case for one in points}}
    with ResultCache(folder, function.__name__) as cache:
        keys = [
            cache.key(of_case[one.case], repr((one.method, one.speeds, one.depths)))
            for one in points
        ]
        return cache.evaluate(function, points, keys, noun, cluster=cluster, progress=progress)


def _reasons(found: Sequence[dict[str, Any]], name: str, labels: Sequence[str]) -> tuple[str, ...]:
    """Why there is no result, empty where there is; refused where there is none at all."""
    reasons = tuple(" ".join(one["refused"]).removeprefix(f"{name}: ") for one in found)
    if all(reasons):
        raise InputError(f"{name}: at {labels[0]}, and at every other value: {reasons[0]}")
    return reasons


def _notes_of(found: Sequence[dict[str, Any]], reasons: Sequence[str]) -> list[tuple[str, ...]]:
    return [tuple(one["notes"]) for one, why in zip(found, reasons, strict=True) if not why]


def _notes(of_points: Sequence[tuple[str, ...]]) -> tuple[str, ...]:
    """Notes of all points first, then some of those that hold at single ones."""
    distinct = list(dict.fromkeys(note for notes in of_points for note in notes))
    everywhere = [note for note in distinct if all(note in notes for notes in of_points)]
    single = [f"at some values: {note}" for note in distinct if note not in everywhere]
    return (*everywhere, *single[:_MOST_NOTES])
