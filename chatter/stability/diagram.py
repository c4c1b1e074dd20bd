"""Stability diagrams: the critical depth over an axis, and the spectral radius over two.

The spindle speed is one axis: `chatter.stability.lobes` draws over it, `chatter.studies` over any
path of a case.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from chatter.description.arrays import Array
from chatter.description.case import Case
from chatter.description.unit_system import UnitSystem, units_of
from chatter.description.units import rpm
from chatter.description.usual_units import UsualUnit
from chatter.description.whole_files import write_whole
from chatter.io.result_files import SavedResult, finite_or_none
from chatter.io.result_tables import Column, Columns
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.lowest_limit import LowestLimit
from chatter.stability.methods.zeroth_order.uniform_pitch import ZeroOrderLimit
from chatter.stability.neglected_effects import (
    EDGE_FORCES,
    NeglectedEffect,
    deciding,
    lowest_factor,
    reasons_of,
)
from chatter.stability.pockets import SPEED_MARGIN, Pocket, depth_margin
from chatter.stability.search_range import beyond_the_cut, known_to

#: values excluded that are reported on the terminal
_MOST_REPORTED = 3
#: pockets that a notebook names
_POCKETS_TOLD = 3


@dataclass(frozen=True)
class DiagramAxis:
    """A value of a case along an axis of a diagram.

    Parameters
    ----------
    name : str
        Path in the case, as in headings.
    unit : str
    values : (n,) array of float
        In the unit.
    labels : tuple of n str
        The values as people read them.
    case_value : float
        What the case itself has, in the unit; nan where it has none.
    """

    name: str
    unit: str
    values: Array
    labels: tuple[str, ...] = ()
    case_value: float = math.nan

    @property
    def heading(self) -> str:
        """Name with the unit."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    def summary(self) -> dict:
        """Return the axis as JSON knows it."""
        return {
            "path": self.name,
            "unit": self.unit,
            "values": self.values.tolist(),
            "value_of_the_case": finite_or_none(self.case_value),
        }


@dataclass(frozen=True, repr=False)
class StabilityMap(SavedResult):
    """Spectral radius over two axes.

    Parameters
    ----------
    case : Case
    method : str
    x_axis, y_axis : DiagramAxis
        Of n and m values.
    spectral_radius : (m, n) array of float
        Over one period of the cut: the tooth period of a uniform pitch, else a revolution or what
        part of it repeats, or that of the speed variation; above 1 is chatter.
    notes : tuple of str
    excluded : mapping
        Values that describe no cut, and why; their points of the map are nan.
    """

    drawn_by: ClassVar[str] = "plots.stability_diagram.plot_map"
    picture: ClassVar[str] = "lobes.png"

    case: Case
    method: str
    x_axis: DiagramAxis
    y_axis: DiagramAxis
    spectral_radius: Array
    notes: tuple[str, ...] = ()
    excluded: Mapping[str, str] = field(default_factory=dict)

    @property
    def boundary(self) -> tuple[Array, ...]:
        """Values of y where the spectral radius passes 1, at each x (n arrays).

        Between points of the map the logarithm of the spectral radius is taken as linear.
        """
        growth_rate = np.log(np.maximum(self.spectral_radius, 1e-300))
        return tuple(_zeros(self.y_axis.values, column) for column in growth_rate.T)

    def summary(self) -> dict:
        """Return the content of summary.json."""
        return {
            "title": self.case.title,
            "method": self.method,
            "x": self.x_axis.summary(),
            "y": self.y_axis.summary(),
            "stable_share": self._stable_share,
            "lowest_spectral_radius": float(np.nanmin(self.spectral_radius)),
            "highest_spectral_radius": float(np.nanmax(self.spectral_radius)),
            "boundary": [found.tolist() for found in self.boundary],
            "excluded": dict(self.excluded),
            "notes": list(self.notes),
        }

    def sentences(self) -> list[str]:
        """Return sentences for the terminal."""
        radius = self.spectral_radius
        return [
            *_report_of(self.excluded),
            f"{self._stable_share:.0%} of the map is stable; spectral radius from "
            f"{np.nanmin(radius):.4g} to {np.nanmax(radius):.4g}",
        ]

    @property
    def _stable_share(self) -> float:
        known = self.spectral_radius[np.isfinite(self.spectral_radius)]
        return float((known < 1.0).mean())

    def tables(self) -> dict[str, Columns]:
        """Columns of the table "lobes", a row a point of the map."""
        y, x = np.meshgrid(self.y_axis.values, self.x_axis.values, indexing="ij")
        return {
            "lobes": {
                self.x_axis.heading: Column(x.ravel(), ".9g"),
                self.y_axis.heading: Column(y.ravel(), ".9g"),
                "spectral_radius": Column(self.spectral_radius.ravel(), ".9g"),
            }
        }

    def save_grid(self, path: Path) -> Path:
        """Write grid.npz of a map over spindle speed [rpm] and axial depth [mm]."""
        arrays = {
            "spindle_speed": self.x_axis.values,
            "axial_depth": self.y_axis.values,
            "spectral_radius": self.spectral_radius,
        }
        return write_whole(path, lambda file: np.savez_compressed(file, **arrays))


@dataclass(frozen=True, repr=False)
class StabilityDiagram(SavedResult):
    """Critical depth over an axis.

    Parameters
    ----------
    case : Case
    method : str
        Name in `chatter.stability.registry.METHODS`.
    axis : DiagramAxis
        Of n values.
    limits : LimitCurve
        Limits at each value; a critical depth is nan where there is none at all.
    max_depth : (n,) array of float
        Maximum axial depth searched, m.
    notes : tuple of str
        Assumptions and limits of the result.
    reasons : tuple of n str
        Why a value has no limit at all, as where the tool does not reach the work; empty where it
        was searched.
    zero_order : ZeroOrderLimit, optional
        Over spindle speed: the zeroth-order approximation, for comparison.
    pockets : tuple of Pocket
        Over spindle speed: cuts worth using, highest removal rate first.
    operating : LimitCurve, optional
        Over spindle speed: limits at the speed of the case alone.
    lowest : LowestLimit, optional
        Over spindle speed: the lowest limit, between the samples as well.
    at_lowest : LimitCurve, optional
        Over spindle speed: limits at the speed of the lowest one, where that is between the speeds.
    natural_frequencies : (k, n) array of float
        Over spindle speed: of the k modes, Hz.
    depth_step : float
        Of the grid on which limits were searched, m.
    grid : StabilityMap or None
        Spectral radius over spindle speed and depth.
    neglected : tuple of NeglectedEffect
        Over spindle speed: what the linear limits leave out at the operating point.
    resting_friction : float
        Over spindle speed: factor of the lowest limit that frictions at rest leave of it at least.
    """

    drawn_by: ClassVar[str] = "plots.stability_diagram.plot_limits"
    picture: ClassVar[str] = "lobes.png"

    case: Case
    method: str
    axis: DiagramAxis
    limits: LimitCurve
    max_depth: Array
    notes: tuple[str, ...] = ()
    reasons: tuple[str, ...] = ()
    zero_order: ZeroOrderLimit | None = None
    pockets: tuple[Pocket, ...] = ()
    operating: LimitCurve | None = None
    lowest: LowestLimit | None = None
    at_lowest: LimitCurve | None = None
    natural_frequencies: Array = field(default_factory=lambda: np.empty((0, 0)))
    depth_step: float = math.nan
    grid: StabilityMap | None = None
    neglected: tuple[NeglectedEffect, ...] = ()
    resting_friction: float = 1.0

    @property
    def units(self) -> UnitSystem:
        """Units that the words, the tables and the picture are in: those of the case."""
        return units_of(self.case)

    @property
    def neglected_at_all_speeds(self) -> tuple[NeglectedEffect, ...]:
        """What the linear limits leave out at every speed alike, with a known bound."""
        return tuple(one for one in self.neglected if one.name == EDGE_FORCES)

    @property
    def depth_margin(self) -> float:
        """Part of a limit that pockets keep in hand: the usual, or what edge forces may take."""
        return depth_margin(self.neglected_at_all_speeds)

    @property
    def why_no_pocket(self) -> str:
        """Why the linear limits name no pocket at all; empty where they could."""
        if lowest_factor(self.neglected_at_all_speeds) > 0.0:
            return ""
        reasons = "; ".join(one.because for one in self.neglected_at_all_speeds)
        return f"{reasons}, and no linear limit bounds the true one"

    @property
    def lowest_depth(self) -> float:
        """Depth, m, below which any speed is stable: what edge forces and friction leave of it."""
        factor = self.resting_friction * lowest_factor(self.neglected_at_all_speeds)
        if math.isfinite(self.lowest.critical_depth):
            return self.lowest.critical_depth * factor
        # of a limit that was not found no more is known
        deepest = float(self.max_depth[0])
        low = known_to(deepest, self.zero_order) * factor
        return low if low < deepest else self.lowest.critical_depth

    @property
    def deciding(self) -> tuple[NeglectedEffect, ...]:
        """What is left out and could turn the linear verdict on the operating point."""
        depth, crossings = self.case.cut.axial_depth, self.operating.crossings[0]
        stable = self.operating_is_stable
        known = known_to(self._searched, self.zero_order)
        return deciding(self.neglected, depth, crossings, known, stable=stable)

    @property
    def why_not_certain(self) -> str:
        """What could turn the linear verdict on the operating point; empty where it stands."""
        reasons = reasons_of(self.deciding, stable=self.operating_is_stable)
        if self.deciding and not math.isfinite(self.operating.critical_depth[0]):
            reasons.append(f"no limit was found up to {self.units.length.text(self._searched)}")
        return "; ".join(reasons)

    @property
    def _searched(self) -> float:
        """Depth, m, to which limits at the operating speed were searched."""
        return beyond_the_cut(self.case, float(self.max_depth[0]))

    @property
    def is_over_speed(self) -> bool:
        """True where the axis is the spindle speed of a lobe diagram."""
        return self.zero_order is not None

    @property
    def excluded(self) -> dict[str, str]:
        """Values that have no limit at all, and why."""
        pairs = zip(self.axis.labels, self.reasons, strict=True) if self.reasons else ()
        return {f"{self.axis.name} = {label}": why for label, why in pairs if why}

    @property
    def operating_is_stable(self) -> bool:
        """True where the operating depth lies in a stable interval at the speed of the case."""
        below = self.operating.crossings[0] < self.case.cut.axial_depth
        return int(below.sum()) % 2 == 0

    def summary(self) -> dict:
        """Return the content of summary.json."""
        depth = self.limits.critical_depth
        ends = {
            "lowest_limit": self._end(int(np.nanargmin(depth))),
            "highest_limit": self._end(int(np.nanargmax(depth))),
        }
        head = {"title": self.case.title, "method": self.method}
        if self.is_over_speed:
            return {**head, **self._summary_over_speed(), "notes": list(self.notes)}
        return {
            **head,
            "x": self.axis.summary(),
            **ends,
            "values_with_several_stable_intervals": sum(len(c) > 1 for c in self.limits.crossings),
            "excluded": self.excluded,
            "notes": list(self.notes),
        }

    def _summary_over_speed(self) -> dict:
        """Part of summary.json of a diagram over spindle speed."""
        cut, limits = self.case.cut, self.limits
        depth = limits.critical_depth
        lowest, speeds = self.lowest, self.axis.values
        return {
            "spindle_speeds_rpm": [float(speeds[0]), float(speeds[-1])],
            "max_axial_depth_mm": float(self.max_depth[0]) * 1e3,
            "lowest_limit": {
                "critical_depth_mm": finite_or_none(lowest.critical_depth * 1e3),
                "stable_below_mm": finite_or_none(self.lowest_depth * 1e3),
                "spindle_speed_rpm": finite_or_none(rpm(lowest.spindle_speed)),
                "chatter_frequency_Hz": finite_or_none(lowest.chatter_frequency),
            },
            "operating_point": {
                "spindle_speed_rpm": rpm(cut.spindle_speed),
                "axial_depth_mm": cut.axial_depth * 1e3,
                "critical_depth_mm": finite_or_none(float(self.operating.critical_depth[0]) * 1e3),
                "stable": self.operating_is_stable,
                "certain": not self.deciding,
            },
            "neglected_effects": [effect.summary() for effect in self.neglected],
            "pockets": [_pocket_summary(pocket) for pocket in self.pockets],
            "margin": {"depth": self.depth_margin, "spindle_speed": SPEED_MARGIN},
            "zero_order": {
                "lowest_limit_mm": finite_or_none(self.zero_order.lowest_depth * 1e3),
                "chatter_frequency_Hz": self.zero_order.lowest_frequency,
                **_comparison(depth, self.zero_order.critical_depth),
            },
            "resolution": {
                "steps_per_tooth_period": [int(limits.steps.min()), int(limits.steps.max())],
                "estimated_error": finite_or_none(limits.error),
                "depth_step_mm": self.depth_step * 1e3,
            },
        }

    def _end(self, index: int) -> dict:
        return {
            "value": float(self.axis.values[index]),
            "critical_depth_mm": finite_or_none(float(self.limits.critical_depth[index]) * 1e3),
            "max_axial_depth_mm": float(self.max_depth[index]) * 1e3,
            "chatter_frequency_Hz": finite_or_none(float(self.limits.chatter_frequency[index])),
        }

    def sentences(self) -> list[str]:
        """Return sentences for the terminal."""
        lines, summary = _report_of(self.excluded), self.summary()
        if self.is_over_speed:
            return [*lines, *_sentences_over_speed(summary, self.units)]
        length = self.units.instead_of("mm")
        for name in ("lowest_limit", "highest_limit"):
            end = summary[name]
            depth = end["critical_depth_mm"]
            limit = _shown_limit(depth, end["max_axial_depth_mm"], length)
            value = f"{end['value']:.4g} {self.axis.unit}".strip()
            lines.append(f"{name.replace('_', ' ')} {limit}, at {self.axis.name} = {value}")
        return lines

    def save(self, folder: str | Path, tables: str = "csv") -> list[Path]:
        """Write lobes.csv, lobes.png, summary.json and, with a grid, grid.npz.

        Parameters and errors are those of `SavedResult.save`.

        Returns
        -------
        list of Path
            What was written.
        """
        written = super().save(folder, tables)
        if self.grid is not None:
            written.append(self.grid.save_grid(Path(folder) / "grid.npz"))
        return written

    def tables(self) -> dict[str, Columns]:
        """Columns of the table "lobes", a row a value of the axis."""
        limits = self.limits
        columns = {
            self.axis.heading: Column(self.axis.values, ".4f" if self.is_over_speed else ".9g"),
            "critical_depth [mm]": Column(limits.critical_depth * 1e3, ".7g", infinite="inf"),
            "chatter_frequency [Hz]": Column(limits.chatter_frequency, ".3f"),
            "bifurcation": Column(limits.bifurcation),
        }
        if self.is_over_speed:
            return {"lobes": columns}
        crossings = [" ".join(f"{1e3 * one:.7g}" for one in found) for found in limits.crossings]
        return {
            "lobes": {
                **columns,
                "all_crossings [mm]": Column(crossings),
                "max_axial_depth [mm]": Column(self.max_depth * 1e3, ".7g"),
                "excluded": Column(self.reasons or [""] * len(crossings)),
            }
        }


def _shown_limit(depth: float | None, searched: float, length: UsualUnit) -> str:
    """Limit, mm, in a unit of length; how far was searched where there is none."""
    return f"> {length.text(searched)}" if depth is None else length.text(depth)


def _sentences_over_speed(summary: Mapping[str, Any], units: UnitSystem) -> list[str]:
    """Lowest limit, verdict on the cut, and the pockets that remove most."""
    lowest, cut = summary["lowest_limit"], summary["operating_point"]
    length, removal_rate = units.instead_of("mm"), units.instead_of("cm^3/min")
    if lowest["critical_depth_mm"] is None:
        found = f"no limit down to {length.text(summary['max_axial_depth_mm'])}"
    else:
        found = (
            f"lowest limit {length.text(lowest['critical_depth_mm'])}, at "
            f"{lowest['spindle_speed_rpm']:.0f} rpm, chatter at "
            f"{lowest['chatter_frequency_Hz']:.0f} Hz"
        )
    verdict = "stable" if cut["stable"] else "chatter"
    sure = "" if cut["certain"] else " by the linear analysis, not certain"
    judged = (
        f"{verdict}{sure}: {length.text(cut['axial_depth_mm'])} at "
        f"{cut['spindle_speed_rpm']:.0f} rpm"
    )
    best = sorted(summary["pockets"], key=lambda one: -one["removal_rate_cm3_per_min"])
    return [judged, found] + [
        f"pocket: {length.text(one['axial_depth_mm'])} at {one['spindle_speed_rpm']:.0f} rpm, "
        f"{removal_rate.text(one['removal_rate_cm3_per_min'], '.3g')}"
        for one in best[:_POCKETS_TOLD]
    ]


def _pocket_summary(pocket: Pocket) -> dict:
    return {
        "spindle_speed_rpm": rpm(pocket.spindle_speed),
        "axial_depth_mm": pocket.axial_depth * 1e3,
        "critical_depth_mm": finite_or_none(pocket.critical_depth * 1e3),
        "removal_rate_cm3_per_min": pocket.removal_rate * 1e6 * 60.0,
    }


def _comparison(limits: Array, other: Array) -> dict:
    """How far the zeroth-order limits lie from those of the main method."""
    both = np.isfinite(limits) & np.isfinite(other) & (limits > 0.0)
    if not both.any():
        return {"median_ratio": None, "lowest_ratio": None, "highest_ratio": None}
    ratio = other[both] / limits[both]
    return {
        "median_ratio": float(np.median(ratio)),
        "lowest_ratio": float(ratio.min()),
        "highest_ratio": float(ratio.max()),
    }


def _zeros(y: Array, growth_rate: Array) -> Array:
    low, high = growth_rate[:-1], growth_rate[1:]
    k = np.flatnonzero(np.isfinite(low) & np.isfinite(high) & ((low >= 0.0) != (high >= 0.0)))
    return y[k] - low[k] * (y[k + 1] - y[k]) / (high[k] - low[k])


def _report_of(excluded: Mapping[str, str]) -> list[str]:
    """Sentences about values that were excluded; not all where they are many."""
    lines = [f"excluded, {label}: {why}" for label, why in list(excluded.items())[:_MOST_REPORTED]]
    more = len(excluded) - len(lines)
    return [*lines, f"and {more} more values excluded"] if more else lines
