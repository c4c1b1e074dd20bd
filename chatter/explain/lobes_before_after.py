"""Stability lobes of the declared, the refitted and the repaired case."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from chatter.description.case import Case
from chatter.description.errors import InputError, RunError
from chatter.description.progress import no_progress
from chatter.description.unit_system import units_of
from chatter.description.units import rpm
from chatter.description.usual_units import UsualUnit
from chatter.explain.kinds.kind import Cuts
from chatter.explain.kinds.kind_list import KINDS
from chatter.explain.measurement import Measurement
from chatter.stability.diagram import StabilityDiagram
from chatter.stability.limit_curve import LimitCurve
from chatter.stability.lobes import lobes
from chatter.stability.methods.zeroth_order.limits import zero_order_of
from chatter.stability.methods.zeroth_order.uniform_pitch import ZeroOrderLimit
from chatter.stability.model import milling_model
from chatter.stability.registry import chosen_method, fixed_steps
from chatter.stability.search_range import axial_depths, maximum_depth, spindle_speeds

Array = NDArray[np.float64]

#: what lobes need of a case
_NEEDED = ("tool", "material", "cut", "structure")
_SPEEDS, _DEPTHS = 100, 40
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
    """Diagrams over the same speeds and depths, and the cuts that were measured."""

    diagrams: dict[str, StabilityDiagram]  # by model: declared, refitted, repaired
    cuts: Cuts  # measured
    description: tuple[str, ...]  # sentences


class Added(NamedTuple):
    """Effects that were added, and the repaired case without them."""

    effects: tuple[str, ...]
    without: Case


def lobes_before_after(
    measurement: Measurement, cases: Mapping[str, Case], added: Added | None
) -> LobesBeforeAfter | None:
    """Compute lobes before and after; None where the case holds no cut.

    Cases by model, the repaired one, if there is one, last; `added` goes with it.
    """
    if any(getattr(measurement.case, section) is None for section in _NEEDED):
        return None
    cuts = KINDS[measurement.kind].cuts(measurement)
    try:
        lowest = _zero_order(measurement.case).lowest_depth
        ranged = _ranged(cuts, lowest, _SPEEDS)
        diagrams = {model: lobes(case.patch(ranged)) for model, case in cases.items()}
        moved = 0.0
        if added is not None:
            few = _ranged(cuts, lowest, _ASKED)
            repaired = list(cases.values())[-1]
            moved = _largest_change(*(_limits(one.patch(few)) for one in (added.without, repaired)))
    except (InputError, RunError) as error:
        return LobesBeforeAfter({}, cuts, (f"No lobes: {error}.",))
    length = units_of(measurement.case).length
    sentences = [
        f"From {before} to {after}, "
        f"{_change(diagrams[before].limits, diagrams[after].limits, length)}"
        for before, after in pairwise(diagrams)
    ]
    if added is not None and moved < _SAME:
        sentences.append(
            f"{' and '.join(added.effects)} by itself does not act in linear lobes: what changes "
            "in them is the refitting beside it."
        )
    if cuts.stable is None and cuts.speed.size > 1:
        sentences.append(
            "The lobes are for the radial depth and the direction of cut of the declared case; "
            "runs with others are drawn in by speed and depth alone."
        )
    notes = list(diagrams.values())[-1].notes
    sentences += [f"{note[:1].upper()}{note[1:]}." for note in notes]
    return LobesBeforeAfter(diagrams, cuts, tuple(sentences))


def _ranged(cuts: Cuts, lowest: float, count: int) -> dict[str, dict[str, str | int]]:
    """Speeds and depths of a diagram that holds all cuts."""
    speed, depth = cuts.speed, cuts.depth
    lowest = lowest if math.isfinite(lowest) else 0.0
    beyond = _BEYOND if speed.size > 1 else _AROUND_ONE
    speeds = {
        "from": f"{rpm(speed.min() / beyond):.6g} rpm",
        "to": f"{rpm(speed.max() * beyond):.6g} rpm",
        "count": count,
    }
    deepest = max(_DEEPER * float(depth.max()), _LOWEST_LIMITS * lowest)
    return {
        "lobes.speeds": speeds,
        "lobes.depths": {"to": f"{1e3 * deepest:.6g} mm", "count": _DEPTHS},
    }


def _limits(case: Case) -> LimitCurve:
    """Limits alone, without what else a diagram tells."""
    depths = axial_depths(case, maximum_depth(case, _zero_order(case)))
    model, speeds = milling_model(case), spindle_speeds(case)
    return chosen_method(case).limits(model, speeds, depths, fixed_steps(case), no_progress)


def _zero_order(case: Case) -> ZeroOrderLimit:
    return zero_order_of(milling_model(case), spindle_speeds(case))


def _finite(before: LimitCurve, after: LimitCurve) -> tuple[Array, Array, Array]:
    old, new = before.critical_depth, after.critical_depth
    both = np.isfinite(old) & np.isfinite(new)
    return rpm(before.spindle_speed[both]), old[both], new[both]


def _largest_change(before: LimitCurve, after: LimitCurve) -> float:
    _, old, new = _finite(before, after)
    appeared = np.isfinite(before.critical_depth) != np.isfinite(after.critical_depth)
    if appeared.any() or old.size == 0:
        return 1.0 if appeared.any() else 0.0
    return float(np.max(np.abs(new / old - 1.0)))


def _change(before: LimitCurve, after: LimitCurve, length: UsualUnit) -> str:
    speed, old, new = _finite(before, after)
    if old.size == 0:
        return "no limit lies within the depths searched in both."
    if _largest_change(before, after) < _SAME:
        return "the limits stay as they are."
    ratio = new / old
    most = int(np.argmax(np.abs(np.log(ratio))))
    lowest = [length.factor * float(values.min()) for values in (old, new)]
    return (
        f"the lowest limit goes from {lowest[0]:.3g} to {lowest[1]:.3g} {length.name}; at half of "
        f"the speeds the limit is multiplied by {np.median(ratio):.2f} or less, and most changes "
        f"at {speed[most]:.0f} rpm (from {length.factor * old[most]:.3g} to "
        f"{length.text(float(new[most]), '.3g')})."
    )
