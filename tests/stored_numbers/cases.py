"""The cases of the stored numbers, from `cases.toml`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomlkit

HERE = Path(__file__).parent
ROOT = HERE.parents[1]


@dataclass(frozen=True)
class StoredCase:
    """One call on one case.

    Parameters
    ----------
    name : str
        Of the case, and of the call behind a slash: "ball/check".
    call : str
        Key of `results.CALLS`.
    file : Path
        Case file, machine file, FRF file or measurement folder.
    patch : mapping
        Dotted path of the case (or of the machine file) -> value.
    machine_patch : mapping
        Dotted path of the machine file of the case -> value.
    arguments : mapping
        Of the call.
    rtol : float or None
        In place of the tolerance of the call, where rounding grows in the run.
    nightly : bool
        Whether only a nightly run takes it.
    """

    name: str
    call: str
    file: Path
    patch: Mapping[str, Any]
    machine_patch: Mapping[str, Any]
    arguments: Mapping[str, Any]
    rtol: float | None
    nightly: bool


def _path_of(file: str) -> Path:
    return ROOT / file if file.startswith("examples/") else HERE / "cases" / file


def stored_cases() -> dict[str, StoredCase]:
    """All cases by name."""
    tables = tomlkit.parse((HERE / "cases.toml").read_text(encoding="utf-8")).unwrap()
    found = {}
    for name, table in tables.items():
        patch = table.get("set", {})
        for call in table["calls"]:
            arguments = dict(table.get(call, {}))
            further = arguments.pop("set", {})
            rtol = arguments.pop("rtol", None)
            key = f"{name}/{call}"
            found[key] = StoredCase(
                key,
                call,
                _path_of(table["file"]),
                patch | further,
                table.get("set_machine", {}),
                arguments,
                rtol,
                call in table.get("nightly", ()),
            )
    return found
