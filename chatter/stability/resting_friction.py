"""What frictions at rest do to the limits of a machine, for the reader of linear limits."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from chatter.description.arrays import Array
from chatter.description.unit_system import units_of
from chatter.description.units import rpm
from chatter.description.usual_units import UsualUnit
from chatter.stability.methods.zeroth_order.limits import zero_order_of
from chatter.stability.methods.zeroth_order.uniform_pitch import ZeroOrderLimit
from chatter.stability.model import MillingModel
from chatter.stability.neglected_effects import NeglectedEffect

if TYPE_CHECKING:
    from chatter.compile.linearised_machine import LinearisedMachine
    from dynamics.friction.laws import FrictionLaw

#: change of the limit by what sticks that is worth a note
_REPORTED = 0.02
#: amplitudes, m, at which the limit is looked at beside that of the case: presliding damps most at
#: some of them, so that the limit there may be above that of either end
_AMPLITUDES = (0.3e-6, 2e-6, 20e-6)
#: frequency, Hz, and velocity, m/s (rad/s), of sliding at which frictions are compared
_LINE, _SLOW = 1.0, 1e-6


def neglected_resting_friction(model: MillingModel) -> tuple[NeglectedEffect, ...]:
    """What the limit at the speed of the case is by how far resting frictions vibrate.

    Stuck, at some amplitudes and without them. Zeroth-order limits: what is compared is the
    structures. None where no friction rests, or where it makes no difference.
    """
    if model.case.structure.machine is None:
        return ()
    from chatter.compile.linearised_machine import LinearisedMachine

    structure = model.structure
    if not isinstance(structure, LinearisedMachine) or not (names := structure.resting):
        return ()
    speed = model.case.cut.spindle_speed
    amplitude = model.case.structure.amplitude_at_frictions

    def limit(changed: LinearisedMachine) -> float:
        own = replace(model, structure=changed)
        return float(zero_order_of(own, np.array([speed])).critical_depth[0])

    here, stuck, free = map(limit, (structure, structure.with_stuck(), structure.without_resting()))
    at = {one: limit(structure.with_amplitude(one)) for one in _AMPLITUDES}
    limits = (stuck, *at.values(), here, free)
    low, high = min(limits), max(limits)
    if high == low or math.isclose(low, high, rel_tol=_REPORTED):
        return ()
    listed = ", ".join(_sliding_from(structure, names))
    how_far = f"; their own motion makes them slide from: {listed}" if listed else ""
    length = units_of(model.case).length
    taken = "as stuck" if amplitude == 0.0 else f"at vibration of {1e6 * amplitude:g} um"
    highest = _highest_at(at, max(stuck, here, free), length)
    note = (
        f"frictions of axes at rest ({', '.join(names)}) are taken {taken} "
        f"(structure.friction_amplitude): at {rpm(speed):.0f} rpm the zeroth-order limit is "
        f"{_shown(here, length)} so, {_shown(stuck, length)} with them stuck, as under "
        f"vanishing vibration, and {_shown(free, length)} without them{highest}{how_far}"
    )
    effect = NeglectedEffect(
        name="resting friction",
        share=high / low - 1.0,
        lowest=low / here if math.isfinite(here) else 0.0,
        highest=high / here if math.isfinite(here) else 1.0,
        because="frictions of axes at rest make the limit anything from "
        f"{_shown(low, length)} to {_shown(high, length)}, by the amplitude of vibration "
        "(zeroth order)",
        note=note,
    )
    return (effect,)


class LimitsAtRest(NamedTuple):
    """What frictions at rest leave of limits at least, whether they stick or are not there."""

    of_lowest: float  # factor of the lowest limit over speeds, at most 1
    here: Array  # zeroth-order limits at the speeds as the frictions are taken, m (n,)
    least: Array  # the lower of those with them stuck and without them, m (n,)

    def bounded(self, limits: Array) -> Array:
        """Limits, m, at the speeds by any method, less what the frictions may take of them."""
        known = np.isfinite(self.here)
        share = np.where(known, self.least, np.inf) / np.where(known, self.here, 1.0)
        return np.minimum(limits, np.where(known, limits * share, self.least))


def limits_with_resting_friction(model: MillingModel, here: ZeroOrderLimit) -> LimitsAtRest:
    """What resting frictions leave of limits over speeds: stuck or without, whichever is less.

    By zeroth-order limits over those as the frictions are taken, `here`; 1 where none rests.
    """
    all_of_it = LimitsAtRest(1.0, here.critical_depth, np.full(len(here.critical_depth), np.inf))
    if model.case.structure.machine is None:
        return all_of_it
    from chatter.compile.linearised_machine import LinearisedMachine

    structure = model.structure
    if not isinstance(structure, LinearisedMachine) or not structure.resting:
        return all_of_it
    if not math.isfinite(here.lowest_depth):
        return all_of_it
    stuck, free = (
        zero_order_of(replace(model, structure=one), here.spindle_speed)
        for one in (structure.with_stuck(), structure.without_resting())
    )
    of_lowest = min(stuck.lowest_depth, free.lowest_depth) / here.lowest_depth
    least = np.minimum(stuck.critical_depth, free.critical_depth)
    return LimitsAtRest(min(1.0, of_lowest), here.critical_depth, least)


def _highest_at(limits: Mapping[float, float], others: float, length: UsualUnit) -> str:
    """Say at which amplitude, m, a limit, m, is above all others; empty where none is."""
    amplitude, highest = max(limits.items(), key=lambda one: one[1])
    if highest <= others:
        return ""
    shown = _shown(highest, length)
    return f"; it is highest, {shown}, at vibration of about {1e6 * amplitude:g} um"


def _shown(depth: float, length: UsualUnit) -> str:
    return length.text(depth, ".3g") if math.isfinite(depth) else "none"


def _sliding_from(structure: LinearisedMachine, names: Sequence[str]) -> Iterator[str]:
    """Motion of each friction, along or about its axis, beyond which it slides, in words."""
    # the tables of machine files are needed here alone
    from chatter.description.machine.references import is_straight

    laws = {one.name: one.law for one in structure.cut.machine.frictions}
    file = structure.cut.file
    for name in names:
        way = _giving_way(laws[name])
        if way > 0.0:
            unit = "um" if is_straight(file, file.friction[name].on) else "urad"
            yield f"{name} {1e6 * way:.2g} {unit}"


def _giving_way(law: FrictionLaw) -> float:
    """Displacement, m (rad), at which the spring at rest carries the force of slow sliding."""
    spring = np.real(law.stiffness_at_rest(np.array([_LINE])))[0]
    return float(np.abs(law.steady_state_force(np.array([_SLOW])))[0] / spring)
