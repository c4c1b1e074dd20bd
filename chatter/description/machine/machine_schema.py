"""JSON schema of the machine file, from the same declarations that read it."""

from __future__ import annotations

from typing import Any

from chatter.description.json_schema import schema_of
from chatter.description.machine.machine_file import MachineFile


def machine_schema() -> dict[str, Any]:
    """Return the JSON schema (draft 2020-12) of the machine file."""
    return schema_of(
        MachineFile,
        "chatter machine file",
        "Bodies, joints, beams, drives, control and friction of a machine tool.",
    )
