"""[material]: force law and coefficients, or the name of a row of a table of materials."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import Field, ValidationInfo, model_validator

from chatter.description.errors import InputError
from chatter.description.file_name import FileName, in_case_folder
from chatter.description.formatting import formatted
from chatter.description.law_section import FORCE_LAWS, LawSection, law_section
from chatter.description.material_table import (
    is_in_table,
    name_of_row,
    read_material_table,
    row_named,
)
from chatter.description.quantities import quantity
from chatter.description.section import SectionError
from cutting.force.law import ForceLaw
from cutting.material.row import MaterialRow
from cutting.material.table import MATERIALS


class _ForceLawSection(LawSection):
    LAWS = FORCE_LAWS


_Keys: Any = law_section(_ForceLawSection, "linear", quantity)


class Material(_Keys):
    """Force law and cutting coefficients."""

    name: str | None = Field(
        None,
        description="row of the table of materials (`chatter materials` lists it), or of `table`, "
        "or a grade of one; coefficients given beside it override its own",
        examples=list(MATERIALS)[:3],
    )
    condition: str | None = Field(
        None,
        description="chooses among the rows of a grade: words of their condition or name",
        examples=["annealed", "quenched and tempered, 850 MPa"],
    )
    table: FileName | None = Field(None, description="file with a table of materials of your own")

    @model_validator(mode="before")
    @classmethod
    def _take_named_row(cls, data: Any, info: ValidationInfo) -> Any:
        if isinstance(data, Mapping) and "name" in data:
            data = {**data, "name": _as_text(data["name"])}
        row = _row_of(data, info)
        if row is None:
            return data
        if data.get("law", row.law) != row.law:
            text = f"has coefficients of the {row.law} law, not of law = {formatted(data['law'])}"
            raise SectionError([("name", f"{formatted(data['name'])} {text}")])
        return {**row.keys(), **data}

    @property
    def row(self) -> MaterialRow | None:
        """Row of the table that the section names; None where it names none."""
        if self.name is None:
            return None
        return self._rows[self.row_name]

    @property
    def row_name(self) -> str:
        """Name of the row that the section names, by it or by a grade; empty where by none."""
        return "" if self.name is None else name_of_row(self.name, self._rows, self.condition)

    @property
    def _rows(self) -> Mapping[str, MaterialRow]:
        return MATERIALS if self.table is None else read_material_table(self.table)

    def force_law(self, helix: float) -> ForceLaw:
        """Force law of an edge inclined by the helix, rad."""
        return self.LAWS[self.law].of(self.values, helix)


def _as_text(name: Any) -> Any:
    """Grade of digits alone as text: 304, or a material number, which has four behind the point."""
    if isinstance(name, bool) or not isinstance(name, (int, float)):
        return name
    return str(name) if isinstance(name, int) else f"{name:.4f}"


def _row_of(data: Any, info: ValidationInfo) -> MaterialRow | None:
    """Row that the keys of a section name; SectionError where there is none such."""
    if not isinstance(data, Mapping):
        return None
    name, table = data.get("name"), data.get("table")
    if table is not None and name is None:
        raise SectionError([("table", "is given without name, the row that is meant")])
    condition = data.get("condition")
    if condition is not None and name is None:
        raise SectionError([("condition", "is given without name, the grade that is meant")])
    if not isinstance(name, str) or not isinstance(condition, (str, type(None))):
        return None
    if table is None:
        return _named(name, MATERIALS, condition)
    try:
        rows = read_material_table(in_case_folder(table, info))
    except ValueError as error:
        raise SectionError([("table", str(error))]) from None
    except InputError as error:
        raise SectionError([("table", text) for text in error.messages]) from None
    return _named(name, rows, condition)


def _named(name: str, rows: Mapping[str, MaterialRow], condition: str | None) -> MaterialRow:
    try:
        return row_named(name, rows, condition)
    except ValueError as error:
        # a condition is at fault only where there are rows to choose among
        key = "name" if condition is None or not is_in_table(name, rows) else "condition"
        raise SectionError([(key, str(error))]) from None
