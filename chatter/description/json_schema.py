"""JSON schemas of the case file and the machine file, from the declarations that read them."""

from collections.abc import Sequence
from typing import Any

from chatter.description.case import Case
from chatter.description.machine.machine_file import MachineFile
from chatter.description.patchable import Description


def schema_of(model: type[Description], title: str, description: str) -> dict[str, Any]:
    """Return the JSON schema (draft 2020-12) of a kind of file."""
    content = _tidy(model.model_json_schema(by_alias=True))
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **content,
        "title": title,
        "description": description,
    }


def _tidy(node: Any) -> Any:
    """Leave out what a TOML file cannot hold (null) and what tells an editor nothing."""
    if isinstance(node, list):
        return [_tidy(entry) for entry in node]
    if not isinstance(node, dict):
        return node
    tidied = {
        # below "properties" and "$defs" the keys are names, not keywords
        key: (
            {name: _tidy(entry) for name, entry in value.items()}
            if key in ("properties", "$defs")
            else _tidy(value)
        )
        for key, value in node.items()
        if not (key == "title" and isinstance(value, str))
    }
    if tidied.get("default", 0) is None:
        del tidied["default"]
    return _without_null(tidied)


def _without_null(node: dict) -> dict:
    """Merge an optional value with its only alternative; both descriptions are kept."""
    alternatives = [entry for entry in node.get("anyOf", []) if entry != {"type": "null"}]
    if len(alternatives) == len(node.get("anyOf", [])):
        return node
    rest = {key: value for key, value in node.items() if key != "anyOf"}
    if len(alternatives) > 1:
        return {**rest, "anyOf": alternatives}
    merged = {**alternatives[0], **rest}
    return {**merged, **_description(rest, alternatives[0])}


def _description(*nodes: dict) -> dict:
    texts = [node["description"] for node in nodes if "description" in node]
    return {"description": ": ".join(texts)} if texts else {}


def case_schema(methods: Sequence[str]) -> dict[str, Any]:
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


def machine_schema() -> dict[str, Any]:
    """Return the JSON schema (draft 2020-12) of the machine file."""
    return schema_of(
        MachineFile,
        "chatter machine file",
        "Bodies, joints, beams, drives, control and friction of a machine tool.",
    )
