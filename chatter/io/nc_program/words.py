"""Lines of an NC program as words: a letter and a number each."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from chatter.description.errors import InputError

_COMMENT = re.compile(r"\([^()]*\)")
_WORD = re.compile(r"\s*(CR|[A-Z])\s*=?\s*([+-]?(?:\d+\.?\d*|\.\d+))(?![\d.])")
_LONGEST = 40


@dataclass(frozen=True)
class Word:
    """A letter, or CR, and its number."""

    letter: str
    number: float
    text: str  # as written


@dataclass(frozen=True)
class Line:
    """The words of a line, without its number."""

    path: Path
    number: int  # of the line in the file, from 1
    words: tuple[Word, ...]

    def refuse(self, problem: str) -> InputError:
        """Error that names file and line."""
        return InputError(f"{self.path}: line {self.number}: {problem}")

    def of(self, letter: str) -> float | None:
        """Number of a letter that is there once; None where it is not there."""
        found = [word for word in self.words if word.letter == letter]
        if len(found) > 1:
            texts = " and ".join(word.text for word in found)
            raise self.refuse(f"{texts} are both there; one {letter} a block")
        return found[0].number if found else None


def lines_of(path: Path, texts: Sequence[str]) -> Iterator[Line]:
    """Lines that hold words, without comments, program number, line numbers and percent signs.

    InputError where a part of a line is no word.
    """
    for number, text in enumerate(texts, start=1):
        line = Line(path, number, ())
        body = _COMMENT.sub(" ", text.partition(";")[0]).strip().upper()
        if "(" in body or ")" in body:
            raise line.refuse(f"a bracket is open: {text.strip()[:_LONGEST]!r}")
        if not body or body == "%":
            continue
        if body.startswith("/"):
            raise line.refuse("a block that may be skipped (/) is not known: leave it out, or in")
        words = list(_words(line, body))
        if words and words[0].letter in ("O", "N"):
            words.pop(0)
        if words:
            yield Line(path, number, tuple(words))


def _words(line: Line, body: str) -> Iterator[Word]:
    place = 0
    while place < len(body):
        if body[place:].isspace():
            return
        match = _WORD.match(body, place)
        if match is None:
            raise line.refuse(
                f"{body[place:].strip()[:_LONGEST]!r} is no word such as X-12.5 or G1"
            )
        yield Word(match[1], float(match[2]), match[0].strip())
        place = match.end()
