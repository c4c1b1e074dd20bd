"""Rows of a maker's catalogue as tools of a library.

A CSV with a heading; a column is known by its name, in English or German, by DIN 4000 or ISO 13399.
Its unit stands behind the name (``diameter [mm]``, ``Durchmesser mm``) or behind each number.
"""

from __future__ import annotations

import codecs
import csv
import math
import re
import unicodedata
from pathlib import Path

import tomlkit

from chatter.assembly.library import Library
from chatter.description.errors import InputError
from chatter.description.shop_units import with_decimals
from chatter.description.toml_document import read_text

#: key of a tool -> names that catalogues give it (DIN 4000-82, ISO 13399 and plain words)
_NAMES = {
    "name": (
        *("name", "tool name", "tool", "designation", "order code", "order number", "article"),
        *("article number", "item", "id", "bezeichnung", "werkzeug", "artikel", "artikelnummer"),
        *("artikel nr", "art nr", "bestellnummer", "bestell nr"),
    ),
    "diameter": (
        *("diameter", "cutting diameter", "tool diameter", "dc", "d1", "a1", "durchmesser"),
        *(
            "schneidendurchmesser",
            "werkzeugdurchmesser",
            "nenndurchmesser",
            "ø",
            "⌀",
            "schneiden ø",
        ),
    ),
    "shank_diameter": (
        *("shank diameter", "shank", "dmm", "dcon", "d2", "c3", "schaftdurchmesser", "schaft ø"),
        *("schaft",),
    ),
    "flute_length": (
        *("flute length", "cutting length", "length of cut", "apmx", "l2", "lc"),
        *("schneidenlänge", "schneidlänge", "schnittlänge", "schneidenlaenge", "schneidlaenge"),
    ),
    "length": (
        *("length", "overall length", "total length", "oal", "l1", "b5", "gesamtlänge", "länge"),
        *("gesamtlaenge", "laenge"),
    ),
    "teeth": (
        *("teeth", "flutes", "number of teeth", "number of flutes", "no of teeth", "no of flutes"),
        *("zefp", "nof", "z", "schneidenzahl", "zähnezahl", "zähne", "anzahl schneiden"),
        *("anzahl zähne", "zaehnezahl", "zaehne"),
    ),
    "material": (
        *("material", "substrate", "cutting material", "tool material", "schneidstoff"),
        *("werkstoff", "schneidwerkstoff"),
    ),
}
_REQUIRED = ("name", "diameter", "flute_length", "length")
_LENGTHS = ("diameter", "shank_diameter", "flute_length", "length")
_MATERIALS = {"hm": "carbide", "vhm": "carbide", "solid carbide": "carbide", "hss-e": "hss"}
_MATERIALS |= {"hartmetall": "carbide", "vollhartmetall": "carbide", "stahl": "steel"}
#: rows, and those of them that may stand above the heading
_MOST_ROWS, _MOST_ABOVE = 100_000, 20
#: units of length as catalogues write them -> as they are read
_UNITS = {unit: unit for unit in ("mm", "cm", "um", "m", "in", "inch")}
_UNITS |= {"inches": "inch", "zoll": "inch", '"': "inch"}
_UNIT = "|".join(sorted(map(re.escape, _UNITS), key=len, reverse=True))
#: a name with its unit in brackets, or behind "in", a stroke, a comma or nothing
_BRACKETS = re.compile(r"^(?P<name>[^\[(]*?)\s*[\[(]\s*(?P<unit>[^\])]*?)\s*[\])]$")
_BEHIND = re.compile(rf"^(?P<name>.*?)(?:\s+in\s+|\s*[/,]\s*|\s+)(?P<unit>{_UNIT})$", re.IGNORECASE)
_CELL = re.compile(rf"^(?P<number>.*?)\s*(?P<unit>{_UNIT})?$", re.IGNORECASE)


def library_of_catalogue(path: str | Path) -> tuple[str, list[str]]:
    """Library (TOML) with the tools of a catalogue, and their names.

    Parameters
    ----------
    path : str or Path
        CSV with commas, semicolons or tabs. Columns name, diameter, flute length and length are
        needed, shank diameter (else the diameter), teeth and material may be there; lengths have
        their unit in the heading, as in ``diameter [mm]``, or behind each number.

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
    lines = _text(path).splitlines()
    if not any(line.strip() for line in lines):
        raise InputError(f"{path}: is empty; a heading such as name,diameter [mm] is required")
    above, separator = _heading(lines)
    rows = list(csv.reader(lines[above:], delimiter=separator))
    if len(rows) > _MOST_ROWS:
        raise InputError(f"{path}: {len(rows)} rows; at most {_MOST_ROWS} are allowed")
    columns = _columns(path, rows[0])
    document = tomlkit.document()
    document.add("title", f"catalogue {path.name}")
    tools = tomlkit.table(is_super_table=True)
    names: list[str] = []
    for number, row in enumerate(rows[1:], above + 2):
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


def _text(path: Path) -> str:
    """Text of a catalogue; spreadsheets write UTF-8, UTF-16 or Windows-1252."""
    if not path.is_file():
        return read_text(path, "catalogue")  # says why it cannot be read
    raw = path.read_bytes()
    if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return raw.decode("utf-16", "replace")
    if b"\0" in raw:
        raise InputError(f"{path}: is a binary file; save the table as CSV")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("cp1252", "replace")


def _heading(lines: list[str]) -> tuple[int, str]:
    """Lines above the heading, which may be a title, and the separator of columns.

    The heading is the line with most names that are known, the first where none has two.
    """
    best, above, separator = 1, 0, max(",;\t", key=lines[0].count)
    for number, line in enumerate(lines[:_MOST_ABOVE]):
        for mark in ",;\t":
            cells = next(csv.reader([line], delimiter=mark), [])
            known = sum(_key_and_unit(cell)[0] is not None for cell in cells)
            if known > best:
                best, above, separator = known, number, mark
    return above, separator


def _key_and_unit(text: str) -> tuple[str | None, str]:
    """Key of a tool that a heading names, None where it names none, and the unit beside it."""
    known = {name: key for key, names in _NAMES.items() for name in names}
    text = text.strip()
    for pattern in (_BRACKETS, _BEHIND):
        match = pattern.match(text)
        if match and (key := known.get(_plain(match["name"]))):
            unit = match["unit"].strip()
            return key, _UNITS.get(unit.lower(), unit)
    return known.get(_plain(text)), ""


def _plain(name: str) -> str:
    """A name in small letters, its words apart by one blank."""
    letters = unicodedata.normalize("NFC", name).lower()
    return " ".join(re.sub(r"[_.:\-]", " ", letters).split())


def _columns(path: Path, heading: list[str]) -> dict[str, tuple[int, str]]:
    """Index of each known column and the unit in its heading, empty where there is none."""
    found: dict[str, tuple[int, str]] = {}
    for index, text in enumerate(heading):
        key, unit = _key_and_unit(text)
        if key is None:
            continue
        if key in found:
            raise InputError(
                f"{path}: two columns hold {key.replace('_', ' ')}: "
                f"{heading[found[key][0]].strip()!r} and {text.strip()!r}; rename or remove one"
            )
        found[key] = (index, unit)
    missing = [key for key in _REQUIRED if key not in found]
    if missing:
        wanted = "; ".join(
            f"{key.replace('_', ' ')} (such as {', '.join(_NAMES[key][:4])})" for key in missing
        )
        raise InputError(f"{path}: no column {wanted}; the heading is {', '.join(heading)}")
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
            entry[key] = _length(where, text, unit, separator)
        elif key == "teeth":
            teeth = _number(where, text, separator)
            if teeth != round(teeth):
                raise InputError(f"{where}: {text!r} is not a whole number")
            entry[key] = round(teeth)
        else:
            entry[key] = _MATERIALS.get(text.lower(), text.lower())
    if not name:
        raise InputError(f"{path}: line {number}: name is empty")
    entry.setdefault("shank_diameter", entry["diameter"])
    return name, entry


def _length(where: str, text: str, unit: str, separator: str) -> str:
    """Length with its unit: that behind the number, else that of the heading."""
    cell = _CELL.match(text)
    own = (cell["unit"] or "") if cell else ""
    value = _number(where, with_decimals(cell["number"] if cell else text), separator)
    unit = _UNITS.get(own.lower(), own) or unit
    if not unit:
        name = where.rpartition(": ")[2]
        raise InputError(
            f'{where}: {text!r} has no unit; write it in the heading, as "{name} [mm]"'
        )
    return f"{value:.10g} {unit}"


def _number(where: str, text: str, separator: str) -> float:
    """Number with a decimal point, or a decimal comma that separates no columns."""
    written = text.strip()
    if re.fullmatch(r"[+-]?[1-9]\d{0,2},\d{3}", written) and separator == ",":
        raise InputError(
            f"{where}: {text!r} may be a decimal comma or a thousand; write a decimal point"
        )
    if written.count(",") == 1 and "." not in written:
        written = written.replace(",", ".")
    try:
        value = float(written)
    except ValueError:
        raise InputError(f"{where}: {text!r} is not a number") from None
    if not math.isfinite(value):
        raise InputError(f"{where}: {text!r} is not a number")
    return value
