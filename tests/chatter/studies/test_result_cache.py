"""The result cache on a disk that fails: an error in words, and what is there stays."""

import re
import sqlite3
import subprocess
import sys
from contextlib import closing

import pytest

from chatter import RunError
from chatter.studies.result_cache import FOLDER, ResultCache

FULL = """
import resource, sys
from chatter import RunError
from chatter.studies.result_cache import ResultCache
with ResultCache(sys.argv[1]) as cache:
    cache["first"] = 1
    resource.setrlimit(resource.RLIMIT_FSIZE, (65536, 65536))
    try:
        for number in range(1000):
            cache[str(number)] = "x" * 1000
    except RunError as error:
        print(error)
"""


def test_a_full_disk_is_told_and_loses_nothing(tmp_path):
    run = subprocess.run(
        [sys.executable, "-c", FULL, str(tmp_path)], capture_output=True, text=True, check=True
    )
    assert re.search(r"result-cache: the cache cannot be written: ", run.stdout)
    with ResultCache(tmp_path) as cache:
        assert cache["first"] == 1


def test_a_damaged_cache_is_told(tmp_path):
    with ResultCache(tmp_path) as cache:
        cache["first"] = 1
    for path in (tmp_path / FOLDER).iterdir():
        path.write_bytes(b"no database at all, by whatever accident" * 200)
    with ResultCache(tmp_path) as cache, pytest.raises(RunError, match=r"result-cache: the cache"):
        cache["first"]


def test_a_record_that_is_no_json_is_told(tmp_path):
    with ResultCache(tmp_path) as cache:
        cache["first"] = 1
    with closing(sqlite3.connect(tmp_path / FOLDER / "cache.db")) as database, database:
        database.execute("UPDATE Cache SET value = '{half'")
    with ResultCache(tmp_path) as cache, pytest.raises(RunError, match="delete it"):
        cache["first"]


def test_a_folder_that_cannot_be_made_is_told(tmp_path):
    (tmp_path / "file").write_text("")
    with (
        ResultCache(tmp_path / "file") as cache,
        pytest.raises(RunError, match="cannot be written"),
    ):
        cache["first"] = 1


def test_two_runs_write_into_one_cache(tmp_path):
    with ResultCache(tmp_path) as one, ResultCache(tmp_path) as other:
        one["a"], other["b"] = 1, 2
        assert (other["a"], one["b"]) == (1, 2)
