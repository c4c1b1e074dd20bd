"""Results over any path of a case: limit depths over one, the spectral radius over two."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.io.presentation import presentation
from chatter.io.result_files import as_json, finite_or_none, write_results
from chatter.studies.whatif.variation import Variation

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: values left out that are told on the terminal
_MOST_TOLD = 3


@dataclass(frozen=True)
class PathLimits:
    """Limit depths over the values of a path, at the speed of the cut.

    Parameters
    ----------
    case : Case
    method : str
    axis : Variation
        The path, its unit and numbers (n).
    crossings : tuple of n arrays of float
        m, all changes of stability: lost at even places, regained at odd ones.
    chatter_frequency : (n,) array of float
        Hz, at the first limit; nan where none was found.
    bifurcation : tuple of str
        "hopf", "flip" or "none".
    searched_to : (n,) array of float
        m.
    standing : float
        What the case itself has at the path, in the unit of the axis; nan where it has none.
    notes : tuple of str
    reasons : tuple of n str
        Why a value has no limit at all, as where the tool does not reach the work; empty where it
        was looked for.
    """

    case: Case
    method: str
    axis: Variation
    crossings: tuple[NDArray[np.float64], ...]
    chatter_frequency: NDArray[np.float64]
    bifurcation: tuple[str, ...]
    searched_to: NDArray[np.float64]
    standing: float
    notes: tuple[str, ...] = ()
    reasons: tuple[str, ...] = ()

    @property
    def x(self) -> NDArray[np.float64]:
        """Values (n,) of the path, in the unit of the axis."""
        return np.array(self.axis.numbers)

    @property
    def critical_depth(self) -> NDArray[np.float64]:
        """First limit (n,), m; inf where none was found, nan where none could be looked for."""
        first = [found[0] if len(found) else np.inf for found in self.crossings]
        return np.where(np.isnan(self.searched_to), np.nan, first)

    def summary(self) -> dict:
        """Return the content of summary.json."""
        depth = self.critical_depth
        ends = {}
        lowest, highest = np.nanargmin(depth), np.nanargmax(depth)
        for name, place in (("lowest_limit", lowest), ("highest_limit", highest)):
            ends[name] = {
                "value": float(self.x[place]),
                "critical_depth_mm": finite_or_none(float(depth[place]) * 1e3),
                "searched_to_mm": float(self.searched_to[place]) * 1e3,
                "chatter_frequency_Hz": finite_or_none(float(self.chatter_frequency[place])),
            }
        return {
            "title": self.case.title,
            "method": self.method,
            "x": _axis_summary(self.axis, self.standing),
            **ends,
            "values_with_several_stable_intervals": sum(len(c) > 1 for c in self.crossings),
            "left_out": self.left_out,
            "notes": list(self.notes),
        }

    @property
    def left_out(self) -> dict[str, str]:
        """Values that have no limit at all, and why."""
        pairs = zip(self.axis.values, self.reasons, strict=True) if self.reasons else ()
        return {f"{self.axis.path} = {value.label}": why for value, why in pairs if why}

    def told(self) -> list[str]:
        """Sentences for the terminal."""
        lines = _told_of(self.left_out)
        for name in ("lowest_limit", "highest_limit"):
            end = self.summary()[name]
            depth = end["critical_depth_mm"]
            limit = f"> {end['searched_to_mm']:.4g}" if depth is None else f"{depth:.4g}"
            value = f"{end['value']:.4g} {self.axis.unit}".strip()
            lines.append(f"{name.replace('_', ' ')} {limit} mm, at {self.axis.path} = {value}")
        return lines

    def plot(self) -> Figure:
        """Return the limits as a matplotlib figure."""
        return presentation("plots.diagram_over_axes").plot_limits(self)

    def save(self, folder: str | Path) -> list[Path]:
        """Write lobes.csv, lobes.png and summary.json; return what was written."""
        return _save(self, folder, self._table())

    def _table(self) -> str:
        lines = [
            f"{_heading(self.axis)},critical_depth [mm],chatter_frequency [Hz],bifurcation,"
            "all_crossings [mm],searched_to [mm],left_out"
        ]
        rows = zip(
            self.x,
            self.critical_depth,
            self.chatter_frequency,
            self.bifurcation,
            self.crossings,
            self.searched_to,
            strict=True,
        )
        reasons = self.reasons or ("",) * len(self.crossings)
        for (value, depth, frequency, kind, crossings, deepest), why in zip(
            rows, reasons, strict=True
        ):
            if why:
                lines.append(f"{value:.9g},,,none,,,{_quoted(why)}")
                continue
            heard = f"{frequency:.3f}" if math.isfinite(frequency) else ""
            every = " ".join(f"{one * 1e3:.7g}" for one in crossings)
            lines.append(
                f"{value:.9g},{depth * 1e3:.7g},{heard},{kind},{every},{deepest * 1e3:.7g},"
            )
        return "\n".join(lines) + "\n"


@dataclass(frozen=True)
class StabilityMap:
    """Spectral radius over the values of two paths.

    Parameters
    ----------
    case : Case
    method : str
    x_axis, y_axis : Variation
        Paths, units and numbers, n and m of them.
    spectral_radius : (m, n) array of float
        Over one period of the cut; above 1 is chatter.
    standing : (float, float)
        What the case itself has at the paths, in the units of the axes; nan where it has none.
    notes : tuple of str
    left_out : mapping
        Values that describe no cut, and why; their points of the map are nan.
    """

    case: Case
    method: str
    x_axis: Variation
    y_axis: Variation
    spectral_radius: NDArray[np.float64]
    standing: tuple[float, float]
    notes: tuple[str, ...] = ()
    left_out: Mapping[str, str] = field(default_factory=dict)

    @property
    def x(self) -> NDArray[np.float64]:
        """Values (n,) of the path across, in its unit."""
        return np.array(self.x_axis.numbers)

    @property
    def y(self) -> NDArray[np.float64]:
        """Values (m,) of the path upwards, in its unit."""
        return np.array(self.y_axis.numbers)

    @property
    def boundary(self) -> tuple[NDArray[np.float64], ...]:
        """Values of y where the spectral radius passes 1, at each x (n arrays).

        Between points of the map the logarithm of the spectral radius is taken as linear.
        """
        growth = np.log(np.maximum(self.spectral_radius, 1e-300))
        return tuple(_zeros(self.y, column) for column in growth.T)

    def summary(self) -> dict:
        """Return the content of summary.json."""
        return {
            "title": self.case.title,
            "method": self.method,
            "x": _axis_summary(self.x_axis, self.standing[0]),
            "y": _axis_summary(self.y_axis, self.standing[1]),
            "stable_share": self._stable_share,
            "lowest_spectral_radius": float(np.nanmin(self.spectral_radius)),
            "highest_spectral_radius": float(np.nanmax(self.spectral_radius)),
            "boundary": [found.tolist() for found in self.boundary],
            "left_out": dict(self.left_out),
            "notes": list(self.notes),
        }

    def told(self) -> list[str]:
        """Sentences for the terminal."""
        radius = self.spectral_radius
        return [
            *_told_of(self.left_out),
            f"{self._stable_share:.0%} of the map is stable; spectral radius from "
            f"{np.nanmin(radius):.4g} to {np.nanmax(radius):.4g}",
        ]

    @property
    def _stable_share(self) -> float:
        known = self.spectral_radius[np.isfinite(self.spectral_radius)]
        return float((known < 1.0).mean())

    def plot(self) -> Figure:
        """Return the map as a matplotlib figure."""
        return presentation("plots.diagram_over_axes").plot_map(self)

    def save(self, folder: str | Path) -> list[Path]:
        """Write lobes.csv, lobes.png and summary.json; return what was written."""
        return _save(self, folder, self._table())

    def _table(self) -> str:
        lines = [f"{_heading(self.x_axis)},{_heading(self.y_axis)},spectral_radius"]
        for j, y in enumerate(self.y):
            for i, x in enumerate(self.x):
                radius = self.spectral_radius[j, i]
                lines.append(f"{x:.9g},{y:.9g}," + (f"{radius:.9g}" if radius == radius else ""))
        return "\n".join(lines) + "\n"


def _zeros(y: NDArray[np.float64], growth: NDArray[np.float64]) -> NDArray[np.float64]:
    known = np.isfinite(growth[1:]) & np.isfinite(growth[:-1])
    k = np.flatnonzero(known & ((growth[1:] >= 0.0) != (growth[:-1] >= 0.0)))
    return y[k] - growth[k] * (y[k + 1] - y[k]) / (growth[k + 1] - growth[k])


def _told_of(left_out: Mapping[str, str]) -> list[str]:
    """Sentences about values that were left out; not all where they are many."""
    lines = [f"left out, {label}: {why}" for label, why in list(left_out.items())[:_MOST_TOLD]]
    more = len(left_out) - len(lines)
    return [*lines, f"and {more} more values left out"] if more else lines


def _quoted(text: str) -> str:
    """Text as one cell of a table."""
    return '"' + text.replace('"', '""') + '"'


def _heading(axis: Variation) -> str:
    return f"{axis.path} [{axis.unit}]" if axis.unit else axis.path


def _axis_summary(axis: Variation, standing: float) -> dict:
    return {
        "path": axis.path,
        "unit": axis.unit,
        "values": axis.numbers,
        "value_of_the_case": finite_or_none(standing),
    }


def _save(diagram: PathLimits | StabilityMap, folder: str | Path, table: str) -> list[Path]:
    texts = {"lobes.csv": table, "summary.json": as_json(diagram.summary())}
    return write_results(folder, texts, {"lobes.png": diagram.plot()})
