"""Arrays that are kept on disk: read again after a kill, whatever a file of them has come to."""

import re
import subprocess
import sys

import numpy as np
import pytest

from chatter import RunError
from chatter.studies.kept_arrays import KeptArrays

KILLED = """
import os, sys
import numpy as np
from chatter.studies.kept_arrays import KeptArrays
kept = KeptArrays(sys.argv[1], "inputs")
for number in range(5):
    kept.made(str(number), lambda: {"x": np.arange(4.0) + number})
os.kill(os.getpid(), 9)
"""
FULL = """
import resource, sys
import numpy as np
from chatter.studies.kept_arrays import KeptArrays
kept = KeptArrays(sys.argv[1], "inputs")
resource.setrlimit(resource.RLIMIT_FSIZE, (65536, 65536))
try:
    for number in range(100):
        kept.made(str(number), lambda: {"x": np.full(1000, float(number))})
except OSError as error:
    print(error)
"""


def never():
    raise AssertionError("computed again")


def numbers(kept, count):
    """Records that are read, not made."""
    return [kept.made(str(number), never)["x"] for number in range(count)]


def test_what_a_killed_run_has_made_is_read(tmp_path):
    subprocess.run([sys.executable, "-c", KILLED, str(tmp_path)], check=False)
    kept = KeptArrays(tmp_path, "inputs")
    assert kept.count == 5
    np.testing.assert_array_equal(numbers(kept, 5)[4], np.arange(4.0) + 4)


def test_other_inputs_see_nothing_of_it(tmp_path):
    KeptArrays(tmp_path, "inputs").made("0", lambda: {"x": np.ones(2)})
    assert KeptArrays(tmp_path, "others").count == 0


def test_names_types_and_order_of_arrays_stay(tmp_path):
    made = {"b": np.array([1.5, np.nan]), "a": np.arange(3), "c": np.array([1j])}
    KeptArrays(tmp_path, "inputs").made("0", lambda: made)
    found = KeptArrays(tmp_path, "inputs").made("0", never)
    assert list(found) == ["b", "a", "c"]
    for name, values in made.items():
        np.testing.assert_array_equal(found[name], values)
        assert found[name].dtype == values.dtype


@pytest.mark.parametrize("damage", ["cut off", "a byte changed", "something else"])
def test_a_record_that_is_damaged_is_made_again(tmp_path, damage):
    kept = KeptArrays(tmp_path, "inputs")
    for number in range(2):
        kept.made(str(number), lambda number=number: {"x": np.full(50, float(number))})
    (path,) = kept.path.iterdir()
    content = path.read_bytes()
    changed = {
        "cut off": content[:-9],
        "a byte changed": content[:-9] + bytes([content[-9] ^ 1]) + content[-8:],
        "something else": content[: len(content) // 2] + b"no record at all" * 40,
    }
    path.write_bytes(changed[damage])
    again = KeptArrays(tmp_path, "inputs")
    assert numbers(again, 1)[0][0] == 0.0
    assert again.made("1", lambda: {"x": np.full(50, 7.0)})["x"][0] == 7.0
    assert numbers(KeptArrays(tmp_path, "inputs"), 2)[1][0] == 7.0


def test_two_runs_keep_in_one_folder_and_one_may_end_first(tmp_path):
    one, other = KeptArrays(tmp_path, "inputs"), KeptArrays(tmp_path, "inputs")
    one.made("0", lambda: {"x": np.zeros(2)})
    other.made("1", lambda: {"x": np.ones(2)})
    third = KeptArrays(tmp_path, "inputs")
    assert third.count == 2
    one.discard()
    # what another run has deleted is made again
    assert third.made("0", lambda: {"x": np.full(2, 5.0)})["x"][0] == 5.0
    other.made("2", lambda: {"x": np.ones(2)})
    other.discard()
    third.discard()
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_is_told_and_loses_nothing(tmp_path):
    run = subprocess.run(
        [sys.executable, "-c", FULL, str(tmp_path)], capture_output=True, text=True, check=True
    )
    assert re.search(r"predictions cannot be kept: File too large; .*predictions", run.stdout)
    kept = KeptArrays(tmp_path, "inputs")
    assert kept.count == 8  # of 8000 bytes each and some, below 65536
    assert numbers(kept, 8)[7][0] == 7.0


def test_no_more_is_kept_than_a_part_of_the_disk(tmp_path, monkeypatch):
    monkeypatch.setattr("chatter.studies.kept_arrays._MOST_BYTES", 2000)
    kept = KeptArrays(tmp_path, "inputs")
    for number in range(4):
        kept.made(str(number), lambda: {"x": np.zeros(100)})
    assert kept.count == 2


def interrupted(kept):
    """A search that is interrupted after one prediction."""
    with kept.going_on():
        kept.made("0", lambda: {"x": np.zeros(2)})
        raise KeyboardInterrupt


def test_an_interrupted_search_says_what_is_kept(tmp_path):
    with pytest.raises(RunError, match=r"interrupted: 1 predictions are in .* goes on from there"):
        interrupted(KeptArrays(tmp_path, "inputs"))
    with pytest.raises(KeyboardInterrupt):
        interrupted(KeptArrays(None))
