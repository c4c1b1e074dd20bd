"""[material]: force law and coefficients, or the name of a row of the table of materials."""

import difflib
from typing import Any

from pydantic import Field, model_validator

from chatter.description.formatting import formatted
from chatter.description.law_section import FORCE_LAWS, LawSection, law_section
from chatter.description.quantities import quantity
from chatter.description.section import SectionError
from cutting.force.law import ForceLaw
from cutting.material.table import MATERIALS


def _no_such_row(name: str) -> str:
    near = difflib.get_close_matches(name[:60], MATERIALS, n=1, cutoff=0.4)
    known = ", ".join(f'"{row}"' for row in MATERIALS)
    hint = f'did you mean "{near[0]}"? There are {known}' if near else f"there are {known}"
    return f"{formatted(name)} is not in the table of materials; {hint}"


class _ForceLawSection(LawSection):
    LAWS = FORCE_LAWS


_Keys: Any = law_section(_ForceLawSection, "linear", quantity)


class Material(_Keys):
    """Force law and cutting coefficients."""

    name: str | None = Field(
        None,
        description="row of the table of materials; coefficients given beside it override its own",
        json_schema_extra={"enum": list(MATERIALS)},
    )

    @model_validator(mode="before")
    @classmethod
    def _take_named_row(cls, data: Any) -> Any:
        if not isinstance(data, dict) or not isinstance(data.get("name"), str):
            return data
        row = MATERIALS.get(data["name"])
        if row is None:
            raise SectionError([("name", _no_such_row(data["name"]))])
        if data.get("law", "linear") != "linear":
            text = f"has coefficients of the linear law, not of law = {formatted(data['law'])}"
            raise SectionError([("name", f"{formatted(data['name'])} {text}")])
        return {**row.coefficients(), **data}

    def force_law(self, helix: float) -> ForceLaw:
        """Force law of an edge inclined by the helix, rad."""
        return self.LAWS[self.law].of(self.values, helix)
