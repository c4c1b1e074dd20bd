"""The program says that it is loaded, where that takes long, and only then."""

import os
import subprocess
import sys
import threading
import time

from chatter.cli import start_up
from chatter.cli.start_up import StartUp, is_importing
from tests.places import ROOT


def test_an_import_is_seen(tmp_path, monkeypatch):
    (tmp_path / "module_that_takes_long.py").write_text(
        "import time\ntime.sleep(0.5)\n", encoding="utf-8"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    thread = threading.Thread(target=__import__, args=("module_that_takes_long",))
    thread.start()
    time.sleep(0.2)
    assert is_importing(thread)
    thread.join()
    assert not is_importing(thread)


def test_a_word_is_said_while_it_imports(capsys, monkeypatch):
    monkeypatch.setattr(start_up, "_SAID_AFTER", 0.05)
    monkeypatch.setattr(start_up, "_LOOKED_EVERY", 0.05)
    monkeypatch.setattr(start_up, "is_importing", lambda thread: True)
    of_program = StartUp()
    of_program.begin()
    time.sleep(0.4)
    assert capsys.readouterr().err.strip() == "loading the program ..."
    # the word was news: what follows counts from it, once
    assert 0.0 < of_program.end() < 0.4
    assert of_program.end() == 0.0


def test_a_question_that_waits_is_no_silence(capsys, monkeypatch):
    monkeypatch.setattr(start_up, "_SAID_AFTER", 0.05)
    monkeypatch.setattr(start_up, "_LOOKED_EVERY", 0.05)
    of_program = StartUp()
    of_program.begin()
    time.sleep(0.3)
    assert of_program.end() > 0.2
    assert capsys.readouterr().err == ""


def test_a_word_that_is_being_said_ends_before_the_program(monkeypatch):
    monkeypatch.setattr(start_up, "_SAID_AFTER", 0.01)
    monkeypatch.setattr(start_up, "is_importing", lambda thread: True)
    said = []

    def slowly(text):
        time.sleep(0.3)
        said.append(text)

    monkeypatch.setattr("chatter.report.console.print_message", slowly)
    of_program = StartUp()
    of_program.begin()
    time.sleep(0.1)
    of_program.close()
    assert said == ["loading the program ..."]


def test_no_word_between_what_a_shell_completes(tmp_path):
    slow = tmp_path / "sitecustomize.py"
    slow.write_text(
        "from chatter.cli import start_up\n"
        "start_up._SAID_AFTER = 0.0\n"
        "start_up.is_importing = lambda thread: True\n",
        encoding="utf-8",
    )
    words = {"COMP_WORDS": "chatter lo", "COMP_CWORD": "1"}
    of_user = {**os.environ, "PYTHONPATH": f"{tmp_path}{os.pathsep}{ROOT}"}

    def said(**given):
        command = [sys.executable, "-c", "from chatter.cli import main; main()", "materials"]
        done = subprocess.run(
            command, env={**of_user, **given}, capture_output=True, text=True, check=False
        )
        return done.stderr

    assert "loading the program" in said()
    assert said(_CHATTER_COMPLETE="complete_bash", **words) == ""
