"""Completion as a shell does it: bash itself, with what `chatter --show-completion` prints."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys

import pytest

from tests.places import ROOT

#: calls the function that bash calls for a line whose last word is completed; words are as typed
COMPLETED = """
eval "$(chatter --show-completion bash)"
complete -p chatter
COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMPREPLY=()
_chatter_completion chatter
printf '%s\n' "${COMPREPLY[@]}"
# as `-o default` does: files, where the program offers nothing
[ ${#COMPREPLY[@]} -gt 0 ] || compgen -f -- "${!#}"
"""


@pytest.fixture
def shell(tmp_path):
    """Environment of a shell in which `chatter` is this one."""
    bash = shutil.which("bash")
    assert bash
    program = tmp_path / "bin" / "chatter"
    program.parent.mkdir()
    program.write_text(f"#!{sys.executable}\nfrom chatter.cli import main\n\nmain()\n")
    program.chmod(0o755)
    (tmp_path / "here").mkdir()
    path = f"{program.parent}{os.pathsep}{os.environ['PATH']}"

    def run(script, *words):
        done = subprocess.run(
            [bash, "--norc", "-c", script, "bash", *words], cwd=tmp_path / "here",
            env={**os.environ, "PATH": path, "PYTHONPATH": str(ROOT), "HOME": str(tmp_path),
                 "SHELL": bash},
            capture_output=True, text=True, timeout=120, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        assert not done.stderr
        return done.stdout.splitlines()

    run.folder = tmp_path
    return run


def test_commands_options_values_and_files(shell):
    (shell.folder / "here" / "my case.toml").touch()
    asked = {
        ("lo",): {"lobes"},
        ("mo",): {"modes", "move", "mode-shapes"},
        ("lobes", "case.toml", "--li"): {"--live"},
        ("lobes", "my"): {"my case.toml"},
        ("lobes", r"my\ case.toml", "--out", "m"): {"my case.toml"},
        ("lobes", r"my\ case.toml", "--rep"): {"--report"},
        ("lobes", "case.toml", "--method", "z"): {"zero-order"},
        ("examples", "two-i"): {"two-insert-cutter"},
    }
    for words, wanted in asked.items():
        declared, *offered = shell(COMPLETED, "chatter", *words)
        assert declared == "complete -o default -F _chatter_completion chatter"
        assert set(filter(None, offered)) == wanted, words


def test_it_installs_itself_for_the_next_shell(shell):
    # with one command alone bash would give way to it, and whose shell it is would not be seen
    shell("chatter --install-completion bash; exit $?")
    assert shell('. "$HOME/.bashrc"; complete -p chatter')[-1].endswith("chatter")
