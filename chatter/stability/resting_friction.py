"""What frictions at rest do to the limits of a machine, for the reader of linear limits."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from chatter.description.units import rpm
from chatter.stability.methods.zeroth_order.limits import zero_order_of
from chatter.stability.model import MillingModel
from chatter.stability.neglected_effects import NeglectedEffect

if TYPE_CHECKING:
    from chatter.compile.linearised_machine import LinearisedMachine
    from dynamics.friction.laws import FrictionLaw

#: change of the limit by what sticks that is worth a note
_REPORTED = 0.02
#: frequency, Hz, and velocity, m/s (rad/s), of sliding at which frictions are compared
_LINE, _SLOW = 1.0, 1e-6


def neglected_resting_friction(model: MillingModel) -> tuple[NeglectedEffect, ...]:
    """What the limit at the speed of the case is with resting frictions stuck and without.

    Zeroth-order limits: what is compared is the structures. None where no friction rests, or where
    it makes no difference.
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
    if math.isclose(stuck, free, rel_tol=_REPORTED) and math.isclose(here, free, rel_tol=_REPORTED):
        return ()
    laws = {one.name: one.law for one in structure.cut.machine.frictions}
    ways = {name: _giving_way(laws[name]) for name in names}
    listed = ", ".join(f"{name} {way:.2g}" for name, way in ways.items() if way > 0.0)
    how_far = f"; they slide from (m or rad of their own motion): {listed}" if listed else ""
    taken = "as stuck" if amplitude == 0.0 else f"at vibration of {1e6 * amplitude:g} um"
    note = (
        f"frictions of axes at rest ({', '.join(names)}) are taken {taken} "
        f"(structure.friction_amplitude): at {rpm(speed):.0f} rpm the zeroth-order limit is "
        f"{_shown(here)} so, {_shown(stuck)} with them stuck, as under vanishing vibration, and "
        f"{_shown(free)} without them{how_far}"
    )
    low, high = min(stuck, free), max(stuck, free)
    effect = NeglectedEffect(
        name="resting friction",
        share=high / low - 1.0,
        lowest=min(low / here, 1.0) if math.isfinite(here) else 0.0,
        highest=max(high / here, 1.0) if math.isfinite(here) else 1.0,
        because=f"frictions of axes at rest make the limit anything from {_shown(low)} to "
        f"{_shown(high)}, by the amplitude of vibration (zeroth order)",
        note=note,
    )
    return (effect,)


def notes_on_resting_friction(model: MillingModel) -> tuple[str, ...]:
    """Say what the limit at the speed of the case is with resting frictions stuck and without."""
    return tuple(effect.note for effect in neglected_resting_friction(model))


def _shown(depth: float) -> str:
    return f"{depth * 1e3:.3g} mm" if math.isfinite(depth) else "none"


def _giving_way(law: FrictionLaw) -> float:
    """Displacement, m (rad), at which the spring at rest carries the force of slow sliding."""
    spring = np.real(law.stiffness_at_rest(np.array([_LINE])))[0]
    return float(np.abs(law.steady_state_force(np.array([_SLOW])))[0] / spring)
