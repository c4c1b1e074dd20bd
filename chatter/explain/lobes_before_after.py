"""Stability lobes of the declared case, the refitted one, and the one with what was added."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.description.errors import InputError, RunError
from chatter.description.units import rpm
from chatter.explain.before_after import STEPS
from chatter.stability.diagram import StabilityDiagram
from chatter.stability.lobes import lobes

if TYPE_CHECKING:
    from chatter.explain.explanation import Explanation

Array = NDArray[np.float64]

#: what lobes need of a case
_NEEDED = ("tool", "material", "cut", "structure")
_SPEEDS, _DEPTHS = 100, 60
#: speeds at which it is asked whether an effect acts in lobes at all
_ASKED = 16
#: speeds beyond those that were measured, and depths beyond the deepest cut
_BEYOND, _DEEPER = 1.15, 1.25
#: factor in speed around a single cut, and depths in units of the lowest limit
_AROUND_ONE, _LOWEST_LIMITS = 2.0, 3.0
#: change of limits that is no more than that of the method
_SAME = 1e-4


@dataclass(frozen=True, eq=False)
class LobesBeforeAfter:
    """Diagrams over the same speeds and depths, and the cuts that were measured.

    Parameters
    ----------
    diagrams : dict of str to StabilityDiagram
        By step: declared, refitted, with what was added.
    speed, depth : (n,) array of float
        Cuts measured, rad/s and m.
    stable : (n,) array of bool or None
        Verdicts, where they were measured.
    says : tuple of str
        Sentences.
    """

    diagrams: dict[str, StabilityDiagram]
    speed: Array
    depth: Array
    stable: NDArray[np.bool_] | None
    says: tuple[str, ...]


def lobes_before_after(explanation: Explanation) -> LobesBeforeAfter | None:
    """Compute lobes before and after; None where the case holds no cut.

    Parameters
    ----------
    explanation : Explanation
    """
    measurement = explanation.measurement
    if any(getattr(measurement.case, section) is None for section in _NEEDED):
        return None
    cases = {STEPS[0]: measurement.case, STEPS[1]: explanation.refitted}
    if explanation.verdict == "explained":
        cases[STEPS[2]] = explanation.case
    try:
        cuts = _cuts(explanation)
        ranged = _ranged(cuts, _SPEEDS)
        diagrams = {step: lobes(case.patch(ranged)) for step, case in cases.items()}
        acts = _acts(explanation, _ranged(cuts, _ASKED))
    except (InputError, RunError) as error:
        return LobesBeforeAfter({}, np.empty(0), np.empty(0), None, (f"No lobes: {error}.",))
    says = _sentences(explanation, diagrams, acts)
    return LobesBeforeAfter(diagrams, cuts.speed, cuts.depth, cuts.stable, tuple(says))


class _Cuts(NamedTuple):
    """Cuts measured, and the lowest limit of the declared case by the quick solution, m."""

    speed: Array
    depth: Array
    stable: NDArray[np.bool_] | None
    lowest_limit: float


def _cuts(explanation: Explanation) -> _Cuts:
    measurement = explanation.measurement
    lowest = lobes(measurement.case, "zero-order").zero_order.lowest_depth
    lowest = lowest if math.isfinite(lowest) else 0.0
    if measurement.kind == "stability":
        columns = [
            np.concatenate([run.signals[name] for run in measurement.runs])
            for name in ("spindle_speed", "axial_depth", "stable")
        ]
        return _Cuts(columns[0], columns[1], columns[2] > 0.5, lowest)
    if measurement.kind == "milling":
        cuts = [run.of(measurement.case).cut for run in measurement.runs]
    else:
        cuts = [measurement.case.cut]
    return _Cuts(
        np.array([cut.spindle_speed for cut in cuts]),
        np.array([cut.axial_depth for cut in cuts]),
        None,
        lowest,
    )


def _ranged(cuts: _Cuts, count: int) -> dict[str, dict[str, str | int]]:
    """Speeds and depths of a diagram that holds all cuts."""
    speed, depth = cuts.speed, cuts.depth
    beyond = _BEYOND if speed.size > 1 else _AROUND_ONE
    speeds = {
        "from": f"{rpm(speed.min() / beyond):.6g} rpm",
        "to": f"{rpm(speed.max() * beyond):.6g} rpm",
        "count": count,
    }
    deepest = max(_DEEPER * float(depth.max()), _LOWEST_LIMITS * cuts.lowest_limit)
    return {
        "lobes.speeds": speeds,
        "lobes.depths": {"to": f"{1e3 * deepest:.6g} mm", "count": _DEPTHS},
    }


def _without_effects(explanation: Explanation) -> Case:
    """Case with the uncertain values of the final fit, and without the effects."""
    found = explanation.found
    uncertain = {one.name for one in found.base.parameters}
    values = {key: v for key, v in found.final.by_name.items() if key in uncertain}
    return explanation.measurement.case.patch(values) if values else explanation.measurement.case


def _acts(explanation: Explanation, ranged: dict[str, dict[str, str | int]]) -> bool:
    """Whether the effects that were added move linear lobes by themselves."""
    if explanation.verdict != "explained":
        return False
    without, with_effects = (
        lobes(case.patch(ranged)) for case in (_without_effects(explanation), explanation.case)
    )
    return _largest_change(without, with_effects) >= _SAME


def _sentences(
    explanation: Explanation, diagrams: dict[str, StabilityDiagram], acts: bool
) -> list[str]:
    says = []
    steps = list(diagrams)
    for before, after in pairwise(steps):
        says.append(f"{_names(before, after)}{_change(diagrams[before], diagrams[after])}")
    if explanation.verdict == "explained" and not acts:
        names = " and ".join(stage.best.effect.name for stage in explanation.found.accepted)
        says.append(
            f"{names} by itself does not act in linear lobes: what changes in them is the "
            "refitting beside it."
        )
    if explanation.measurement.kind == "milling":
        says.append(
            "The lobes are for the radial depth and the direction of cut of the declared case; "
            "runs with others are drawn in by speed and depth alone."
        )
    says += [f"{note[:1].upper()}{note[1:]}." for note in diagrams[steps[-1]].notes]
    return says


def _names(before: str, after: str) -> str:
    return f"From {before} to {after}, "


def _finite(before: StabilityDiagram, after: StabilityDiagram) -> tuple[Array, Array, Array]:
    old, new = before.limits.critical_depth, after.limits.critical_depth
    both = np.isfinite(old) & np.isfinite(new)
    return rpm(before.limits.spindle_speed[both]), old[both], new[both]


def _largest_change(before: StabilityDiagram, after: StabilityDiagram) -> float:
    _, old, new = _finite(before, after)
    appeared = np.isfinite(before.limits.critical_depth) != np.isfinite(after.limits.critical_depth)
    if appeared.any() or old.size == 0:
        return 1.0 if appeared.any() else 0.0
    return float(np.max(np.abs(new / old - 1.0)))


def _change(before: StabilityDiagram, after: StabilityDiagram) -> str:
    speed, old, new = _finite(before, after)
    if old.size == 0:
        return "no limit lies within the depths looked at in both."
    if _largest_change(before, after) < _SAME:
        return "the limits stay as they are."
    ratio = new / old
    most = int(np.argmax(np.abs(np.log(ratio))))
    lowest = [1e3 * float(values.min()) for values in (old, new)]
    return (
        f"the lowest limit goes from {lowest[0]:.3g} to {lowest[1]:.3g} mm; at half of the speeds "
        f"the limit is multiplied by {np.median(ratio):.2f} or less, and most changes at "
        f"{speed[most]:.0f} rpm (from {1e3 * old[most]:.3g} to {1e3 * new[most]:.3g} mm)."
    )
