"""The file of a run stands for that run, with what measurement.toml beside it says."""

import shutil

import numpy as np
import pytest

from chatter.description.errors import InputError
from chatter.explain.measurement_file import read_measurement
from tests.places import EXAMPLES

FOLDER = EXAMPLES / "explain-axis" / "measurement"


def test_a_single_file_is_as_good_as_its_folder():
    whole = read_measurement(FOLDER)
    one = read_measurement(FOLDER / "move02.npz")
    assert [run.name for run in one.runs] == ["move02.npz"]
    assert one.kind == whole.kind
    same = next(run for run in whole.runs if run.name == "move02.npz")
    assert one.runs[0].signals.keys() == same.signals.keys()
    for name, values in same.signals.items():
        np.testing.assert_array_equal(one.runs[0].signals[name], values)


def test_a_file_without_its_measurement_says_what_it_lacks(tmp_path):
    path = tmp_path / "move02.npz"
    shutil.copy(FOLDER / "move02.npz", path)
    with pytest.raises(InputError, match=r'move02\.npz: is a record, .*file = "move02\.npz"'):
        read_measurement(path)


def test_a_file_that_no_run_names_is_refused(tmp_path):
    for one in FOLDER.iterdir():
        shutil.copy(one, tmp_path / one.name)
    shutil.copy(tmp_path / "move02.npz", tmp_path / "other.npz")
    with pytest.raises(InputError, match=r"other\.npz is the file of no run; there are move01"):
        read_measurement(tmp_path / "other.npz")
