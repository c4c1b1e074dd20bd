"""How far cutting tests are from the stability limit of a case, and how they chatter."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from threading import Lock
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.compile.cutter import force_law, helix_angles, process_damping_of
from chatter.compile.inclined_axis import refuse_inclined_axis
from chatter.compile.structure import depends_on_speed, structure_of
from chatter.description.case import Case
from chatter.explain.tests_side_by_side import (
    ScaledPoints,
    can_be_scaled,
    is_straight,
    scaled_multipliers,
)
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.methods.collocation.multipliers import multipliers
from chatter.stability.model import MillingModel, milling_model
from chatter.stability.steady_flank import about_steady_motion, follows_steady_motion
from cutting.edge_segments.segments import period_angle

Array = NDArray[np.float64]

#: share of the depth over which the growth rate is evaluated
_STEP = 0.04
#: ratio of depths between which a growth rate is as good as linear in the logarithm of the depth
_RATIO = 1.22
#: Gauss points per element and chatter wavelengths in it: margins to a thousandth near the limit,
#: which scatters by some percent, at half the time of the usual ones
_RESOLUTION = (6, 1.0)
#: margins beyond this count as this
_FAR = 3.0
#: columns of tests that override the case -> path
_COLUMNS = {
    "radial_depth": "cut.radial_depth",
    "feed_per_tooth": "cut.feed_per_tooth",
    "cut_time": "cut.cut_time",
}
_TIME = _COLUMNS["cut_time"]


#: models by tool, engagement and directions of motion, of which a search needs many
_MODELS: dict[Any, MillingModel] = {}
_MOST_MODELS = 64
_LOCK = Lock()


class CuttingTests(NamedTuple):
    """Conditions of n cutting tests."""

    speed: Array  # rad/s
    depth: Array  # axial, m
    #: path of the case -> value of every test, SI
    varied: Mapping[str, Array]

    def at(self, chosen: NDArray[np.bool_]) -> CuttingTests:
        """Some of the tests."""
        varied = {path: values[chosen] for path, values in self.varied.items()}
        return CuttingTests(self.speed[chosen], self.depth[chosen], varied)


class ResponseOfTests(NamedTuple):
    """What a case predicts of n cutting tests."""

    margin: Array  # share of its depth by which a cut is away from the limit; above 0: stable
    angle: Array  # of the dominant multiplier, rad, 0 to pi
    period: Array  # after which the cut repeats itself, s
    rate: Array  # logarithm of the spectral radius over that period

    def chatter_frequency(self, near: Array) -> Array:
        """Frequency (Hz) of the dominant motion that is nearest to one given for each test.

        A motion of a periodic cut holds its frequency and all that differ by multiples of that of
        the cut (Insperger et al. 2003, J. Sound Vib. 262:333).
        """
        own, turn = self.angle / (2.0 * math.pi * self.period), 1.0 / self.period
        above = own + turn * np.round((near - own) / turn)
        below = -own + turn * np.round((near + own) / turn)
        return np.where(np.abs(above - near) < np.abs(below - near), above, below)


def tests_of(case: Case, signals: Mapping[str, Array]) -> CuttingTests:
    """Conditions of the tests of a table; those of the case where a cell is empty."""
    varied = {}
    for column, path in _COLUMNS.items():
        if column in signals and np.isfinite(signals[column]).any():
            declared = case.get(path)
            values = signals[column]
            varied[path] = np.where(np.isfinite(values), values, declared or np.nanmin(values))
    return CuttingTests(signals["spindle_speed"], signals["axial_depth"], varied)


def stability_margins(case: Case, speeds: Array, depths: Array) -> Array:
    """Share of its depth by which a cut is away from the limit; above 0: stable.

    Speeds (n,), rad/s, and depths (n,), m, are point by point.
    """
    return response_of_tests(case, CuttingTests(speeds, depths, {})).margin


def limits_over(case: Case, speeds: Array, depths: Array) -> Array:
    """Least critical depth (s,), m, at speeds (s,), rad/s, on a grid of depths (d,), m, ascending.

    Inf where a case is stable at all of them.
    """
    tests = CuttingTests(np.repeat(speeds, depths.size), np.tile(depths, speeds.size), {})
    margins = response_of_tests(case, tests).margin.reshape(speeds.size, depths.size)
    return first_limits(margins, depths)


def first_limits(margins: Array, depths: Array) -> Array:
    """Depth (...) at which margins (..., d) over depths (d,), m, ascending, first reach zero.

    Margins are shares of the depth: of the depths on both sides the one with the smaller margin
    tells the limit.
    """
    unstable = margins <= 0.0
    first = unstable.argmax(axis=-1)
    before = np.maximum(first - 1, 0)
    above, below = (
        np.take_along_axis(margins, index[..., None], axis=-1)[..., 0] for index in (first, before)
    )
    nearer_below = (first > 0) & (below < -above)
    limit = np.where(nearer_below, depths[before] * (1.0 + below), depths[first] * (1.0 + above))
    limit = np.clip(limit, np.where(first > 0, depths[before], 0.0), depths[first])
    return np.where(unstable.any(axis=-1), limit, np.inf)


def margins_over(case: Case, speeds: Array, depths: Array) -> Array:
    """Margins (s, d) of a case over speeds (s,), rad/s, and depths (d,), m, ascending.

    Each is the share of its depth by which a cut is away from the nearest limit at its speed, found
    between depths that are as many as the growth rate needs.
    """
    count = 1 + max(2, math.ceil(math.log(depths[-1] / depths[0]) / math.log(_RATIO)))
    at = np.geomspace(depths[0], depths[-1], count)
    rates = growth_rate_at(case, np.repeat(speeds, count), np.tile(at, speeds.size))
    return margins_between(rates.reshape(speeds.size, count), at, depths)


def margins_between(rates: Array, at: Array, depths: Array) -> Array:
    """Margins (s, d) at depths (d,), m, from growth rates (s, k) at some depths (k,), ascending."""
    logs, wanted = np.log(at), np.log(depths)
    rate = np.stack([np.interp(wanted, logs, row) for row in rates])
    steps = np.diff(rates, axis=1) / np.diff(logs)
    crosses = (rates[:, :-1] < 0.0) != (rates[:, 1:] < 0.0)
    limits = np.where(crosses, logs[:-1] - rates[:, :-1] / np.where(crosses, steps, 1.0), np.inf)
    nearest = np.abs(limits[:, None, :] - wanted[:, None]).argmin(axis=2)
    distance = np.take_along_axis(limits, nearest, axis=1) - wanted
    # where no limit lies between the depths, it is as far as the rate at the end tells
    own = np.minimum(np.searchsorted(logs, wanted, side="right"), logs.size - 1) - 1
    slope = np.maximum(steps[:, np.maximum(own, 0)], 0.3 * np.abs(rate) + 1e-3)
    outside = np.clip(-rate / slope, -_FAR, _FAR)
    inside = np.abs(np.expm1(np.where(np.isfinite(distance), distance, 0.0)))
    margin = np.where(np.isfinite(distance), np.where(rate < 0.0, inside, -inside), outside)
    return np.clip(margin, -_FAR, _FAR)


def growth_rate_at(case: Case, speeds: Array, depths: Array) -> Array:
    """Logarithm (n,) of the spectral radius over a period of the tool; below 0: stable.

    Speeds (n,), rad/s, and depths (n,), m, are point by point.
    """
    found, _ = _multipliers(case, CuttingTests(speeds, depths, {}), (1.0,))
    return np.log(np.maximum(np.abs(found[0]), 1e-12))


def response_of_tests(case: Case, tests: CuttingTests) -> ResponseOfTests:
    """Margins and multipliers of cutting tests.

    A margin follows from the logarithm of the spectral radius at the depth and a little above, as
    if it were linear in the logarithm of the depth.
    """
    both = np.empty((2, tests.speed.size), dtype=np.complex128)
    period = np.empty(tests.speed.size)
    paths = [path for path in tests.varied if path != _TIME and _acts(case, path)]
    for chosen, own in cases_of(case, tests, paths):
        both[:, chosen], period[chosen] = _multipliers(own, tests.at(chosen), (1.0, 1.0 + _STEP))
    at, above = np.log(np.maximum(np.abs(both), 1e-12))
    rate, slope = at, (above - at) / np.log1p(_STEP)
    # where rate does not rise with depth, its size tells no more than the side
    rising = np.maximum(slope, 0.3 * np.abs(rate) + 1e-3)
    margin = np.clip(-rate / rising, -_FAR, _FAR)
    return ResponseOfTests(margin, np.abs(np.angle(both[0])), period, rate)


def _multipliers(case: Case, tests: CuttingTests, shares: Sequence[float]) -> tuple[Array, Array]:
    """Multipliers (d, n) of tests in one engagement, at d shares of their depths; their periods.

    Periods (n,) are those after which the cut repeats itself, s.
    """
    fresh = _model_of(case.model_copy(update={"wear": None}))
    differ = case.wear is not None or depends_on_speed(case)
    if not (differ or is_straight(fresh)) or not can_be_scaled(fresh, float(tests.speed.min())):
        return _multipliers_one_by_one(case, tests, shares)
    columns = (tests.speed, tests.depth, *_growth_by_wear(case, tests))
    points = ScaledPoints(*(np.tile(values, len(shares)) for values in columns))
    points = points._replace(depth=np.repeat(shares, tests.speed.size) * points.depth)
    models = [(np.ones(points.speed.size, dtype=bool), fresh)]
    if depends_on_speed(case):
        models = [
            (points.speed == speed, fresh.at_speed(float(speed)))
            for speed in np.unique(tests.speed)
        ]
    found = scaled_multipliers(models, points, _RESOLUTION)
    return found.reshape(len(shares), -1), period_angle(fresh.cutter) / tests.speed


def _growth_by_wear(case: Case, tests: CuttingTests) -> tuple[Array, Array]:
    """Factors (n,) of the cutting coefficients and of process damping by the time of each test."""
    if case.wear is None:
        return np.ones(tests.speed.size), np.ones(tests.speed.size)
    times = tests.varied.get(_TIME, np.full(tests.speed.size, case.cut.cut_time))
    cutting, damping = (
        np.array([1.0 + case.wear.increase(key, time) for time in times.tolist()])
        for key in ("cutting", "process_damping")
    )
    return cutting, damping


def _multipliers_one_by_one(
    case: Case, tests: CuttingTests, shares: Sequence[float]
) -> tuple[Array, Array]:
    """The same of tests that share nothing but their engagement."""
    found = np.empty((len(shares), tests.speed.size), dtype=np.complex128)
    period = np.empty(tests.speed.size)
    for chosen, model in _models(case, tests):
        speeds, depths = tests.speed[chosen], np.outer(shares, tests.depth[chosen])
        cut = element_cut(model, float(depths.max()), *_RESOLUTION)
        own = multipliers(cut, np.tile(speeds, len(shares)), depths.ravel())
        found[:, chosen] = own.reshape(depths.shape)
        period[chosen] = cut.arrays.period_angle / speeds
    return found, period


def _models(case: Case, tests: CuttingTests) -> Iterator[tuple[NDArray[np.bool_], MillingModel]]:
    """Tests that share a model, and the model; of one engagement."""
    times = [path for path in tests.varied if path == _TIME and case.wear is not None]
    for chosen, own in cases_of(case, tests, times):
        yield from _models_at(own, tests, chosen)


def cases_of(
    case: Case, tests: CuttingTests, paths: Sequence[str]
) -> Iterator[tuple[NDArray[np.bool_], Case]]:
    """Tests that are alike in some paths of the case, and the case with their values."""
    if not paths:
        yield np.ones(tests.speed.size, dtype=bool), case
        return
    columns = np.column_stack([tests.varied[path] for path in paths])
    keys = [path.partition(".")[2] for path in paths]
    for row in np.unique(columns, axis=0):
        # numbers of [cut] that the table of tests was checked for
        cut = case.cut.model_copy(update=dict(zip(keys, row.tolist(), strict=True)))
        yield np.all(columns == row, axis=1), case.model_copy(update={"cut": cut})


def _acts(case: Case, path: str) -> bool:
    """Whether the limit depends on what a column of the tests changes."""
    if path == "cut.feed_per_tooth":
        # of a linear law the slope does not know the feed
        return case.material.law != "linear" or _ploughs(case)
    return True


def _ploughs(case: Case) -> bool:
    return case.process_damping is not None and case.process_damping.coefficient is None


def _model_of(case: Case) -> MillingModel:
    """Model of a case; checks and averages are those of a case with the same tool and modes."""
    refuse_inclined_axis(case)
    directions = tuple(mode.direction for mode in case.structure.mode)
    if not directions or _ploughs(case):
        return milling_model(case)
    key = (case.tool, case.uncut_band, directions)
    with _LOCK:
        like = _MODELS.get(key)
    if like is None:
        like = milling_model(case)
        with _LOCK:
            while len(_MODELS) >= _MOST_MODELS:
                del _MODELS[next(iter(_MODELS))]
            _MODELS[key] = like
    return replace(
        like,
        case=case,
        structure=structure_of(case),
        laws=tuple(force_law(case, helix) for helix in helix_angles(case)),
        flank=process_damping_of(case),
    )


def _models_at(
    case: Case, tests: CuttingTests, chosen: NDArray[np.bool_]
) -> Iterator[tuple[NDArray[np.bool_], MillingModel]]:
    model = _model_of(case)
    if not depends_on_speed(case) and not follows_steady_motion(model):
        yield chosen, model
        return
    for speed in np.unique(tests.speed[chosen]):
        own = model.at_speed(float(speed)) if depends_on_speed(case) else model
        at_speed = chosen & (tests.speed == speed)
        if not follows_steady_motion(model):
            yield at_speed, own
            continue
        for depth in np.unique(tests.depth[at_speed]):
            here = at_speed & (tests.depth == depth)
            yield here, about_steady_motion(own, float(speed), float(depth))
