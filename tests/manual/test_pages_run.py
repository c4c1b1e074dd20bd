"""Every command and every Python line of the pages runs, in a folder with the files it names.

Tutorials and docs/ordinary-jobs.md are run, and compared with what they print, by tests of their
own. What is not run stands in `NOT_RUN`, with the reason.
"""

import contextlib
import io
import re
import shlex
import sys

import pytest
from typer.testing import CliRunner

import chatter
from chatter.cli import program
from tests.manual import page_files
from tests.manual.test_code_of_pages import PAGES, blocks
from tests.places import ROOT

sys.path.insert(0, str(ROOT / "docs" / "site"))
import code_blocks

#: page -> what makes its files
FILES = {
    "README.md": page_files.first_toml_of_readme,
    "docs/app.md": page_files.case,
    "docs/assemble.md": page_files.assembly,
    "docs/closing-the-loop.md": page_files.measurement,
    "docs/cluster.md": page_files.given_case,
    "docs/coefficients.md": page_files.cuts_with_forces,
    "docs/detect.md": page_files.recordings,
    "docs/finite-element-parts.md": page_files.case,
    "docs/first-steps.md": page_files.nothing,
    "docs/friction.md": page_files.moves,
    "docs/learning.md": page_files.cutting_tests,
    "docs/optimum.md": page_files.optimum_and_pitch,
    "docs/sheet.md": page_files.sheets,
    "docs/virtual-machine.md": page_files.machine,
    "docs/what-if.md": page_files.shipped_examples,
}
#: minutes each; what they call has quicker tests of its own
NIGHTLY = {
    "docs/assemble.md", "docs/closing-the-loop.md", "docs/coefficients.md", "docs/detect.md",
    "docs/friction.md", "docs/learning.md", "docs/optimum.md", "docs/sheet.md",
    "docs/virtual-machine.md", "docs/what-if.md",
}  # fmt: skip
#: beginning of a command -> why it is not run here
NOT_RUN = {
    "pip ": "changes the environment; tests/test_distribution.py installs the wheel",
    "make ": "runs all of this; the same steps are those of .ci/run",
    "pytest ": "runs all of this",
    "python3 -m venv": "changes the environment",
    "python -m benchmarks": "minutes to hours; tests/benchmarks runs each with few cases",
    "chatter app": "serves until Ctrl-C; tests/chatter/app",
    "chatter compile": "minutes; tests/chatter/first_steps/test_compile_kernels.py",
    "chatter detect cut.wav --spindle-speed \"1656 rpm\" --teeth 6 --follow":
        "goes on until Ctrl-C; tests/chatter/monitoring/test_follow.py",
    "chatter uncertainty CASE --cluster": "a cluster; tests/chatter/studies/test_cluster.py",
    "chatter whatif CASE --vary ... --cluster": "the same, and on another machine",
    "chatter lobes CASE --grid --cluster": "the same",
    "chatter lobes CASE --x machine.axis": "the same",
    "chatter whatif --study workspace --cluster": "the same",
}  # fmt: skip
OWN_TESTS = {"docs/ordinary-jobs.md"}
STATEMENT = re.compile(r"(import|from|print|\w+ = chatter\.|found\b|learnt\b|chatter\.)")
COMMAND = re.compile(r"(chatter|pip|make|pytest|python3?) ")


def name_of(page):
    return page.relative_to(ROOT).as_posix()


def runs(page):
    """Whether a page is run here: its kinds of code, but fenced ones that print."""
    return name_of(page) not in OWN_TESTS and "tutorials" not in page.parts and bool(steps(page))


def steps(page):
    """Commands and Python of a page, in their order: (kind, text)."""
    found = []
    for block in blocks(page):
        if block.kind == "python":
            found.append(("python", block.text))
        elif block.kind in ("sh", "text"):
            for line in block.text.replace("\\\n", " ").splitlines():
                if COMMAND.match(line):
                    found.append(("command", line))
                elif STATEMENT.match(line):
                    found.append(("python", line))
    return found


def why_not(command):
    return next((why for begin, why in NOT_RUN.items() if command.startswith(begin)), "")


def run(command):
    words = [word for word in shlex.split(command, comments=True) if word != "\\"]
    result = CliRunner().invoke(program, words[1:], input="\n" * 5)
    assert result.exit_code == 0, f"{command}\n{result.output}"


RUN = [page for page in PAGES if runs(page)]


@pytest.mark.parametrize(
    "page",
    [pytest.param(one, marks=[pytest.mark.nightly] if name_of(one) in NIGHTLY else [])
     for one in RUN],
    ids=name_of,
)  # fmt: skip
def test_every_block_of_a_page_runs(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    if "theory" in page.parts:
        code_blocks.run_page(page)  # fenced, with what they print
        return
    if name_of(page) in FILES:
        FILES[name_of(page)]()
    namespace = page_files.loaded_case()
    for kind, text in steps(page):
        if kind == "command":
            if not why_not(text):
                run(text)
            continue
        with contextlib.redirect_stdout(io.StringIO()):
            exec(compile(text, name_of(page), "exec"), namespace)


def test_what_is_not_run_is_on_a_page_and_pages_have_their_files():
    commands = [text for page in RUN for kind, text in steps(page) if kind == "command"]
    assert not [begin for begin in NOT_RUN if not any(one.startswith(begin) for one in commands)]
    with_code = {name_of(page) for page in RUN if "theory" not in page.parts}
    assert set(FILES) <= with_code
    assert with_code - set(FILES) == {"CONTRIBUTING.md"}
    assert set(NIGHTLY) <= set(FILES)


def test_code_is_not_missed_in_blocks_of_text():
    """What is neither a command nor Python in a block without a kind is no code."""
    for page in RUN:
        for block in blocks(page):
            if block.kind == "text":
                left = [one for one in block.text.splitlines() if "chatter." in one]
                assert all(STATEMENT.match(one.strip()) or "=" not in one for one in left), left


def test_every_public_name_is_in_the_manual():
    text = "\n".join(page.read_text(encoding="utf-8") for page in PAGES)
    missing = [name for name in chatter.__all__ if f"chatter.{name}" not in text]
    assert not missing
