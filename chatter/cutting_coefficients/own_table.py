"""A row of the user's own table of materials, from coefficients that were found."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomlkit

from chatter.description.errors import InputError
from chatter.description.material_table import read_material_table
from chatter.description.toml_document import parse_document, read_text


def add_row(table: str | Path, name: str, row: Mapping[str, Any]) -> Path:
    """Add a row to a table of materials, which is made where it is missing.

    The other rows and the comments stay as they are.

    Raises
    ------
    InputError
        If there is a row of that name, or the table is no table of materials.
    """
    path = Path(table)
    document = tomlkit.document()
    if path.exists():
        rows = read_material_table(path)
        if name in rows:
            raise InputError(
                f'{path}: there is a row "{name}" already; take another name, or remove that row'
            )
        document = parse_document(read_text(path, "table of materials"), str(path))
    if not name.strip():
        raise InputError(f"{path}: the name of the new row is empty")
    section = tomlkit.table()
    for key, value in row.items():
        section.add(key, value)
    document.add(tomlkit.key(name), section)
    # the old table stays until the new one is whole
    beside = path.with_name(f"{path.name}.new")
    path.parent.mkdir(parents=True, exist_ok=True)
    beside.write_text(tomlkit.dumps(document), encoding="utf-8", newline="")
    read_material_table(beside)
    beside.replace(path)
    return path
