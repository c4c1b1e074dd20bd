"""Pages of the keys of case, machine and measurement files, made from their schemas."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

_CASE_HEAD = """# Keys of the case file

Made from the schema (`chatter schema`).
What the sections mean stands in [the case file](../case-file.md). A quantity is text with
a unit; a bare number is in the SI unit that the table names.
"""
_MACHINE_HEAD = """# Keys of the machine file

Made from the schema (`chatter schema --machine`). How the parts make a machine stands in
[the virtual machine](../virtual-machine.md).
"""

_MEASUREMENT_HEAD = """# Keys of the measurement file

Made from the schema (`chatter schema --measurement`). A folder with `measurement.toml` is what
`compare`, `explain`, `learn`, `coefficients` and `friction` take. How they use it stands in
[closing the loop](../closing-the-loop.md), the columns of the files in
[file formats](../file-formats.md).
"""

_OVERRIDES = (
    " Any further key is such a difference: a path such as `cut.axial_depth`, or a key of cut, "
    "tool, material or axis alone."
)


def _definition(schema: dict[str, Any], node: dict[str, Any]) -> str | None:
    """Name of the section that a node of the schema leads to."""
    if "$ref" in node:
        return str(node["$ref"]).rsplit("/", 1)[-1]
    for key in ("anyOf", "oneOf", "allOf"):
        for one in node.get(key, ()):
            found = _definition(schema, one)
            if found:
                return found
    for key in ("items", "additionalProperties"):
        if isinstance(node.get(key), dict):
            found = _definition(schema, node[key])
            if found:
                return found
    return None


def _is_list(node: dict[str, Any]) -> bool:
    return node.get("type") == "array" or any(map(_is_list, node.get("anyOf", ())))


def _is_named(node: dict[str, Any]) -> bool:
    return isinstance(node.get("additionalProperties"), dict)


def _bounds(node: dict[str, Any]) -> str:
    words = []
    for key, sign in (
        ("exclusiveMinimum", "above "),
        ("minimum", "from "),
        ("exclusiveMaximum", "below "),
        ("maximum", "to "),
    ):
        if key in node:
            words.append(f"{sign}{node[key]:.4g}")
    return ", ".join(words)


def _kinds(node: dict[str, Any]) -> Iterator[str]:
    """What may stand there, in words."""
    if "enum" in node:
        yield " or ".join(f'`"{one}"`' for one in node["enum"])
        return
    if "const" in node:
        yield f'`"{node["const"]}"`'
        return
    for key in ("anyOf", "oneOf"):
        for one in node.get(key, ()):
            yield from _kinds(one)
    kind = node.get("type")
    if kind == "string":
        examples = node.get("examples")
        yield f'text such as `"{examples[0]}"`' if examples else "text"
    elif kind in ("number", "integer"):
        bounds = _bounds(node)
        yield ("whole number" if kind == "integer" else "number") + (f" {bounds}" if bounds else "")
    elif kind == "boolean":
        yield "`true` or `false`"
    elif kind == "array":
        inner = node.get("items", {})
        words = list(dict.fromkeys(_kinds(inner))) if isinstance(inner, dict) else []
        yield "list of " + " or ".join(words) if words else "list"


def _default(node: dict[str, Any]) -> str:
    if "default" not in node or node["default"] in (None, "", [], {}):
        return ""
    value = node["default"]
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    return f"`{value:.6g}`" if isinstance(value, float) else f"`{value}`"


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")


def _rows(schema: dict[str, Any], properties: dict[str, Any], required: list[str]) -> list[str]:
    lines = ["| key | takes | default | what it is |", "|---|---|---|---|"]
    for key, node in properties.items():
        if _definition(schema, node):
            continue
        takes = "; ".join(dict.fromkeys(_kinds(node)))
        default = "required" if key in required else _default(node)
        cells = [f"`{key}`", takes, default, node.get("description", "")]
        lines.append(f"| {' | '.join(map(_cell, cells))} |")
    return lines if len(lines) > 2 else []


def _sections(schema: dict[str, Any], path: str, name: str, many: bool) -> Iterator[str]:
    section = schema["$defs"][name]
    # a range is a table or a text
    section = {**section.get("anyOf", [{}])[0], **section}
    title = f"[[{path}]]" if many else f"[{path}]"
    yield f"## `{title}`\n"
    yield section.get("description", "") + "\n"
    rows = _rows(schema, section.get("properties", {}), section.get("required", []))
    if rows:
        yield "\n".join(rows) + "\n"
    yield from _nested(schema, path, section.get("properties", {}))


def _nested(schema: dict[str, Any], path: str, properties: dict[str, Any]) -> Iterator[str]:
    for key, node in properties.items():
        inner = _definition(schema, node)
        if inner:
            place = f"{path}.{key}" if path else key
            place += ".NAME" if _is_named(node) else ""
            yield from _sections(schema, place, inner, _is_list(node) and not _is_named(node))


def _page(head: str, schema: dict[str, Any]) -> str:
    rows = _rows(schema, schema["properties"], schema.get("required", []))
    top = ["## At the top of the file\n", "\n".join(rows) + "\n"] if rows else []
    return "\n".join([head, *top, *_nested(schema, "", schema["properties"])])


def case_page() -> str:
    """Return the page of the case file."""
    from chatter.stability.case_schema import schema

    return _page(_CASE_HEAD, schema())


def machine_page() -> str:
    """Return the page of the machine file."""
    from chatter.description.json_schema import machine_schema

    return _page(_MACHINE_HEAD, machine_schema())


def measurement_page() -> str:
    """Return the page of the measurement file."""
    from chatter.explain import measurement_file
    from chatter.explain.measurement_schema import measurement_schema

    schema = measurement_schema()
    run = schema["$defs"]["Run"]
    own = {*measurement_file.OWN_KEYS, "cut_time"}
    run["properties"] = {key: node for key, node in run["properties"].items() if key in own}
    run["description"] += _OVERRIDES
    return _page(_MEASUREMENT_HEAD, schema)
