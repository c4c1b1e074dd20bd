"""All speeds and depths at one radial depth and feed: stability and what limits the cut."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from chatter.description.arrays import Array, BooleanArray
from chatter.description.brief_repr import BriefRepr
from chatter.description.case import Case
from chatter.description.progress import Progress, no_progress
from chatter.stability.methods.collocation.element_cut import element_cut
from chatter.stability.model import MillingModel
from chatter.studies.optimisation.limits import Limits
from chatter.studies.optimisation.stable_depths import StableDepths, is_inside, stable_depths
from chatter.studies.optimisation.steady_cut import SteadyCuts, SteadyModel
from cutting.engagement.immersion import removed_section

_REVOLUTION = 2.0 * math.pi
#: names of what excludes points besides the keys of [optimum]
STABILITY = "stability"
#: the search for limits goes beyond the deepest one by this much, so that its end is no limit
_BEYOND = 1.02
#: step of the depths that only the margins ask for, a share of the deepest, at the least
_STEP_BESIDE = 0.03


@dataclass(frozen=True, eq=False, repr=False)
class SpeedDepthSlice(BriefRepr):
    """Points over depth (m) and speed (n) at one radial depth and feed."""

    model: MillingModel  # at this radial depth and feed
    speeds: Array  # rad/s (n,)
    depths: Array  # m (m,)
    stable: StableDepths
    kept: BooleanArray  # stable with its margins (m, n)
    cuts: SteadyCuts  # nan where the cut is not stable (m, n)
    #: share of each limit of [optimum] that is used; nan where the cut is not stable (m, n)
    usage: dict[str, Array]

    @property
    def case(self) -> Case:
        """Case at this radial depth and feed."""
        return self.model.case

    @property
    def removal_rate(self) -> Array:
        """Volume removed per time (m, n), m^3/s."""
        return removal_rates(self.model, self.speeds, self.depths)

    @property
    def satisfied(self) -> dict[str, BooleanArray]:
        """Where (m, n) each limit is held; stability first."""
        return {STABILITY: self.kept, **{key: self.usage[key] <= 1.0 for key in self.usage}}

    @property
    def feasible(self) -> BooleanArray:
        """Where (m, n) all of them are."""
        return np.logical_and.reduce(list(self.satisfied.values()))

    def feasible_between(self, limits: Limits, depths: Array) -> BooleanArray:
        """Where all limits are held at depths (k,), m, and all speeds of `stable` (p,): (k, p).

        Stability with its margins is known there; the usage of the other limits is interpolated.
        """
        margins = limits.depth_margin, limits.speed_margin
        speeds = self.stable.speeds
        inside = [is_inside(self.stable.within(speed, *margins), depths) for speed in speeds]
        feasible = np.stack(inside, axis=1)
        for usage in self.usage.values():
            feasible &= self._usage_between(usage, depths, speeds) <= 1.0
        return feasible

    def _usage_between(self, usage: Array, depths: Array, speeds: Array) -> Array:
        """Usage of a limit between the points of the grid; the nearest beside a point without."""
        at = np.clip(depths, *self.depths[[0, -1]]), np.clip(speeds, *self.speeds[[0, -1]])
        if min(self.depths.size, self.speeds.size) < 2:
            rows, columns = _nearest(self.depths, depths), _nearest(self.speeds, speeds)
            return usage[np.ix_(rows, columns)]
        points = np.stack(np.meshgrid(*at, indexing="ij"), axis=-1)
        linear, nearest = (
            RegularGridInterpolator((self.depths, self.speeds), usage, method=method)(points)
            for method in ("linear", "nearest")
        )
        return np.where(np.isnan(linear), nearest, linear)


def _nearest(values: Array, wanted: Array) -> Array:
    """Index of the nearest of some ascending values to each wanted one."""
    return np.abs(values[:, None] - wanted[None, :]).argmin(axis=0)


def removal_rates(model: MillingModel, speeds: Array, depths: Array) -> Array:
    """Volume removed per time (m, n), m^3/s, at depths (m,), m, and speeds (n,), rad/s."""
    case, cutter = model.case, model.cutter
    area = removed_section(cutter, case.uncut_band, depths)
    return np.outer(area, speeds) * case.cut.feed_per_tooth * cutter.teeth / _REVOLUTION


def evaluated_slice(
    model: MillingModel,
    limits: Limits,
    speeds: Array,
    depths: Array,
    evaluation_speeds: Array,
    progress: Progress = no_progress,
) -> SpeedDepthSlice:
    """Compute a slice at speeds (n,), rad/s, and depths (m,), m, ascending.

    The model is at its radial depth and feed. Stability is computed at `evaluation_speeds` (p,),
    with those that the margins need, ascending; `progress` is called with (done, total) speeds.
    """
    grid = with_margins(depths, limits.depth_margin)
    stable = stable_depths(
        element_cut(model, float(grid[-1]), wavelengths=limits.wavelengths),
        evaluation_speeds,
        grid,
        progress,
    )
    return slice_with(model, limits, speeds, depths, stable)


def slice_with(
    model: MillingModel,
    limits: Limits,
    speeds: Array,
    depths: Array,
    stable: StableDepths,
    cuts: SteadyCuts | None = None,
) -> SpeedDepthSlice:
    """Slice of known stable depths, and steady cuts where they are known too."""
    kept = _inside_at(stable, speeds, depths, limits.depth_margin, limits.speed_margin)
    # a corner or ball may not reach the work: that is no cut
    kept &= _reached(model, depths)[:, None]
    if cuts is None:
        settled = settled_at(model, speeds, depths, stable)
        cuts = _steady(SteadyModel(model, float(speeds[0])), speeds, depths, settled)
    return SpeedDepthSlice(model, speeds, depths, stable, kept, cuts, limits.usage(cuts))


def settled_at(
    model: MillingModel, speeds: Array, depths: Array, stable: StableDepths
) -> BooleanArray:
    """Where (m, n) there is a cut, and it is stable."""
    settled = _inside_at(stable, speeds, depths, 0.0, 0.0)
    return settled & _reached(model, depths)[:, None]


def _reached(model: MillingModel, depths: Array) -> BooleanArray:
    case = model.case
    return removed_section(model.cutter, case.uncut_band, depths) > 0.0


def with_margins(depths: Array, margin: float) -> Array:
    """Depths, and others a step apart below and above as far as the margin reaches, m."""
    step = max(float(np.diff(depths).max(initial=0.0)), _STEP_BESIDE * float(depths[-1]))
    low, high = depths[0] * (1.0 - margin), _BEYOND * depths[-1] / (1.0 - margin)
    below = np.arange(depths[0] - step, max(low - step, 0.5 * depths[0]), -step)
    above = np.append(np.arange(depths[-1] + step, high, step), high)
    return np.concatenate([below[::-1], depths, above])


def _inside_at(
    stable: StableDepths, speeds: Array, depths: Array, depth_margin: float, speed_margin: float
) -> BooleanArray:
    """Whether each depth (m) is stable at each speed (n), with margins: (m, n)."""
    columns = [
        is_inside(stable.within(speed, depth_margin, speed_margin), depths) for speed in speeds
    ]
    return np.stack(columns, axis=1)


def _steady(model: SteadyModel, speeds: Array, depths: Array, settled: BooleanArray) -> SteadyCuts:
    """Steady cuts (m, n) where the cut is stable; nan elsewhere."""
    columns = {name: np.full(settled.shape, np.nan) for name in SteadyCuts._fields}
    for row, depth in enumerate(depths):
        where = np.flatnonzero(settled[row])
        if where.size == 0:
            continue
        found = model.cuts(speeds[where], float(depth))
        for name, values in zip(SteadyCuts._fields, found, strict=True):
            columns[name][row, where] = values
    return SteadyCuts(**columns)


def slice_record(grid_slice: SpeedDepthSlice) -> dict[str, Any]:
    """Record of the result cache: what takes long to compute."""
    settled = settled_at(grid_slice.model, grid_slice.speeds, grid_slice.depths, grid_slice.stable)
    return {
        "crossings": [found.tolist() for found in grid_slice.stable.crossings],
        "max_depth": grid_slice.stable.max_depth,
        "cuts": [values[settled].tolist() for values in grid_slice.cuts],
    }


def slice_from_record(
    record: dict[str, Any], model: MillingModel, limits: Limits
) -> SpeedDepthSlice:
    """Slice of the coarse grid, of a model at its radial depth and feed, from its record."""
    speeds, depths = limits.speeds, limits.depths
    crossings = [np.array(found, dtype=np.float64) for found in record["crossings"]]
    stable = StableDepths(limits.extended_speeds(), crossings, record["max_depth"])
    settled = settled_at(model, speeds, depths, stable)
    cuts = SteadyCuts(*np.full((len(SteadyCuts._fields), *settled.shape), np.nan))
    for values, known in zip(cuts, record["cuts"], strict=True):
        values[settled] = known
    return slice_with(model, limits, speeds, depths, stable, cuts)
