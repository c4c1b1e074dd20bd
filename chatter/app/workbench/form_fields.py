"""Fields of the form of a case, from its schema: paths, kinds, help, examples."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import tomlkit

from chatter.description.assignments import parse_assignments

_OBJECT = "object"


class FormField(NamedTuple):
    """One value of a case."""

    path: str
    label: str
    description: str
    example: str
    options: tuple[str, ...]  # the values allowed; empty where any is
    is_text: bool  # a text, which is not read as a number or a list


def sections(schema: Mapping[str, Any]) -> list[str]:
    """Names of the sections of a case file."""
    return [name for name, one in schema["properties"].items() if one.get("type") != "string"]


def fields_of(
    schema: Mapping[str, Any], section: str, content: Mapping[str, Any]
) -> list[FormField]:
    """Fields of a section: of each table that its content has, where it holds several."""
    return list(_fields(schema, schema["properties"][section], section, content.get(section)))


def new_entries(
    schema: Mapping[str, Any], section: str, content: Mapping[str, Any]
) -> dict[str, str]:
    """Lists of tables of a section that may get one more: label -> path of the new one."""
    root = schema["properties"][section]
    found = {}
    if root.get("type") == "array":
        found[section] = f"{section}[{len(content.get(section) or ())}]"
    inside = _resolved(schema, root).get("properties", {})
    for name, one in inside.items():
        if one.get("type") == "array" and "$ref" in one.get("items", {}):
            stands = (content.get(section) or {}).get(name) or ()
            found[name] = f"{section}.{name}[{len(stands)}]"
    return found


def written(content: Mapping[str, Any], path: str) -> str:
    """Value at a path as it is typed into a field; empty where there is none."""
    value: Any = content
    for step in path.replace("[", ".").replace("]", "").split("."):
        if isinstance(value, list) and step.isdigit() and int(step) < len(value):
            value = value[int(step)]
        elif isinstance(value, Mapping) and step in value:
            value = value[step]
        else:
            return ""
    return value if isinstance(value, str) else tomlkit.item(value).as_string()


def label_in_list(path: str) -> str:
    """Label of a value in a list of tables, "structure.mode[0].damping": "mode 1: damping"."""
    table, _, rest = path.rpartition("].")
    name, _, place = table.rpartition("[")
    number = int(place) + 1
    return f"{name.rpartition('.')[2]} {number}: {rest.replace('.', ', ')}".replace("_", " ")


def typed(field: FormField, text: str) -> Any:
    """Value that a text in a field stands for; None where it is empty."""
    if not text.strip():
        return None
    return text if field.is_text else parse_assignments([f"{field.path}={text}"])[field.path]


def _resolved(schema: Mapping[str, Any], one: Mapping[str, Any]) -> Mapping[str, Any]:
    name = one.get("$ref", "").rpartition("/")[2]
    return schema["$defs"][name] if name else one


def _as_table(rules: Mapping[str, Any], content: Any) -> Mapping[str, Any]:
    """Rules of the table that a range may be, where it is not stated as text."""
    tables = [one for one in rules.get("anyOf", ()) if one.get("type") == _OBJECT]
    return tables[0] if tables and not isinstance(content, str) else rules


def _fields(
    schema: Mapping[str, Any], one: Mapping[str, Any], path: str, content: Any
) -> Iterator[FormField]:
    rules = _as_table(_resolved(schema, one), content)
    if rules.get("type") == "array" and "$ref" in rules.get("items", {}):
        for place, entry in enumerate(content or ()):
            yield from _fields(schema, rules["items"], f"{path}[{place}]", entry)
        return
    if rules.get("type") == _OBJECT and isinstance(rules.get("additionalProperties"), dict):
        for name, entry in (content or {}).items():
            yield from _fields(schema, rules["additionalProperties"], f"{path}.{name}", entry)
        return
    if rules.get("type") == _OBJECT and "properties" in rules:
        for name, inner in rules["properties"].items():
            held = content.get(name) if isinstance(content, Mapping) else None
            yield from _fields(schema, inner, f"{path}.{name}", held)
        return
    yield _field(rules, path)


def _field(rules: Mapping[str, Any], path: str) -> FormField:
    examples = list(rules.get("examples", ()))
    for one in rules.get("anyOf", ()):
        examples += one.get("examples", ())
    options = tuple(str(one) for one in rules.get("enum", ()))
    if rules.get("type") == "boolean":
        options = ("true", "false")
    default = rules.get("default")
    shown = str(examples[0]) if examples else "" if default in (None, "") else f"{default}"
    return FormField(
        path,
        path.rpartition(".")[2].replace("_", " "),
        str(rules.get("description", "")),
        shown,
        options,
        rules.get("type") == "string" and "pattern" not in rules,
    )
