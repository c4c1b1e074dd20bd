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


def in_mm_and_t(folder):
    """The files as Abaqus writes them in mm, t, s: x = 1e3 x_SI, energy in 1e-3 J."""
    per_metre = np.tile([1e3, 1e3, 1e3, 1.0, 1.0, 1.0], NODES)
    for name, file in (("M", "beam_MASS1"), ("K", "beam_STIF1")):
        matrix = np.load(folder / f"{name}.npz")["arr_0"] / (1e-3 * np.outer(per_metre, per_metre))
        lines = [
            f"{i // 6 + 1},{i % 6 + 1},{j // 6 + 1},{j % 6 + 1},{matrix[i, j]:.17g}"
            for i, j in zip(*np.nonzero(np.tril(matrix)), strict=True)
        ]
        (folder / f"{file}.mtx").write_text("\n".join(lines))
    rows = [f"{k + 1}, {125.0 * k}, 0., 0." for k in range(NODES)]
    (folder / "beam.inp").write_text("*NODE\n" + "\n".join(rows) + "\n")


def test_units_and_places_instead_of_numbers_of_nodes(head_on_beam, folder):
    in_mm_and_t(folder)
    data = with_imported(head_on_beam, [f"p{k}" for k in range(NODES)])
    expected = assembled_machine(MachineFile.from_dict(data, folder=folder)).structure
    part = data["imported"]["crossbeam"]
    part.update(mass="beam_MASS1.mtx", stiffness="beam_STIF1.mtx", nodes="beam.inp")
    part["units"] = {"length": "mm", "mass": "t"}
    part["total_mass"] = "49.94 kg"  # 7850 kg/m^3 pi/4 (90 mm)^2 1 m
    for number, point in enumerate(part["point"].values()):
        del point["nodes"]
        x = point["at"][0]
        near = {"box": [[x - 0.01, -0.01, 0], [x + 0.01, 0.01, 0]]}
        point.update({"within": "10 mm"} if number % 2 else near)
    found = assembled_machine(MachineFile.from_dict(data, folder=folder)).structure
    assert found.mass == pytest.approx(expected.mass, rel=1e-9, abs=1e-9)
    assert found.natural_frequencies(8) == pytest.approx(expected.natural_frequencies(8), rel=1e-6)
    part["units"] = {"length": "mm"}
    with pytest.raises(InputError, match=r"beam_MASS1.mtx: has 0.04994 kg along x, 49.94 kg"):
        assembled_machine(MachineFile.from_dict(data, folder=folder))
    part["units"] = {"mass": "t"}
    with pytest.raises(InputError, match=r'point "p1": .* the nearest, 1, is 125 mm .*see units'):
        assembled_machine(MachineFile.from_dict(data, folder=folder))


def test_rail_between_points(head_on_beam, folder):
    expected = assembled_machine(
        MachineFile.from_dict(head_on_beam), positions={"X": 0.03}
    ).structure
    rail = [f"p{k}" for k in range(NODES)]
    file = MachineFile.from_dict(with_imported(head_on_beam, rail), folder=folder)
    found = assembled_machine(file, positions={"X": 0.03}).structure
    # the beam between its points lacks the bending that the force there adds
    ratio = found.natural_frequencies(3) / expected.natural_frequencies(3)
    assert np.all((ratio > 1.0) & (ratio < 1.004)), ratio
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
        ("total_mass", "60 kg", ["imported.crossbeam", "M.npz: has 49.94 kg along x, 60 kg"]),
        ("names", {"mass": "MAAX"}, ['M.npz: has no matrix "MAAX"']),
        (
            "point",
            {"a": {"at": [0, 0.3, 0], "within": "20 mm"}},
            ['point "a"', "the nearest, 1, is 300 mm from the point"],
        ),
        ("point", {"a": {"at": [0, 0, 0]}}, ["point.a.nodes: is missing"]),
        (
            "point",
            {"a": {"at": [0, 0, 0], "nodes": [1], "within": 1}},
            ["nodes and within are both given"],
        ),
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
