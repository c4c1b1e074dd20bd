"""Spindle-speed variation for a cut that chatters or has little in hand."""

from __future__ import annotations

import math
from typing import NamedTuple

from chatter.description.case import Case
from chatter.stability.check import check
from chatter.stability.pockets import DEPTH_MARGIN

#: amplitudes that are tried, share of the mean speed
_AMPLITUDES = (0.1, 0.2)
#: revolutions in a period of the variation; a drive follows it below some 5 Hz
_REVOLUTIONS = 20.0
#: gain of the limit from which variation is worth its wear
_HELPS = 1.1


class Variation(NamedTuple):
    """A variation of the speed that raises the limit."""

    amplitude: float  # share of the mean speed
    frequency: float  # Hz
    limit: float | None  # m; None where none was found


def variation_that_helps(case: Case, limit: float) -> Variation | None:
    """The sinusoidal variation of the most depth, where it is a tenth more than without.

    Nothing is tried where the cut, of a limit in m, keeps the usual margin as it is, varies its
    speed already, or is on a machine, whose modes hold at one speed.
    """
    cut = case.cut
    in_hand = cut.axial_depth <= (1.0 - DEPTH_MARGIN) * limit
    if in_hand or cut.speed_variation is not None or case.on_machine:
        return None
    frequency = cut.spindle_speed / (2.0 * math.pi * _REVOLUTIONS)
    best = max(
        (_with_variation(case, amplitude, frequency) for amplitude in _AMPLITUDES),
        key=lambda one: math.inf if one.limit is None else one.limit,
    )
    return best if best.limit is None or best.limit > _HELPS * limit else None


def _with_variation(case: Case, amplitude: float, frequency: float) -> Variation:
    varied = case.patch({"cut.speed_variation": {"amplitude": amplitude, "frequency": frequency}})
    limit = check(varied).critical_depth
    return Variation(amplitude, frequency, limit if math.isfinite(limit) else None)
