"""Effects of the sensors: the resonance of the dynamometer."""

from __future__ import annotations

import numpy as np

from chatter.explain.effects.effect import Effect, Values, free
from chatter.explain.fitting import Parameter
from chatter.explain.measurement import Measurement


class Dynamometer(Effect):
    """Resonance of the force sensor."""

    name = "dynamometer"
    label = "dynamometer resonance"
    help = "the force sensor has a resonance of its own"
    kinds = ("milling",)
    section = "dynamometer"

    def applies(self, measurement: Measurement) -> bool:
        """Of forces measured by a sensor without a declared resonance."""
        measured = any("Fx" in run.signals for run in measurement.runs)
        return measured and measurement.case.dynamometer is None

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Frequency and damping."""
        return [
            free("frequency", 2000.0, 30.0, "Hz", lower=100.0, upper=5e4),
            Parameter("damping", 0.03, 0.02, 0.002, 0.7, True, ""),
        ]

    def starts(self, measurement: Measurement) -> list[Values]:
        """Frequencies up to beyond the highest that is recorded."""
        highest = 0.5 / float(np.median(np.diff(measurement.runs[0].signals["time"])))
        return [{"frequency": float(f)} for f in np.geomspace(400.0, 1.2 * highest, 14)]
