"""State space of a machine against its receptance, and what other programs read of it."""

import json

import numpy as np
import pytest
import scipy.io

import chatter
from chatter.description.errors import InputError
from chatter.simulation.virtual_tests.from_file import in_state, row_of_point
from dynamics.machine.state_space import state_space
from dynamics.structure.linear_structure import LinearStructure
from tests.command_line import chatter_command
from tests.places import EXAMPLES

MACHINE = EXAMPLES / "machine-coupled-milling" / "machine.toml"


def test_one_freedom_by_hand():
    """m x'' + c x' + k x = f: 1/(k - m w^2 + i c w)."""
    mass, damping, stiffness = 2.0, 30.0, 5e5
    structure = LinearStructure(
        np.array([[mass]]), np.array([[damping]]), np.array([[stiffness]]), {}
    )
    system = state_space(structure, np.ones((1, 1)), np.ones((1, 1)))
    line = 70.0
    omega = 2.0 * np.pi * line
    exact = 1.0 / (stiffness - mass * omega**2 + 1j * damping * omega)
    assert system.response(line)[0, 0, 0] == pytest.approx(exact)


def test_response_is_the_receptance_of_the_structure():
    found = chatter.export(MACHINE)
    assembled = in_state(found.file, type(found.file.frf["rest"])(excite="table:y", band=(1, 2)))
    rows = np.array([row_of_point("", assembled, name) for name in found.inputs])
    lines = np.array([12.0, 49.0, 130.0])
    wanted = assembled.structure.receptance(lines, rows)
    scale = np.abs(wanted).max(axis=(1, 2), keepdims=True)
    assert found.system.response(lines) / scale == pytest.approx(wanted / scale, abs=1e-9)
    assert found.inputs == (
        "motor:X",
        "motor:Y",
        "motor:Z",
        "tool/work:x",
        "tool/work:y",
        "tool/work:z",
    )
    assert found.input_units == ("N*m",) * 3 + ("N",) * 3
    assert found.output_units == ("rad",) * 3 + ("m",) * 3


def test_files_for_other_programs(tmp_path):
    found = chatter.export(MACHINE, ["motor:Y"], ["table:y", "table:rx"])
    found.save(tmp_path)
    with np.load(tmp_path / "state_space.npz", allow_pickle=False) as npz:
        assert npz["B"].shape == (66, 1)
        assert npz["output_names"].tolist() == ["table:y", "table:rx"]
        assert npz["output_units"].tolist() == ["m", "rad"]
    mat = scipy.io.loadmat(tmp_path / "state_space.mat")
    assert np.array_equal(mat["A"], found.system.a)
    assert mat["input_names"][0, 0][0] == "motor:Y"
    assert json.loads((tmp_path / "summary.json").read_text())["states"] == 66


def test_the_command(tmp_path):
    shown = chatter_command("export", MACHINE, "--excite", "motor:Y", "--out", tmp_path)
    assert "66 states" in shown.stdout
    assert (tmp_path / "state_space.mat").exists()


@pytest.mark.parametrize("place", ["tabel:y", "motor:Q", "nothing"])
def test_an_unknown_place_is_told(place):
    with pytest.raises(InputError):
        chatter.export(MACHINE, [place])
