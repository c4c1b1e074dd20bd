"""What a report holds, whatever it is written as; `recording` fills it while a command runs."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import tomlkit

from chatter.description.patchable import Description
from chatter.description.path import field_at, parse_path
from chatter.description.units import DIMENSIONS
from chatter.report.parameters import dimension_read_in

#: files of a folder that are listed by name; a folder of records may hold thousands
_FILES_LISTED = 60


class Table(NamedTuple):
    """Table of texts; its numbers have their units in the headings or beside them."""

    title: str
    headers: Sequence[str]
    rows: Sequence[Sequence[str]]


class Picture(NamedTuple):
    """Picture as PNG."""

    name: str
    png: bytes


class InputFile(NamedTuple):
    """A file that a command read."""

    name: str
    size: int  # bytes
    sha256: str


@dataclass
class Document:
    """Report on one call of a command.

    Parameters
    ----------
    command : str
        Name of the command.
    command_line : str
        As it was typed.
    question : str
        What the command was asked.
    methods : list of str
        How the answer was found, each with its source.
    """

    command: str
    command_line: str
    question: str
    methods: list[str] = field(default_factory=list)
    answer: str = ""
    parts: list[str | Table] = field(default_factory=list)
    descriptions: list[Description] = field(default_factory=list)
    files: list[InputFile] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    pictures: list[Picture] = field(default_factory=list)
    written: list[Path] = field(default_factory=list)

    @property
    def title(self) -> str:
        """Title of the first case, else the name of the command."""
        titles = (getattr(one, "title", None) for one in self.descriptions)
        return next((title for title in titles if title), f"chatter {self.command}")

    def add_answer(self, sentence: str) -> None:
        """Take a sentence as the answer; the first one stays, others follow it as text."""
        if self.answer:
            self.parts.append(sentence)
        else:
            self.answer = sentence

    def take_first_sentence_as_answer(self) -> None:
        """Let a sentence before all tables answer where the command named none.

        One that follows a table says more of what the table has told.
        """
        first = next(iter(self.parts), None)
        if not self.answer and isinstance(first, str):
            del self.parts[0]
            self.answer = first

    def add_description(self, described: Description) -> None:
        """Take a case or machine with what was patched in it; once."""
        if not any(one is described or one == described for one in self.descriptions):
            self.descriptions.append(described)

    def add_note(self, note: str) -> None:
        """Take what the reader should know; once."""
        if note not in self.notes:
            self.notes.append(note)

    def add_written(self, paths: Sequence[Path]) -> None:
        """Take files that were written; pictures among them are shown."""
        self.written.extend(paths)
        self.pictures.extend(
            Picture(path.stem, path.read_bytes()) for path in paths if path.suffix.lower() == ".png"
        )

    def add_input(self, path: Path) -> None:
        """Take a file, or those of a folder, with their hashes."""
        found = sorted(one for one in path.rglob("*") if one.is_file()) if path.is_dir() else [path]
        for one in found[:_FILES_LISTED]:
            name = one.relative_to(path.parent).as_posix() if path.is_dir() else one.name
            with one.open("rb") as file:
                digest = hashlib.sha256()
                for block in iter(lambda: file.read(1 << 20), b""):
                    digest.update(block)
            self.files.append(InputFile(name, one.stat().st_size, digest.hexdigest()))
        if len(found) > _FILES_LISTED:
            self.add_note(f"{path.name}: {len(found)} files, the first {_FILES_LISTED} are listed")


def rows_of(described: Description) -> list[list[str]]:
    """Keys and values of a description, in the units of its file; bare numbers have theirs too."""
    return [
        [path, _shown(value, _dimension(described, path, value))]
        for path, value in _leaves(tomlkit.parse(described.to_toml()).unwrap(), "")
    ]


def _dimension(described: Description, path: str, value: object) -> str:
    """Dimension of the bare numbers at a path."""
    steps = parse_path(f"{path}[0]" if isinstance(value, list) else path)
    found = field_at(type(described), steps)
    return "number" if found is None else found.dimension


def _leaves(value: object, path: str) -> Iterator[tuple[str, object]]:
    if isinstance(value, dict):
        for key, one in value.items():
            yield from _leaves(one, f"{path}.{key}" if path else str(key))
    elif isinstance(value, list) and any(isinstance(one, dict | list) for one in value):
        for index, one in enumerate(value):
            yield from _leaves(one, f"{path}[{index}]")
    else:
        yield path, value


def _shown(value: object, dimension: str) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int | float) and DIMENSIONS[dimension].unit:
        read, factor = dimension_read_in(dimension, float(value))
        return f"{factor * value:.6g} {read}"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list):
        return ", ".join(_shown(one, dimension) for one in value)
    return str(value)
