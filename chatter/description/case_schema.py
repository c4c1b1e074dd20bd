"""JSON schema of the case file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from chatter.description.case import Case
from chatter.description.json_schema import schema_of


def schema(methods: Sequence[str]) -> dict[str, Any]:
    """Return the JSON schema (draft 2020-12) of the case file.

    Parameters
    ----------
    methods : sequence of str
        Names of the stability methods, for [lobes].
    """
    content = schema_of(
        Case,
        "chatter case file",
        "Tool, material, cut and structure: what milling stability depends on.",
    )
    content["$defs"]["Lobes"]["properties"]["method"]["enum"] = list(methods)
    return content
