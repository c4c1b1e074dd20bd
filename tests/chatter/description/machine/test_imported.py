"""Imported parts: reduced to their points, joined there and along a rail."""

import numpy as np
import pytest

from chatter import InputError
from chatter.compile.machine_parts import assembled_machine
from chatter.description.machine.machine_file import MachineFile
from dynamics.beam.shaft import BeamLine, Material, Segment

NODES = 9
LENGTH = 1.0


@pytest.fixture
def folder(tmp_path):
    """Matrices of a free beam along x, one node each 125 mm with six freedoms."""
    steel = Material(206e9, 7850.0, 0.3)
    beam = BeamLine("fe", [Segment(LENGTH, 0.09, steel, elements=NODES - 1)], axis=(1, 0, 0))
    np.savez(tmp_path / "M.npz", beam.mass_matrix)
    np.savez(tmp_path / "K.npz", beam.stiffness_matrix)
    rows = [f"{k + 1},{x},0,0" for k, x in enumerate(np.linspace(0.0, LENGTH, NODES))]
    (tmp_path / "nodes.csv").write_text("node,x,y,z\n" + "\n".join(rows) + "\n")
    held = beam.stiffness_matrix + np.diag([1e8] * 6 + [0.0] * (6 * NODES - 6))
    np.savez(tmp_path / "held.npz", held)
    return tmp_path


def with_imported(head_on_beam, rail=()):
    """The same machine with its crossbeam imported, a point at each node."""
    beam = head_on_beam.pop("beam")["crossbeam"]
    head_on_beam["imported"] = {
        "crossbeam": {
            "mass": "M.npz", "stiffness": "K.npz", "nodes": "nodes.csv",
            "highest_frequency": "20 kHz", "rail": list(rail),
            "point": {f"p{k}": {"at": [k / 8.0, 0, 0], "nodes": [k + 1]} for k in range(NODES)},
        }
    }  # fmt: skip
    for bearing, x in zip(beam["bearings"], (0.0, 1.0), strict=True):
        radial, tilt = bearing["radial"], bearing["tilt"]
        along_y, along_z = (radial, radial) if isinstance(radial, str) else radial
        about_y, about_z = (tilt, tilt) if isinstance(tilt, str) else tilt
        head_on_beam["connector"][bearing["name"]] = {
            "between": ["crossbeam", "ground"],
            "at": [x, 0.0, 0.0],
            "stiffness": {
                "x": bearing.get("axial", 0), "y": along_y, "z": along_z,
                "rx": bearing.get("torsion", 0), "ry": about_y, "rz": about_z,
            },
        }  # fmt: skip
    return head_on_beam


def test_imported_beam_is_the_beam(head_on_beam, folder):
    head_on_beam["connector"]["carriage"]["places"] = [[0.5, 0, 0]]
    head_on_beam["connector"]["carriage"]["stiffness"].update(ry="1e6 N*m/rad", rz="1e6 N*m/rad")
    expected = assembled_machine(
        MachineFile.from_dict(head_on_beam), positions={"X": 0.125}
    ).structure
    file = MachineFile.from_dict(with_imported(head_on_beam), folder=folder)
    found = assembled_machine(file, positions={"X": 0.125}).structure
    assert found.natural_frequencies(8) == pytest.approx(expected.natural_frequencies(8), rel=1e-6)


def test_rail_between_points(head_on_beam, folder):
    expected = assembled_machine(
        MachineFile.from_dict(head_on_beam), positions={"X": 0.03}
    ).structure
    rail = [f"p{k}" for k in range(NODES)]
    file = MachineFile.from_dict(with_imported(head_on_beam, rail), folder=folder)
    found = assembled_machine(file, positions={"X": 0.03}).structure
    # a line that is straight between its points lacks their bending, so it is a little stiffer
    ratio = found.natural_frequencies(3) / expected.natural_frequencies(3)
    assert np.all((ratio > 1.0) & (ratio < 1.015)), ratio
    with pytest.raises(InputError, match=r"m\.toml: .*off the end of the rail"):
        assembled_machine(
            MachineFile.from_dict(head_on_beam, "m.toml", folder), positions={"X": 0.6}
        )


def test_read_once_for_all_positions(head_on_beam, folder):
    file = MachineFile.from_dict(with_imported(head_on_beam, ["p0", "p8"]), folder=folder)
    first = assembled_machine(file).structure
    (folder / "M.npz").unlink()
    assert assembled_machine(file).structure.mass == pytest.approx(first.mass)


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("mass", "none.npz", ["imported.crossbeam", "none.npz"]),
        ("stiffness", "held.npz", ["imported.crossbeam: is held by itself"]),
        ("rail", ["p0", "q"], ["imported.crossbeam", 'no point "q"']),
        ("rail", [], ["no point at (0.45, 0, 0)"]),
        ("point", {"a": {"at": [0, 0, 0], "nodes": [77]}}, ["imported.crossbeam", "no node 77"]),
        (
            "point",
            {"a": {"at": [0, 0, 0], "nodes": [1, 2, 3], "kind": "interpolating"}},
            ["imported.crossbeam", '"a"'],
        ),
    ],
)
def test_told(head_on_beam, folder, key, value, words):
    data = with_imported(head_on_beam, ["p0", "p8"])
    data["imported"]["crossbeam"][key] = value
    with pytest.raises(InputError) as caught:
        assembled_machine(MachineFile.from_dict(data, "m.toml", folder))
    for word in words:
        assert word in str(caught.value)
