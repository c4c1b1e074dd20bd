"""What a MAT file of version 5 unpacks to: bytes and arrays, counted before it is read.

Shapes of its variables alone bound neither: those of a structure say nothing about its fields.
Source: MathWorks, MAT-File Format, data elements of types miCOMPRESSED and miMATRIX.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from pathlib import Path

from chatter.io.files import read_content
from chatter.io.formats.named_arrays import require_size
from dynamics.frf.container import MeasurementError

#: types of data elements, and classes of arrays that hold arrays: cells, structures, objects
_MATRIX, _COMPRESSED = 14, 15
_OF_ARRAYS = (1, 2, 3)
#: bytes unpacked at a time
_BLOCK = 2**20
#: most arrays in the structures of a file: each takes a hundred bytes of memory, or 8 of a file
_MOST_ARRAYS = 100_000


def require_unpacked_size(path: Path) -> None:
    """MeasurementError where variables unpack to more bytes or more arrays than are read."""
    content = read_content(path)
    order = {b"IM": "<", b"MI": ">"}.get(content[126:128])
    if order is None:
        return
    unpacked = arrays = 0
    for kind, element in _elements(content, order, 128):
        if kind != _COMPRESSED:
            arrays += _arrays(element, order)
            continue
        blocks: list[bytes] = []
        for block in _blocks(element):
            unpacked += len(block)
            require_size(path, float(unpacked))
            # numbers alone are as many as their shape says, which is asked before
            if not blocks or _holds_arrays(blocks[0], order):
                blocks.append(block)
        arrays += _arrays(b"".join(blocks), order)
    if arrays > _MOST_ARRAYS:
        raise MeasurementError(
            f"{path}: its structures and cells hold {arrays} arrays; at most {_MOST_ARRAYS} are "
            "read"
        )


def _blocks(packed: bytes) -> Iterator[bytes]:
    inflation = zlib.decompressobj()
    while packed and not inflation.eof:
        yield inflation.decompress(packed, _BLOCK)
        packed = inflation.unconsumed_tail


def _elements(content: bytes, order: str, at: int) -> Iterator[tuple[int, bytes]]:
    """Types and content, tag included where it is an array, of the elements of a file."""
    while at + 8 <= len(content):
        kind, size = struct.unpack_from(f"{order}II", content, at)
        begin = at if kind == _MATRIX else at + 8
        yield kind, content[begin : at + 8 + size]
        at += 8 + size


def _holds_arrays(element: bytes, order: str, at: int = 0) -> bool:
    """Whether an array, by its flags behind its tag, holds arrays."""
    if at + 20 > len(element):
        return False
    kind, _, _, _, flags = struct.unpack_from(f"{order}5I", element, at)
    return kind == _MATRIX and flags % 256 in _OF_ARRAYS


def _arrays(element: bytes, order: str) -> int:
    """Arrays that lie one in the other, a little more than are allowed at the most."""
    count = at = 0
    while at + 8 <= len(element) and count <= _MOST_ARRAYS:
        kind, size = struct.unpack_from(f"{order}II", element, at)
        count += kind == _MATRIX
        if _holds_arrays(element, order, at) or kind >> 16:
            # what it holds comes next; small elements lie in their tag
            at += 8
        elif kind == _MATRIX:
            at += 8 + size
        else:
            at += 8 + size + -size % 8
    return count
