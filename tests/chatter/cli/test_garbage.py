"""The garbage collector is off while a command starts, and on while it works."""

import gc
import subprocess
import sys

import pytest

from chatter.cli.garbage import collect_from_here, start_without_collection
from chatter.cli.progress import running

AT_START = """
import gc, sys
from chatter.cli import progress
from chatter.cli.imported_commands import ImportedCommands
states = []
taken = ImportedCommands.__getitem__
ImportedCommands.__getitem__ = lambda self, name: states.append(gc.isenabled()) or taken(self, name)
from chatter.cli import main
sys.argv = ["chatter", "schema"]
try:
    main()
except SystemExit:
    print(states, gc.isenabled(), file=sys.stderr)
"""


@pytest.fixture(autouse=True)
def _left_on():
    yield
    gc.enable()
    gc.unfreeze()


def test_work_is_collected_and_what_was_there_before_is_not_looked_at():
    start_without_collection()
    assert not gc.isenabled()
    with running("work"):
        assert gc.isenabled()
        assert gc.get_freeze_count() > 0


def test_a_collector_that_is_on_is_left_alone():
    gc.unfreeze()
    collect_from_here()
    assert gc.isenabled()
    assert gc.get_freeze_count() == 0


def test_a_command_starts_without_and_ends_with_it():
    done = subprocess.run([sys.executable, "-c", AT_START], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stderr.splitlines()[-1] == "[False] True"
