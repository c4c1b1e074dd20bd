"""JSON schema of the case file with the stability methods that there are."""

from typing import Any

from chatter.description.json_schema import case_schema
from chatter.stability.registry import AUTO, METHODS


def schema() -> dict[str, Any]:
    """Return the JSON schema (draft 2020-12) of the case file."""
    return case_schema((AUTO, *METHODS.names()))
