"""Lines of an NC program as words: a letter and a number each."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from chatter.description.errors import InputError

#: not the bracket of "I=AC(25)"
_COMMENT = re.compile(r"(?<!AC)(?<!IC)\([^()]*\)")
#: a text on the screen of the control
_MESSAGE = re.compile(r"^((?:N\d+\s*)?)MSG\s*\(.*\)\s*$")
_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)"
_WORD = re.compile(rf"\s*(CR|[A-Z])\s*=?\s*({_NUMBER})(?![\d.])")
#: an end or a centre that is absolute or incremental by itself, whatever holds in the program
_REFERRED = re.compile(rf"\s*([XYZIJK])\s*=\s*(AC|IC)\s*\(\s*({_NUMBER})\s*\)")
_DECIMAL_COMMA = re.compile(r",\d")
#: first words of a program in the dialogue of Heidenhain
_DIALOGUE = re.compile(r"^(\d+\s+)?(BEGIN PGM|BLK FORM|L [XYZI]|CC |TOOL CALL)")
_LONGEST = 40


@dataclass(frozen=True)
class Word:
    """A letter, or CR, and its number."""

    letter: str
    number: float
    text: str  # as written
    reference: str = ""  # "AC": absolute, "IC": incremental, "": as the program has it


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

    def is_incremental(self, letter: str, usually: bool) -> bool:
        """Whether the number of a letter counts from the start of the block."""
        references = {word.reference for word in self.words if word.letter == letter}
        return "IC" in references or (usually and "AC" not in references)


def lines_of(path: Path, texts: Sequence[str]) -> Iterator[Line]:
    """Lines that hold words, without comments, program number, line numbers and percent signs.

    InputError where a part of a line is no word.
    """
    for number, text in enumerate(texts, start=1):
        line = Line(path, number, ())
        body = _MESSAGE.sub(r"\1", text.partition(";")[0].strip().upper())
        body = _COMMENT.sub(" ", body).strip()
        if body.count("(") != body.count(")"):
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
        referred = _REFERRED.match(body, place)
        match = referred or _WORD.match(body, place)
        if match is None:
            raise line.refuse(_no_word(body, place))
        reference = referred[2] if referred else ""
        yield Word(match[1], float(match[match.lastindex]), match[0].strip(), reference)
        place = match.end()


def _no_word(body: str, place: int) -> str:
    """Why what stands at a place of a line is no word."""
    if _DIALOGUE.match(body):
        return "is a block of Heidenhain's dialogue; write the program as DIN/ISO (G codes)"
    if place and _DECIMAL_COMMA.match(body, place):
        word = body[:place].split()[-1] + body[place:].split()[0]
        return f"{word} has a decimal comma; write a point"
    return f"{body[place:].strip()[:_LONGEST]!r} is no word such as X-12.5 or G1"
