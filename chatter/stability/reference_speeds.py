"""Structures that depend on the spindle speed, for methods that know of one structure each.

A sweep over speeds is split into groups of speeds with the same structure; every group goes to the
method on a model with that structure, and what comes back is put together again.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from chatter.compile.structure import standing_speeds
from chatter.description.progress import Progress, no_progress
from chatter.engine.parallel import one_thread, sweep, worker_count
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.methods.zeroth_order.method import ZeroOrderLimit
from chatter.stability.model import MillingModel

LimitMethod = Callable[
    [MillingModel, NDArray[np.float64], NDArray[np.float64], "int | None", Progress], LimitCurve
]
RadiusMethod = Callable[
    [MillingModel, NDArray[np.float64], NDArray[np.float64], "int | None", Progress],
    NDArray[np.float64],
]
ZeroOrderMethod = Callable[[MillingModel, NDArray[np.float64]], ZeroOrderLimit]
Result = TypeVar("Result")
#: called with the model of a group, the places of its speeds, and its progress
OfGroup = Callable[[MillingModel, NDArray[np.int64], Progress], Result]

#: below this many groups a thread, the threads work inside each group instead
_GROUPS_A_THREAD = 4


def limits_by_group(method: LimitMethod) -> LimitMethod:
    """Make a method for limits take every speed with its own structure."""

    @wraps(method)
    def limits(
        model: MillingModel,
        speeds: NDArray[np.float64],
        depths: NDArray[np.float64],
        steps: int | None,
        progress: Progress,
    ) -> LimitCurve:
        if not model.depends_on_speed:
            return method(model, speeds, depths, steps, progress)

        def of(own: MillingModel, places: NDArray[np.int64], report: Progress) -> LimitCurve:
            return method(own, speeds[places], depths, steps, report)

        return _joined_limits(speeds, _in_groups(model, speeds, of, progress))

    return limits


def radius_by_group(method: RadiusMethod) -> RadiusMethod:
    """Make a method for the spectral radius at points take each with its own structure."""

    @wraps(method)
    def radius(
        model: MillingModel,
        speeds: NDArray[np.float64],
        depths: NDArray[np.float64],
        steps: int | None,
        progress: Progress,
    ) -> NDArray[np.float64]:
        if not model.depends_on_speed:
            return method(model, speeds, depths, steps, progress)

        def of(
            own: MillingModel, places: NDArray[np.int64], report: Progress
        ) -> NDArray[np.float64]:
            return method(own, speeds[places], depths[places], steps, report)

        out = np.empty(len(speeds))
        for places, found in _in_groups(model, speeds, of, progress):
            out[places] = found
        return out

    return radius


def zero_order_by_group(method: ZeroOrderMethod) -> ZeroOrderMethod:
    """Make the zeroth-order solution take every speed with its own structure."""

    @wraps(method)
    def limits(model: MillingModel, speeds: NDArray[np.float64]) -> ZeroOrderLimit:
        if not model.depends_on_speed:
            return method(model, speeds)

        def of(own: MillingModel, places: NDArray[np.int64], _: Progress) -> ZeroOrderLimit:
            return method(own, speeds[places])

        found = _in_groups(model, speeds, of, no_progress)
        depth, frequency = np.empty(len(speeds)), np.empty(len(speeds))
        for places, limit in found:
            depth[places], frequency[places] = limit.critical_depth, limit.chatter_frequency
        lowest = min((limit for _, limit in found), key=lambda limit: limit.lowest_depth)
        return ZeroOrderLimit(
            speeds, depth, frequency, lowest.lowest_depth, lowest.lowest_frequency
        )

    return limits


def natural_frequencies(model: MillingModel, speeds: NDArray[np.float64]) -> NDArray[np.float64]:
    """Natural frequencies (k, n), Hz, of k modes at n speeds (rad/s).

    Of FRFs measured at several speeds those at the speed of the cut.
    """
    given = model.case.structure.mode
    if given and model.depends_on_speed:
        return np.array([[mode.frequency_at(float(speed)) for speed in speeds] for mode in given])
    own = np.array([mode.frequency for mode in model.structure.modes])
    return np.repeat(own[:, None], len(speeds), axis=1)


def _in_groups(
    model: MillingModel, speeds: NDArray[np.float64], of: OfGroup, progress: Progress
) -> list[tuple[NDArray[np.int64], Result]]:
    """Places and result of every group of speeds with the same structure."""
    standing, group_of = np.unique(standing_speeds(model.case, speeds), return_inverse=True)
    groups = [np.flatnonzero(group_of == group) for group in range(standing.size)]
    if standing.size < _GROUPS_A_THREAD * worker_count():
        found, done = [], 0
        for speed, places in zip(standing, groups, strict=True):
            found.append(of(model.at_speed(float(speed)), places, no_progress))
            done += places.size
            progress(done, len(speeds))
        return list(zip(groups, found, strict=True))

    def some(chunk: NDArray[np.int64]) -> list:
        with one_thread():
            return [
                of(model.at_speed(float(standing[group])), groups[group], no_progress)
                for group in chunk
            ]

    found = [result for part in sweep(some, standing.size, progress, 1) for result in part]
    return list(zip(groups, found, strict=True))


def _joined_limits(
    speeds: NDArray[np.float64], found: list[tuple[NDArray[np.int64], LimitCurve]]
) -> LimitCurve:
    count = len(speeds)
    depth, frequency = np.empty(count), np.empty(count)
    kind, crossings = [""] * count, [np.empty(0)] * count
    steps = np.empty(count, dtype=np.int64)
    for places, curve in found:
        depth[places], frequency[places] = curve.critical_depth, curve.chatter_frequency
        steps[places] = curve.steps
        for i, place in enumerate(places):
            kind[place], crossings[place] = curve.bifurcation[i], curve.crossings[i]
    error = max(curve.error for _, curve in found)
    return LimitCurve(speeds, depth, frequency, tuple(kind), tuple(crossings), steps, error)
