"""Result of a pitch design: designs, picture, files."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

from chatter.description.arrays import Array
from chatter.description.brief_repr import BriefRepr
from chatter.description.case import Case
from chatter.description.formatting import rounded_down
from chatter.description.unit_system import UnitSystem, units_of
from chatter.description.units import rpm
from chatter.io.result_files import SavedResult
from chatter.io.result_tables import Column, Columns
from chatter.studies.pitch_design.families import regeneration
from chatter.studies.pitch_design.pitch_search import Design


@dataclass(frozen=True, eq=False, repr=False)
class FamilyCurve(BriefRepr):
    """Designs of a family over its difference."""

    name: str
    differences: Array  # rad (n,)
    designs: tuple[Design, ...]
    #: differences at which regeneration cancels by the rule, rad, within the bounds (k,)
    rule: Array

    @property
    def best(self) -> Design:
        """Design with the highest score."""
        return max(self.designs, key=lambda one: one.score)


@dataclass(frozen=True, eq=False, repr=False)
class PitchResult(SavedResult):
    """Pitch angles for a range of speeds.

    Parameters
    ----------
    case : Case
    goal : str
    max_pitch_ratio : float
        That was allowed, in units of the mean.
    max_depth : float
        Depth to which limits were searched, m.
    original : Design
        That of the case.
    designs : tuple of Design
        Best first, that of the case among them; their limits are those at `speeds`.
    curves : tuple of FamilyCurve
        Their limits are those at the coarser speeds of the search.
    chatter_frequency, design_speed : float
        What the rule uses: the chatter frequency of the uniform-pitch tool where its limit is
        lowest, Hz, and the middle of the speeds, rad/s.
    speeds : (m,) array of float
        rad/s.
    notes : tuple of str
    """

    drawn_by: ClassVar[str] = "plots.pitch_design.plot_pitch"
    picture: ClassVar[str] = "pitch.png"

    case: Case
    goal: str
    max_pitch_ratio: float
    max_depth: float
    original: Design
    designs: tuple[Design, ...]
    curves: tuple[FamilyCurve, ...]
    chatter_frequency: float
    design_speed: float
    speeds: Array
    notes: tuple[str, ...] = ()

    @property
    def units(self) -> UnitSystem:
        """Units that the words and the picture are in: those of the case."""
        return units_of(self.case)

    @property
    def best(self) -> Design:
        """Design with the highest score."""
        return self.designs[0]

    @property
    def is_better(self) -> bool:
        """Whether the best design is another than that of the case."""
        return self.best.pitch != self.original.pitch

    @property
    def best_case(self) -> Case:
        """The case with the best pitch angles written in."""
        return self.case.patch({"tool.pitch": [f"{angle:g} deg" for angle in self.best.pitch]})

    def summary(self) -> dict:
        """Return the content of summary.json."""
        return {
            "title": self.case.title,
            "goal": self.goal,
            "max_pitch_ratio_allowed": self.max_pitch_ratio,
            "spindle_speeds_rpm": [float(rpm(end)) for end in self.speeds[[0, -1]]],
            "max_axial_depth_mm": self.max_depth * 1e3,
            "better_than_the_case": self.is_better,
            "best": self._design(self.best),
            "designs": [self._design(one) for one in self.designs],
            "lowest_limit_mm": {
                "before": self.original.lowest_limit * 1e3,
                "after": self.best.lowest_limit * 1e3,
            },
            "rule": {
                "chatter_frequency_Hz": self.chatter_frequency,
                "spindle_speed_rpm": rpm(self.design_speed),
                "differences_deg": {
                    curve.name: np.degrees(curve.rule).round(3).tolist() for curve in self.curves
                },
            },
            "notes": list(self.notes),
        }

    def _design(self, one: Design) -> dict:
        frequency = 2.0 * math.pi * self.chatter_frequency
        return {
            "name": one.name,
            "pitch_deg": list(one.pitch),
            "lowest_limit_mm": one.lowest_limit * 1e3,
            "stable_below_mm": one.stable_below * 1e3,
            "mean_limit_mm": float(one.limits.mean()) * 1e3,
            "max_pitch_ratio": one.max_pitch_ratio,
            "regeneration_left": regeneration(np.radians(one.pitch), self.design_speed, frequency),
        }

    def sentences(self) -> list[str]:
        """Sentences for the terminal."""
        low, high = rpm(self.speeds[[0, -1]])
        angles = ", ".join(f"{angle:g}" for angle in self.best.pitch)
        lines = [
            f"pitch {angles} deg: lowest limit from {low:.0f} to {high:.0f} rpm "
            f"{self._lowest(self.best)}, with that of the case {self._lowest(self.original)}",
            f"stable at any of these speeds {self._below(self.best)}, with that of the case "
            f"{self._below(self.original)}{self._taken_off()}",
            f"largest pitch ratio {self.best.max_pitch_ratio:.3g} of the mean",
        ]
        if not self.is_better:
            lines.append("no pitch within the bounds is better than that of the case")
        return lines

    def _lowest(self, one: Design) -> str:
        """Lowest limit of a design in words."""
        if one.lowest_limit >= self.max_depth:
            return f"none up to {self.units.length.text(self.max_depth)}"
        return self.units.length.text(one.lowest_limit)

    def _below(self, one: Design) -> str:
        """Depth below which a design is stable at any of the speeds, in words."""
        unit, factor = self.units.length
        depth = one.stable_below * factor
        return f"below {rounded_down(depth)} {unit}" if depth > 0.0 else "at no depth for certain"

    def _taken_off(self) -> str:
        """What of the lowest limits is not certain."""
        if min(self.best.kept, self.original.kept) >= 1.0:
            return ""
        shares = " and ".join(f"{1.0 - one.kept:.0%}" for one in (self.best, self.original))
        causes = dict.fromkeys((*self.best.taken_by, *self.original.taken_by))
        return f" (less {shares}: {', '.join(causes)})"

    def save(self, folder: str | Path, tables: str = "csv") -> list[Path]:
        """Write pitch.csv, lobes.csv, summary.json, pitch.png and case-pitch.toml.

        Parameters and errors are those of `SavedResult.save`.
        """
        path = Path(folder) / "case-pitch.toml"
        written = super().save(folder, tables)
        self.best_case.save(path)
        return [*written, path]

    def tables(self) -> dict[str, Columns]:
        """Columns of the tables "pitch" and "lobes"."""
        found = self.designs
        angles = [" ".join(f"{angle:g}" for angle in one.pitch) for one in found]
        designs = {
            "rank": Column(range(1, len(found) + 1), "d"),
            "name": Column([one.name for one in found], ""),
            "pitch [deg]": Column(angles, ""),
            "lowest_limit [mm]": Column([one.lowest_limit * 1e3 for one in found], ".6g"),
            "stable_below [mm]": Column([one.stable_below * 1e3 for one in found], ".6g"),
            "mean_limit [mm]": Column([one.limits.mean() * 1e3 for one in found], ".6g"),
            "max_pitch_ratio": Column([one.max_pitch_ratio for one in found], ".5g"),
        }
        limits = {
            "spindle_speed [rpm]": Column(rpm(self.speeds), ".4f"),
            "critical_depth_before [mm]": Column(self.original.limits * 1e3, ".6g"),
            "critical_depth_after [mm]": Column(self.best.limits * 1e3, ".6g"),
        }
        return {"pitch": designs, "lobes": limits}
