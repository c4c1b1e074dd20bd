"""Code on every page of the manual: commands with options that there are, files that can be read.

Tutorials and docs/ordinary-jobs.md are run as they stand by tests of their own.
"""

import ast
import re
import shlex
from dataclasses import dataclass

import pytest
import tomlkit
import typer

import chatter
from chatter.cli import program
from tests.places import ROOT

PAGES = sorted(
    path
    for path in [*(ROOT / "docs").rglob("*.md"), ROOT / "README.md", ROOT / "CONTRIBUTING.md"]
    if "generated" not in path.parts
)
FENCE = re.compile(r"^```(\w*)[^\n]*\n(.*?)^```$", re.MULTILINE | re.DOTALL)
TABLE = re.compile(r"\s*\[{1,2}[A-Za-z][\w.\-\"* ]*\]{1,2}\s*(#.*)?$")
KEY = re.compile(r"\s*[\"\w.\-]+ = \S")


@dataclass(frozen=True)
class Block:
    kind: str
    text: str


def blocks(page):
    """Fenced and indented blocks; an indented one is what it looks like."""
    text = page.read_text(encoding="utf-8")
    found = [Block(one[1], one[2]) for one in FENCE.finditer(text)]
    rest = FENCE.sub("", text)
    for indented in re.findall(r"(?:\A|\n\n)((?:    .*\n(?:\n(?=    ))?)+)", rest):
        lines = [line[4:] for line in indented.splitlines()]
        found.append(Block(_kind_of(lines), "\n".join(lines) + "\n"))
    return found


def _kind_of(lines):
    written = [line for line in lines if line.strip() and not line.lstrip().startswith("#")]
    if any(line.startswith(("chatter ", "pip ", "python ", "make ")) for line in written):
        return "sh"
    if any(line.startswith(("import ", "from ", "def ", "class ")) for line in written):
        return "python"
    if written and all(TABLE.match(line) or KEY.match(line) for line in written):
        return "toml"
    return "text"


def commands(block):
    for line in block.text.replace("\\\n", " ").splitlines():
        words = shlex.split(line.strip().removeprefix("$ "), comments=True)
        if words[:1] == ["chatter"] and len(words) > 1:
            yield words[1:]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_commands_have_their_options(page):
    group = typer.main.get_command(program)
    for block in blocks(page):
        if block.kind not in ("sh", "text", "bash", "console"):
            continue
        for name, *words in commands(block) if block.kind == "sh" else ():
            if name.startswith("-"):
                continue
            command = group.get_command(typer.Context(group), name)
            assert command is not None, f"chatter {name}"
            context = typer.Context(command, info_name=name)
            command.make_parser(context).parse_args([word for word in words if word != "..."])


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_files_and_scripts_can_be_read(page):
    for block in blocks(page):
        if block.kind == "toml":
            tomlkit.parse(block.text)
        if block.kind == "python":
            tree = ast.parse(block.text)
            for node in ast.walk(tree):
                calls = isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name)
                if calls and node.value.id == "chatter":
                    assert node.attr in (*chatter.__all__, "__version__", "explore"), node.attr


def test_blocks_of_each_kind_are_found():
    kinds = [block.kind for page in PAGES for block in blocks(page)]
    assert min(kinds.count(kind) for kind in ("sh", "toml", "python")) > 5
