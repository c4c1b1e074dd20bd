"""The reference is complete: results of commands, measurement files, licences, gallery."""

import ast
import json
import re

import tomlkit

from chatter.cli import COMMANDS
from chatter.explain import measurement_file
from chatter.explain.measurement_schema import measurement_schema
from chatter.explain.records import description
from chatter.io.shipped_examples import examples
from tests.places import ROOT

REFERENCE = ROOT / "docs" / "reference"
RESULTS = (REFERENCE / "results.md").read_text(encoding="utf-8")
LICENCES = (REFERENCE / "licences.md").read_text(encoding="utf-8")


def keys_of_summaries():
    """Keys that functions named summary write, by where."""
    for path in sorted((ROOT / "chatter").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.FunctionDef) or not node.name.endswith("summary"):
                continue
            for table in ast.walk(node):
                for key in getattr(table, "keys", []) if isinstance(table, ast.Dict) else []:
                    if isinstance(key, ast.Constant):
                        yield f"{path.relative_to(ROOT)}: {key.value}", key.value


def test_every_key_of_a_result_is_in_the_reference():
    words = set(re.findall(r"\w+", RESULTS))
    found = list(keys_of_summaries())
    assert len(found) > 300
    assert not [where for where, key in found if key not in words]


def test_every_command_that_has_a_result_has_its_part():
    without = {"app", "new", "doctor", "compile", "schema", "setup"}
    parts = "\n".join(re.findall(r"^## .*", RESULTS, re.MULTILINE))
    assert not [name for name in COMMANDS if name not in without and f"chatter {name}" not in parts]


def test_every_key_of_a_measurement_file_is_described():
    sections = measurement_schema()["$defs"]
    keys = {
        "Run": [*measurement_file.OWN_KEYS, "cut_time"],
        "Record": description.RECORD_KEYS,
        "Channel": description.CHANNEL_KEYS,
    }
    for section, names in keys.items():
        for key in names:
            assert sections[section]["properties"][key].get("description"), key


def test_measurements_of_the_examples_keep_to_the_schema():
    content = measurement_schema()
    for path in (ROOT / "examples").glob("*/measurement/measurement.toml"):
        given = tomlkit.parse(path.read_text(encoding="utf-8")).unwrap()
        assert set(given) <= set(content["properties"]), path
        assert set(content["required"]) <= set(given), path
        assert given["kind"] in content["properties"]["kind"]["enum"]


def test_licences_of_all_that_is_installed_and_shipped_are_listed():
    project = tomlkit.parse((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"].values()
    wanted = [*project["dependencies"], *(one for extra in extras for one in extra)]
    names = {re.match(r"[\w-]+", one)[0] for one in wanted}
    listed = set(re.findall(r"[\w-]+", LICENCES.split("## Installed with it")[1]))
    assert names <= listed
    # measured data of others: every folder that says so
    for path in [*(ROOT / "examples").glob("*/*.md"), ROOT / "tests" / "data" / "README.md"]:
        for commit in re.findall(r"commit (\w{8})", path.read_text(encoding="utf-8")):
            assert commit in LICENCES, path
    for folder in (ROOT / "tests" / "data").iterdir():
        assert not folder.is_dir() or f"tests/data/{folder.name}" in LICENCES


def test_the_gallery_is_of_the_examples():
    """`python docs/site/run_examples.py` refreshes pictures and run times."""
    measured = json.loads((ROOT / "docs/site/run-times.json").read_text(encoding="utf-8"))
    pictures = {path.stem for path in (ROOT / "docs/pictures/gallery").glob("*.png")}
    assert measured["machine"]
    assert set(measured["seconds"]) <= set(examples())
    assert pictures <= set(measured["seconds"])
