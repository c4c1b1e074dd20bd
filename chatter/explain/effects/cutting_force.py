"""Effects of the cutting force: edge force, chip exponent, process damping."""

import math

from chatter.description.case import Case
from chatter.explain.effects.effect import Effect, Patch, Values, free
from chatter.explain.measurement import Measurement
from chatter.explain.parameters import Parameter

#: reference thickness of the exponential law where the case has none, m
_H0 = 1e-4
#: tangential over radial process damping where the case has none
_FRICTION = 0.3
#: process damping that is little, N/m at the least, and as a share of Ktc V / omega
_LEAST_USUAL_DAMPING, _USUAL_DAMPING = 5e4, 0.02


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

    @property
    def richer(self) -> tuple[Effect, ...]:
        """Radial forces that level off sooner, or later, than the tangential ones."""
        return (ChipExponentByDirection(),)

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


class ChipExponentByDirection(ChipExponent):
    """Exponential law whose radial forces have an exponent of their own."""

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """The exponents."""
        names = ("exponent", "radial_exponent")
        return [free(name, 1.0, 0.03, "", lower=0.1, upper=1.0) for name in names]

    def nothing(self, measurement: Measurement) -> Values:
        """The linear law."""
        return {"exponent": 1.0, "radial_exponent": 1.0}

    def patch(self, case: Case, values: Values) -> Patch:
        """Law of the material."""
        radial = float(values["radial_exponent"])
        return {**super().patch(case, values), "material.radial_exponent": radial}


class ProcessDamping(Effect):
    """Viscous process damping of the flank."""

    name = "process_damping"
    label = "process damping"
    help = "the flank resists vibration into the work, the more the slower the cut"
    kinds = ("milling", "stability")
    declared = "process_damping"

    def parameters(self, measurement: Measurement) -> list[Parameter]:
        """The coefficient."""
        return [free("coefficient", 0.0, _usual_damping(measurement.case), "N/m", lower=0.0)]

    def patch(self, case: Case, values: Values) -> Patch:
        """Process damping, with the friction that is declared."""
        friction = case.process_damping.friction if case.process_damping else _FRICTION
        coefficient = float(values["coefficient"])
        return {"process_damping": {"coefficient": coefficient, "friction": friction}}

    def starts(self, measurement: Measurement) -> list[Values]:
        """From none to much."""
        usual = _usual_damping(measurement.case)
        return [{"coefficient": factor * usual} for factor in (0.0, 1.0, 4.0, 16.0)]


def _usual_damping(case: Case) -> float:
    """Coefficient of a small process damping, N/m.

    Its force over the amplitude is C b omega / V, that of the chip is Ktc b: what counts is in
    proportion to Ktc V / omega, which is large where a heavy structure vibrates slowly.
    """
    material, cut, tool, structure = case.material, case.cut, case.tool, case.structure
    modes = structure.mode if structure is not None else ()
    Ktc = getattr(material, "Ktc", None)
    if not modes or not Ktc or cut is None or tool is None:
        return _LEAST_USUAL_DAMPING
    omega = 2.0 * math.pi * min(mode.frequency for mode in modes)
    speed = 0.5 * tool.diameter * cut.spindle_speed
    return max(_LEAST_USUAL_DAMPING, _USUAL_DAMPING * Ktc * speed / omega)
