"""Sentences of the program in the words of the page, where they name options of commands."""

from __future__ import annotations

import re

#: what a sentence of the commands says -> what the page says in its place
_INSTEAD = (
    (re.compile(r" \(--method time-domain\)"), " (the view Cut simulates it)"),
    (re.compile(r", or --set [\w.\[\]*]+=(\"[^\"]*\"|\S+)"), ""),
    (re.compile(r"--set:? "), ""),
    (re.compile(r"--vary "), "a value that varies: "),
    (re.compile(r"--direction says otherwise"), "the field Direction says otherwise"),
)
#: any other option is called as its field is
_OPTION = re.compile(r"(?<![\w-])--([a-z][a-z-]*)")


def in_words_of_the_page(text: str) -> str:
    """Return a sentence without options of the command line.

    Commands that are shown to be copied are no sentences, and stay as they are.
    """
    for pattern, words in _INSTEAD:
        text = pattern.sub(words, text)
    return _OPTION.sub(lambda found: found[1].replace("-", " "), text)
