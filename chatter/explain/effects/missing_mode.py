"""A mode that the structure lacks, or the modes of a tool that was taken as rigid."""

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from chatter.description.case import Case
from chatter.explain.effects.effect import Effect, Patch, Reported, Signals, Values, free
from chatter.explain.effects.resembling_modes import resembling_modes
from chatter.explain.effects.structure import has_modes, stiffness_of
from chatter.explain.measurement import Measurement
from chatter.explain.parameters import Parameter

#: compliance of a mode that is not small, as a share of that of the most compliant known one
_SIZABLE = 0.5
#: lowest and highest natural frequency, Hz
_LOWEST, _HIGHEST = 5.0, 2e4
#: of a tool that was taken as rigid: natural frequencies between which a mode is sought first, Hz,
#: and the compliance of a usual one, m/N
_USUAL, _USUAL_COMPLIANCE = (150.0, 3000.0), 5e-8
#: lowest frequency sought over the lowest of known modes, and highest over the highest
_AROUND = (0.3, 2.5)
#: angles from x, rad, and start frequencies of either of two modes
_ANGLES = {"x": 0.0, "y": 0.5 * math.pi}
_STARTS_AN_AXIS = 10


class MissingMode(Effect):
    """One mode more, in the plane of the cut."""

    name = "missing_mode"
    label = "missing mode"
    help = "the structure has a mode more"
    kinds = ("milling", "frf", "stability")

    @property
    def variants(self) -> tuple[Effect, ...]:
        """A mode alone, or one along the feed and one across it where the tool was rigid."""
        return (self, ModesOfRigidTool())

    def applies(self, measurement: Measurement) -> bool:
        """Of a structure of modes, or a tool whose forces were measured and that has none."""
        return has_modes(measurement) or is_rigid(measurement)

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Frequency, damping, compliance and direction; no compliance: no mode."""
        compliance = _most_compliance(measurement)
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
        modes = case.structure.mode if case.structure else ()
        known = [mode.model_dump(exclude_none=True) for mode in modes]
        return {"structure.mode": [*known, _mode(values, float(values["angle"]))]}

    def starts(self, measurement: Measurement) -> list[Values]:
        """Frequencies around and between the known modes, along x and y."""
        frequencies = np.geomspace(*_sought(measurement), 14)
        return [
            {"frequency": float(frequency), "angle": angle}
            for angle in (0.0, 0.5 * math.pi)
            for frequency in frequencies
        ]

    def sizable_starts(self, measurement: Measurement) -> list[Values]:
        """The same, half as compliant as the most compliant mode."""
        most = _most_compliance(measurement)
        return [{**one, "compliance": _SIZABLE * most} for one in self.starts(measurement)]

    def proposed(
        self, measurement: Measurement, predicted: Mapping[str, Signals]
    ) -> Sequence[Values]:
        """Modes whose answer to the forces resembles the residual of displacements or FRFs."""
        return resembling_modes(measurement, predicted, _sought(measurement))

    def reported(self, values: Values) -> Reported:
        """Frequency, damping, mass, and the direction as an angle from x within half a turn."""
        return {
            "frequency": (values["frequency"], "Hz"),
            "damping": (values["damping"], ""),
            "mass": (_mass(values), "kg"),
            "direction": (values["angle"] % math.pi, "rad"),
        }


class ModesOfRigidTool(MissingMode):
    """A mode along the feed and one across it, of a tool that was taken as rigid."""

    @property
    def variants(self) -> tuple[Effect, ...]:
        """None: it is one of a family."""
        return (self,)

    def applies(self, measurement: Measurement) -> bool:
        """Of a tool without a structure whose forces were measured in the plane of the cut."""
        told = all({"Fx", "Fy"} <= set(run.signals) for run in measurement.runs)
        return is_rigid(measurement) and told

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Frequency, damping and compliance of either mode."""
        return [
            replace(one, name=f"{one.name}_{axis}")
            for axis in "xy"
            for one in super(ModesOfRigidTool, self).parameters(measurement)
            if one.name != "angle"
        ]

    def nothing(self, measurement: Measurement) -> Values:
        """No compliance of either."""
        del measurement
        return {"compliance_x": 0.0, "compliance_y": 0.0}

    def patch(self, case: Case, values: Values) -> Patch:
        """Modes of the structure."""
        del case
        modes = [_mode(_along(values, axis), _ANGLES[axis]) for axis in "xy"]
        return {"structure.mode": modes}

    def starts(self, measurement: Measurement) -> list[Values]:
        """Every frequency of the one with every one of the other."""
        grid = np.geomspace(*_sought(measurement), _STARTS_AN_AXIS)
        return [
            {f"frequency_{axis}": float(one) for axis, one in zip("xy", pair, strict=True)}
            for pair in itertools.product(grid, repeat=2)
        ]

    def sizable_starts(self, measurement: Measurement) -> list[Values]:
        """The same, both half as compliant as a usual mode."""
        own = {f"compliance_{axis}": _SIZABLE * _most_compliance(measurement) for axis in "xy"}
        return [{**one, **own} for one in self.starts(measurement)]

    def proposed(
        self, measurement: Measurement, predicted: Mapping[str, Signals]
    ) -> Sequence[Values]:
        """None: the starts cover the plane."""
        del measurement, predicted
        return []

    def reported(self, values: Values) -> Reported:
        """Frequency, damping and mass of either."""
        found = {}
        for axis in "xy":
            own = _along(values, axis)
            found[f"frequency_{axis}"] = (own["frequency"], "Hz")
            found[f"damping_{axis}"] = (own["damping"], "")
            found[f"mass_{axis}"] = (_mass(own), "kg")
        return found


def is_rigid(measurement: Measurement) -> bool:
    """Whether a cut was measured and the declared tool has no structure at all."""
    return measurement.case.structure is None and "milling" in measurement.kinds


def _mode(values: Values, angle: float) -> dict[str, Any]:
    """Mode of the tool in a case, at an angle from x in the plane of the cut, rad."""
    return {
        "frequency": float(values["frequency"]),
        "damping": float(values["damping"]),
        "mass": _mass(values),
        "direction": [math.cos(angle), math.sin(angle), 0.0],
        "side": "tool",
    }


def _along(values: Values, axis: str) -> dict[str, float]:
    """Numbers of the mode along an axis."""
    return {key: float(values[f"{key}_{axis}"]) for key in ("frequency", "damping", "compliance")}


def _mass(values: Values) -> float:
    """Modal mass, kg, of a compliance, m/N, and a frequency, Hz."""
    compliance = max(float(values["compliance"]), 1e-16)
    return 1.0 / compliance / (2.0 * math.pi * float(values["frequency"])) ** 2


def _most_compliance(measurement: Measurement) -> float:
    """Compliance, m/N, of the most compliant mode that is known; a usual one where none is."""
    if not has_modes(measurement):
        return _USUAL_COMPLIANCE
    modes = measurement.case.structure.mode
    return max(1.0 / stiffness_of(m.frequency, m.modal_mass) for m in modes)


def _sought(measurement: Measurement) -> tuple[float, float]:
    """Frequencies around the known modes between which another is sought first, Hz."""
    if not has_modes(measurement):
        return _USUAL
    known = sorted(mode.frequency for mode in measurement.case.structure.mode)
    return _AROUND[0] * known[0], _AROUND[1] * known[-1]


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
