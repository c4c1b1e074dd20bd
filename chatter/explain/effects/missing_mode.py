"""A mode that the structure lacks."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from chatter.description.case import Case
from chatter.explain.effects.effect import Effect, Patch, Reported, Signals, Values, free
from chatter.explain.effects.resembling_modes import resembling_modes
from chatter.explain.effects.structure import has_modes, stiffness_of
from chatter.explain.fitting import Parameter
from chatter.explain.measurement import Measurement

#: compliance of a mode that is not small, as a share of that of the most compliant known one
_SIZABLE = 0.5
#: lowest and highest natural frequency, Hz
_LOWEST, _HIGHEST = 5.0, 2e4


class MissingMode(Effect):
    """One mode more, in the plane of the cut."""

    name = "missing_mode"
    label = "missing mode"
    help = "the structure has a mode more"
    kinds = ("milling", "frf", "stability")

    def applies(self, measurement: Measurement) -> bool:
        """Of a structure of modes."""
        return has_modes(measurement)

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Frequency, damping, compliance and direction; no compliance: no mode."""
        modes = measurement.case.structure.mode
        compliance = max(1.0 / stiffness_of(m.frequency, m.modal_mass) for m in modes)
        lowest, highest = _band(measurement)
        return [
            free("frequency", 300.0, 5.0, "Hz", lower=lowest, upper=highest),
            Parameter("damping", 0.03, 0.01, 0.002, 0.3, True, ""),
            free("compliance", 0.01 * compliance, 0.02 * compliance, "m/N", lower=0.0),
            free("angle", 0.0, 0.3, "rad"),
        ]

    def nothing(self, measurement: Measurement) -> Values:
        """No compliance."""
        return {"compliance": 0.0}

    def patch(self, case: Case, values: Values) -> Patch:
        """Modes of the structure."""
        known = [mode.model_dump(exclude_none=True) for mode in case.structure.mode]
        angle = float(values["angle"])
        added = {
            "frequency": float(values["frequency"]),
            "damping": float(values["damping"]),
            "mass": self._mass(values),
            "direction": [math.cos(angle), math.sin(angle), 0.0],
            "side": "tool",
        }
        return {"structure.mode": [*known, added]}

    def starts(self, measurement: Measurement) -> list[Values]:
        """Frequencies around and between the known modes, along x and y."""
        known = sorted(mode.frequency for mode in measurement.case.structure.mode)
        frequencies = np.geomspace(0.3 * known[0], 2.5 * known[-1], 14)
        return [
            {"frequency": float(frequency), "angle": angle}
            for angle in (0.0, 0.5 * math.pi)
            for frequency in frequencies
        ]

    def sizable_starts(self, measurement: Measurement) -> list[Values]:
        """The same, half as compliant as the most compliant mode."""
        modes = measurement.case.structure.mode
        most = max(1.0 / stiffness_of(one.frequency, one.modal_mass) for one in modes)
        return [{**one, "compliance": _SIZABLE * most} for one in self.starts(measurement)]

    def proposed(
        self, measurement: Measurement, predicted: Mapping[str, Signals]
    ) -> Sequence[Values]:
        """Modes whose answer to the forces resembles the residual of displacements or FRFs."""
        return resembling_modes(measurement, predicted)

    def reported(self, values: Values) -> Reported:
        """Frequency, damping, mass, and the direction as an angle from x within half a turn."""
        return {
            "frequency": (values["frequency"], "Hz"),
            "damping": (values["damping"], ""),
            "mass": (self._mass(values), "kg"),
            "direction": (values["angle"] % math.pi, "rad"),
        }

    @staticmethod
    def _mass(values: Values) -> float:
        compliance = max(float(values["compliance"]), 1e-16)
        return 1.0 / compliance / (2.0 * math.pi * float(values["frequency"])) ** 2


def _band(measurement: Measurement) -> tuple[float, float]:
    """Frequencies between which a mode is sought, Hz: where all are FRFs, those measured.

    Of a mode beyond them an FRF shows no more than a stiffness or a mass.
    """
    lines = [run.signals.get("frequency") for run in measurement.runs]
    if not lines or any(one is None for one in lines):
        return _LOWEST, _HIGHEST
    return (
        max(_LOWEST, *(float(one.min()) for one in lines)),
        min(_HIGHEST, *(float(one.max()) for one in lines)),
    )
