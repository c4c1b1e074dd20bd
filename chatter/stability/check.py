"""Verdict on the operating point of a case."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from chatter.description.case import Case
from chatter.description.progress import no_progress
from chatter.description.units import rpm
from chatter.io.result_files import as_json, finite_or_none, write_results
from chatter.stability.floquet_multiplier import Multiplier, bifurcation_kind
from chatter.stability.forced_vibration import notes_on_steady_cut
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.model import milling_model
from chatter.stability.registry import (
    chosen_method,
    operating_frequency,
    operating_multiplier,
    resolution,
    zero_order_of,
)
from chatter.stability.search_range import depths_at_one_speed


@dataclass(frozen=True)
class StabilityCheck:
    """Stability of the operating point of a case.

    Parameters
    ----------
    case : Case
    method : str
        That gave the limit depth.
    multiplier : Multiplier
        Dominant multiplier at the operating point.
    chatter_frequency : float
        Hz, of the motion that grows; nan where the cut is stable.
    limit : LimitCurve
        At the operating speed alone.
    searched_to : float
        m.
    zero_order_depth : float
        Limit by the zeroth-order solution, m.
    notes : tuple of str
    """

    case: Case
    method: str
    multiplier: Multiplier
    chatter_frequency: float
    limit: LimitCurve
    searched_to: float
    zero_order_depth: float
    notes: tuple[str, ...] = ()

    @property
    def spectral_radius(self) -> float:
        """Magnitude of the dominant multiplier over one period: from tooth to like tooth."""
        return abs(self.multiplier.value)

    @property
    def stable(self) -> bool:
        """True where every disturbance dies out."""
        return self.spectral_radius < 1.0

    @property
    def bifurcation(self) -> str:
        """Kind of the instability at the operating point; ``"none"`` where it is stable."""
        return "none" if self.stable else bifurcation_kind(self.multiplier.value)

    @property
    def critical_depth(self) -> float:
        """First limit at the operating speed, m; inf where none was found."""
        return float(self.limit.critical_depth[0])

    def summary(self) -> dict:
        """Return what `chatter check` prints."""
        cut = self.case.cut
        return {
            "spectral_radius": self.spectral_radius,
            "stable": self.stable,
            "chatter_frequency_Hz": finite_or_none(self.chatter_frequency),
            "bifurcation": self.bifurcation,
            "critical_depth_mm": finite_or_none(self.critical_depth * 1e3),
            "spindle_speed_rpm": rpm(cut.spindle_speed),
            "axial_depth_mm": cut.axial_depth * 1e3,
            "limit": {
                "chatter_frequency_Hz": finite_or_none(float(self.limit.chatter_frequency[0])),
                "bifurcation": self.limit.bifurcation[0],
                "crossings_mm": [float(depth * 1e3) for depth in self.limit.crossings[0]],
                "estimated_error": finite_or_none(self.limit.error),
                "searched_to_mm": self.searched_to * 1e3,
                "zero_order_depth_mm": finite_or_none(self.zero_order_depth * 1e3),
            },
            "method": self.method,
            "steps_per_tooth_period": self.multiplier.steps,
            "spectral_radius_error": self.multiplier.error,
            "notes": list(self.notes),
        }

    def save(self, folder: str | Path) -> list[Path]:
        """Write check.json and return its path in a list."""
        return write_results(folder, {"check.json": as_json(self.summary())}, {})


def check(case: Case, method: str | None = None) -> StabilityCheck:
    """Judge the operating point of a case and find the limit depth at its speed.

    Parameters
    ----------
    case : Case
    method : str, optional
        Gives the limit depth: one of `chatter.stability.registry.METHODS`, or "auto". The
        spectral radius is that of semi-discretization or the matrix-free method where that is
        the method, else of collocation.

    Returns
    -------
    StabilityCheck

    Raises
    ------
    InputError
        If the case lacks something or asks for what cannot be computed.
    """
    name, limits_of = chosen_method(case, method)
    model = milling_model(case)
    point = operating_multiplier(model, name, resolution(case))
    heard = np.nan
    if abs(point.value) >= 1.0:
        heard = operating_frequency(model, name)
    speeds = np.array([case.cut.spindle_speed])
    zero_order = zero_order_of(model, speeds)
    depths = depths_at_one_speed(case, zero_order)
    return StabilityCheck(
        case=case,
        method=name,
        multiplier=point,
        chatter_frequency=heard,
        limit=limits_of(model, speeds, depths, resolution(case), no_progress),
        searched_to=float(depths[-1]),
        zero_order_depth=float(zero_order.critical_depth[0]),
        notes=(*model.notes, *notes_on_steady_cut(model, name)),
    )
