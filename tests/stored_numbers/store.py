"""The stored numbers: `numbers.toml` read, written, and compared with what is computed now."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomlkit

from tests.stored_numbers.results import Reading

FILE = Path(__file__).parent / "numbers.toml"
_HEADER = """\
# What the stored cases give. Written by update.py alone, with the reason of a change beside it:
#   python tests/stored_numbers/update.py NAME... --reason "why the number moved"
# A number may differ from its stored value by rtol times its magnitude (in a list: the largest
# there) plus atol; texts, counts and verdicts must be the same.

"""
_BARE = re.compile(r"[A-Za-z0-9_-]+")

#: quantity -> entry with value, unit, rtol, atol and reason
Entries = dict[str, dict[str, Any]]


def read() -> dict[str, Entries]:
    """Stored entries of every case."""
    if not FILE.exists():
        return {}
    return tomlkit.parse(FILE.read_text(encoding="utf-8")).unwrap()


def write(stored: Mapping[str, Entries]) -> None:
    """Write the store: one table a case, one line a quantity."""
    tables = []
    for case in sorted(stored):
        lines = [f"[{_key(case)}]"]
        for name, entry in stored[case].items():
            inside = ", ".join(f"{key} = {_text(value)}" for key, value in entry.items())
            lines.append(f"{_key(name)} = {{ {inside} }}")
        tables.append("\n".join(lines) + "\n")
    FILE.write_text(_HEADER + "\n".join(tables), encoding="utf-8")


def entry_of(reading: Reading) -> dict[str, Any]:
    """What is stored of a reading; tolerances only of what has any."""
    entry: dict[str, Any] = {"value": reading.value}
    if reading.unit:
        entry["unit"] = reading.unit
    if _is_measured(reading.value):
        entry["rtol"] = reading.rtol
        if reading.atol:
            entry["atol"] = float(f"{reading.atol:.1e}")
    return entry


def differences(stored: Entries, now: Mapping[str, Reading]) -> list[str]:
    """Sentences on every quantity that is not what is stored."""
    found = [f"{name}: is computed, but not stored" for name in now if name not in stored]
    for name, entry in stored.items():
        if name not in now:
            found.append(f"{name}: is stored, but not computed")
        elif not _agrees(entry, now[name].value):
            tolerance = f"rtol {entry.get('rtol', 0)}, atol {entry.get('atol', 0)}"
            got, unit = now[name].value, entry.get("unit", "")
            found.append(f"{name}: got {got}, stored {entry['value']} {unit} ({tolerance})")
    return found


def _agrees(entry: Mapping[str, Any], got: Any) -> bool:
    wanted = entry["value"]
    if not _is_measured(wanted):
        return wanted == got
    pair = [one if isinstance(one, list) else [one] for one in (wanted, got)]
    if len(pair[0]) != len(pair[1]) or not _is_measured(got):
        return False
    largest = max((abs(one) for one in pair[0] if math.isfinite(one)), default=0.0)
    allowed = entry["rtol"] * largest + entry.get("atol", 0.0)
    return all(
        a == b or (math.isnan(a) and math.isnan(b)) or abs(a - b) <= allowed
        for a, b in zip(*pair, strict=True)
    )


def _is_measured(value: Any) -> bool:
    """Whether a value is a float or a list of them: what has a tolerance."""
    several = value if isinstance(value, list) else [value]
    return bool(several) and all(isinstance(one, float) for one in several)


def _key(name: str) -> str:
    return name if _BARE.fullmatch(name) else f'"{name}"'


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        # twelve digits: more than any tolerance asks for, and few enough to be read
        return repr(float(f"{value:.12g}"))
    if isinstance(value, list):
        return "[" + ", ".join(_text(one) for one in value) + "]"
    if isinstance(value, str):
        return tomlkit.string(value).as_string()
    return str(value)
