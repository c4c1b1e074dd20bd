"""Effects of the drive of a feed axis: offset, cogging, backlash."""

from __future__ import annotations

import numpy as np

from chatter.description.case import Case
from chatter.explain.effects.axis_friction import AxisValue, typical_force
from chatter.explain.effects.effect import Effect, Patch, Reported, Values, free, polar
from chatter.explain.fitting import Parameter
from chatter.explain.measurement import Measurement


class Offset(AxisValue):
    """Constant force."""

    name = "offset"
    label = "constant force"
    help = "a constant force is held, as of weight"


class Cogging(Effect):
    """Sine of the position, as two components so that none is singular where there is none."""

    name = "cogging"
    label = "cogging"
    help = "a force repeats along the axis"
    kinds = ("axis",)

    def applies(self, measurement: Measurement) -> bool:
        """Where none is declared."""
        return measurement.case.axis.cogging is None

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Both components, and the period."""
        force = 0.05 * typical_force(measurement)
        return [
            free("sine", 0.0, force, "N"),
            free("cosine", 0.0, force, "N"),
            free("period", 0.01, 2e-5, "m", lower=2e-4, upper=0.5),
        ]

    def patch(self, case: Case, values: Values) -> Patch:
        """Cogging of the axis."""
        return {"axis.cogging": {key: value for key, (value, _) in self.reported(values).items()}}

    def starts(self, measurement: Measurement) -> list[Values]:
        """Periods spaced evenly in cycles over the travel, so that none is missed."""
        travel = max(float(np.ptp(run.signals["position"])) for run in measurement.runs)
        return [{"period": travel / cycles} for cycles in np.linspace(1.0, 20.0, 60)]

    def reported(self, values: Values) -> Reported:
        """Amplitude, period and phase."""
        amplitude, phase = polar(values["sine"], values["cosine"])
        return {
            "amplitude": (amplitude, "N"),
            "period": (float(values["period"]), "m"),
            "phase": (phase, "rad"),
        }


class Backlash(Effect):
    """Gap of the drive, and the mass of its motor where the motion of both sides is known."""

    name = "backlash"
    label = "backlash"
    help = "the motor crosses a gap at every reversal"
    kinds = ("axis",)
    section = "axis"

    def applies(self, measurement: Measurement) -> bool:
        """Where none is declared."""
        return not measurement.case.axis.backlash

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """The gap, and the mass of the motor."""
        gap = free("backlash", 2e-5, 5e-6, "m", lower=0.0, upper=1e-3)
        if not any("backlash" in run.signals for run in measurement.runs):
            return [gap]
        mass = measurement.case.axis.moving_mass
        return [gap, free("motor_mass", 0.2 * mass, 0.05 * mass, "kg", lower=0.0, upper=mass)]

    def starts(self, measurement: Measurement) -> list[Values]:
        """Gaps from small to large."""
        return [{"backlash": gap} for gap in (3e-6, 1e-5, 3e-5, 1e-4)]
