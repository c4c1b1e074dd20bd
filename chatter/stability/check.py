"""Verdict on the operating point of a case."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from chatter.compile.chip_of_teeth import thickest_chip_of_teeth
from chatter.compile.cutter import cutter_of
from chatter.compile.inclined_axis import diameter_in_cut, inclined_engagement, is_inclined
from chatter.description.case import Case
from chatter.description.case_or_path import takes_case_or_path
from chatter.description.formatting import distinct_from, to_digits
from chatter.description.progress import Progress, begin, no_progress
from chatter.description.questioned import question_of_flutes, question_of_spectral_radius
from chatter.description.unit_system import UnitSystem, units_of
from chatter.description.units import rpm
from chatter.detection.bifurcation_type import bifurcation_of_multiplier
from chatter.io.result_files import (
    NotebookResult,
    as_json,
    finite_or_none,
    presentation,
    short_repr,
    write_results,
)
from chatter.simulation.resolution import slices_of_inclined
from chatter.stability.forced_vibration import neglected_in_steady_cut, notes_on_dashpot
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.methods.zeroth_order.limits import zero_order_of
from chatter.stability.misfit_of_modes import neglected_misfit_of_modes
from chatter.stability.model import MillingModel, milling_model
from chatter.stability.neglected_effects import (
    CHATTER,
    EDGE_FORCES,
    NOT_CERTAIN,
    STABLE,
    NeglectedEffect,
    deciding,
    highest_factor,
    lowest_factor,
    notes_of,
    reasons_of,
)
from chatter.stability.registry import (
    METHODS,
    chosen_method,
    fixed_steps,
    with_chatter_frequency,
    with_multiplier,
)
from chatter.stability.resting_friction import neglected_resting_friction
from chatter.stability.search_range import depths_at_one_speed, known_to
from chatter.stability.stability_method import Multiplier, StabilityMethod
from chatter.stability.steady_flank import about_steady_motion
from cutting.edge_segments.segments import period_angle
from cutting.engagement.immersion import slice_engagement

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike

#: bifurcation -> words
_KINDS = {"hopf": "quasi-periodic", "flip": "period doubling", "fold": "cyclic fold"}


@dataclass(frozen=True, repr=False)
class StabilityCheck(NotebookResult):
    """Stability of the operating point of a case.

    Parameters
    ----------
    case : Case
    method : str
        Name of the one that gave the critical depth.
    multiplier : Multiplier
        Dominant multiplier at the operating point.
    chatter_frequency : float
        Hz, of the motion that grows; nan where the cut is stable.
    limit : LimitCurve
        At the operating speed alone.
    max_depth : float
        Maximum axial depth searched, m.
    known_to : float
        Depth, m, above which a limit lies that was not found.
    zero_order_depth : float
        Limit by the zeroth-order solution, m.
    notes : tuple of str
    neglected : tuple of NeglectedEffect
        What the linear limit leaves out in this cut, with bounds of the true limit.
    radius_method : str
        Name of the one that gave the spectral radius.
    """

    case: Case
    method: str
    multiplier: Multiplier
    chatter_frequency: float
    limit: LimitCurve
    max_depth: float
    known_to: float
    zero_order_depth: float
    notes: tuple[str, ...] = ()
    neglected: tuple[NeglectedEffect, ...] = ()
    radius_method: str = ""

    @property
    def units(self) -> UnitSystem:
        """Units that the words, the table and the picture are in: those of the case."""
        return units_of(self.case)

    @property
    def spectral_radius(self) -> float:
        """Magnitude of the dominant multiplier over one period: from tooth to like tooth."""
        return abs(self.multiplier.value)

    @property
    def stable(self) -> bool:
        """True where every small disturbance dies out, by the linear analysis.

        Where the limit is that of cuts in the time domain, it is the limit that decides.
        """
        if self.is_by_limit:
            return self._is_below_limit
        return self.spectral_radius < 1.0

    @property
    def is_by_limit(self) -> bool:
        """Whether the method takes account of what the linear analysis leaves out."""
        return not METHODS[self.method].is_linear

    @property
    def _is_below_limit(self) -> bool:
        """True where the depth of the cut lies in a stable interval of the limits."""
        below = [one for one in self.limit.crossings[0] if one <= self.case.cut.axial_depth]
        return len(below) % 2 == 0

    @property
    def deciding(self) -> tuple[NeglectedEffect, ...]:
        """What the linear analysis leaves out and could turn its verdict; empty where it stands."""
        depth, crossings = self.case.cut.axial_depth, self.limit.crossings[0]
        return deciding(self.neglected, depth, crossings, self.known_to, stable=self.stable)

    @property
    def verdict(self) -> str:
        """``"stable"`` or ``"chatter"``; ``"not certain"`` where what is left out may decide."""
        if self.deciding:
            return NOT_CERTAIN
        return STABLE if self.stable else CHATTER

    @property
    def lowest_depth(self) -> float:
        """Least depth, m, at which the limit may lie by what the linear analysis leaves out.

        Of a limit that was not found no more is known than that it lies beyond the search.
        """
        low = lowest_factor(self.neglected) * min(self.critical_depth, self.known_to)
        is_beyond = not np.isfinite(self.critical_depth) and low >= self.max_depth
        return self.critical_depth if is_beyond else low

    @property
    def bifurcation(self) -> str:
        """Kind of the instability at the operating point; ``"none"`` where it is stable."""
        if self.stable:
            return "none"
        if self.is_by_limit:
            return self.limit.bifurcation[0]
        return bifurcation_of_multiplier(self.multiplier.value)

    @property
    def critical_depth(self) -> float:
        """First limit at the operating speed, m; inf where none was found."""
        return float(self.limit.critical_depth[0])

    def __repr__(self) -> str:
        """What the result is of: its arrays would fill the screen."""
        return short_repr(self)

    def summary(self) -> dict:
        """Return what `chatter check` prints."""
        cut = self.case.cut
        return {
            "spectral_radius": self.spectral_radius,
            "stable": self.stable,
            "verdict": self.verdict,
            "chatter_frequency_Hz": finite_or_none(self.chatter_frequency),
            "bifurcation": self.bifurcation,
            "critical_depth_mm": finite_or_none(self.critical_depth * 1e3),
            "spindle_speed_rpm": rpm(cut.spindle_speed),
            "axial_depth_mm": cut.axial_depth * 1e3,
            "cutting_speed_m_per_min": 30.0 * self.case.tool.diameter * cut.spindle_speed,
            "feed_rate_mm_per_min": 60e3 * self.case.feed_speed,
            "limit": {
                "chatter_frequency_Hz": finite_or_none(float(self.limit.chatter_frequency[0])),
                "bifurcation": self.limit.bifurcation[0],
                "crossings_mm": [float(depth * 1e3) for depth in self.limit.crossings[0]],
                "estimated_error": finite_or_none(self.limit.error),
                "max_axial_depth_mm": self.max_depth * 1e3,
                "zero_order_depth_mm": finite_or_none(self.zero_order_depth * 1e3),
            },
            "method": self.method,
            "steps_per_tooth_period": self.multiplier.steps,
            "spectral_radius_error": self.multiplier.error,
            "neglected_effects": [effect.summary() for effect in self.neglected],
            "notes": list(self.notes),
        }

    def sentences(self) -> list[str]:
        """Verdict in words."""
        cut, (unit, factor) = self.case.cut, self.units.length
        depth = distinct_from(factor * cut.axial_depth, factor * self.critical_depth)
        point = f"{depth} {unit} at {rpm(cut.spindle_speed):.6g} rpm"
        deciding, words = self.deciding, STABLE if self.stable else CHATTER
        if deciding:
            words = f"{words} by the linear analysis, not certain"
        if not self.stable:
            point = f"{point}{self._chatter()}"
        if not deciding:
            return [f"{words}: {point}"]
        reasons = "; ".join(reasons_of(deciding, stable=self.stable))
        return [f"{words}: {point}", f"{reasons}{self._bound()}; `chatter simulate` decides"]

    def _chatter(self) -> str:
        """Frequency and kind of chatter; nothing of a growth that no number describes."""
        frequency = self.chatter_frequency
        if not frequency > 0.0:
            return ""
        kind = _KINDS.get(self.bifurcation)
        return f", {frequency:.0f} Hz{f' ({kind})' if kind else ''}"

    def _bound(self) -> str:
        """How far the limit next to the cut may lie from the linear one, where that is known.

        What frictions at rest make of it is in their own words.
        """
        if any(effect.name != EDGE_FORCES for effect in self.deciding):
            return ""
        depth, (unit, factor) = self.case.cut.axial_depth, self.units.length
        if not self.stable:
            below = [limit for limit in self.limit.crossings[0] if limit <= depth]
            high = below[-1] * highest_factor(self.neglected) if below else np.inf
            if high == np.inf:
                return ""
            return f", from {factor * below[-1]:.4g} to {factor * high:.3g} {unit}"
        low, limit = self.lowest_depth, self.critical_depth
        if not 0.0 < low < depth:
            return ""
        if not np.isfinite(limit):
            above = f"{factor * self.known_to:.4g} {unit}"
            return f", to {factor * low:.3g} {unit} of a limit that lies above {above}"
        return f", from {factor * limit:.4g} to {factor * low:.3g} {unit}"

    def rows(self) -> list[list[str]]:
        """Table of the verdict: what, and how much."""
        cut, tool, units = self.case.cut, self.case.tool, self.units
        cutting_speed, feed_rate = units.cutting_speed, units.feed_rate
        speed = cut.spindle_speed * tool.diameter / 2.0
        wide, effective = diameter_in_cut(self.case), []
        if wide is not None:
            there = cutting_speed.text(0.5 * wide * cut.spindle_speed)
            effective = [["effective diameter", f"{units.length.text(wide)}, {there} there"]]
        return [
            ["critical depth", self._depth()],
            *self._lowest(),
            ["chatter frequency at the limit", _hertz(float(self.limit.chatter_frequency[0]))],
            [
                "spectral radius",
                f"{distinct_from(self.spectral_radius, 1.0)}{self._radius_by()} (below 1: stable"
                f"{'; of a period of the speed' if cut.speed_variation else ''})",
            ],
            ["cutting speed", f"{to_digits(cutting_speed.factor * speed, 4)} {cutting_speed.name}"],
            *effective,
            *self._engagement(),
            *self._life(speed),
            [
                "feed rate",
                f"{to_digits(feed_rate.factor * self.case.feed_speed, 4)} {feed_rate.name}",
            ],
            ["method", self.method],
        ]

    def _radius_by(self) -> str:
        """Method of the spectral radius where it is another than that of the limit."""
        return "" if self.radius_method in ("", self.method) else f" by {self.radius_method}"

    def _life(self, speed: float) -> list[list[str]]:
        """Life of the edge at a cutting speed, m/s, where the case states one."""
        if self.case.tool_life is None:
            return []
        return [["tool life", f"{self.case.tool_life.life_at(speed) / 60.0:.3g} min"]]

    def _engagement(self) -> list[list[str]]:
        """Width and angles where the edge is at the depth of the cut; inclined, of all edges."""
        if is_inclined(self.case):
            return self._engagement_of_inclined()
        radius = np.array([cutter_of(self.case).radius_at(self.case.cut.axial_depth)])
        band = self.case.uncut_band
        entry, leave = _degrees(np.ravel(slice_engagement(band, radius)))
        return [
            ["width of cut", self.units.length.text(band.width(radius)[0])],
            ["tooth in the cut", f"{entry:.4g} to {leave:.4g} deg from +y"],
            *self._thickest_chip(),
        ]

    def _thickest_chip(self) -> list[list[str]]:
        """Thickest chip of the rigid cut of an edge; a corner makes it thinner."""
        cutter = cutter_of(self.case)
        if cutter.corner_radius > 0.0:
            return []
        thickest = thickest_chip_of_teeth(self.case, cutter)
        return [["thickest chip", self.units.length.text(thickest, ".3g")]]

    def _engagement_of_inclined(self) -> list[list[str]]:
        case = self.case
        found = slices_of_inclined(case, cutter_of(case))
        entry, leave = _degrees(found.reach)
        angles = (
            f"{entry:.4g} to {leave:.4g} deg" if leave - entry < 360.0 else "all around, 360 deg,"
        )
        width = inclined_engagement(case, cutter_of(case)).width
        return [
            ["width of cut", self.units.length.text(width)],
            ["tooth in the cut", f"{angles} about the inclined axis"],
        ]

    def _lowest(self) -> list[list[str]]:
        """What the limit is at least, where that is another."""
        low, limit = self.lowest_depth, self.critical_depth
        if not low < limit:
            return []
        names = ", ".join(one.name for one in self.neglected if one.lowest < 1.0)
        known = self.units.length.text(low, ".3g") if low > 0.0 else "not known"
        return [[f"at least, with {names}", known]]

    def _depth(self) -> str:
        length, depth = self.units.length, self.case.cut.axial_depth
        if np.isfinite(self.critical_depth):
            limit = distinct_from(length.factor * self.critical_depth, length.factor * depth)
            return f"{limit} {length.name}"
        tool = self.case.tool
        reached = self.max_depth >= tool.depth_that_tool_allows * (1.0 - 1e-9)
        why = f", tool.{tool.limiting_length}" if reached else ""
        return f"no limit up to {length.text(self.max_depth)}{why}"

    def plot(self) -> Figure:
        """Return the stable depths at the operating speed as a matplotlib figure."""
        return presentation("plots.check").plot_check(self)

    def save(self, folder: str | Path) -> list[Path]:
        """Write check.json and return its path in a list."""
        return write_results(folder, {"check.json": as_json(self.summary())}, {})


def _degrees(angles: ArrayLike) -> list[float]:
    """Angles, rad, in deg, to what anyone reads of them: 0, not 5e-10."""
    return [round(float(angle), 6) + 0.0 for angle in np.degrees(angles)]


def _hertz(frequency: float) -> str:
    return f"{frequency:.1f} Hz" if np.isfinite(frequency) else "none"


def _teeth_of_period(model: MillingModel) -> float:
    """Teeth that pass while the tool turns to where it repeats itself."""
    return model.teeth * period_angle(model.cutter) / (2.0 * np.pi)


@takes_case_or_path
def check(
    case: Case, method: str | None = None, progress: Progress = no_progress
) -> StabilityCheck:
    """Judge the operating point of a case and find the critical depth at its speed.

    Parameters
    ----------
    case : Case
    method : str, optional
        Gives the critical depth: name in `chatter.stability.registry.METHODS`, or "auto". The
        spectral radius is that of the method where it gives one, else of collocation. The verdict
        goes by the spectral radius, with "time-domain" by the critical depth.
    progress : callable, optional
        Called with (done, total) points of the search for the critical depth.

    Returns
    -------
    StabilityCheck

    Raises
    ------
    InputError
        If the case lacks something or asks for what cannot be computed.
    """
    chosen = chosen_method(case, method)
    if case.on_machine:
        begin(progress, "machine: structure, frictions and loops")
    model = milling_model(case)
    chosen.check(model)
    steps = fixed_steps(case)
    speeds = np.array([case.cut.spindle_speed])
    zero_order = zero_order_of(model, speeds)
    depths = depths_at_one_speed(case, zero_order)
    if case.on_machine:
        begin(progress, "critical depth at this speed")
    limit = chosen.limits(model, speeds, depths, steps, progress)
    begin(progress, "stability of the cut itself")
    beside = about_steady_motion(model, *model.operating_point, float(limit.chatter_frequency[0]))
    judge = with_multiplier(chosen)
    multiplier = judge.multiplier(beside, steps)
    frequency = _chatter_frequency(chosen, beside, limit, multiplier)
    begin(progress, "what linear methods leave out")
    neglected = (
        *neglected_resting_friction(model),
        *neglected_misfit_of_modes(model, chosen),
        *neglected_in_steady_cut(model, chosen, limit.critical_depth),
    )
    radius = abs(multiplier.value)
    return StabilityCheck(
        case=case,
        method=chosen.name,
        multiplier=multiplier,
        chatter_frequency=frequency,
        limit=limit,
        max_depth=float(depths[-1]),
        known_to=known_to(float(depths[-1]), zero_order),
        zero_order_depth=float(zero_order.critical_depth[0]),
        notes=(
            *question_of_spectral_radius(radius ** (1.0 / _teeth_of_period(model))),
            *question_of_flutes(case, float(limit.critical_depth[0])),
            *model.notes,
            *notes_of(neglected),
            *notes_on_dashpot(model, chosen),
            *_notes_on_two_methods(case, limit, chosen, judge.name, radius),
        ),
        neglected=neglected,
        radius_method=judge.name,
    )


def _chatter_frequency(
    method: StabilityMethod, beside: MillingModel, limit: LimitCurve, multiplier: Multiplier
) -> float:
    """Hz, of the motion that grows; in the time domain that at the limit; nan where none does."""
    if not method.is_linear:
        return float(limit.chatter_frequency[0])
    if abs(multiplier.value) < 1.0:
        return np.nan
    return with_chatter_frequency(method).chatter_frequency(beside)


def _notes_on_two_methods(
    case: Case, limit: LimitCurve, method: StabilityMethod, of_radius: str, radius: float
) -> tuple[str, ...]:
    """Say that the limit of one method is on the other side of the cut than another one says."""
    below = sum(1 for one in limit.crossings[0] if one <= case.cut.axial_depth)
    of_limit = method.name
    if of_limit == of_radius or (below % 2 == 0) == (radius < 1.0):
        return ()
    word, other = (STABLE, CHATTER) if radius < 1.0 else (CHATTER, STABLE)
    if not method.is_linear:
        return (
            f"the linear analysis ({of_radius}, spectral radius {radius:.4g}) says {word}; the "
            f"verdict is that of the time domain, `chatter check --method {of_radius}` says what "
            "the linear analysis leaves out",
        )
    return (
        f"by its critical depth {of_limit} would say {other}; the verdict is by {of_radius}, "
        f"whose spectral radius says {word}: the limits of the two methods differ, and "
        f"`chatter check --method {of_radius}` has that one",
    )
