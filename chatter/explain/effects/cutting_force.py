"""Effects of the cutting force and its sensor: edge force, chip exponent, process damping."""

import itertools

import numpy as np

from chatter.description.case import Case
from chatter.explain.effects.effect import Effect, Patch, Values, free
from chatter.explain.fitting import Parameter
from chatter.explain.measurement import Measurement

#: reference thickness of the exponential law where the case has none, m
_H0 = 1e-4
#: tangential over radial process damping where the case has none
_FRICTION = 0.3
#: start frequencies of a resonance of one axis beside that of another
_STARTS_AN_AXIS = 10


class EdgeForce(Effect):
    """Force of the edge that rubs."""

    name = "edge_force"
    label = "edge force"
    help = "the edge rubs with a force that does not depend on the chip"
    kinds = ("milling",)
    section = "material"

    def applies(self, measurement: Measurement) -> bool:
        """Of laws with edge coefficients that are not declared."""
        material = measurement.case.material
        return material.law != "oblique" and not (material.Kte or material.Kre)

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Edge coefficients."""
        return [free(key, 0.0, 5e3, "N/m", lower=0.0) for key in ("Kte", "Kre")]


class ChipExponent(Effect):
    """Exponential law in the place of the linear one."""

    name = "chip_exponent"
    label = "exponential chip thickness law"
    help = "thin chips take more force per thickness than thick ones"
    kinds = ("milling",)

    def applies(self, measurement: Measurement) -> bool:
        """Of the linear law."""
        return measurement.case.material.law == "linear"

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """The exponent."""
        return [free("exponent", 1.0, 0.03, "", lower=0.3, upper=1.0)]

    def nothing(self, measurement: Measurement) -> Values:
        """The linear law."""
        return {"exponent": 1.0}

    def patch(self, case: Case, values: Values) -> Patch:
        """Law of the material."""
        return {
            "material.law": "exponential",
            "material.h0": case.material.h0 or _H0,
            "material.exponent": float(values["exponent"]),
        }


class ProcessDamping(Effect):
    """Viscous process damping of the flank."""

    name = "process_damping"
    label = "process damping"
    help = "the flank resists vibration into the work, the more the slower the cut"
    kinds = ("milling", "stability")
    declared = "process_damping"

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """The coefficient."""
        return [free("coefficient", 0.0, 5e4, "N/m", lower=0.0)]

    def patch(self, case: Case, values: Values) -> Patch:
        """Process damping, with the friction that is declared."""
        friction = case.process_damping.friction if case.process_damping else _FRICTION
        coefficient = float(values["coefficient"])
        return {"process_damping": {"coefficient": coefficient, "friction": friction}}

    def starts(self, measurement: Measurement) -> list[Values]:
        """From none to much."""
        return [{"coefficient": value} for value in (0.0, 5e4, 2e5, 8e5)]


class Dynamometer(Effect):
    """Resonance of the force sensor."""

    name = "dynamometer"
    label = "dynamometer resonance"
    help = "the force sensor has a resonance of its own"
    kinds = ("milling",)
    section = "dynamometer"

    @property
    def variants(self) -> tuple[Effect, ...]:
        """One resonance of all axes, or one of each."""
        return (self, DynamometerOfAxes())

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


class DynamometerOfAxes(Dynamometer):
    """A resonance of the force sensor along each axis."""

    @property
    def variants(self) -> tuple[Effect, ...]:
        """None: it is one of a family."""
        return (self,)

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """Frequency and damping along each axis that is measured."""
        found = []
        for axis in _axes(measurement):
            size = {"lower": 100.0, "upper": 5e4}
            found.append(free(f"frequency_{axis}", 2000.0, 30.0, "Hz", **size))
            found.append(Parameter(f"damping_{axis}", 0.03, 0.02, 0.002, 0.7, True, ""))
        return found

    def patch(self, case: Case, values: Values) -> Patch:
        """Resonances by axis."""
        axes = [key.removeprefix("frequency_") for key in values if key.startswith("frequency_")]
        return {
            "dynamometer": {
                "resonance": [
                    {
                        "frequency": float(values[f"frequency_{axis}"]),
                        "damping": float(values[f"damping_{axis}"]),
                        "axis": axis,
                    }
                    for axis in axes
                ]
            }
        }

    def starts(self, measurement: Measurement) -> list[Values]:
        """Frequencies of the first two axes apart; a third one as the first."""
        highest = 0.5 / float(np.median(np.diff(measurement.runs[0].signals["time"])))
        grid = np.geomspace(400.0, 1.2 * highest, _STARTS_AN_AXIS)
        axes = _axes(measurement)
        return [
            {f"frequency_{axis}": float(pair[k % 2]) for k, axis in enumerate(axes)}
            for pair in itertools.product(grid, repeat=2)
        ]


def _axes(measurement: Measurement) -> list[str]:
    """Axes along which every run has a force."""
    return [axis for axis in "xyz" if all(f"F{axis}" in run.signals for run in measurement.runs)]
