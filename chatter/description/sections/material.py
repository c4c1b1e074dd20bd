"""[material]: force law and coefficients, or the name of a row of the table of materials."""

from __future__ import annotations

import difflib
import math
from typing import Any, Literal

from pydantic import Field, model_validator

from chatter.description.formatting import shown
from chatter.description.quantities import PositiveLength, quantity
from chatter.description.section import Section, SectionError, raise_if_any
from cutting.force.force_law import Coefficients, oblique_cutting_coefficients
from cutting.material.table import MATERIALS

Pressure = quantity("pressure")
PositivePressure = quantity("pressure", above=0.0)
LineForce = quantity("line_force")
ShearAngle = quantity("angle", above=0.0, below=0.5 * math.pi)
FrictionAngle = quantity("angle", at_least=0.0, below=0.5 * math.pi)
RakeAngle = quantity("angle", above=-0.5 * math.pi, below=0.5 * math.pi)

_CUTTING = ("Ktc", "Krc", "Kac")
_EDGE = ("Kte", "Kre", "Kae")
_EXPONENTIAL = ("h0", "exponent")
_OBLIQUE = ("shear_stress", "friction_angle", "shear_angle", "rake_angle")


def _no_such_row(name: str) -> str:
    near = difflib.get_close_matches(name[:60], MATERIALS, n=1, cutoff=0.4)
    known = ", ".join(f'"{row}"' for row in MATERIALS)
    hint = f'did you mean "{near[0]}"? There are {known}' if near else f"there are {known}"
    return f"{shown(name)} is not in the table of materials; {hint}"


class Material(Section):
    """Force law and cutting coefficients."""

    law: Literal["linear", "exponential", "oblique"] = "linear"
    name: str | None = Field(
        None,
        description="row of the table of materials; coefficients given beside it override its own",
        json_schema_extra={"enum": list(MATERIALS)},
    )
    Ktc: PositivePressure | None = Field(None, description="tangential cutting coefficient")
    Krc: Pressure = Field(0.0, description="radial cutting coefficient")
    Kac: Pressure = Field(0.0, description="axial cutting coefficient")
    Kte: LineForce = Field(0.0, description="tangential edge coefficient")
    Kre: LineForce = Field(0.0, description="radial edge coefficient")
    Kae: LineForce = Field(0.0, description="axial edge coefficient")
    h0: PositiveLength | None = Field(None, description="reference chip thickness")
    exponent: quantity("number", above=0.0, at_most=1.0) | None = Field(
        None, description="p of K h0 (h/h0)^p"
    )
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
            raise SectionError([("name", _no_such_row(data["name"]))])
        if data.get("law", "linear") != "linear":
            text = f"has coefficients of the linear law, not of law = {shown(data['law'])}"
            raise SectionError([("name", f"{shown(data['name'])} {text}")])
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
            "oblique": (*_EXPONENTIAL, *_CUTTING),
        }
        problems += [
            (key, f'does not belong to law = "{self.law}"')
            for key in foreign[self.law]
            if key in self.model_fields_set
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
