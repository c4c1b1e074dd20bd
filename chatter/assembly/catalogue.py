"""Rows of a maker's catalogue as tools of a library.

A CSV with a heading; a column is known by its name, its unit stands in brackets: ``diameter [mm]``.
"""

from __future__ import annotations

import csv
import re
from pathlib import Path

import tomlkit

from chatter.assembly.library import Library
from chatter.description.errors import InputError
from chatter.description.toml_document import read_text

#: key of a tool -> names that catalogues give it (DIN 4000-82, ISO 13399 and plain words)
_NAMES = {
    "name": ("name", "designation", "order code", "article", "id"),
    "diameter": ("diameter", "cutting diameter", "dc", "d1", "a1"),
    "shank_diameter": ("shank diameter", "dmm", "dcon", "d2", "c3"),
    "flute_length": ("flute length", "cutting length", "length of cut", "apmx", "l2", "lc"),
    "length": ("length", "overall length", "oal", "l1", "b5"),
    "teeth": ("teeth", "flutes", "number of teeth", "zefp", "nof", "z"),
    "material": ("material", "substrate", "cutting material"),
}
_REQUIRED = ("name", "diameter", "flute_length", "length")
_LENGTHS = ("diameter", "shank_diameter", "flute_length", "length")
_MATERIALS = {"hm": "carbide", "vhm": "carbide", "solid carbide": "carbide", "hss-e": "hss"}
_MOST_ROWS = 100_000
_HEADING = re.compile(r"^\s*(?P<name>[^\[(]*?)\s*(?:[\[(]\s*(?P<unit>[^\])]*)\s*[\])])?\s*$")


def library_of_catalogue(path: str | Path) -> tuple[str, list[str]]:
    """Library (TOML) with the tools of a catalogue, and their names.

    Parameters
    ----------
    path : str or Path
        CSV with commas, semicolons or tabs. Columns name, diameter, flute length and length are
        needed, shank diameter (else the diameter), teeth and material may be there; lengths have
        their unit in the heading, as in ``diameter [mm]``.

    Returns
    -------
    text : str
        Of the library, checked.
    names : list of str

    Raises
    ------
    InputError
        If a column, a unit or a number is missing or wrong; file, line and column are named.
    """
    path = Path(path)
    lines = read_text(path, "catalogue").lstrip("\ufeff").splitlines()
    if not lines:
        raise InputError(f"{path}: is empty; a heading such as name,diameter [mm] is required")
    separator = max(",;\t", key=lines[0].count)
    rows = list(csv.reader(lines, delimiter=separator))
    if len(rows) > _MOST_ROWS:
        raise InputError(f"{path}: {len(rows)} rows; at most {_MOST_ROWS} are allowed")
    columns = _columns(path, rows[0])
    document = tomlkit.document()
    document.add("title", f"catalogue {path.name}")
    tools = tomlkit.table(is_super_table=True)
    names: list[str] = []
    for number, row in enumerate(rows[1:], 2):
        if not any(cell.strip() for cell in row):
            continue
        name, entry = _tool(path, number, row, columns, separator)
        if name in names:
            raise InputError(f'{path}: line {number}: name "{name}" stands twice')
        names.append(name)
        table = tomlkit.table()
        for key, value in entry.items():
            table.add(key, value)
        table.add("source", path.name)
        tools.add(tomlkit.key(name), table)
    if not names:
        raise InputError(f"{path}: holds no row below its heading")
    document.add("tool", tools)
    text = tomlkit.dumps(document)
    Library.from_text(text, str(path))
    return text, names


def _columns(path: Path, heading: list[str]) -> dict[str, tuple[int, str]]:
    """Index and unit of each known column."""
    known = {name: key for key, names in _NAMES.items() for name in names}
    found: dict[str, tuple[int, str]] = {}
    for index, text in enumerate(heading):
        match = _HEADING.match(text)
        key = (
            known.get(" ".join(match["name"].lower().replace("_", " ").split())) if match else None
        )
        if key is None or match is None:
            continue
        if key in found:
            raise InputError(f"{path}: two columns hold {key.replace('_', ' ')}: {text!r}")
        if key in _LENGTHS and not match["unit"]:
            raise InputError(
                f"{path}: column {text!r} has no unit; write it in the heading, as in "
                f'"{text.strip()} [mm]"'
            )
        found[key] = (index, match["unit"] or "")
    missing = [key.replace("_", " ") for key in _REQUIRED if key not in found]
    if missing:
        raise InputError(
            f"{path}: no column {', '.join(missing)}; the heading is {', '.join(heading)}"
        )
    return found


def _tool(
    path: Path, number: int, row: list[str], columns: dict[str, tuple[int, str]], separator: str
) -> tuple[str, dict[str, str | int]]:
    """Name and keys of the tool of one row."""
    entry: dict[str, str | int] = {}
    name = ""
    for key, (index, unit) in columns.items():
        text = row[index].strip() if index < len(row) else ""
        where = f"{path}: line {number}: {key.replace('_', ' ')}"
        if key == "name":
            name = text
        elif not text and key not in _REQUIRED:
            continue
        elif key in _LENGTHS:
            value = _number(where, text.replace(",", ".") if separator != "," else text)
            entry[key] = f"{value:.10g} {unit}"
        elif key == "teeth":
            entry[key] = round(_number(where, text))
        else:
            entry[key] = _MATERIALS.get(text.lower(), text.lower())
    if not name:
        raise InputError(f"{path}: line {number}: name is empty")
    entry.setdefault("shank_diameter", entry["diameter"])
    return name, entry


def _number(where: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{where}: {text!r} is not a number") from None
