"""Mean spindle power of cutting tests: prediction, and readings that are not to be trusted."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.compile.cutter import force_law, helix_angles
from chatter.description.case import Case
from chatter.explain.stability_margin import CuttingTests, cases_of
from cutting.engagement.immersion import cutting_speed, engagement

Array = NDArray[np.float64]

_WIDTH, _FEED, _TIME = "cut.radial_depth", "cut.feed_per_tooth", "cut.cut_time"
#: points over the engagement of a tooth, and their weights
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)
#: deviation from the trend over the tests beyond which a reading is out of line: in standard
#: deviations of the others, and as a share
_OUT_OF_LINE, _LEAST_DEVIATION = 6.0, 0.15
#: readings before and after one that its trend is taken from
_NEIGHBOURS = 4
#: readings from which a trend can be told
_LEAST_READINGS = 6
#: median of measured over predicted power, beyond which it was read in another unit
_OTHER_UNIT = 100.0


def cutting_power(case: Case, tests: CuttingTests) -> Array:
    """Mean power (n,), W, that the rigid tool takes in each of n tests, without idle power.

    Tangential force over the engagement times the cutting speed (Altintas 2012, Manufacturing
    Automation, section 2.8); vibration does not change the mean chip.
    """
    found = np.empty(tests.speed.size)
    feeds = tests.varied.get(_FEED, np.full(found.size, case.cut.feed_per_tooth))
    wears = case.wear is not None
    at_once = wears and case.material.law == "linear" and _TIME in tests.varied
    timed = (_TIME,) if wears and not at_once else ()
    paths = [path for path in tests.varied if path in (_WIDTH, *timed)]
    for chosen, own in cases_of(case, tests, paths):
        speed = cutting_speed(own.tool.diameter, 1.0) * tests.speed[chosen]
        if at_once:
            force = _worn_line_force(own, feeds[chosen], tests.varied[_TIME][chosen])
        else:
            force = mean_line_force(own, feeds[chosen])
        found[chosen] = force * tests.depth[chosen] * speed
    return found


def _worn_line_force(case: Case, feeds: Array, times: Array) -> Array:
    """The same as `mean_line_force` of a linear law at the cutting time, s, of each feed."""
    fresh = case.model_copy(update={"wear": None})
    whole = mean_line_force(fresh, feeds)
    # the part in proportion to the chip
    removing = mean_line_force(fresh, 2.0 * feeds) - whole
    cutting, rubbing = (
        np.array([case.wear.increase(key, time) for time in times.tolist()])
        for key in ("cutting", "edge_tangential")
    )
    arc = engagement(case.uncut_band, 0.5 * case.tool.diameter)
    engaged = case.tool.teeth * (arc.exit - arc.entry) / (2.0 * math.pi)
    return whole + removing * cutting + rubbing * engaged


def mean_line_force(case: Case, feeds: Array) -> Array:
    """Tangential force (n,) of all teeth per axial depth, mean over a turn, N/m, at n feeds, m."""
    arc = engagement(case.uncut_band, 0.5 * case.tool.diameter)
    angle = arc.entry + 0.5 * (arc.exit - arc.entry) * (_NODES + 1.0)
    chip = np.multiply.outer(feeds, np.maximum(np.sin(angle), 1e-9))
    share = 0.5 * (arc.exit - arc.entry) / (2.0 * math.pi)
    helices, counts = np.unique(helix_angles(case), return_counts=True)
    return sum(
        count * share * (force_law(case, float(helix)).force(chip)[0] @ _WEIGHTS)
        for helix, count in zip(helices, counts, strict=True)
    )


class Readings(NamedTuple):
    """Power readings of tests as they are understood."""

    power: Array  # (n,), W, of the cut alone; NaN where there is no reading
    idle: float  # W, that was taken off
    factor: float  # that the readings were multiplied by, 1 where they are in their unit
    out_of_line: NDArray[np.bool_]  # (n,)


def readings(case: Case, tests: CuttingTests, measured: Array, idle: float | None) -> Readings:
    """Understand the power readings (n,), W, of tests beside what the declared case predicts.

    The idle power, where it is not given, is what the readings have in common beyond a share of
    the predicted power.
    """
    predicted = cutting_power(case, tests)
    factor = _factor(measured, predicted + (idle or 0.0))
    total = measured * factor
    if idle is None:
        idle = _common(total, predicted)
    ratio = (total - idle) / predicted
    return Readings(total - idle, idle, factor, _out_of_line(ratio))


def _factor(measured: Array, predicted: Array) -> float:
    """1000 or 0.001 where the readings are in another unit than their heading says."""
    good = np.isfinite(measured) & (measured > 0.0)
    if not good.any():
        return 1.0
    ratio = float(np.median(measured[good] / predicted[good]))
    if ratio < 1.0 / _OTHER_UNIT:
        return 1e3
    return 1e-3 if ratio > _OTHER_UNIT else 1.0


def _common(total: Array, predicted: Array) -> float:
    """Intercept of the readings over the predicted power, by the median of slopes (Theil 1950)."""
    good = np.isfinite(total)
    x, y = predicted[good], total[good]
    first, second = np.triu_indices(x.size, 1)
    apart = np.abs(x[first] - x[second]) > 1e-9 * np.max(np.abs(x), initial=1e-300)
    if not apart.any():
        return 0.0
    first, second = first[apart], second[apart]
    slope = float(np.median((y[first] - y[second]) / (x[first] - x[second])))
    return max(0.0, float(np.median(y - slope * x)))


def _out_of_line(ratio: Array) -> NDArray[np.bool_]:
    """Readings whose share of the predicted power differs from that of tests before and after.

    Of both sides the nearer one counts: a tool that chips leaves no reading out of line.
    """
    found = np.zeros(ratio.size, dtype=bool)
    usable = np.flatnonzero(np.isfinite(ratio))
    if usable.size < _LEAST_READINGS:
        return found
    values = ratio[usable]
    deviation = np.empty(values.size)
    for k, value in enumerate(values):
        sides = values[max(0, k - _NEIGHBOURS) : k], values[k + 1 : k + 1 + _NEIGHBOURS]
        # a single neighbour may be the one that is out of line
        medians = [np.median(side) for side in sides if side.size > 1]
        deviation[k] = min((value - median for median in medians), key=abs)
    spread = 1.4826 * float(np.median(np.abs(deviation)))
    level = float(np.median(np.abs(values)))
    found[usable] = np.abs(deviation) > max(_OUT_OF_LINE * spread, _LEAST_DEVIATION * level)
    return found
