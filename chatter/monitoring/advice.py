"""What to do about chatter: speeds that its frequency proposes, or that a case has as stable."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from chatter.description.case import Case
from chatter.stability.diagram import StabilityDiagram

#: range about the speed of the cut in which the chatter frequency proposes speeds, and how many
_SLOWEST, _FASTEST, _MOST = 0.5, 2.0, 4
#: critical depth over the depth of the cut from which a speed is called stable
_MARGIN = 1.1
#: relative difference of speeds that are one
_SAME_SPEED = 0.01
#: chatter frequency over the natural frequency of the mode that it belongs to
_BELOW_MODE, _ABOVE_MODE = 0.9, 1.2


@dataclass(frozen=True)
class ProposedSpeed:
    """A spindle speed to try.

    Attributes
    ----------
    spindle_frequency : float
        Hz.
    lobe : int or None
        k of fc / k, where the chatter frequency proposes the speed.
    critical_depth : float
        m, of the case; nan without one, inf where no limit was found.
    """

    spindle_frequency: float
    lobe: int | None
    critical_depth: float = math.nan

    @property
    def spindle_speed_rpm(self) -> float:
        """Spindle speed in revolutions per minute."""
        return 60.0 * self.spindle_frequency


@dataclass(frozen=True)
class ChatterMode:
    """The mode of a case that chatters.

    Attributes
    ----------
    number : int
        In the order of the case, from 1.
    frequency : float
        Hz, natural frequency.
    """

    number: int
    frequency: float


def proposed_by_frequency(
    chatter_frequency: float, spindle_frequency: float, teeth: int
) -> list[ProposedSpeed]:
    """Speeds at which a whole number of chatter periods passes between teeth, nearest first.

    There the surface that one tooth leaves is in phase with the vibration of the next, in the
    pockets between the lobes (Smith and Delio 1992, J. Eng. Ind. 114, 146: tooth passing
    frequency = fc / k).
    """
    low, high = _SLOWEST * spindle_frequency, _FASTEST * spindle_frequency
    first = max(math.ceil(chatter_frequency / (teeth * high)), 1)
    last = math.floor(chatter_frequency / (teeth * low))
    found = [ProposedSpeed(chatter_frequency / (k * teeth), k) for k in range(first, last + 1)]
    found.sort(key=lambda one: abs(math.log(one.spindle_frequency / spindle_frequency)))
    return found[:_MOST]


def stable_speeds(diagram: StabilityDiagram, spindle_frequency: float) -> list[ProposedSpeed]:
    """Nearest speeds below and above that are stable at the depth of the case, nearest first."""
    speeds = diagram.limits.spindle_speed / (2.0 * math.pi)
    depths = diagram.limits.critical_depth
    other = np.abs(speeds / spindle_frequency - 1.0) > _SAME_SPEED
    deep = np.flatnonzero((depths > _MARGIN * diagram.case.cut.axial_depth) & other)
    below, above = deep[speeds[deep] <= spindle_frequency], deep[speeds[deep] > spindle_frequency]
    chosen = [*below[-1:], *above[:1]]
    found = [ProposedSpeed(float(speeds[k]), None, float(depths[k])) for k in chosen]
    return sorted(found, key=lambda one: abs(one.spindle_frequency - spindle_frequency))


def is_stable(diagram: StabilityDiagram, spindle_frequency: float) -> bool:
    """Whether the case has its own depth as stable at a speed."""
    speeds = diagram.limits.spindle_speed / (2.0 * math.pi)
    nearest = int(np.argmin(np.abs(speeds - spindle_frequency)))
    inside = speeds[0] <= spindle_frequency <= speeds[-1]
    return inside and bool(diagram.limits.critical_depth[nearest] > diagram.case.cut.axial_depth)


def mode_of(
    diagram: StabilityDiagram, chatter_frequency: float, spindle_frequency: float
) -> ChatterMode | None:
    """Mode whose natural frequency is next to a chatter frequency; None where none is near.

    Chatter lies some percent above the natural frequency of its mode.
    """
    if not diagram.natural_frequencies.size:
        return None
    speeds = diagram.limits.spindle_speed / (2.0 * math.pi)
    column = int(np.argmin(np.abs(speeds - spindle_frequency)))
    natural = diagram.natural_frequencies[:, column]
    ratio = chatter_frequency / natural
    near = np.flatnonzero((ratio > _BELOW_MODE) & (ratio < _ABOVE_MODE))
    if not near.size:
        return None
    best = int(near[np.argmin(np.abs(np.log(ratio[near])))])
    return ChatterMode(best + 1, float(natural[best]))


def in_words(
    proposed: list[ProposedSpeed],
    mode: ChatterMode | None,
    case: Case | None,
    frequency: float,
    stable: bool,
) -> list[str]:
    """Sentences of the advice; `stable` is what the case has the cut as."""
    if case is None:
        return [_of_frequency(proposed, frequency)] if proposed else []
    sentences = []
    if mode is None:
        sentences.append(
            f"no mode of the case lies near {frequency:.0f} Hz: it lacks the one that chatters"
        )
    else:
        sentences.append(f"mode {mode.number} of the case chatters, {mode.frequency:.0f} Hz")
    depth = 1e3 * case.cut.axial_depth
    if stable:
        sentences.append(
            f"the case has {depth:.3g} mm as stable at this speed: its modes or coefficients are "
            "not those of the cut; `chatter learn` and `chatter explain` find what it lacks"
        )
    if proposed:
        speeds = ", ".join(_with_limit(one) for one in proposed)
        sentences.append(f"nearest speeds that the case has as stable at {depth:.3g} mm: {speeds}")
    else:
        sentences.append(
            f"the case has no stable speed at {depth:.3g} mm in the range of its diagram"
        )
    return sentences


def _of_frequency(proposed: list[ProposedSpeed], frequency: float) -> str:
    speeds = ", ".join(f"{one.spindle_speed_rpm:.0f} rpm (k = {one.lobe})" for one in proposed)
    return f"speeds whose tooth passing frequency is {frequency:.1f} Hz / k: {speeds}"


def _with_limit(one: ProposedSpeed) -> str:
    limit = (
        f"limit {1e3 * one.critical_depth:.3g} mm"
        if math.isfinite(one.critical_depth)
        else "no limit found"
    )
    return f"{one.spindle_speed_rpm:.0f} rpm ({limit})"


def as_rows(proposed: list[ProposedSpeed]) -> list[dict[str, Any]]:
    """Proposed speeds as JSON knows them."""
    return [
        {
            "spindle_speed_rpm": one.spindle_speed_rpm,
            "lobe": one.lobe,
            "critical_depth_mm": 1e3 * one.critical_depth
            if math.isfinite(one.critical_depth)
            else None,
        }
        for one in proposed
    ]
