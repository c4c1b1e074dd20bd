"""What frictions that stick do to the limits of a machine, for the reader of linear limits."""

import math
from dataclasses import replace

import numpy as np

from chatter.compile.linearised_machine import LinearisedMachine
from chatter.description.units import rpm
from chatter.stability.methods.zeroth_order.limits import zero_order_of
from chatter.stability.model import MillingModel
from dynamics.friction.laws import FrictionLaw

#: change of the limit by what sticks that is worth a note
_REPORTED = 0.02
#: frequency, Hz, and velocity, m/s (rad/s), of sliding at which frictions are compared
_LINE, _SLOW = 1.0, 1e-6


def notes_on_resting_friction(model: MillingModel) -> tuple[str, ...]:
    """Say what the limit at the speed of the case is with resting frictions stuck and without.

    Zeroth-order limits: what is compared is the two structures. None where no friction sticks, or
    where it makes no difference.
    """
    structure = model.structure
    if not isinstance(structure, LinearisedMachine) or not structure.sticking:
        return ()
    speed = model.case.cut.spindle_speed
    freed = replace(model, structure=structure.without_sticking())
    stuck, free = (
        float(zero_order_of(one, np.array([speed])).critical_depth[0]) for one in (model, freed)
    )
    if math.isclose(stuck, free, rel_tol=_REPORTED):
        return ()
    laws = {one.name: one.law for one in structure.cut.machine.frictions}
    ways = {name: _giving_way(laws[name]) for name in structure.sticking}
    listed = ", ".join(f"{name} from {way:.2g}" for name, way in ways.items() if way > 0.0)
    how_far = f" (in m or rad of its own motion: {listed})" if listed else ""
    names = ", ".join(structure.sticking)
    return (
        f"frictions of axes at rest ({names}) are taken as stuck: at {rpm(speed):.0f} rpm the "
        f"zeroth-order limit is {_shown(stuck)} with them stuck and {_shown(free)} without them; "
        "the first holds only for vanishing vibration. Where the vibration of the cut, that by the "
        f"teeth included, makes them give way{how_far}, they dissipate, and the time domain is "
        f"expected to show about {_shown(free)} or more; structure.friction_amplitude linearises "
        "them at a stated amplitude",
    )


def _shown(depth: float) -> str:
    return f"{depth * 1e3:.3g} mm" if math.isfinite(depth) else "none"


def _giving_way(law: FrictionLaw) -> float:
    """Displacement, m (rad), at which the spring at rest carries the force of slow sliding."""
    spring = np.real(law.stiffness_at_rest(np.array([_LINE])))[0]
    return float(np.abs(law.steady_state_force(np.array([_SLOW])))[0] / spring)
