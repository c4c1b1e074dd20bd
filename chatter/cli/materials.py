"""`chatter materials [WORD...]`: rows of the table of materials, with law, source and range."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from chatter.cli import options
from chatter.description.errors import InputError
from chatter.report.console import print_json, print_line

if TYPE_CHECKING:
    from collections.abc import Sequence

    from cutting.material.row import MaterialRow

#: rows up to which a search prints all that is known of each
_IN_FULL = 5


def materials(
    words: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[WORD...]", help='All must occur: a grade, "titanium", "iso S", "group 34".'
        ),
    ] = None,
    table: Annotated[
        Path | None, typer.Option("--table", metavar="FILE", help="A table of your own (TOML).")
    ] = None,
    json: options.Json = False,
) -> None:
    """List or search the table of materials: coefficients, source, range."""
    from chatter.description.material_table import read_material_table, words_of_family
    from cutting.material.table import MATERIALS, found_rows

    rows = MATERIALS if table is None else read_material_table(table)
    found = found_rows(_with_groups(words or ()), rows)
    if not found:
        family = words_of_family(" ".join(words or ()), rows)
        raise InputError(
            f"no row has {' and '.join(words or ())}; {family and family + '; '}"
            f"`chatter materials` lists all {len(rows)}"
        )
    if json:
        print_json({name: _summary(row) for name, row in found.items()})
        return
    for name, row in found.items():
        for line in _lines(name, row, in_full=len(found) <= _IN_FULL):
            print_line(line)
    if len(found) > _IN_FULL:
        print_line(f"{len(found)} rows; a search that finds up to {_IN_FULL} prints their sources")


def _with_groups(words: Sequence[str]) -> list[str]:
    """Words of a search, "iso K" as one, and so a letter alone: it is in the name of every row."""
    found: list[str] = []
    for word in words:
        if len(word) == 1 and word.isalpha():
            if found and found[-1].lower() == "iso":
                found.pop()
            found.append(f"iso {word}")
        else:
            found.append(word)
    return found


def _lines(name: str, row: MaterialRow, *, in_full: bool) -> list[str]:
    """Lines on a row: its name and coefficients, and in full where they come from."""
    from chatter.description.material_words import range_in_words, values_in_words

    group = f" [{row.iso_group}]" if row.iso_group else ""
    lines = [f'"{name}"{group}', f"    {values_in_words(row.law, row.values)}"]
    if not in_full:
        return lines
    told = {
        "condition": row.condition,
        "grades": ", ".join(row.examples),
        "tool and cut": row.validity,
        "source": row.source,
        "range": range_in_words(row),
        "assumption": row.assumption,
    }
    return [*lines, *(f"    {key}: {text}" for key, text in told.items() if text)]


def _summary(row: MaterialRow) -> dict:
    """Row as JSON, SI."""
    return {
        **row.keys(),
        "source": row.source,
        "iso_group": row.iso_group,
        "condition": row.condition,
        "examples": list(row.examples),
        "validity": row.validity,
        "chip_thickness_m": None if row.chip_thickness is None else list(row.chip_thickness),
        "assumption": row.assumption,
    }
