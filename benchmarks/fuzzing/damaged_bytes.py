"""Strategies of damaged content: cut off, overwritten, repeated, with numbers that fit nothing."""

from __future__ import annotations

import re

from hypothesis import strategies as st

_NUMBER = re.compile(rb"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
_NUMBERS = (
    b"nan",
    b"inf",
    b"-1",
    b"0",
    b"1e400",
    b"1e300",
    b"99999999999999999999",
    b"",
    b"1,5",
    b"x",
)
_WORDS = (
    b"",
    b"\n",
    b"\0",
    b"\xff\xfe",
    b"\t" * 50,
    b";",
    b",",
    b'"',
    b"<!ENTITY a 'b'>",
    b"A" * 20000,
)


@st.composite
def _cut_off(draw: st.DrawFn, content: bytes) -> bytes:
    return content[: draw(st.integers(0, len(content)))]


@st.composite
def _overwritten(draw: st.DrawFn, content: bytes) -> bytes:
    damaged = bytearray(content)
    # headers decide how the rest is read: every second place lies there
    for _ in range(draw(st.integers(1, 6))):
        end = draw(st.sampled_from([min(512, len(damaged)), len(damaged)]))
        at = draw(st.integers(0, max(0, end - 1)))
        if damaged:
            damaged[at] = draw(st.integers(0, 255) | st.sampled_from([0, 127, 128, 255]))
    return bytes(damaged)


@st.composite
def _block(draw: st.DrawFn, content: bytes) -> bytes:
    first = draw(st.integers(0, len(content)))
    last = min(len(content), first + draw(st.integers(1, 2000)))
    block = content[first:last]
    put = draw(st.sampled_from([b"", block * 2, block * 50, block[::-1], bytes(len(block))]))
    return content[:first] + put + content[last:]


@st.composite
def _number(draw: st.DrawFn, content: bytes) -> bytes:
    found = [match.span() for match in _NUMBER.finditer(content, 0, 20000)]
    if not found:
        return content
    first, last = draw(st.sampled_from(found))
    return content[:first] + draw(st.sampled_from(_NUMBERS)) + content[last:]


@st.composite
def _line(draw: st.DrawFn, content: bytes) -> bytes:
    lines = content.split(b"\n")
    at = draw(st.integers(0, len(lines) - 1))
    way = draw(st.integers(0, 3))
    if way == 0:
        del lines[at]
    elif way == 1:
        lines.insert(at, lines[at])
    elif way == 2:
        lines[at] = draw(st.sampled_from(_WORDS)) + lines[at]
    else:
        lines[at] = lines[at].replace(b",", b";").replace(b"\t", b" ")
    return b"\n".join(lines)


@st.composite
def damaged(draw: st.DrawFn, content: bytes) -> bytes:
    """Content of a file damaged at one to three places."""
    for _ in range(draw(st.integers(1, 3))):
        way = draw(st.sampled_from([_cut_off, _overwritten, _overwritten, _block, _number, _line]))
        content = draw(way(content))
    return content
