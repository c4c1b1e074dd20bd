"""Columns of numbers between bars, below their names and units, as a lab book prints them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from chatter.io.formats.format import Format
from chatter.io.table import Column, Table

MARK = b"LABBOOK"


def read(path: Path) -> Table:
    _, heading, *rows = path.read_text(encoding="utf-8").splitlines()
    cells = zip(*([float(cell) for cell in row.split("|")] for row in rows), strict=True)
    names = [name.strip() for name in heading.split("|")]
    return Table(path, tuple(Column(n, np.array(c)) for n, c in zip(names, cells, strict=True)))


FORMAT = Format(
    name="labbook",
    label="lab book",
    help="columns between bars",
    extensions=(".lab",),
    read_signals=read,
    recognises=lambda head: head.startswith(MARK),
)
