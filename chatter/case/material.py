"""[material]: force law and coefficients, or the name of a row of the table of materials."""

from __future__ import annotations

import difflib
from typing import Any, Literal

from pydantic import Field, model_validator

from chatter.case.base import Section, SectionError, raise_if_any
from chatter.case.quantities import PositiveLength, quantity
from cutting.force_law import Coefficients, oblique_cutting_coefficients
from cutting.material_table import MATERIALS

Pressure = quantity("pressure")
PositivePressure = quantity("pressure", above=0.0)
LineForce = quantity("line_force")
ShearAngle = quantity("angle", above=0.0, below=1.5707963267948966)
FrictionAngle = quantity("angle", at_least=0.0, below=1.5707963267948966)
RakeAngle = quantity("angle", above=-1.5707963267948966, below=1.5707963267948966)

_CUTTING = ("Ktc", "Krc", "Kac")
_EDGE = ("Kte", "Kre", "Kae")
_EXPONENTIAL = ("h0", "exponent")
_OBLIQUE = ("shear_stress", "friction_angle", "shear_angle", "rake_angle")


class Material(Section):
    """Cutting coefficients: pressures in Pa, edge coefficients in N/m."""

    law: Literal["linear", "exponential", "oblique"] = "linear"
    name: str | None = Field(None, description="row of the table of materials")
    Ktc: PositivePressure | None = None
    Krc: Pressure = 0.0
    Kac: Pressure = 0.0
    Kte: LineForce = 0.0
    Kre: LineForce = 0.0
    Kae: LineForce = 0.0
    h0: PositiveLength | None = Field(None, description="reference chip thickness")
    exponent: quantity("number", above=0.0, at_most=1.0) | None = None
    shear_stress: PositivePressure | None = None
    friction_angle: FrictionAngle | None = None
    shear_angle: ShearAngle | None = None
    rake_angle: RakeAngle | None = None

    @model_validator(mode="before")
    @classmethod
    def _take_named_row(cls, data: Any) -> Any:
        if not isinstance(data, dict) or not isinstance(data.get("name"), str):
            return data
        row = MATERIALS.get(data["name"])
        if row is None:
            near = difflib.get_close_matches(data["name"], MATERIALS, n=1, cutoff=0.4)
            hint = f'; did you mean "{near[0]}"?' if near else ""
            known = ", ".join(f'"{name}"' for name in MATERIALS)
            text = f'"{data["name"]}" is not in the table of materials{hint} There are {known}'
            raise SectionError([("name", text)])
        return {**row.coefficients(), **data}

    @model_validator(mode="after")
    def _check_law(self) -> Material:
        wanted = {"linear": ("Ktc",), "exponential": ("Ktc", *_EXPONENTIAL), "oblique": _OBLIQUE}
        problems = [
            (key, f'is missing; law = "{self.law}" needs it')
            for key in wanted[self.law]
            if getattr(self, key) is None
        ]
        foreign = {
            "linear": (*_EXPONENTIAL, *_OBLIQUE),
            "exponential": _OBLIQUE,
            "oblique": (*_EXPONENTIAL, "Ktc"),
        }
        problems += [
            (key, f'does not belong to law = "{self.law}"')
            for key in foreign[self.law]
            if getattr(self, key) is not None
        ]
        raise_if_any(problems)
        return self

    def cutting_coefficients(self, inclination: float) -> Coefficients:
        """Return K_tc, K_rc, K_ac (N/m^2) for an edge inclined by an angle (the helix), rad."""
        if self.law == "oblique":
            return oblique_cutting_coefficients(
                self.shear_stress,
                self.friction_angle,
                self.shear_angle,
                self.rake_angle,
                inclination,
            )
        return (self.Ktc, self.Krc, self.Kac)

    @property
    def edge_coefficients(self) -> Coefficients:
        """K_te, K_re, K_ae, N/m."""
        return (self.Kte, self.Kre, self.Kae)
