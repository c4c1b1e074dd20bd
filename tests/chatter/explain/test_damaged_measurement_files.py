"""What fuzzing found in measurement.toml: refusals that name the file and the key."""

import shutil

import pytest

from chatter import InputError
from chatter.explain.measurement_file import read_measurement
from tests.places import DATA

SET = DATA / "measurements" / "set-121"


@pytest.mark.parametrize("kind", ['["stability"]', "{ of = 1 }", "1", "nan"])
def test_a_kind_that_is_no_word(tmp_path, kind):
    shutil.copytree(SET, tmp_path, dirs_exist_ok=True)
    path = tmp_path / "measurement.toml"
    path.write_text(path.read_text().replace('kind = "stability"', f"kind = {kind}"))
    with pytest.raises(InputError, match=r"measurement\.toml: kind: .* is none of milling"):
        read_measurement(tmp_path)


@pytest.mark.parametrize("name", ["x" * 5000, "a\\u0000b", "", "1"])
@pytest.mark.parametrize("key", ["case", "points"])
def test_a_file_name_that_is_none(tmp_path, key, name):
    shutil.copytree(SET, tmp_path, dirs_exist_ok=True)
    path = tmp_path / "measurement.toml"
    old = {"case": "case.toml", "points": "points.csv"}[key]
    path.write_text(path.read_text().replace(f'{key} = "{old}"', f'{key} = "{name}"'))
    with pytest.raises(InputError, match=r"measurement\.toml: |/1: "):
        read_measurement(tmp_path)
