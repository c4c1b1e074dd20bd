"""The TOML document behind a case or machine: reading text, values for it, file names in it."""

import codecs
import os
import re
import sys
from collections.abc import Mapping
from datetime import date, time
from pathlib import Path
from typing import Any

import tomlkit

from chatter.description.errors import InputError
from chatter.description.formatting import formatted, printable
from chatter.description.kinds_of_files import other_format, with_article
from chatter.description.path import Step, join_path

_LARGEST_FILE = 256 * 1024
#: TOML's whole numbers have 64 bits
_LARGEST_INTEGER = 2**63 - 1
#: where a parser stumbled; text in quotes of word processors; a value with its unit and no quotes
_LINE = re.compile(r"\bline (\d+)")
_CURLY = re.compile("[\u201c-\u201f\u00ab\u2018\u2019]\\s*([^\u201c-\u201f\u00bb\u2018\u2019]*)")
_UNQUOTED = re.compile(r"^[\w.\[\]-]+\s*=\s*([-+]?[\d.]+\s*[A-Za-z%\u00b0\u00b5\u03bc][^#\"]*)")
#: what the parsers say -> what people say
_PLAIN_WORDS = {
    "Cannot overwrite a value": "a key is given twice",
    "Cannot declare": "the table is given twice:",
}


def read_text(path: Path, noun: str = "case") -> str:
    """Read a file as text; raise InputError saying why that cannot be done.

    Parameters
    ----------
    path : Path
    noun : str
        What the file describes, for messages.
    """
    try:
        if path.is_dir():
            raise InputError(f"{path}: is a folder; {with_article(noun)} file is required")
        with path.open("rb") as file:
            # a size is no use: pipes and devices have none
            raw = file.read(_LARGEST_FILE + 1)
    except FileNotFoundError:
        raise InputError(f"{path}: there is no such file") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None
    except ValueError:
        raise InputError(f"{formatted(str(path))}: is not a file name") from None
    if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        raise InputError(
            f"{path}: is text in UTF-16; {with_article(noun)} file is TOML text in UTF-8, an "
            "encoding that editors offer when they save"
        )
    if b"\0" in raw:
        raise InputError(f"{path}: is a binary file; {with_article(noun)} file is TOML text")
    if len(raw) > _LARGEST_FILE:
        raise InputError(
            f"{path}: has more than {_LARGEST_FILE} bytes; no {noun} file is that large"
        )
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            f"{path}: is not UTF-8 text (byte {error.start}); {with_article(noun)} file is TOML "
            "text in UTF-8"
        ) from None
    if not text.strip():
        raise InputError(f"{path}: is empty; {with_article(noun)} file is TOML text")
    return text


def parse_document(text: str, name: str, noun: str = "case") -> tomlkit.TOMLDocument:
    """Parse TOML text of what the noun says; raise InputError with line and column."""
    try:
        if sys.version_info >= (3, 11):
            import tomllib

            # its messages name the line even of a duplicate key
            tomllib.loads(text)
        return tomlkit.parse(text)
    except Exception as error:
        # whatever a parser of untrusted text stumbles over
        if other := other_format(Path(name), text):
            required = f"{with_article(noun)} file is TOML text"
            raise InputError(f"{name}: {other}; {required}") from None
        reason = f"{_reason(error)}{_about_line(str(error), text)}"
        raise InputError(f"{name}: is no valid TOML: {reason}") from None


def _reason(error: Exception) -> str:
    if isinstance(error, RecursionError):
        return "it is too deeply nested"
    text = printable(str(error).replace("\n", " "), 200)
    for words, plain in _PLAIN_WORDS.items():
        text = text.replace(words, plain)
    return text


def _about_line(message: str, text: str) -> str:
    """Line that a parser stumbled over, and what to write where a quantity lacks its quotes."""
    number = _LINE.search(message)
    lines = text.splitlines()
    if number is None or not 1 <= int(number[1]) <= len(lines):
        return ""
    line = lines[int(number[1]) - 1].strip()
    if curly := _CURLY.search(line):
        hint = f'; straight quotes are required: "{printable(curly[1], 40)}"'
    elif bare := _UNQUOTED.match(line):
        hint = f'; a quantity stands in quotes: "{printable(bare[1].strip(), 40)}"'
    else:
        hint = ""
    return f": {printable(line, 80)}{hint}"


def plain(value: Any, steps: tuple[Step, ...] = (), noun: str = "case") -> Any:
    """Return a value of Python as one of TOML; None stands for a key that is not there.

    Steps and noun, what the document describes, are for the message of an InputError where TOML has
    nothing for it.
    """
    if hasattr(value, "tolist"):
        # numbers and arrays of numpy
        value = value.tolist()
    if isinstance(value, Path):
        return value.as_posix()
    if isinstance(value, Mapping):
        given = {str(key): plain(each, (*steps, str(key)), noun) for key, each in value.items()}
        return {key: entry for key, entry in given.items() if entry is not None}
    if isinstance(value, (list, tuple)):
        return [plain(entry, (*steps, index), noun) for index, entry in enumerate(value)]
    known = value is None or isinstance(value, (bool, int, float, str, date, time))
    if not known or (isinstance(value, int) and abs(value) > _LARGEST_INTEGER):
        raise InputError(
            f"{join_path(steps)}: {formatted(value)} is not a value of {with_article(noun)} file"
        )
    return value


def value_at(document: Any, steps: tuple[Step, ...]) -> Any:
    """Value at a path of plain keys and places; None where there is none."""
    item = document
    for step in steps:
        try:
            item = item[step]
        except (KeyError, IndexError, TypeError):
            return None
    return item


def moved_reference(name: str, old: Path, new: Path) -> str:
    """Return a file name relative to one folder so that it holds in another."""
    if Path(name).is_absolute():
        return name
    return Path(os.path.relpath(old.resolve() / name, new.resolve())).as_posix()


def move_references(document: Any, old: Path, new: Path) -> None:
    """Rewrite file names of a case relative to one folder so that they hold in another."""

    def moved(name: str) -> str:
        return moved_reference(name, old, new)

    material = document.get("material")
    if isinstance(material, dict) and isinstance(material.get("table"), str):
        material["table"] = moved(material["table"])
    simulation = document.get("simulation")
    program = simulation.get("program") if isinstance(simulation, dict) else None
    if isinstance(program, dict) and isinstance(program.get("file"), str):
        program["file"] = moved(program["file"])
    structure = document.get("structure")
    if not isinstance(structure, dict):
        return
    frf = structure.get("frf")
    if isinstance(frf, str):
        structure["frf"] = moved(frf)
    if isinstance(structure.get("machine"), str):
        structure["machine"] = moved(structure["machine"])
    for entries in [frf] if isinstance(frf, list) else []:
        for index, entry in enumerate(entries):
            if isinstance(entry, str):
                entries[index] = moved(entry)
            elif isinstance(entry, dict) and "file" in entry:
                entry["file"] = moved(entry["file"])
    if isinstance(frf, dict) and "file" in frf:
        frf["file"] = moved(frf["file"])
