"""Code blocks of a page, and how they are run: what a reader would type, in a folder of its own.

======== =====================================================================================
fence    what happens
======== =====================================================================================
toml     written to the file that its first line names (``# case.toml``)
csv      the same
python   run in one namespace for the page; written first where its first line names a file
sh       each ``chatter`` command is called; ``pip install --editable .`` makes the folder a
         package as pip does, without building it; other programs are not allowed
text     every line stands in what the block before it printed, numbers to 1 %
======== =====================================================================================
"""

from __future__ import annotations

import contextlib
import io
import re
import shlex
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import installed_package

_FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_NAME = re.compile(r"# (\S+\.(?:toml|csv|py))\n")
_PICTURE = re.compile(r"!\[[^\]]*\]\((?:\.\./)*pictures/tutorials/([^)]+)\)")
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_TOLERANCE = 0.01


@dataclass(frozen=True)
class Block:
    """A fenced block of a page."""

    kind: str
    text: str
    line: int

    @property
    def file(self) -> str | None:
        """File that the first line names."""
        found = _NAME.match(self.text)
        return found[1] if found else None


def blocks(page: str) -> list[Block]:
    """Fenced blocks of a page in their order, those of Sphinx left out."""
    return [
        Block(found[1], found[2], page.count("\n", 0, found.start()) + 1)
        for found in _FENCE.finditer(page)
    ]


def pictures(page: str) -> list[str]:
    """Pictures of a tutorial: NAME/PATH, the path within the folder in which it ran."""
    return _PICTURE.findall(page)


def _alike(expected: str, printed: str) -> bool:
    """Whether two texts differ in numbers alone, and those by 1 % at most."""
    if _NUMBER.sub("#", expected) != _NUMBER.sub("#", printed):
        return False
    pairs = zip(_NUMBER.findall(expected), _NUMBER.findall(printed), strict=True)
    return all(
        abs(float(one) - float(other)) <= _TOLERANCE * abs(float(other)) for one, other in pairs
    )


def _plain(line: str) -> str:
    """Line without the frame of a table and with single spaces."""
    return " ".join(re.sub(r"[│┃|]", " ", line).split())


def missing(expected: str, printed: str) -> list[str]:
    """Lines that were not printed; a line of the page may be the beginning of one that was."""
    there = [_plain(line) for line in printed.splitlines()]
    lost = []
    for line in map(_plain, expected.splitlines()):
        if line in ("", "...") or any(line in one or _alike(line, one) for one in there):
            continue
        lost.append(line)
    return lost


class BlockError(AssertionError):
    """A block that fails, or prints something else than its page says."""


@dataclass
class Runner:
    """Runs the blocks of one page; the folder is the working folder of the process."""

    page: str
    namespace: dict[str, Any] = field(default_factory=dict)
    printed: str = ""
    installed: bool = False  # whether the working folder is a package

    def run(self, block: Block) -> None:
        """Run a block; BlockError where it fails."""
        if block.kind == "text":
            lost = missing(block.text, self.printed)
            if lost:
                words = f"{self.page}:{block.line}: not printed: {lost}\n{self.printed}"
                raise BlockError(words)
            return
        if block.file:
            Path(block.file).parent.mkdir(parents=True, exist_ok=True)
            Path(block.file).write_text(block.text, encoding="utf-8")
        if block.kind == "python" and not block.file:
            self.printed = self._python(block)
        elif block.kind == "sh":
            self.printed = "".join(self._command(block, line) for line in _lines(block.text))
        elif block.kind in ("toml", "csv") and not block.file:
            raise BlockError(f"{self.page}:{block.line}: the first line names no file")

    def _python(self, block: Block) -> str:
        code = compile("\n" * block.line + block.text, self.page, "exec")
        with contextlib.redirect_stdout(io.StringIO()) as printed, _modules_of_folder():
            exec(code, self.namespace)
        return printed.getvalue()

    def _command(self, block: Block, line: str) -> str:
        from typer.testing import CliRunner

        from chatter.cli import program

        words = shlex.split(line, comments=True)
        if not words:
            return ""
        if words == ["pip", "install", "--editable", "."]:
            self.installed = installed_package.lay_out(Path.cwd())
            return ""
        if words[0] != "chatter":
            raise BlockError(f"{self.page}:{block.line}: {words[0]} is not chatter")
        if self.installed:
            return installed_package.command(Path.cwd(), words[1:])
        result = CliRunner().invoke(program, words[1:])
        if result.exit_code != 0:
            raise BlockError(f"{self.page}:{block.line}: {line}\n{result.output}")
        return result.stdout + result.stderr


@contextlib.contextmanager
def _modules_of_folder() -> Iterator[None]:
    """Import modules that a page has written, as Python does in its working folder."""
    folder = str(Path.cwd())
    sys.path.insert(0, folder)
    try:
        yield
    finally:
        sys.path.remove(folder)
        for name in [name for name, one in sys.modules.items() if _lies_in(one, folder)]:
            del sys.modules[name]


def _lies_in(module: Any, folder: str) -> bool:
    return str(getattr(module, "__file__", None) or "").startswith(folder)


def _lines(text: str) -> list[str]:
    """Commands of a block; one may go on behind a backslash."""
    return text.replace("\\\n", " ").splitlines()


def run_page(path: Path) -> None:
    """Run all blocks of a page in the working folder; BlockError with the first that fails."""
    page = path.read_text(encoding="utf-8")
    runner = Runner(path.name)
    for block in blocks(page):
        runner.run(block)
    for picture in pictures(page):
        name = picture.split("/", 1)[1]
        if not Path(name).exists():
            raise BlockError(f"{path.name}: {name} was not written")
