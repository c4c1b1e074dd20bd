"""Kinds of files that people mix up, told by what stands in them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import tomlkit

from chatter.description.errors import InputError


class KindOfFile(NamedTuple):
    """A kind of TOML file."""

    noun: str
    signs: Callable[[Mapping[str, Any]], list[str]]  # that nested tables are of it; empty: not
    use: str  # where such a file belongs


#: sections that a case has and a machine has not
OF_CASES_ALONE = (
    *("tool", "material", "cut", "structure", "process_damping", "wear", "tool_life"),
    *("dynamometer", "empirical", "simulation", "stock", "lobes", "uncertainty", "optimum"),
    "pitch_design",
)
#: keys of a kind, of which as many as the number must be there
_CASE = (("tool", "material", "cut", "structure"), 2)
_MACHINE = (("body", "beam", "imported", "connector", "point"), 2)
_MEASUREMENT = (("kind", "case", "run", "part", "tolerance", "channels"), 2)
_ASSEMBLY = (("spindle", "stick_out"), 2)
_PARTS_OF_LIBRARY = ("tool", "holder", "spindle")
#: keys that a row of a table of materials has one of
_OF_ROW = ("law", "Ktc", "Ks", "Kt", "iso_group", "source")


def _keys_of(data: Mapping[str, Any], keys: tuple[tuple[str, ...], int]) -> list[str]:
    found = [key for key in keys[0] if key in data]
    return found if len(found) >= keys[1] else []


def _of_measurement(data: Mapping[str, Any]) -> list[str]:
    return _keys_of(data, _MEASUREMENT) if isinstance(data.get("kind"), str) else []


def _of_case(data: Mapping[str, Any]) -> list[str]:
    return _keys_of(data, _CASE) if isinstance(data.get("tool", {}), Mapping) else []


def _of_library(data: Mapping[str, Any]) -> list[str]:
    """Tables of tables alone: `[tool.NAME]`, `[holder.NAME]`."""
    found = [key for key in _PARTS_OF_LIBRARY if key in data]
    whole = {key for key in data if key != "title"}
    named = all(data[key] and _is_table_of_tables(data[key]) for key in found)
    return found if found and named and set(found) == whole else []


def _of_materials(data: Mapping[str, Any]) -> list[str]:
    rows = list(data.values())
    named = bool(rows) and all(
        isinstance(row, Mapping) and any(key in row for key in _OF_ROW) for row in rows
    )
    sections = (*_CASE[0], *_MACHINE[0])
    return list(data) if named and not any(key in sections for key in data) else []


def _is_table_of_tables(value: Any) -> bool:
    return isinstance(value, Mapping) and all(isinstance(one, Mapping) for one in value.values())


KINDS_OF_FILES = (
    KindOfFile("measurement", _of_measurement, "chatter explain and compare take one"),
    KindOfFile(
        "assembly", lambda data: _keys_of(data, _ASSEMBLY), "chatter assemble takes one"
    ),
    KindOfFile("library", _of_library, "library of an assembly names it"),
    KindOfFile(
        "machine", lambda data: _keys_of(data, _MACHINE),
        'a case with [tool], [material] and [cut] names it by [structure] machine = "(this file)"; '
        "chatter frf, move and whatif take the machine itself",
    ),
    KindOfFile("case", _of_case, "chatter check, lobes and simulate take one"),
    KindOfFile("table of materials", _of_materials, "material.table of a case names it"),
)  # fmt: skip


def with_article(noun: str) -> str:
    """Return "a case", "an assembly"."""
    return f"{'an' if noun[0] in 'aeio' else 'a'} {noun}"


def refuse_other_kind(data: Mapping[str, Any], name: str, noun: str) -> None:
    """Raise InputError in one sentence where nested tables are of another kind than the noun."""
    sentence = other_kind(data, noun)
    if sentence is not None:
        raise InputError(f"{name}: {sentence}")


def other_kind(data: Mapping[str, Any], noun: str) -> str | None:
    """Say of which other kind than the noun nested tables are; None where nothing tells.

    A file with signs of the kind that is required is of it.
    """
    found = {kind.noun: kind.signs(data) for kind in KINDS_OF_FILES}
    if found.get(noun):
        return None
    for kind in KINDS_OF_FILES:
        if found[kind.noun]:
            signs = " and ".join(_as_written(data, key) for key in found[kind.noun][:3])
            return (
                f"is {with_article(kind.noun)} ({signs}), where {with_article(noun)} is "
                f"required; {kind.use}"
            )
    return None


def refuse_other_file(path: str | Path, noun: str) -> None:
    """Raise InputError where a TOML file is of another kind than the noun; others are left."""
    path = Path(path)
    sentence = kind_of_file(path, noun)
    if sentence is not None:
        raise InputError(f"{path}: {sentence}")


def kind_of_file(path: Path, noun: str) -> str | None:
    """Say of which other kind than the noun a TOML file is; None where nothing tells."""
    if path.suffix.lower() != ".toml" or not path.is_file():
        return None
    try:
        data = tomlkit.parse(path.read_text(encoding="utf-8-sig")).unwrap()
        return other_kind(data, noun)
    except (OSError, ValueError, RecursionError):
        # told by what reads it
        return None


def _as_written(data: Mapping[str, Any], key: str) -> str:
    value = data[key]
    if isinstance(value, list) and value and isinstance(value[0], Mapping):
        return f"[[{key}]]"
    return f"[{key}]" if isinstance(value, Mapping) else key


def other_format(path: Path, text: str) -> str | None:
    """Say what a text file that is no TOML is, and where it belongs; None where nothing tells."""
    first = next((line.strip() for line in text.splitlines() if line.strip()), "")
    suffix = path.suffix.lower()
    if first.startswith("{"):
        return "is JSON, such as the summary.json of a result"
    if suffix in (".nc", ".mpf", ".h", ".tap", ".gcode") or first == "%":
        return "is an NC program; simulation.program of a case names it"
    if suffix in (".csv", ".txt", ".tsv", ".dat", ".uff", ".unv", ".frf", ".lvm"):
        return (
            "is a table or a record; [[structure.frf]] of a case names measured FRFs, chatter "
            "modes and detect read records"
        )
    return None
