"""The JSON schema: covers every key, and accepts what a case file may hold."""

import copy
import json
import re

import pytest
import tomlkit

import chatter
from chatter import InputError
from chatter.description.case import Case
from chatter.description.path import keys_of
from tests.places import DATA, EXAMPLES

SCHEMA = chatter.schema()


def definitions(node):
    if isinstance(node, dict):
        if "$ref" in node:
            yield node["$ref"]
        for value in node.values():
            yield from definitions(value)
    elif isinstance(node, list):
        for value in node:
            yield from definitions(value)


def test_is_json_with_all_references_resolved():
    assert json.loads(json.dumps(SCHEMA, allow_nan=False)) == SCHEMA
    names = {f"#/$defs/{name}" for name in SCHEMA["$defs"]}
    assert set(definitions(SCHEMA)) <= names


def test_no_null_and_no_unknown_keys():
    # TOML has no null
    assert '"null"' not in json.dumps(SCHEMA)
    assert SCHEMA["additionalProperties"] is False
    for name, section in SCHEMA["$defs"].items():
        # a range is a table or a text
        table = section["anyOf"][0] if "anyOf" in section else section
        assert table["additionalProperties"] is False, name


def test_every_section_and_key_is_there():
    assert set(SCHEMA["properties"]) == set(keys_of(Case))
    assert set(SCHEMA["$defs"]["SpeedRange"]["anyOf"][0]["properties"]) == {"from", "to", "count"}
    assert set(SCHEMA["$defs"]["Tool"]["required"]) == {"teeth", "diameter"}


def patterns(node):
    if isinstance(node, dict):
        if isinstance(node.get("pattern"), str):
            yield node
        for value in node.values():
            yield from patterns(value)
    elif isinstance(node, list):
        for value in node:
            yield from patterns(value)


def test_examples_fit_their_patterns():
    found = [node for node in patterns(SCHEMA) if "examples" in node]
    assert len(found) > 20
    for node in found:
        for example in node["examples"]:
            assert re.search(node["pattern"], example), (node["pattern"], example)


@pytest.mark.parametrize("text", ["2 mm", "1650 +- 80 MPa", "1e-3m", "-30 °", "0", "5 µm"])
def test_pattern_of_quantities_accepts(text):
    pattern = next(iter(patterns(SCHEMA["$defs"]["Tool"])))["pattern"]
    assert re.search(pattern, text)


@pytest.mark.parametrize("text", ["2", "mm", "", "two mm"])
def test_pattern_of_quantities_refuses(text):
    pattern = next(iter(patterns(SCHEMA["$defs"]["Tool"])))["pattern"]
    assert not re.search(pattern, text)


TYPES = {
    "object": dict,
    "array": list,
    "string": str,
    "number": (int, float),
    "integer": int,
    "boolean": bool,
}
#: keyword -> whether a value may stand
CHECKS = {
    "type": lambda value, names: any(
        isinstance(value, TYPES[name]) and (name == "boolean" or not isinstance(value, bool))
        for name in ([names] if isinstance(names, str) else names)
    ),
    "enum": lambda value, allowed: value in allowed,
    "const": lambda value, only: value == only,
    "pattern": lambda value, text: not isinstance(value, str) or bool(re.search(text, value)),
    "minimum": lambda value, bound: value >= bound,
    "maximum": lambda value, bound: value <= bound,
    "exclusiveMinimum": lambda value, bound: value > bound,
    "exclusiveMaximum": lambda value, bound: value < bound,
    "minItems": lambda value, count: not isinstance(value, list) or len(value) >= count,
    "maxItems": lambda value, count: not isinstance(value, list) or len(value) <= count,
    "minLength": lambda value, count: not isinstance(value, str) or len(value) >= count,
    "required": lambda value, keys: not isinstance(value, dict) or set(keys) <= set(value),
    "anyOf": lambda value, nodes: any(fits(value, node) for node in nodes),
    "oneOf": lambda value, nodes: sum(fits(value, node) for node in nodes) == 1,
    "items": lambda value, node: (
        not isinstance(value, list) or all(fits(entry, node) for entry in value)
    ),
    "$ref": lambda value, name: fits(value, SCHEMA["$defs"][name.rsplit("/", 1)[1]]),
}
NO_CHECK = {
    "$schema", "$defs", "title", "description", "examples", "default",
    "properties", "additionalProperties",
}  # fmt: skip


def fits(value, node):
    """Check a value against the keywords that the schema uses."""
    assert set(node) <= set(CHECKS) | NO_CHECK
    if isinstance(value, dict) and "additionalProperties" in node:
        others = node["additionalProperties"]
        known = node.get("properties", {})
        for key, entry in value.items():
            below = known.get(key, others)
            if below is False or not fits(entry, below):
                return False
    return all(check(value, node[key]) for key, check in CHECKS.items() if key in node)


def case_files():
    return sorted([*EXAMPLES.glob("*/case.toml"), *DATA.rglob("case.toml")])


@pytest.mark.parametrize("path", case_files(), ids=lambda path: path.parent.name)
def test_case_files_fit(path):
    text = path.read_text(encoding="utf-8")
    assert fits(tomlkit.parse(text).unwrap(), SCHEMA)


GOOD = {
    "title": "a case",
    "tool": {"teeth": 2, "diameter": "16 mm", "helix": ["30 deg", "0"]},
    "material": {"law": "linear", "Ktc": "600 +- 30 MPa"},
    "cut": {
        "mode": "up", "spindle_speed": "1000 rpm", "feed_per_tooth": "0.1 mm",
        "axial_depth": 0.001, "radial_depth": "3 mm",
    },
    "structure": {
        "mode": [{"frequency": 500, "damping": "3 %", "mass": "1 kg", "direction": [1, 0, 0]}]
    },
    "friction": {"guide": {"coulomb": "80 N"}},
    "lobes": {"speeds": {"from": "1000 rpm", "to": "2000 rpm", "count": 5}},
}  # fmt: skip


def changed(path, value):
    data = copy.deepcopy(GOOD)
    *steps, last = path
    item = data
    for step in steps:
        item = item[step]
    item[last] = value
    return data


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (["title"], "other"),
        (["material"], {"name": "Al7075-T6"}),
        (["structure"], {"frf": "tap.uff"}),
        (["structure"], {"frf": ["a.csv", {"file": "b.csv", "direction": "xy", "node": 3}]}),
        (["structure"], {"frf": {"file": "b.csv"}}),
        (["structure"], {"machine": "machine.toml"}),
        (["tool", "runout"], {"offset": "10 um", "angle": "30 deg"}),
        (["tool", "pitch"], ["170 deg", "190 deg"]),
        (["lobes", "method"], "zero-order"),
        (["simulation"], {"chip": "dexel", "revolutions": 20}),
        (["contact"], {"stiffness": "1 N/um"}),
    ],
)
def test_schema_and_reader_accept(path, value):
    data = changed(path, value)
    assert fits(data, SCHEMA)
    assert Case.from_dict(data)


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (["title"], 3),
        (["titel"], "x"),
        (["tool", "teeth"], 0),
        (["tool", "teeth"], 2.5),
        (["tool", "teeth"], 10**9),
        (["tool", "teeth"], True),
        (["tool", "diameter"], "16"),
        (["tool", "diameter"], -1),
        (["tool", "diameter"], 20),
        (["tool", "kind"], "drill"),
        (["tool", "diamter"], "16 mm"),
        (["material", "law"], "cubic"),
        (["cut", "mode"], "climb"),
        (["cut", "axial_depth"], 0),
        (["cut", "axial_depth"], [1]),
        (["structure", "mode", 0, "damping"], 1.5),
        (["structure", "mode", 0, "direction"], [1, 0]),
        (["structure", "mode", 0, "side"], "spindle"),
        (["structure", "mode", 0, "stiffness"], 1e6),
        (["structure", "mode"], {}),
        (["structure"], {"frf": {"direction": "x"}}),
        (["structure"], {"frf": {"file": "a.csv", "direction": "u"}}),
        (["structure"], {"frf": 3}),
        (["friction", "guide"], 3),
        (["lobes", "speeds", "count"], 10**6),
        (["lobes", "steps"], 1),
    ],
)
def test_schema_and_reader_refuse(path, value):
    data = changed(path, value)
    assert not fits(data, SCHEMA)
    with pytest.raises(InputError):
        Case.from_dict(data)
