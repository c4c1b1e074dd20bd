"""Patches of a machine, writing back, and its schema."""

import contextlib
import json

import numpy as np
import pytest
import tomlkit

from chatter import InputError
from chatter.compile.machine_parts import machine_parts
from chatter.description.json_schema import machine_schema
from chatter.description.machine.machine_file import MachineFile, load_machine
from chatter.description.path import keys_of


def test_patch_keeps_comments_and_units(line_text):
    file = MachineFile.from_text(line_text)
    patched = file.patch({
        "axis.Y.control.velocity.proportional_gain": 7.5,
        "connector.guide.stiffness.x": 2e8,
        "body.bed.centre[1]": -0.25,
        "friction.screw.coulomb": 3,
        "axis.Y.position": "120 mm",
    })  # fmt: skip
    text = patched.to_toml()
    assert "# a comment that stays" in text
    for written in ("7.5 N*m*s/rad", "200 N/um", "-250 mm", "3 N*m", "120 mm"):
        assert f'"{written}"' in text
    assert patched.get("axis.Y.control.velocity.proportional_gain") == 7.5
    assert patched.get("axis.Y.position") == 0.12
    # the first one stays as it is
    assert file.to_toml() == line_text
    assert file.get("body.bed.centre") == (0.0, -0.5, 0.0)
    assert MachineFile.from_text(text) == patched
    assert patched != file


def test_patch_and_back(line_text):
    file = MachineFile.from_text(line_text)
    back = file.patch({"body.table.mass": "350 kg"}).patch({"body.table.mass": "300 kg"})
    assert back == file
    assert back.to_toml() == line_text
    assert hash(back) == hash(file)


def test_new_tables_get_headers(line_text):
    file = MachineFile.from_text(line_text)
    patched = file.patch({
        "body.block": {"mass": "20 kg", "size": [0.1, 0.1, 0.1], "centre": [0, 0.1, 0.2]},
        "connector.bolts.between": ["block", "table"],
        "connector.bolts.positions": [[0, 0.1, 0.1], [0.1, 0.1, 0.1], [0, 0.2, 0.1]],
        "connector.bolts.stiffness": {"x": "1e3 N/um", "y": "1e3 N/um", "z": "1e3 N/um"},
        "axis.Y.carries": ["table", "block"],
    })  # fmt: skip
    text = patched.to_toml()
    assert "[body.block]" in text
    assert "[connector.bolts]" in text
    assert MachineFile.from_text(text) == patched
    # one place instead of several takes these away
    one = patched.patch({"connector.bolts.at": [0, 0.1, 0.1]})
    assert one.connector["bolts"].positions is None


def test_bare_numbers_of_a_rotation_keep_its_unit(line_text):
    patched = MachineFile.from_text(line_text).patch({"friction.screw.low_speed_decay": 0.25})
    assert '"0.25 s/rad"' in patched.to_toml()
    with pytest.raises(InputError, match=r"friction\.screw\.coulomb"):
        patched.patch({"friction.screw.coulomb": "3 N"})


def test_deviations(line_text):
    text = line_text.replace('"300 kg"', '"300 +- 15 kg"').replace('"2 N*m"', '"2 +- 0.5 N*m"')
    assert MachineFile.from_text(text).deviations() == {
        "body.table.mass": 15.0, "friction.screw.coulomb": 0.5,
    }  # fmt: skip


def test_from_dict_writes_a_file_that_reads_back(head_on_beam, tmp_path):
    file = MachineFile.from_dict(head_on_beam)
    file.save(tmp_path / "machine.toml")
    assert load_machine(tmp_path / "machine.toml") == file
    made = MachineFile(body={"one": {"mass": 1, "size": [1, 1, 1], "centre": [0, 0, 0]}})
    assert MachineFile.from_text(made.to_toml()).body == made.body


def test_file_names_move_with_the_file(head_on_beam, tmp_path):
    head_on_beam["imported"] = {
        "column": {
            "mass": "M.npz", "stiffness": "fe/K.npz", "nodes": "/data/nodes.csv",
            "highest_frequency": "1 kHz", "point": {"top": {"at": [0, 0, 1], "nodes": [1, 2, 3]}},
        }
    }  # fmt: skip
    file = MachineFile.from_dict(head_on_beam, folder=tmp_path)
    file.save(tmp_path / "out/machine.toml")
    text = (tmp_path / "out/machine.toml").read_text()
    assert '"../M.npz"' in text
    assert '"../fe/K.npz"' in text
    assert '"/data/nodes.csv"' in text
    assert load_machine(tmp_path / "out/machine.toml") == file


def test_schema_covers_every_key():
    schema = machine_schema()
    assert json.loads(json.dumps(schema, allow_nan=False)) == schema
    assert '"null"' not in json.dumps(schema)
    assert set(schema["properties"]) == set(keys_of(MachineFile))
    for name, section in schema["$defs"].items():
        assert section["additionalProperties"] is False, name
    assert set(schema["$defs"]["AxisSection"]["properties"]) >= {"drive", "brake", "control"}


@pytest.mark.parametrize("value", [np.nan, 1e400, True, [], {}, "x", "1 N", None, 10**30, [[1]]])
def test_nothing_but_input_errors(line_text, value):
    file = MachineFile.from_text(line_text)
    paths = []

    def collect(item, path):
        for key, entry in item.items() if isinstance(item, dict) else enumerate(item):
            here = f"{path}[{key}]" if isinstance(key, int) else f"{path}.{key}".lstrip(".")
            paths.append(here)
            if isinstance(entry, (dict, list)):
                collect(entry, here)

    collect(tomlkit.parse(line_text).unwrap(), "")
    assert len(paths) > 80
    for path in paths:
        with contextlib.suppress(InputError):
            machine_parts(file.patch({path: value}))
