"""Folders in which nothing can be written: told in words, before the work."""

import os

import pytest

from chatter.cli import options
from chatter.description.errors import InputError
from tests.command_line import chatter_command


def test_a_file_in_the_place_of_a_folder_is_told_before_the_work(tmp_path):
    (tmp_path / "file").write_text("stays")
    run = chatter_command("lobes", "examples/slotting/case.toml", "--out", tmp_path / "file" / "a")
    assert run.exit_code == 2
    assert "file is a file; a folder is required" in run.stderr
    assert "so far" not in run.stderr
    assert (tmp_path / "file").read_text() == "stays"


def test_a_folder_that_may_not_be_written_is_told(tmp_path, monkeypatch):
    """Root may write everywhere but on a disk that is read-only: the system is asked."""
    asked = []

    def refuse(path, mode):
        asked.append((path, mode))
        return False

    monkeypatch.setattr(options.os, "access", refuse)
    with pytest.raises(InputError, match=r"nothing may be written to .*; name another folder"):
        options.output_folder(tmp_path / "new" / "deeper", "case")
    assert asked == [(tmp_path, os.W_OK | os.X_OK)]
    assert not (tmp_path / "new").exists()


def test_the_folder_is_named_after_the_input_where_none_is_given(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert str(options.output_folder(None, "case")) == "case-out"
    assert list(tmp_path.iterdir()) == []
