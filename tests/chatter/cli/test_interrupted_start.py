"""Ctrl-C while the command line is imported: no traceback, and afterwards a KeyboardInterrupt."""

import signal
import subprocess
import sys

WHILE_IMPORTING = """
import os, signal, sys

class Interrupting:
    def find_spec(self, name, path=None, target=None):
        if name == "typer":
            signal.raise_signal(signal.SIGINT)

sys.meta_path.insert(0, Interrupting())
import chatter.cli
"""

AFTERWARDS = """
import signal
import chatter.cli
try:
    signal.raise_signal(signal.SIGINT)
except KeyboardInterrupt:
    print("interrupted")
"""


def of_program(text):
    line = [sys.executable, "-c", text]
    return subprocess.run(line, capture_output=True, text=True, timeout=60.0, check=False)


def test_ctrl_c_while_the_command_line_is_imported_leaves_no_traceback():
    ended = of_program(WHILE_IMPORTING)
    assert ended.returncode != 0
    assert ended.stderr == ""
    if sys.platform != "win32":
        assert ended.returncode == -signal.SIGINT


def test_ctrl_c_is_an_exception_again_afterwards():
    ended = of_program(AFTERWARDS)
    assert (ended.returncode, ended.stdout.strip()) == (0, "interrupted"), ended.stderr


OUTSIDE_OF_A_COMMAND = """
import sys
from chatter.cli.imported_commands import ImportedCommands

def interrupted(self, name):
    raise KeyboardInterrupt

from chatter.cli import main
ImportedCommands.__getitem__ = interrupted
sys.argv = ["chatter", "schema"]
main()
"""


def test_ctrl_c_outside_of_a_command_is_told_as_within_one():
    ended = of_program(OUTSIDE_OF_A_COMMAND)
    assert (ended.returncode, ended.stderr) == (1, "chatter: interrupted\n")
