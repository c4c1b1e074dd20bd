"""A range of a case file, from, to and count, stated in a line: "3000 rpm..9000 rpm:200"."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import BaseModel, model_validator

from chatter.description.formatting import formatted
from chatter.description.path import Step, keys_of, model_at
from chatter.description.quantities import RANGE_PATTERN
from chatter.description.ranges import stated_ends, without_count
from chatter.description.section import Section
from chatter.description.toml_editing import WRITTEN

if TYPE_CHECKING:
    from pydantic import GetJsonSchemaHandler
    from pydantic_core import CoreSchema


class StatedRange(Section):
    """A range: a table of from, to and count, or the text "FROM..TO:COUNT"."""

    #: of messages and the schema
    EXAMPLE: ClassVar[str]

    @model_validator(mode="before")
    @classmethod
    def _read_text(cls, given: Any) -> Any:
        return table_of_range(cls, given) if isinstance(given, str) else given

    @classmethod
    def __get_pydantic_json_schema__(
        cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Schema of the table, or of the text."""
        schema = handler(core_schema)
        found = handler.resolve_ref_schema(schema)
        table = dict(found)
        found.clear()
        found["description"] = f'{table.pop("description", "")} As a table, or "FROM..TO:COUNT".'
        text = {"type": "string", "pattern": RANGE_PATTERN, "examples": [cls.EXAMPLE]}
        found["anyOf"] = [table, text]
        return schema


def table_of_range(kind: type[StatedRange], given: str) -> dict[str, Any]:
    """Table of a range that is given as FROM..TO or FROM..TO:COUNT.

    ValueError where that is no range, no end has a unit, it has a count that its kind has not, or
    one that begins at 0 is to begin elsewhere.
    """
    keys = keys_of(kind)
    span, count = without_count(given)
    ends = stated_ends(span)
    if ends is None or " " not in ends[1]:
        raise ValueError(
            f"{formatted(given)} is no range with units; FROM..TO"
            f"{':COUNT' if 'count' in keys else ''} is required, such as {formatted(kind.EXAMPLE)}"
        )
    if ":" in span:
        wrong = span.rpartition(":")[2].strip()
        raise ValueError(
            f"{formatted(wrong)} is no count; behind the colon of FROM..TO:COUNT stands a whole "
            "number"
        )
    if count is not None and "count" not in keys:
        raise ValueError(
            f"{formatted(given)} has a count, which does not belong here; leave it out"
        )
    first, last = ends
    table: dict[str, Any] = {"to": last}
    if count is not None:
        table["count"] = count
    begins = float(first.partition(" ")[0])
    required = "from" in keys and kind.model_fields["from_"].is_required()
    if required or ("from" in keys and begins != 0.0):
        return {"from": first, **table}
    if begins != 0.0:
        raise ValueError(f'{formatted(given)} is given; it begins at 0, as in "0..{table["to"]}"')
    return table


def ranges_spelt_out(kind: type[BaseModel], steps: tuple[Step, ...], given: Any) -> Any:
    """Content at a path with the ranges in it, stated as text, as tables.

    Texts that are no range stay: the section that reads them says what is wrong.
    """
    if isinstance(given, dict):
        return {key: ranges_spelt_out(kind, (*steps, key), one) for key, one in given.items()}
    if not isinstance(given, str) or ".." not in given:
        return given
    section = model_at(kind, steps)
    if section is None or not issubclass(section, StatedRange):
        return given
    try:
        return table_of_range(section, given)
    except ValueError:
        return given


def open_stated_ranges(kind: type[BaseModel], document: Any, steps: tuple[Step, ...]) -> None:
    """Make a table of a range in a document that is stated as text, where a path leads into it."""
    inside = document
    for index, step in enumerate(steps[:-1], start=1):
        if not isinstance(inside, dict) or step not in inside:
            return
        table = ranges_spelt_out(kind, steps[:index], inside[step])
        if isinstance(inside[step], str) and isinstance(table, dict):
            inline = WRITTEN.inline_table()
            inline.update(table)
            inside[step] = inline
        inside = inside[step]
