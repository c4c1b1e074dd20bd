"""`chatter lobes --live` from the command line."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import urllib.error
import urllib.request

import pytest

from tests.command_line import chatter_command
from tests.places import EXAMPLES

CASE = EXAMPLES / "two-degrees-of-freedom" / "case.toml"
COMMAND = [sys.executable, "-c", "from chatter.cli import main; main()", "lobes", str(CASE)]


@pytest.mark.skipif(os.name != "posix", reason="Ctrl-C is sent as a signal")
def test_serves_until_ctrl_c():
    process = subprocess.Popen(
        [*COMMAND, "--live", "--no-browser", "--method", "zero-order"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        url = process.stdout.readline().split()[0]
        assert url.startswith("http://localhost:")
        with urllib.request.urlopen(url, timeout=60) as answer:
            assert b"bokeh" in answer.read()
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
    finally:
        process.kill()
        process.wait()
    assert process.returncode == 0, errors
    assert "ended" in errors
    assert "Traceback" not in errors
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(url, timeout=5)


@pytest.mark.parametrize(
    "options",
    [["--live", "--grid"], ["--live", "--json"], ["--live", "--tables", "none"], ["--port", "1"]],
)
def test_options_that_do_not_go_together_are_told(options):
    found = chatter_command("lobes", CASE, *options)
    assert found.exit_code == 2
    assert "--live" in found.output


def test_the_page_is_imported_only_when_asked_for():
    script = (
        "import sys, chatter.cli, chatter.stability.diagram;"
        "print(any(name in sys.modules for name in ('chatter.app', 'http.server', 'distributed')))"
    )
    found = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert found.stdout.strip() == "False", found.stderr
