"""The TOML document behind a case: reading, changing in place, keeping comments and units."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

import tomlkit
from tomlkit.exceptions import TOMLKitError

from chatter.case.path import Step, join_path
from chatter.errors import InputError

_LARGEST_FILE = 4 * 1024 * 1024
#: giving one of these keys takes the other away
_ALTERNATIVES = {
    "mass": "stiffness",
    "stiffness": "mass",
    "duration": "revolutions",
    "revolutions": "duration",
}


def read_text(path: Path) -> str:
    """Read a case file as text; raise InputError saying why that cannot be done."""
    if path.is_dir():
        raise InputError(f"{path}: is a folder; a case file is wanted")
    try:
        size = path.stat().st_size
        if size > _LARGEST_FILE:
            raise InputError(f"{path}: has {size} bytes; no case file is that large")
        raw = path.read_bytes()
    except FileNotFoundError:
        raise InputError(f"{path}: there is no such file") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None
    if b"\0" in raw:
        raise InputError(f"{path}: is a binary file; a case file is TOML text")
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            f"{path}: is not UTF-8 text (byte {error.start}); a case file is TOML text in UTF-8"
        ) from None
    if not text.strip():
        raise InputError(f"{path}: is empty; a case file is TOML text")
    return text


def parse_document(text: str, name: str) -> tomlkit.TOMLDocument:
    """Parse TOML text; raise InputError with line and column."""
    try:
        if sys.version_info >= (3, 11):
            import tomllib

            # its messages name the line even of a duplicate key
            tomllib.loads(text)
        return tomlkit.parse(text)
    except (ValueError, TOMLKitError, RecursionError) as error:
        reason = str(error).replace("\n", " ") or "too deeply nested"
        raise InputError(f"{name}: is no valid TOML: {reason}") from None


def set_value(document: Any, steps: tuple[Step, ...], value: Any) -> None:
    """Set, or with None remove, the value at a path; ``"*"`` stands for every place of a list.

    Raises
    ------
    InputError
        If the path leads through something that is no table or list, or past the end of a list.
    """
    containers = [document]
    for place, step in enumerate(steps[:-1]):
        create = tomlkit.table if place == 0 else tomlkit.inline_table
        containers = [
            inner for item in containers for inner in _enter(item, step, create, steps, place)
        ]
    for item in containers:
        _assign(item, steps[-1], value, steps)


def _enter(item: Any, step: Step, create: Any, steps: tuple[Step, ...], place: int) -> list[Any]:
    if isinstance(step, str) and step != "*":
        if not isinstance(item, dict):
            raise InputError(f"{join_path(steps)}: {join_path(steps[:place])} is no table")
        if step not in item:
            item[step] = create()
        return [item[step]]
    return [item[k] for k in _places(item, step, steps, place)]


def _places(item: Any, step: Step, steps: tuple[Step, ...], place: int) -> range:
    where = join_path(steps[:place])
    if not isinstance(item, list):
        raise InputError(f"{join_path(steps)}: {where} is no list")
    if step == "*":
        return range(len(item))
    if step >= len(item):
        raise InputError(
            f"{join_path(steps)}: {where} has {len(item)} entries; the last is {where}"
            f"[{len(item) - 1}]"
        )
    return range(step, step + 1)


def _assign(item: Any, step: Step, value: Any, steps: tuple[Step, ...]) -> None:
    if isinstance(step, str) and step != "*":
        if not isinstance(item, dict):
            raise InputError(f"{join_path(steps)}: {join_path(steps[:-1])} is no table")
        if value is None:
            item.pop(step, None)
            return
        if step in _ALTERNATIVES:
            item.pop(_ALTERNATIVES[step], None)
        item[step] = value
        return
    for k in _places(item, step, steps, len(steps) - 1):
        if value is None:
            raise InputError(f"{join_path(steps)}: an entry of a list cannot be removed")
        item[k] = value


def value_at(document: Any, steps: tuple[Step, ...]) -> Any:
    """Value at a path of plain keys and places; None where there is none."""
    item = document
    for step in steps:
        try:
            item = item[step]
        except (KeyError, IndexError, TypeError):
            return None
    return item


def move_references(document: Any, old: Path, new: Path) -> None:
    """Rewrite file names relative to one folder so that they hold in another."""
    structure = document.get("structure")
    if not isinstance(structure, dict):
        return

    def moved(name: str) -> str:
        if Path(name).is_absolute():
            return name
        return Path(os.path.relpath(old.resolve() / name, new.resolve())).as_posix()

    frf = structure.get("frf")
    if isinstance(frf, str):
        structure["frf"] = moved(frf)
    if isinstance(structure.get("machine"), str):
        structure["machine"] = moved(structure["machine"])
    for entries in [frf] if isinstance(frf, list) else []:
        for place, entry in enumerate(entries):
            if isinstance(entry, str):
                entries[place] = moved(entry)
            elif isinstance(entry, dict) and "file" in entry:
                entry["file"] = moved(entry["file"])
    if isinstance(frf, dict) and "file" in frf:
        frf["file"] = moved(frf["file"])
