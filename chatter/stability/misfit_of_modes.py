"""What the modes fitted to a machine make of its limit, for methods that need modes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from chatter.compile.structure import GivenModes
from chatter.description.unit_system import units_of
from chatter.description.units import rpm
from chatter.description.usual_units import UsualUnit
from chatter.stability.methods.zeroth_order.limits import zero_order_of
from chatter.stability.model import MillingModel
from chatter.stability.neglected_effects import NeglectedEffect
from chatter.stability.stability_method import StabilityMethod

#: change of the zeroth-order limit by the fit that is worth a note
_REPORTED = 0.03


def neglected_misfit_of_modes(
    model: MillingModel, method: StabilityMethod
) -> tuple[NeglectedEffect, ...]:
    """What a method that takes real modes misses of the receptance of a machine.

    Zeroth-order limits at the speed of the case, of the receptance and of the modes that were
    fitted to it. None where the method takes the receptance, or both agree.
    """
    if model.case.structure.machine is None or method.takes_frfs or not method.is_linear:
        return ()
    speed = np.array([model.case.cut.spindle_speed])
    fitted = replace(model, structure=GivenModes(tuple(model.structure.modes)))
    here, of_modes = (float(zero_order_of(one, speed).critical_depth[0]) for one in (model, fitted))
    if here == of_modes or math.isclose(here, of_modes, rel_tol=_REPORTED):
        return ()
    ratio = here / of_modes if math.isfinite(of_modes) else 0.0
    length = units_of(model.case).length
    told = (
        f"the real modes that this method takes make the zeroth-order limit at "
        f"{rpm(float(speed[0])):.0f} rpm {_shown(of_modes, length)}, the receptance of the machine "
        f"itself {_shown(here, length)}"
    )
    return (
        NeglectedEffect(
            name="real modes",
            share=abs(ratio - 1.0) if math.isfinite(ratio) else math.nan,
            lowest=min(ratio, 1.0),
            highest=max(ratio, 1.0),
            because=told,
            note=f"{told}; --method zero-order takes the receptance, the time domain the machine",
        ),
    )


def _shown(depth: float, length: UsualUnit) -> str:
    return length.text(depth, ".3g") if math.isfinite(depth) else "none"
