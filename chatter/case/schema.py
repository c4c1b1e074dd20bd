"""JSON schema of the case file, from the same declarations that read it."""

from __future__ import annotations

from typing import Any

from chatter.case.case import Case


def schema() -> dict[str, Any]:
    """Return the JSON schema (draft 2020-12) of the case file."""
    content = Case.model_json_schema(by_alias=True)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **content,
        "title": "chatter case file",
    }
