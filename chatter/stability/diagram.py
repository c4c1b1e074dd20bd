"""Stability lobe diagram of a case: limits over spindle speed by two independent methods."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.description.progress import Progress, no_progress
from chatter.description.units import rpm
from chatter.engine.parallel import Executor
from chatter.io.presentation import presentation
from chatter.io.result_files import as_json, finite_or_none, write_results
from chatter.stability.forced_vibration import notes_on_steady_cut
from chatter.stability.grid_blocks import radius_in_blocks
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.methods.collocation.converged_limits import LIMIT_ERROR
from chatter.stability.methods.zeroth_order.method import ZeroOrderLimit
from chatter.stability.model import MillingModel, milling_model
from chatter.stability.pockets import DEPTH_MARGIN, SPEED_MARGIN, Pocket, find_pockets
from chatter.stability.reference_speeds import natural_frequencies
from chatter.stability.registry import (
    GRIDS,
    LimitMethod,
    chosen_method,
    radius_by_collocation,
    resolution,
    zero_order_of,
)
from chatter.stability.search_range import axial_depths, deepest_depth, spindle_speeds

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class StabilityGrid:
    """Spectral radius on a grid of speeds and depths.

    Parameters
    ----------
    spindle_speed : (n,) array of float
        rad/s.
    axial_depth : (m,) array of float
        m.
    spectral_radius : (m, n) array of float
        Over one period of the cut: from tooth to tooth where they are alike, else a turn or what
        part of it repeats, or that of the speed variation; above 1 is chatter.
    """

    spindle_speed: NDArray[np.float64]
    axial_depth: NDArray[np.float64]
    spectral_radius: NDArray[np.float64]

    def save(self, path: Path) -> None:
        """Write grid.npz: spindle_speed [rpm], axial_depth [mm], spectral_radius."""
        np.savez_compressed(
            path,
            spindle_speed=rpm(self.spindle_speed),
            axial_depth=self.axial_depth * 1e3,
            spectral_radius=self.spectral_radius,
        )


@dataclass(frozen=True)
class LobeDiagram:
    """Stability limits of a case over spindle speed.

    Parameters
    ----------
    case : Case
    method : str
        Key of `chatter.stability.registry.METHODS` that gave the limits.
    limits : LimitCurve
        Limit depth (m), chatter frequency (Hz), bifurcation at every speed (rad/s).
    zero_order : ZeroOrderLimit
        The zeroth-order solution, for comparison.
    deepest : float
        Depth to which limits were looked for, m.
    pockets : tuple of Pocket
        Places worth using, highest removal rate first.
    operating : LimitCurve
        Limits at the speed of the case alone.
    natural_frequencies : (k, n) array of float
        Of the k modes at every speed, Hz.
    grid : StabilityGrid or None
    notes : tuple of str
        Assumptions and limits of the result.
    """

    case: Case
    method: str
    limits: LimitCurve
    zero_order: ZeroOrderLimit
    deepest: float
    pockets: tuple[Pocket, ...]
    operating: LimitCurve
    natural_frequencies: NDArray[np.float64]
    grid: StabilityGrid | None = None
    notes: tuple[str, ...] = ()

    @property
    def operating_is_stable(self) -> bool:
        """True where the operating depth lies in a stable stretch at its speed."""
        below = self.operating.crossings[0] < self.case.cut.axial_depth
        return int(below.sum()) % 2 == 0

    def summary(self) -> dict:
        """Return the content of summary.json."""
        cut = self.case.cut
        depth = self.limits.critical_depth
        lowest = int(np.argmin(depth))
        found = bool(np.isfinite(depth[lowest]))
        return {
            "title": self.case.title,
            "method": self.method,
            "spindle_speeds_rpm": [
                float(rpm(self.limits.spindle_speed[0])),
                float(rpm(self.limits.spindle_speed[-1])),
            ],
            "searched_to_mm": self.deepest * 1e3,
            "lowest_limit": {
                "critical_depth_mm": depth[lowest] * 1e3 if found else None,
                "spindle_speed_rpm": rpm(self.limits.spindle_speed[lowest]) if found else None,
                "chatter_frequency_Hz": self.limits.chatter_frequency[lowest] if found else None,
            },
            "operating_point": {
                "spindle_speed_rpm": rpm(cut.spindle_speed),
                "axial_depth_mm": cut.axial_depth * 1e3,
                "critical_depth_mm": finite_or_none(float(self.operating.critical_depth[0]) * 1e3),
                "stable": self.operating_is_stable,
            },
            "pockets": [_pocket_summary(pocket) for pocket in self.pockets],
            "margin": {"depth": DEPTH_MARGIN, "spindle_speed": SPEED_MARGIN},
            "zero_order": {
                "lowest_limit_mm": finite_or_none(self.zero_order.lowest_depth * 1e3),
                "chatter_frequency_Hz": self.zero_order.lowest_frequency,
                **_comparison(self.limits.critical_depth, self.zero_order.critical_depth),
            },
            "resolution": {
                "steps_per_tooth_period": [
                    int(self.limits.steps.min()),
                    int(self.limits.steps.max()),
                ],
                "estimated_error": finite_or_none(self.limits.error),
                "depth_step_mm": self.deepest * 1e3 / len(axial_depths(self.case, self.deepest)),
            },
            "notes": list(self.notes),
        }

    def plot(self) -> Figure:
        """Return the diagram as a matplotlib figure."""
        return presentation("plots.lobes").plot_lobes(self)

    def save(self, folder: str | Path) -> list[Path]:
        """Write lobes.csv, lobes.png, summary.json and, with a grid, grid.npz.

        Returns
        -------
        list of Path
            What was written.
        """
        written = write_results(
            folder,
            {"lobes.csv": self._table(), "summary.json": as_json(self.summary())},
            {"lobes.png": self.plot()},
        )
        if self.grid is not None:
            written.append(Path(folder) / "grid.npz")
            self.grid.save(written[-1])
        return written

    def _table(self) -> str:
        lines = ["spindle_speed [rpm],critical_depth [mm],chatter_frequency [Hz],bifurcation"]
        rows = zip(
            rpm(self.limits.spindle_speed),
            self.limits.critical_depth * 1e3,
            self.limits.chatter_frequency,
            self.limits.bifurcation,
            strict=True,
        )
        for speed, depth, frequency, kind in rows:
            heard = f"{frequency:.3f}" if np.isfinite(frequency) else ""
            lines.append(f"{speed:.4f},{depth:.7g},{heard},{kind}")
        return "\n".join(lines) + "\n"


def _pocket_summary(pocket: Pocket) -> dict:
    return {
        "spindle_speed_rpm": rpm(pocket.spindle_speed),
        "axial_depth_mm": pocket.axial_depth * 1e3,
        "limit_depth_mm": finite_or_none(pocket.limit_depth * 1e3),
        "removal_rate_cm3_per_min": pocket.removal_rate * 1e6 * 60.0,
    }


def _comparison(limits: NDArray[np.float64], other: NDArray[np.float64]) -> dict:
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


def lobes(
    case: Case,
    method: str | None = None,
    grid: bool = False,
    progress: Progress = no_progress,
    cluster: str | Executor | None = None,
    folder: str | Path | None = None,
) -> LobeDiagram:
    """Compute the stability lobe diagram of a case.

    Parameters
    ----------
    case : Case
    method : str, optional
        One of `chatter.stability.registry.METHODS`, or "auto"; by default what the case says,
        else "auto".
    grid : bool
        Also the spectral radius on the whole grid of speeds and depths.
    progress : callable, optional
        Called with (done, total) speeds.
    cluster : str or Executor, optional
        Where the grid is computed, as for `chatter.studies.executor.open_executor`; None: here.
    folder : path, optional
        On a cluster, keeps finished blocks of the grid in the result cache there.

    Returns
    -------
    LobeDiagram

    Raises
    ------
    InputError
        If the case lacks something or asks for what cannot be computed.
    """
    name, limits_of = chosen_method(case, method)
    model = milling_model(case)
    speeds = spindle_speeds(case)
    zero_order = zero_order_of(model, speeds)
    deepest = deepest_depth(case, zero_order)
    depths = axial_depths(case, deepest)
    limits = limits_of(model, speeds, depths, resolution(case), progress)
    computed = None
    if grid and cluster is not None:
        radius = radius_in_blocks(case, speeds, depths, name, cluster, folder, progress)
        computed = StabilityGrid(speeds, depths, radius)
    elif grid:
        computed = stability_grid(case, model, speeds, depths, name, progress)
    return LobeDiagram(
        case=case,
        method=name,
        limits=limits,
        zero_order=zero_order,
        deepest=deepest,
        pockets=find_pockets(speeds, limits.critical_depth, deepest, removal_area(case)),
        operating=operating_limit(case, model, limits_of, deepest),
        natural_frequencies=natural_frequencies(model, speeds),
        grid=computed,
        notes=(
            *model.notes, *notes_on_steady_cut(model, name), *notes_on_tolerance(case, limits)
        ),
    )  # fmt: skip


def notes_on_tolerance(case: Case, limits: LimitCurve) -> tuple[str, ...]:
    """Say where the tolerance on the depths of the limits is not met."""
    asked = case.lobes.tolerance if case.lobes else LIMIT_ERROR
    if not limits.error > asked:
        return ()
    return (
        f"the limits are good to {limits.error:.1%} of their depth, not to the {asked:.2%} asked "
        "for; a lower lobes.tolerance takes finer elements, and longer",
    )


def operating_limit(
    case: Case, model: MillingModel, limits_of: LimitMethod, deepest: float
) -> LimitCurve:
    """Limits at the operating speed, looked for at least to the operating depth."""
    depths = axial_depths(case, max(deepest, 1.02 * case.cut.axial_depth))
    speeds = np.array([case.cut.spindle_speed])
    return limits_of(model, speeds, depths, resolution(case), no_progress)


def removal_area(case: Case) -> float:
    """Removal rate over axial depth and spindle speed, m^2."""
    return case.width_of_cut * case.cut.feed_per_tooth * case.tool.teeth / (2.0 * math.pi)


def stability_grid(
    case: Case,
    model: MillingModel,
    speeds: NDArray[np.float64],
    depths: NDArray[np.float64],
    method: str,
    progress: Progress = no_progress,
) -> StabilityGrid:
    """Spectral radius on every pair of speed and depth."""
    speed, depth = (part.ravel() for part in np.meshgrid(speeds, depths))
    radius_at = GRIDS.get(method, radius_by_collocation)
    radius = radius_at(model, speed, depth, resolution(case), progress)
    return StabilityGrid(speeds, depths, radius.reshape(len(depths), len(speeds)))
