"""The JSON schema of measurement.toml covers what its readers take."""

import json

import pytest
import tomlkit

from chatter.explain.measurement_file import KEYS, OWN_KEYS
from chatter.explain.measurement_schema import measurement_schema
from tests.command_line import chatter_command
from tests.places import DATA, EXAMPLES

SCHEMA = measurement_schema()
FILES = sorted(
    [
        *EXAMPLES.glob("*/measurement/measurement.toml"),
        *DATA.glob("measurements/*/measurement.toml"),
    ]
)


def unknown_keys(data, node):
    """Keys of tables that the schema has not; references and lists are followed."""
    if "$ref" in node:
        node = SCHEMA["$defs"][node["$ref"].rpartition("/")[2]]
    if isinstance(data, list):
        return [key for one in data for key in unknown_keys(one, node.get("items", {}))]
    if not isinstance(data, dict) or node.get("type") != "object":
        return []
    found = []
    for key, value in data.items():
        below = node.get("properties", {}).get(key, node.get("additionalProperties", False))
        if below is False and not ("." in key and "patternProperties" in node):
            found.append(key)
        elif isinstance(below, dict):
            found += unknown_keys(value, below)
    return found


@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parts[-3]}/{path.parts[-2]}")
def test_shipped_measurements_have_no_key_that_it_lacks(path):
    assert unknown_keys(tomlkit.parse(path.read_text()).unwrap(), SCHEMA) == []


def test_keys_are_those_of_the_readers():
    assert tuple(SCHEMA["properties"]) == KEYS
    assert all(SCHEMA["properties"].values())
    run = SCHEMA["$defs"]["Run"]
    assert {*OWN_KEYS, "spindle_speed", "radial_depth", "Ktc", "teeth"} <= set(run["properties"])
    assert unknown_keys({"run": [{"file": "a.csv", "spindel_speed": 1}]}, SCHEMA)


def test_the_command_prints_it():
    printed = chatter_command("schema", "--measurement")
    assert json.loads(printed.stdout) == SCHEMA
    both = chatter_command("schema", "--measurement", "--machine")
    assert both.exit_code == 2
    assert "one of the two" in both.stderr
