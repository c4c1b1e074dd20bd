"""Numbers of the surface that a simulated cut leaves behind."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from chatter.description.brief_repr import BriefRepr
from chatter.simulation.carved_workpiece import carved_walls
from chatter.simulation.reconstruction import FloorProfile, WallProfiles, surface_profiles
from cutting.chip.discrete_chip import DiscreteCut
from cutting.dexel.stock import DexelStock
from cutting.surface.texture import HeightParameters, Texture, cut_off_for, location_error, texture

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from chatter.simulation.result import SimulationResult

#: sampling lengths that ISO 4288 wants
_SAMPLING_LENGTHS = 5.0
SHARP_CORNER = (
    "floor: its roughness is not evaluated, since a sharp corner leaves feed marks that depend on "
    "the minor cutting edge; tool.corner_radius gives them"
)


@dataclass(frozen=True, eq=False)
class WallFinish:
    """A wall and its numbers."""

    profiles: WallProfiles
    #: (L,), mean deviation at each height, m; positive where too much was removed
    location_errors: NDArray[np.float64]
    location_error: float  # mean deviation of the wall, m
    texture: Texture

    @property
    def largest_location_error(self) -> float:
        """Location error at the height where it is largest, m."""
        return float(self.location_errors[np.argmax(np.abs(self.location_errors))])


@dataclass(frozen=True, eq=False)
class FloorFinish:
    """A floor and its numbers."""

    profile: FloorProfile
    location_error: float  # depth by which too much was removed in the mean, m
    texture: Texture


@dataclass(frozen=True, eq=False, repr=False)
class Finish(BriefRepr):
    """Surface of a cut."""

    walls: tuple[WallFinish, ...] = ()  # one for each side; empty where the run is too short
    floor: FloorFinish | None = None
    notes: tuple[str, ...] = ()  # what could not be evaluated, and why

    @property
    def location_error(self) -> float | None:
        """Surface location error of the wall, m; mean of both walls of a slot."""
        errors = [wall.location_error for wall in self.walls]
        return sum(errors) / len(errors) if errors else None

    def summary(self) -> dict:
        """Return the numbers of the surface for summary.json; None for what is not known."""
        wall = [one.texture for one in self.walls]
        floor = [self.floor.texture] if self.floor and not self.floor.profile.sharp else []
        return {
            "surface_location_error_um": _micrometres(self.location_error),
            "surface_location": {
                "walls": {one.profiles.side: _place(one) for one in self.walls},
                "floor_um": _micrometres(self.floor.location_error) if self.floor else None,
            },
            "roughness": {
                "wall": _heights("R", [one.roughness for one in wall]),
                "floor": _heights("R", [one.roughness for one in floor]),
            },
            "waviness": {
                "wall": _heights("W", [one.waviness for one in wall]),
                "floor": _heights("W", [one.waviness for one in floor]),
            },
            "surface_evaluation": {
                "length_mm": wall[0].length * 1e3 if wall else None,
                "cut_off_mm": wall[0].cut_off * 1e3 if wall else None,
                "notes": list(self.notes),
            },
        }


def _place(wall: WallFinish) -> dict:
    return {
        "mean_um": _micrometres(wall.location_error),
        "largest_um": _micrometres(wall.largest_location_error),
        "height_mm": (wall.profiles.height * 1e3).round(6).tolist(),
        "by_height_um": (wall.location_errors * 1e6).round(6).tolist(),
    }


def _micrometres(value: float | None) -> float | None:
    """Return a length without the digits that only rounding makes."""
    return None if value is None or not math.isfinite(value) else round(value * 1e6, 9)


def _heights(letter: str, found: Sequence[HeightParameters | None]) -> dict[str, float | None]:
    """Mean over the surfaces of a kind."""
    known = [one for one in found if one is not None]

    def mean(name: str) -> float | None:
        if not known:
            return None
        return _micrometres(sum(getattr(one, name) for one in known) / len(known))

    return {
        f"{letter}a_um": mean("mean"),
        f"{letter}q_um": mean("rms"),
        f"{letter}z_um": mean("depth"),
    }


def scallop_height(diameter: float, stepover: float) -> float:
    """Height of what a ball leaves between two straight passes, m.

    R - sqrt(R^2 - s^2/4), where two circles of the radius R, a stepover s apart, cross.
    """
    radius = 0.5 * diameter
    return radius - math.sqrt(max(radius**2 - 0.25 * stepover**2, 0.0))


def finish_of(result: SimulationResult) -> Finish:
    """Evaluate the surface that a cut leaves behind over its last settled turns."""
    walls, floor, notes = surface_profiles(result)
    cut = result.setup.groups[0]
    if walls and isinstance(cut, DiscreteCut) and isinstance(cut.stock, DexelStock):
        # the workpiece itself shows its walls; voxels are too coarse for that
        walls = carved_walls(result) or walls
    feed_per_revolution = result.case.cut.feed_per_tooth * result.case.tool.teeth
    return finish_from_profiles(walls, floor, feed_per_revolution, notes)


def finish_from_profiles(
    walls: Sequence[WallProfiles],
    floor: FloorProfile | None,
    feed_per_revolution: float,
    notes: Sequence[str] = (),
) -> Finish:
    """Evaluate profiles, whether reconstructed from a motion or carved out of a stock.

    The feed per revolution, m, is the longest spacing of marks that belong to the roughness; it
    chooses the cut-off. Notes say what is already known to be missing.
    """
    cut_off = cut_off_for(feed_per_revolution)
    found = tuple(_wall_finish(wall, cut_off) for wall in walls)
    below = None if floor is None else _floor_finish(floor, cut_off)
    evaluated = [wall.texture for wall in found]
    if below is not None:
        evaluated.append(below.texture)
    marks = (SHARP_CORNER,) if floor is not None and floor.sharp else ()
    return Finish(found, below, (*notes, *marks, *_length_notes(evaluated, cut_off)))


def _wall_finish(wall: WallProfiles, cut_off: float) -> WallFinish:
    by_height, mean = location_error(wall.deviation, wall.weight)
    found = texture(wall.deviation, wall.weight, float(wall.x[1] - wall.x[0]), cut_off)
    return WallFinish(wall, by_height, mean, found)


def _floor_finish(floor: FloorProfile, cut_off: float) -> FloorFinish:
    spacing = float(floor.x[1] - floor.x[0])
    found = texture(floor.height[None, :], np.ones(1), spacing, cut_off)
    return FloorFinish(floor, -float(floor.height.mean()), found)


def _length_notes(evaluated: Sequence[Texture], cut_off: float) -> tuple[str, ...]:
    if any(one.waviness is None for one in evaluated):
        return (
            f"surface: less than two cut-offs of {cut_off * 1e3:g} mm were evaluated, so that "
            "roughness holds the waviness as well",
        )
    if any(one.length < _SAMPLING_LENGTHS * cut_off for one in evaluated):
        return (f"surface: fewer than five cut-offs of {cut_off * 1e3:g} mm were evaluated",)
    return ()
